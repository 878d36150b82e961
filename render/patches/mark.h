/* A part's region on the surface: a bold line of constant width where the surface crosses the
 * region's boundary, a slight tint inside. Drawn over the patches at equal depth. */
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

must_check int mark_init(struct mark *mark);
void mark_finish(struct mark *mark);
/* geometry_bind and draws of patches that region_meets_sphere follow, then mark_end. */
void mark_begin(const struct mark *mark, const struct view *view, const struct root_page *root,
		const struct region *region);
void mark_end(void);

#endif
