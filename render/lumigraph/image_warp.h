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

enum {
	IMAGE_WARP_ACROSS = 80, /* cells */
	IMAGE_WARP_UP = 45,
	IMAGE_WARP_STEP = 4, /* depths that are read between two points */
	IMAGE_WARP_DEPTHS = IMAGE_WARP_ACROSS * IMAGE_WARP_UP * IMAGE_WARP_STEP * IMAGE_WARP_STEP,
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
	GLuint program;          /* 0: not built yet */
	GLuint depth_program;    /* likewise */
	GLint axes;              /* its uniform */
	struct gl_target depths; /* what is read of a picture's */
	uint8_t *pixels;         /* of it, as read; owned */
	struct image_warp_point point[IMAGE_WARP_POINTS];
	uint16_t index[IMAGE_WARP_INDICES];
};

/* Returns whether the driver can do it: textures of depths, and fragments with highp. */
bool image_warp_is_supported(void);
/* Makes the picture's target of that size, unless it has it, and binds it. The first call also
 * builds the programs. As gl_program_build and gl_target_create, and -ENOMEM. */
must_check int image_warp_begin(struct image_warp *warp, struct image_warp_reference *reference,
				int width_px, int height_px);
/* Takes the depths of the grid from those that the picture was drawn with. Waits for the GPU.
 * As gl_check; then they are what they were. */
must_check int image_warp_read_depths(struct image_warp *warp,
				      struct image_warp_reference *reference);
/* The same from IMAGE_WARP_DEPTHS depths in memory, in the view's rows, upwards; each as the depth
 * buffer has it, 0..1, in 24 bits: the highest byte first, then a byte that does not count. Where
 * nothing was seen, and beyond it, they are infinitely far. No GL. */
void image_warp_take_depths(struct image_warp_reference *reference, const uint8_t *depths);
/* Returns how far the eye is from that of the reference: up to 1 little is missing. No GL. */
float image_warp_off(const struct image_warp_reference *reference, const struct view *view);
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
