/* A raking light: it comes from low beside what is looked at, as conservators hold a lamp to a
 * wall, so that relief stands out. It goes with the eye, so what the ring shows stays true while
 * the model turns. Pure; docs/tools.md. */
#ifndef GOPURA_RENDER_LUMIGRAPH_RAKING_LIGHT_H
#define GOPURA_RENDER_LUMIGRAPH_RAKING_LIGHT_H

#include <stdbool.h>

#define RAKE_LOW_DEG  5.0f  /* at the ring */
#define RAKE_HIGH_DEG 60.0f /* in its middle */

struct rake {
	bool on;
	float at[2]; /* the finger in the ring's disc: right and up, within a circle of 1 */
};

/* The nearest place within the ring. */
void rake_place(struct rake *rake, float right, float up);
/* The unit vector towards the light, for an eye with these axes (struct view). */
void rake_direction(const struct rake *rake, const float right[3], const float up[3],
		    const float forward[3], float towards[3]);

/* GLSL ES 1.00, both after light_glsl's. The vertex shader says what the fragments need:
 *   vec4 rake_of(vec3 normal, float open, vec4 sun)   sun.w: above 0.5 where the model is lit
 *   float rake_light(vec4 of, vec3 towards)           the picture's colour times this */
extern const char rake_vertex_glsl[], rake_fragment_glsl[];
/* The same in C. */
float rake_light_at(const float normal[3], float open, const float sun[3], bool lit,
		    const float towards[3]);

#endif
