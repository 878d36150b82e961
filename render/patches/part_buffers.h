/* Draws the area of a part on the visible patches, as far as nothing hides it: what the outline of
 * the part (render/lumigraph/outline.h) goes around. */
#ifndef GOPURA_RENDER_PATCHES_PART_BUFFERS_H
#define GOPURA_RENDER_PATCHES_PART_BUFFERS_H

#include "format/root_page.h"
#include "geometry/view.h"
#include "render/display/gl.h"
#include "render/patches/part_area.h"

struct part_renderer {
	GLuint program;
	GLint clip, lattice, cut, nearer;
};

/* The GPU buffers of the area on one patch. */
struct part_buffers {
	GLuint whole, within;
	uint32_t whole_count, within_count;
	uint32_t serial; /* number of the marked part it belongs to; 0: nothing was made */
};

/* Builds the program; needs a current GL context, as everything here. Errors as gl_program_build.
 */
must_check int part_renderer_init(struct part_renderer *renderer);
void part_renderer_finish(struct part_renderer *renderer); /* Deletes it; zeroed is fine. */

/* Uploads an area and replaces what *out held. serial must not be 0. Errors as gl_check. */
must_check int part_buffers_make(struct part_buffers *out, const struct part_area *area,
				 uint32_t serial);
void part_buffers_finish(struct part_buffers *buffers); /* Deletes them; zeroed is fine. */
/* Returns whether the part has no area on the patch. */
bool part_buffers_are_empty(const struct part_buffers *buffers);

/* Sets up the program. Then draw each patch after binding it (geometry_bind; attributes 1 and 2 are
 * not used). Pixels of the part become white. */
void part_renderer_begin(const struct part_renderer *renderer, const struct view *view,
			 const struct root_page *root);
void part_buffers_draw(const struct part_buffers *buffers);

#endif
