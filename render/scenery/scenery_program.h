/* The shader programs of scenery: one for each set of tools and features of a material, built when
 * it is first drawn with. */
#ifndef GOPURA_RENDER_SCENERY_SCENERY_PROGRAM_H
#define GOPURA_RENDER_SCENERY_SCENERY_PROGRAM_H

#include "format/scenery.h"
#include "render/lumigraph/surface.h"

/* What a program has beside the tools (SURFACE_TOOLS). */
enum {
	SCENERY_DISSOLVES = SURFACE_TOOLS,    /* discards pixels outside a range */
	SCENERY_BY_PIXEL = 2 * SURFACE_TOOLS, /* light at each pixel; needed for what follows */
	SCENERY_GLOSSY = 4 * SURFACE_TOOLS,   /* has a highlight, or shines by itself */
	SCENERY_RELIEF = 8 * SURFACE_TOOLS,
	SCENERY_MIRROR = 16 * SURFACE_TOOLS,
	SCENERY_SUBSTANCE = 32 * SURFACE_TOOLS, /* times enum substance_kind */
	SCENERY_FEATURES = SCENERY_SUBSTANCE * SCENERY_SUBSTANCES,
};

struct scenery_program {
	unsigned features;
	GLuint program; /* 0: the driver refused it */
	GLint clip, model, normal, sides, sun[2], range, specular, emissive, opacity;
	GLint solid, slope, tint, relief, mirror, pixel;
	struct surface_tool_uniforms tools;
};

/* Zeroed is empty. */
struct scenery_programs {
	struct scenery_program *all; /* owned */
	uint32_t count, room;
	uint8_t cut; /* root_page.cut of all */
};

/* Returns the program with those features, bits of the above and of SURFACE_TOOLS, for a release's
 * root_page.cut; a missing one is built. Borrowed until the next call. What the driver refuses is
 * drawn without its material, then without tools; NULL: it refuses that too, or memory is short.
 * Substances and relief need fragments with highp; without, they are left out. */
const struct scenery_program *scenery_programs_get(struct scenery_programs *programs,
						   unsigned features, uint8_t cut);
void scenery_programs_finish(struct scenery_programs *programs); /* zeroed is fine */

#endif
