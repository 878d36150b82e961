/* What the light does on a surface of scenery (struct scenery_material), and what fog does to it:
 * in C, which is the truth, and in GLSL, which is compared with it (docs/materials.md).
 *
 *   light     = light.h, with the whole sky open; 1 where the model has the scan's own colours
 *   highlight = min(1, 4 * max(0, n.sun)) * max(0, n.h) ^ shininess    h: half way between eye and
 * sun colour    = min(1, surface * light + emissive + specular * highlight) fog       = d / range,
 * or 1 - exp(-d / (range - d))    d: distance from the eye; 1 beyond range
 *
 * These are the formulas of VRML97 (4.14.4) under the one sun that a release has. All colours are
 * sRGB, 0 to 1, and not made linear, as in light.h. */
#ifndef GOPURA_GEOMETRY_APPEARANCE_H
#define GOPURA_GEOMETRY_APPEARANCE_H

#include "format/scenery.h"

struct appearance_sun {
	float towards[3]; /* unit vector */
	bool is_lit;      /* root_page.lit */
};

/* Computes the colour of a place. surface: its own colour; normal, to_eye: unit vectors, the normal
 * on the side of the eye. */
void appearance_colour(float rgb[3], const struct scenery_material *material,
		       const float surface[3], const float normal[3], const float to_eye[3],
		       const struct appearance_sun *sun);
/* Returns the share of the fog's colour at a distance, for a range above 0. */
float appearance_fog(float distance_m, float range_m, bool is_exponential);

/* GLSL ES 1.00 source of
 *   float highlight(vec3 n, vec3 to_eye, vec3 sun, float shininess)
 *   float fog_share(float d, bool is_exponential), d as a share of the range. */
extern const char appearance_glsl[], appearance_fog_glsl[];

#endif
