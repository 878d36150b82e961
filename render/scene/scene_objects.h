/* The objects that the scene knows, by their hash. Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_OBJECTS_H
#define GOPURA_RENDER_SCENE_SCENE_OBJECTS_H

#include "render/scene/scene_parts.h"

/* Returns the object with this hash, or NULL. Borrowed until the next
 * scene_expect. */
struct object *scene_object(struct scene *scene, struct hash hash);
/* Registers what an object is for and returns it; NULL: out of memory. */
struct object *scene_expect(struct scene *scene, struct hash hash, enum object_kind kind,
			    uint64_t id);
/* Logs a content bug; the object is not wanted again. error is a negative errno. */
void scene_refuse(struct scene *scene, struct object *object, int error);

#endif
