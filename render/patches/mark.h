/* Marks the region of a part on the surface: a bold line of constant width where the surface
 * crosses the boundary of the region, and a slight tint inside. It is drawn over the patches at
 * equal depth. */
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
/* Sets up the program and the GL state. Then draw all patches for which region_meets_sphere is true
 * (geometry_bind, geometry_draw), and call mark_end. */
void mark_begin(const struct mark *mark, const struct view *view, const struct root_page *root,
		const struct region *region);
/* Restores the GL state that the scene expects. */
void mark_end(void);

#endif
