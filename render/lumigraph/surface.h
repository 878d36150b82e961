/* The programs that colour a patch: its own colours under the light, and the images of the faces
 * that see it, tested for occlusion, weighted and blended (docs/lumigraph.md). */
#ifndef GOPURA_RENDER_LUMIGRAPH_SURFACE_H
#define GOPURA_RENDER_LUMIGRAPH_SURFACE_H

#include "format/root_page.h"
#include "geometry/view.h"
#include "render/lumigraph/depth.h"
#include "render/lumigraph/raking_light.h"
#include "render/lumigraph/tiles.h"
#include "render/patches/dissolve.h"
#include "render/patches/patch_buffers.h"

struct surface_program {
	GLuint program;
	GLint clip, lattice, sun, eye, face, place, window, base, tune, share, depth, slack, range,
		rake, cut;
};

/* A program for each number of faces: none, the patch's own colours, is the cheapest; and one each
 * for patches that dissolve, which leave out pixels. */
enum { SURFACE_PROGRAMS = 2 * (PLAN_ENTRIES + 1) };

/* All that again for each tool that is on, made when first drawn with: most visits need none. */
enum { SURFACE_RAKE = 1, SURFACE_CUT = 2, SURFACE_TOOLS = 4 };

struct surface {
	struct surface_program of[SURFACE_TOOLS][SURFACE_PROGRAMS];
	const struct surface_program *used; /* of the last surface_begin */
	const struct tiles *tiles;          /* borrowed */
	bool lacks[SURFACE_TOOLS];          /* the driver refused one: drawn without the tools */
};

/* For the sizes of those textures, which must outlive it. */
must_check int surface_init(struct surface *surface, const struct tiles *tiles);
void surface_finish(struct surface *surface);

struct surface_frame {
	const struct view *view;
	const struct root_page *root;
	const struct tiles *tiles; /* NULL: the patches' own colours */
	const struct depth *depth;
	const struct repository *repository;
	struct rake rake; /* the view has the section */
	bool even;   /* faces weigh what their blend says, whatever they see (the eight corners) */
	bool shares; /* draws how much of a pixel images colour, instead of its colour */
};

/* The program for a piece by which of its faces can be drawn now; below 0: it shows nowhere. */
int surface_choose(const struct surface_frame *frame, const struct blend blend[PLAN_ENTRIES],
		   struct dissolve_range range);
/* How many faces a program blends: 0..PLAN_ENTRIES. */
int surface_faces(int program);
/* Sets up state and uniforms for the program's pieces; geometry_bind and, but for none,
 * surface_dissolve and surface_blend follow per patch and piece. With a section both sides of
 * triangles are needed: the backs are where solid matter is cut. */
void surface_begin(struct surface *surface, const struct surface_frame *frame, int program);
/* Where the patch that is drawn next shows; of no effect in programs that draw it whole. */
void surface_dissolve(const struct surface *surface, struct dissolve_range range);
/* The faces of the piece that is drawn next; error_m as in plan_quality. */
void surface_blend(const struct surface *surface, const struct surface_frame *frame, int program,
		   const struct blend blend[PLAN_ENTRIES], const struct piece *piece,
		   float error_m);

#endif
