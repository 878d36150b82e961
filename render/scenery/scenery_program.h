/* The shader programs of scenery: one for each set of tools and features of a material, built when
 * it is first drawn with. */
#ifndef GOPURA_RENDER_SCENERY_SCENERY_PROGRAM_H
#define GOPURA_RENDER_SCENERY_SCENERY_PROGRAM_H

#include "render/lumigraph/surface.h"

/* What a program has beside the tools (SURFACE_TOOLS). */
enum {
	SCENERY_DISSOLVES = SURFACE_TOOLS,    /* discards pixels outside a range */
	SCENERY_BY_PIXEL = 2 * SURFACE_TOOLS, /* light at each pixel */
	SCENERY_GLOSSY = 4 * SURFACE_TOOLS,   /* has a highlight, or shines by itself */
	SCENERY_FEATURES = 8 * SURFACE_TOOLS,
};

struct scenery_program {
	GLuint program;  /* 0: not built yet */
	bool is_lacking; /* the driver refused it */
	GLint clip, model, normal, sides, sun[2], range, specular, emissive, opacity;
	struct surface_tool_uniforms tools;
};

/* Zeroed is empty. */
struct scenery_programs {
	struct scenery_program of[SCENERY_FEATURES];
};

/* Returns the program with those features, bits of the above and of SURFACE_TOOLS; it is built
 * where it is missing. What the driver refuses is drawn without its material, then without tools;
 * NULL: it refuses that too. */
const struct scenery_program *scenery_programs_get(struct scenery_programs *programs,
						   unsigned features);
void scenery_programs_finish(struct scenery_programs *programs); /* zeroed is fine */

#endif
