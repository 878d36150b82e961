/* Makes the labels of one patch group from the surface of the scan. */
#ifndef GOPURA_PIPELINE_RELEASE_LABEL_PATCH_H
#define GOPURA_PIPELINE_RELEASE_LABEL_PATCH_H

#include "format/label.h"
#include "format/root_page.h"
#include "pipeline/release/label_source.h"

/* patches must be decoded from the published object, because labels refer to its triangles and
 * corners by number. cell_m: the resolution of an outline within a triangle, metres, as far as
 * LABEL_LEVEL_MAX allows. The caller ends *out with label_group_finish(); if part_count is 0, no
 * part is near and nothing needs to be published. Any thread. Returns -ENOMEM, or -EFBIG for more
 * than LABEL_SETS_MAX sets of parts in one group. */
must_check int label_patch_group(struct label_group *out, const struct label_source *source,
				 const struct lattice *lattice, const struct patch_mesh *patches,
				 uint32_t patch_count, float cell_m);

#endif
