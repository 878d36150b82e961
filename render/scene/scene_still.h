/* Pictures of an eye that rests: each shifted by a part of a pixel, and added up
 * (render/lumigraph/accumulation.h). Where a board cannot draw a whole picture in a frame, they are
 * drawn in parts, and left for later if something waits, such as a touch. Private to render/scene.
 */
#ifndef GOPURA_RENDER_SCENE_SCENE_STILL_H
#define GOPURA_RENDER_SCENE_SCENE_STILL_H

#include "render/scene/scene_parts.h"

/* Returns whether the rest of a picture is to be drawn. Until it is, nothing else that the picture
 * shows may be changed. */
bool scene_still_is_begun(const struct scene *scene);
/* What was begun, or added up, is not what the eye sees any more. */
void scene_still_forget(struct scene *scene);
/* The eye sees something new in the same place: the next picture is begun again, and until it is
 * whole the sum of those before is shown. */
void scene_still_renew(struct scene *scene);
/* Shows the sum at the place; before, if draws is true, a picture is drawn and added, unless
 * something waits: then what was seen last is shown, and the picture is begun. The accumulation is
 * prepared. changed: the scene is not as it was in the picture before. */
void scene_still_show(struct scene *scene, const struct gl_place *place, bool draws, bool changed);

#endif
