/* The lighting formula for a lit model (root_page.lit), one for the sampler, the reference pictures
 * and the kiosk.
 *
 *   light = open * (0.36 + 0.20 * n.z) + 0.62 * max(0, dot(n, sun)) * (0.35 + 0.65 * open)
 *   colour = min(1, sRGB colour * light)          evaluated in sRGB, on purpose: cheap and stable
 *
 * n: unit normal; open: share of the sky that is visible from the vertex (patch_vertex.colour[3]);
 * sun: unit vector towards the sun. */
#ifndef GOPURA_GEOMETRY_LIGHT_H
#define GOPURA_GEOMETRY_LIGHT_H

/* GLSL ES 1.00 source of the function float light(vec3 normal, float open, vec3 sun). */
extern const char light_glsl[];
/* Returns the same light, computed in C, for tests and for baked colours. It may exceed 1. */
float light_at(const float normal[3], float open, const float sun[3]);

#endif
