/* What the content says of the materials of a scene's file, which the file cannot say: substances,
 * relief, mirrors (scenes.json). Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_SCENERY_LOOK_H
#define GOPURA_PIPELINE_SCENE_SCENERY_LOOK_H

#include "pipeline/scene/scenery_maker.h"

/* Adds the look of that name to a material. Returns whether there is one; name may be NULL. */
bool scenery_look_add(struct scenery_maker *maker, const char *name,
		      struct scenery_material *material);
/* Sets rgb to the mean colour of the material's substance. */
void scenery_look_mean(uint8_t rgb[3], const struct scenery_material *material);
/* Sets how a substance lies in a shape, which is all of the soup: fibres of wood go along its
 * longest side, by the axes of soup->place; beds of stone are level, at rest. root turns the file's
 * axes to those of the model. */
void scenery_look_grain(struct scenery_material *material, const struct soup *soup,
			const struct scenery_place *root);

#endif
