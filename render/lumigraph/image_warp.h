/* Post-rendering 3D warping, as in Mark, McMillan and Bishop, "Post-Rendering 3D Warping" (1997): a
 * board that cannot draw the model in the time of a frame draws it over several frames, for where
 * the eye will be, and shows each frame what it drew last, moved to where the eye is. Every point
 * of a grid over that picture has a depth, so it is a mesh in space with the picture as its
 * texture; what was hidden in the picture is stretched from what is behind. Needs a current GL
 * context, except where a function says so. */
#ifndef GOPURA_RENDER_LUMIGRAPH_IMAGE_WARP_H
#define GOPURA_RENDER_LUMIGRAPH_IMAGE_WARP_H

#include "geometry/view.h"
#include "render/display/gl.h"
#include "render/lumigraph/visibility.h"

enum {
	IMAGE_WARP_STEP = 4, /* pixels of the visibility pass between two points */
	IMAGE_WARP_ACROSS = VISIBILITY_WIDTH / IMAGE_WARP_STEP, /* cells */
	IMAGE_WARP_UP = VISIBILITY_HEIGHT / IMAGE_WARP_STEP,
	/* One ring of cells around them fills the frame where the picture ends. */
	IMAGE_WARP_COLUMNS = IMAGE_WARP_ACROSS + 3, /* of points */
	IMAGE_WARP_ROWS = IMAGE_WARP_UP + 3,
	IMAGE_WARP_POINTS = IMAGE_WARP_COLUMNS * IMAGE_WARP_ROWS,
	IMAGE_WARP_INDICES = 6 * (IMAGE_WARP_COLUMNS - 1) * (IMAGE_WARP_ROWS - 1),
};

/* A picture with the depths of its grid: a reference picture. */
struct image_warp_reference {
	struct gl_target picture;
	struct view view;                 /* the picture may have other sides in pixels */
	float depth_m[IMAGE_WARP_POINTS]; /* along view.forward, rows upwards */
	float nearest_m;                  /* of them */
};

/* A point of the mesh as the program takes it: in clip space, and in the picture, 0..1. */
struct image_warp_point {
	float x, y, u, v;
};

struct image_warp {
	GLuint program; /* 0: not built yet */
	struct image_warp_point point[IMAGE_WARP_POINTS];
	uint16_t index[IMAGE_WARP_INDICES];
};

/* Makes the picture's target of that size, unless it has it, and binds it. The first call also
 * builds the program. As gl_program_build and gl_target_create. */
must_check int image_warp_begin(struct image_warp *warp, struct image_warp_reference *reference,
				int width_px, int height_px);
/* Takes the depths from a visibility pass that was read back, of the reference's view. Where
 * nothing was seen, and beyond it, they are infinitely far. No GL. */
void image_warp_take_depths(struct image_warp_reference *reference,
			    const struct visibility *visibility);
/* Returns whether the eye is so near to that of the reference that little is missing. No GL. */
bool image_warp_reaches(const struct image_warp_reference *reference, const struct view *view);
/* Fills warp->point for the view. No GL. */
void image_warp_place(struct image_warp *warp, const struct image_warp_reference *reference,
		      const struct view *view);
/* Fills warp->index with all triangles in an order in which what is nearer to the eye is drawn
 * later (McMillan 1995, the occlusion-compatible order), so that no depth buffer is needed. No GL.
 */
void image_warp_order(struct image_warp *warp, const struct image_warp_reference *reference,
		      const struct view *view);
/* Draws the reference as the view sees it, over all of the place. */
void image_warp_draw(struct image_warp *warp, const struct image_warp_reference *reference,
		     const struct view *view, const struct gl_place *place);

/* Frees the picture; image_warp_begin makes it again. Zeroed is fine. */
void image_warp_let_go(struct image_warp_reference *reference);
void image_warp_finish(struct image_warp *warp); /* Deletes the program; zeroed is fine. */

#endif
