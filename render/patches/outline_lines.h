/* Draws outlines as bold lines over the patches they lie on. The width in pixels is the same at any
 * distance, and the model hides them like its surface. The area inside is tinted slightly. */
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

struct outline_renderer {
	struct outline_lines_program line, tint;
	GLuint quads; /* index buffer for the quads of one draw call */
};

/* The GPU buffers of an outline. */
struct outline_lines {
	GLuint lines, whole, within;
	uint32_t line_count, whole_count, within_count;
	uint32_t serial; /* number of the marked part it belongs to; 0: nothing was made */
};

/* Builds the programs; needs a current GL context, as everything here. Errors as gl_program_build,
 * or -ENOMEM; then call outline_renderer_finish. */
must_check int outline_renderer_init(struct outline_renderer *outlines);
/* Frees everything; zeroed is fine. */
void outline_renderer_finish(struct outline_renderer *outlines);

/* Uploads an outline and replaces what *out held. serial must not be 0. -ENOMEM, or as gl_check. */
must_check int outline_lines_make(struct outline_lines *out, const struct outline *outline,
				  uint32_t serial);
void outline_lines_finish(struct outline_lines *lines); /* Deletes the buffers; zeroed is fine. */

/* Drawing is blended over the picture, whose depth stays as it is. First the tints: each with its
 * patch bound (geometry_bind; attributes 1 and 2 are not used). */
void outline_renderer_begin_tints(const struct outline_renderer *outlines, const struct view *view,
				  const struct root_page *root);
/* Draws the tint of one patch, after outline_renderer_begin_tints. */
void outline_lines_tint(const struct outline_lines *lines);
/* Then the lines. */
void outline_renderer_begin_lines(const struct outline_renderer *outlines, const struct view *view,
				  const struct root_page *root);
/* Draws the lines of one patch, after outline_renderer_begin_lines; the patch need not be bound. */
void outline_lines_lines(const struct outline_lines *lines);
/* Finally restores the GL state that the scene expects. */
void outline_renderer_end(void);

#endif
