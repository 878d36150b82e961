/* The finest published patches: the surface that a kiosk draws near to the eye. */
#ifndef GOPURA_PIPELINE_RELEASE_FINEST_PATCHES_H
#define GOPURA_PIPELINE_RELEASE_FINEST_PATCHES_H

#include "format/hierarchy.h"
#include "format/patch.h"
#include "pipeline/release/object_store.h"

struct finest_patches {
	struct patch_mesh *meshes;    /* owned, and what they hold */
	struct hierarchy_patch *rows; /* owned; of each, what the hierarchy page says */
	uint32_t count, room, row_room;
};

/* Reads those patches of a hierarchy page in objects that nothing finer replaces. Errors are as of
 * object_store_read; *out is to be finished all the same. */
must_check int finest_patches_read(struct finest_patches *out, struct object_store *objects,
				   const struct page_child *hierarchy);
void finest_patches_finish(struct finest_patches *patches); /* zeroed is fine */

#endif
