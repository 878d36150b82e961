/* Draws pictures of the scene: its pieces, the streaming mesh, what stands behind and beside.
 * Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_PICTURE_H
#define GOPURA_RENDER_SCENE_SCENE_PICTURE_H

#include "render/scene/scene_parts.h"

/* Direct: in the caller's framebuffer; aside: in a target; shares: there, of the images. */
enum picture { PICTURE_DIRECT, PICTURE_ASIDE, PICTURE_SHARES };

/* Clears the bound target to the background. */
void scene_begin_picture(const struct scene *scene);
/* Sets the state in which pieces are drawn, after other things were drawn. */
void scene_resume_picture(void);
/* What a picture of that kind needs to be drawn in the view, which is borrowed. */
struct surface_frame scene_surface_frame(const struct scene *scene, const struct view *view,
					 enum picture kind);
/* Begins to draw pieces: chooses the program of each. pieces are borrowed until all are drawn. */
void scene_begin_slices(struct scene *scene, const struct surface_frame *frame,
			struct visible_piece *pieces, uint32_t count, struct scene_slice *out);
/* Returns what a piece that blends so many faces costs in a picture of that many pixels, in
 * triangles of the visibility pass. */
float scene_piece_cost(const struct scene *scene, const struct visible_piece *v, int faces,
		       float picture_px);
/* Draws the next of them, that cost at least so much together. Returns whether all are drawn. */
bool scene_draw_slice(struct scene *scene, const struct surface_frame *frame,
		      struct scene_slice *slice, float cost);
/* Draws what a picture has besides pieces: streaming mesh, backdrop, scenery. */
void scene_draw_beside(struct scene *scene, const struct surface_frame *frame);
/* Draws the listed pieces, and what else is shown, as seen in a view. */
void scene_draw_picture(struct scene *scene, const struct view *view, enum picture kind);

#endif
