/* The shader programs of scenery: one for each set of tools and features of a material. A driver
 * may take long to build one, so a frame builds one at most, and draws with plainer ones meanwhile.
 */
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
	SCENERY_TEXTURE = 32 * SURFACE_TOOLS,
	SCENERY_NORMALS = 64 * SURFACE_TOOLS,    /* has a normal map */
	SCENERY_SUBSTANCE = 128 * SURFACE_TOOLS, /* times enum substance_kind */
	SCENERY_FEATURES = SCENERY_SUBSTANCE * SCENERY_SUBSTANCES,
};

struct scenery_program {
	unsigned features;
	GLuint program; /* 0: the driver refused it */
	GLint clip, model, normal, sides, sun[2], range, specular, emissive, opacity;
	GLint solid, slope, tint, relief, mirror, pixel, uv;
	struct surface_tool_uniforms tools;
};

/* Zeroed is empty. */
struct scenery_programs {
	struct scenery_program *all; /* owned */
	uint32_t count, room;
	uint8_t cut;   /* root_page.cut of all */
	bool is_built; /* the frame has built one */
	bool lacks;    /* the frame needs another one */
};

/* Begins a frame of a release with that root_page.cut: it may build a program. */
void scenery_programs_begin(struct scenery_programs *programs, uint8_t cut);
/* Returns the program with those features, bits of the above and of SURFACE_TOOLS. A missing one is
 * built unless the frame has built one. Otherwise returns what is alike: the one that dissolves as
 * well, else without the material; NULL: there is none, so the mesh is drawn later. What the driver
 * refuses is drawn without its material, then without tools. Borrowed until the next call.
 * Substances, relief and normal maps need fragments with highp, and normal maps derivatives
 * (OES_standard_derivatives); without, they are left out. */
const struct scenery_program *scenery_programs_get(struct scenery_programs *programs,
						   unsigned features);
/* Builds the program with those features before it is needed, whatever else the frame has built.
 * Returns it, or NULL where it is there already, or refused. Borrowed until the next call. */
const struct scenery_program *scenery_programs_make(struct scenery_programs *programs,
						    unsigned features);
void scenery_programs_finish(struct scenery_programs *programs); /* zeroed is fine */

#endif
