/* Substances, relief and mirrors for materials of any file. */
#include "pipeline/scene/scenery_look.h"

#include <math.h>
#include <string.h>

#include "geometry/vec.h"

bool scenery_look_add(struct scenery_maker *maker, const char *name,
		      struct scenery_material *material)
{
	for (uint32_t i = 0; i < maker->look_count && name; i++) {
		struct scenery_look *look = &maker->looks[i];

		if (strcmp(look->name, name) != 0)
			continue;
		look->is_used = true;
		material->substance = (uint8_t)look->substance;
		material->relief_m = look->relief_m;
		material->mirror = look->mirror;
		material->by_pixel = true;
		return true;
	}
	return false;
}

void scenery_look_mean(uint8_t rgb[3], const struct scenery_material *material)
{
	static const float nowhere[3], far_m = 1e6f;
	float mean[3];

	substance_colour(mean, (enum substance_kind)material->substance, nowhere, far_m);
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)(mean[k] * 255 + 0.5f);
}

void scenery_look_grain(struct scenery_material *material, const struct soup *soup,
			const struct scenery_place *root)
{
	const float towards[4] = { -root->turn[0], -root->turn[1], -root->turn[2], root->turn[3] };
	float longest = 0;

	if (!material->substance)
		return;
	/* z of the model in the axes of the file */
	material->grain[0] = 2 * (towards[0] * towards[2] + towards[3] * towards[1]);
	material->grain[1] = 2 * (towards[1] * towards[2] - towards[3] * towards[0]);
	material->grain[2] = 1 - 2 * (towards[0] * towards[0] + towards[1] * towards[1]);
	vec_normalise(material->grain);
	for (int axis = 0; axis < 3 && material->substance == SUBSTANCE_WOOD; axis++) {
		float unit[3], low = INFINITY, high = -INFINITY;

		vec_copy(unit, &soup->place[4 * axis]);
		if (!(vec_normalise(unit) > 0))
			continue;
		for (uint32_t i = 0; i < 3 * soup->count; i++) {
			const float at =
				vec_dot(soup->triangles[i / 3].corners[i % 3].position, unit);

			low = vec_least(low, at);
			high = vec_most(high, at);
		}
		if (high - low > longest * 1.001f) {
			longest = high - low;
			vec_copy(material->grain, unit);
		}
	}
}
