/* Scenery in the scene: its object, its time, its place in the picture. Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_SCENERY_H
#define GOPURA_RENDER_SCENE_SCENE_SCENERY_H

#include "render/scene/scene_parts.h"

/* Takes what a worker decoded, unless it is here already, and uploads it; *scenery is then empty.
 * -ENOMEM, or as gl_check. */
must_check int scene_put_scenery(struct scene *scene, struct scenery *scenery);
/* Lets time pass; returns whether the picture changes. */
bool scene_step_scenery(struct scene *scene, float passed_ms);
/* Returns the fog that is seen now. */
struct surface_fog scene_fog(const struct scene *scene);
/* Returns the bytes of its pictures. */
uint64_t scene_scenery_bytes(const struct scene *scene);
/* Returns whether it waits for a program, or a face of what mirrors show, one of which each frame
 * makes: the picture has to be drawn again. */
bool scene_scenery_waits(const struct scene *scene);
/* Draws it over the patches. What has just come is made ready first, and appears then. */
void scene_draw_scenery(struct scene *scene, const struct surface_frame *frame);
/* Returns whether a picture of this frame would have it as it stays until it is touched: nothing of
 * it moves. True before it appears, and without scenery. */
bool scene_scenery_is_still(const struct scene *scene);
/* Draws its depths into the visibility pass that was begun. */
void scene_draw_scenery_depths(struct scene *scene);
/* Returns how far from an eye it may reach; metres, 0: none is shown. */
float scene_scenery_far_m(const struct scene *scene, const float eye_m[3]);
/* Returns the node of the scenery that the ray meets before *distance_m, which is lowered to it, or
 * SCENERY_NONE. */
uint32_t scene_ray_scenery(const struct scene *scene, const float from_m[3],
			   const float direction[3], float least_m, float *distance_m);
/* Frees it. */
void scene_drop_scenery(struct scene *scene);

#endif
