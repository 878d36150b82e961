/* The programs that colour a patch: its own colours under the light, and the images of the faces
 * that see it, tested for occlusion, weighted and blended (docs/lumigraph.md). */
#ifndef GOPURA_RENDER_SURFACE_H
#define GOPURA_RENDER_SURFACE_H

#include "format/root_page.h"
#include "render/depth.h"
#include "render/geometry.h"
#include "render/tiles.h"
#include "render/view.h"

struct surface_program {
	GLuint program;
	GLint clip, lattice, sun, eye, face, slot, tune, share;
};

struct surface {
	struct surface_program plain, blended;
	GLint far_m, slack;
};

/* atlas_px: of the tiles' atlas. */
must_check int surface_init(struct surface *surface, int atlas_px);
void surface_finish(struct surface *surface);

struct surface_frame {
	const struct view *view;
	const struct root_page *root;
	const struct tiles *tiles; /* NULL: the patches' own colours */
	const struct depth *depth;
	bool even;   /* faces weigh what their blend says, whatever they see (the eight corners) */
	bool shares; /* draws how much of a pixel images colour, instead of its colour */
};

/* Sets up state and uniforms; geometry_bind and surface_blend follow per patch and piece. */
void surface_begin(const struct surface *surface, const struct surface_frame *frame);
/* The faces of the piece that is drawn next, at most PLAN_ENTRIES; error_m and
 * spacing_m as in plan_quality and plan_own_quality. */
void surface_blend(const struct surface *surface, const struct surface_frame *frame,
		   const struct repository *repository, const struct blend *blend, float error_m,
		   float spacing_m);

#endif
