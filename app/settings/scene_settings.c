/* Copies a profile's values into the options of a scene: render does not know boards. */
#include "app/settings/scene_settings.h"

struct scene_options scene_settings(const struct profile *profile, enum scene_mode mode)
{
	return (struct scene_options){
		.mode = mode,
		.texture_budget_bytes = (uint64_t)profile->texture_mib << 20,
		.geometry_budget_bytes = (uint64_t)profile->geometry_mib << 20,
		.triangle_budget = profile->triangles,
		.patch_error_px = profile->error_px,
		.price_px_per_kb = profile->price_px_per_kb,
		.upload_budget_us = profile->upload_us,
		.worker_count = profile->workers,
	};
}
