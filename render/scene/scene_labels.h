/* The labels of the release, for the scene: loads them, and makes the area of the marked part
 * on each patch. Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_LABELS_H
#define GOPURA_RENDER_SCENE_SCENE_LABELS_H

#include "render/scene/scene_parts.h"

/* Takes the labels page; needs the hierarchy. -EBADMSG, -ENOMEM. */
must_check int scene_open_labels(struct scene *scene, struct bytes bytes);
/* Frees what the labels page gave. */
void scene_drop_labels(struct scene *scene);
/* Returns whether the release has labels, here already or not. */
bool scene_has_labels(const struct scene *scene);
/* Provides the area of the marked part on a patch, and makes it where it is missing. Returns false
 * where the labels are not here, no part is marked, or memory is short. */
bool scene_part_area(struct scene *scene, uint32_t patch);

#endif
