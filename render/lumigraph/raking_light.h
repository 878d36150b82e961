/* A raking light: light from low beside the surface, as conservators hold a lamp to a wall, so that
 * relief stands out. The light moves with the eye, so the position shown in the ring stays right
 * while the model turns. Pure; docs/tools.md. */
#ifndef GOPURA_RENDER_LUMIGRAPH_RAKING_LIGHT_H
#define GOPURA_RENDER_LUMIGRAPH_RAKING_LIGHT_H

#include <stdbool.h>

#define RAKE_LOW_DEG  5.0f  /* elevation at the ring */
#define RAKE_HIGH_DEG 60.0f /* elevation in its middle */

struct rake {
	bool on;
	/* position of the finger in the disc of the ring: right and up, within a circle of radius
	 * 1 */
	float at[2];
};

/* Sets the position to the nearest point within the ring. */
void rake_place(struct rake *rake, float right, float up);
/* Writes the unit vector towards the light, for an eye with these axes (struct view). */
void rake_direction(const struct rake *rake, const float right[3], const float up[3],
		    const float forward[3], float towards[3]);

/* GLSL ES 1.00 sources; both need light_glsl before them. The vertex shader computes what the
 * fragment shader needs:
 *   vec4 rake_of(vec3 normal, float open, vec4 sun)   sun.w: above 0.5 where the model is lit
 *   float rake_light(vec4 of, vec3 towards)           factor for the picture's colour */
extern const char rake_vertex_glsl[], rake_fragment_glsl[];
/* Returns the same factor, computed in C. */
float rake_light_at(const float normal[3], float open, const float sun[3], bool lit,
		    const float towards[3]);

#endif
