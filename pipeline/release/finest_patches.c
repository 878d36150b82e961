/* Reads the groups of a hierarchy page, and keeps the patches that nothing finer replaces. */
#include "pipeline/release/finest_patches.h"

#include <stdlib.h>

#include "base/array.h"

void finest_patches_finish(struct finest_patches *patches)
{
	for (uint32_t i = 0; i < patches->count; i++)
		patch_mesh_finish(&patches->meshes[i]);
	free(patches->meshes);
	free(patches->rows);
	*patches = (struct finest_patches){ 0 };
}

static int add_group(struct finest_patches *out, struct object_store *objects, struct hash name,
		     const struct hierarchy_patch *rows)
{
	struct patch_mesh meshes[GROUP_PATCHES_MAX];
	uint32_t count;
	int rc = object_store_read_group(objects, name, meshes, &count);

	if (rc == 0)
		rc = ARRAY_RESERVE(out->meshes, out->room, out->count + count, UINT32_MAX);
	if (rc == 0)
		rc = ARRAY_RESERVE(out->rows, out->row_room, out->count + count, UINT32_MAX);
	for (uint32_t i = 0; i < count; i++) {
		if (rc < 0 || rows[i].finer != HIERARCHY_NONE) {
			patch_mesh_finish(&meshes[i]);
			continue;
		}
		out->rows[out->count] = rows[i];
		out->meshes[out->count++] = meshes[i];
	}
	return rc;
}

int finest_patches_read(struct finest_patches *out, struct object_store *objects,
			const struct page_child *page_name)
{
	struct hierarchy hierarchy = { 0 };
	struct page page;
	struct buffer bytes;
	int rc = object_store_read_page(objects, page_name, &page, &bytes);

	*out = (struct finest_patches){ 0 };
	if (rc == 0)
		rc = hierarchy_decode(&hierarchy, page.payload);
	for (uint32_t i = 0; rc == 0 && i < hierarchy.group_count; i++) {
		const struct hierarchy_group *group = &hierarchy.groups[i];
		bool is_finest = false;

		for (uint32_t k = 0; k < group->patch_count; k++)
			is_finest |=
				hierarchy.patches[group->first_patch + k].finer == HIERARCHY_NONE;
		if (is_finest)
			rc = add_group(out, objects, page.children[i].hash,
				       &hierarchy.patches[group->first_patch]);
	}
	hierarchy_finish(&hierarchy);
	page_finish(&page);
	buffer_finish(&bytes);
	return rc;
}
