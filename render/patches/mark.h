/* Draws what lies inside the region of a part white, as far as nothing hides it: what the outline
 * of the part (render/lumigraph/outline.h) goes around, where its labels are not loaded. Drawn over
 * the patches at equal depth. */
#ifndef GOPURA_RENDER_PATCHES_MARK_H
#define GOPURA_RENDER_PATCHES_MARK_H

#include "format/root_page.h"
#include "geometry/region.h"
#include "geometry/view.h"
#include "render/display/gl.h"

struct mark {
	GLuint program;
	GLint clip, lattice, region, corners, middle, cut;
};

/* Builds the program; needs a current GL context. Errors as gl_program_build. */
must_check int mark_init(struct mark *mark);
/* Deletes the program; a zeroed mark is fine. */
void mark_finish(struct mark *mark);
/* Sets up the program. Then draw all patches for which region_meets_sphere is true (geometry_bind,
 * geometry_draw). */
void mark_begin(const struct mark *mark, const struct view *view, const struct root_page *root,
		const struct region *region);

#endif
