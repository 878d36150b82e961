/* Outlines as bold lines over the patches they lie on: as wide in pixels from near as from afar,
 * and hidden where the model hides them; what lies within is tinted slightly. */
#ifndef GOPURA_RENDER_PATCHES_OUTLINE_LINES_H
#define GOPURA_RENDER_PATCHES_OUTLINE_LINES_H

#include "format/root_page.h"
#include "geometry/view.h"
#include "render/display/gl.h"
#include "render/patches/outline.h"

struct outline_lines_program {
	GLuint program;
	GLint clip, lattice, picture, cut;
};

struct ribbons {
	struct outline_lines_program line, tint;
	GLuint quads; /* indices of as many as are drawn at once */
};

/* An outline on the GPU. */
struct outline_lines {
	GLuint lines, whole, within;
	uint32_t line_count, whole_count, within_count;
	uint32_t serial; /* of what it is; 0: nothing was made */
};

must_check int ribbons_init(struct ribbons *ribbons);
void ribbons_finish(struct ribbons *ribbons);

must_check int outline_lines_make(struct outline_lines *out, const struct outline *outline,
				  uint32_t serial);
void outline_lines_finish(struct outline_lines *lines); /* zeroed is fine */

/* Blended over the picture, whose depth stays as it is. In this order: tints, each with its patch
 * bound (geometry_bind; attributes 1 and 2 are not used), lines, the end. */
void ribbons_begin_tints(const struct ribbons *ribbons, const struct view *view,
			 const struct root_page *root);
void outline_lines_tint(const struct outline_lines *lines);
void ribbons_begin_lines(const struct ribbons *ribbons, const struct view *view,
			 const struct root_page *root);
void outline_lines_lines(const struct outline_lines *lines);
void ribbons_end(void);

#endif
