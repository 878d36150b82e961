/* Reference pictures, where frames take too long: drawn over several frames for where the eye will
 * be, then warped to where it is (render/lumigraph/image_warp.h). Every fifth one has a visibility
 * pass of the same view and pieces. Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_REFERENCE_H
#define GOPURA_RENDER_SCENE_SCENE_REFERENCE_H

#include "render/scene/scene_parts.h"

/* Returns whether frames are made of reference pictures now, where one is near. Not with what the
 * visibility pass does not know: backdrop, streaming mesh. Nor while scenery moves and the eye
 * rests; while both move, scenery is shown as it was when the last reference was drawn. */
bool scene_uses_references(const struct scene *scene);
/* Notes how the eye moves; passed_ms since the last frame. */
void scene_note_motion(struct scene *scene, const struct view *view, float passed_ms);
/* Draws a share of the next reference picture; all of a small one, for this frame, where the eye is
 * too far off the last one. Every fifth frame is left to depths of faces, and every third one where
 * some are missing. Returns whether anything was drawn. */
bool scene_build_reference(struct scene *scene);
/* Shows the last one as the eye sees it now. Returns whether there is one that is near enough. */
bool scene_show_reference(struct scene *scene, const struct gl_place *place);
/* At rest: draws the one that the next motion begins with, unless it did since the picture last
 * changed, so that the answer to a touch need not wait for a whole one. */
void scene_keep_reference(struct scene *scene);
/* The scene is no longer as they show it. */
void scene_forget_references(struct scene *scene);
/* Forgets them, and frees them. */
void scene_drop_references(struct scene *scene);

#endif
