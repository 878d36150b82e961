/* Labels of one patch group from the surface of the scan. */
#ifndef GOPURA_PIPELINE_RELEASE_LABEL_PATCH_H
#define GOPURA_PIPELINE_RELEASE_LABEL_PATCH_H

#include "format/label.h"
#include "format/root_page.h"
#include "pipeline/release/label_source.h"

/* patches: as decoded from the published object, since labels count its triangles and corners.
 * cell_m: an outline within a triangle is as fine as this, where LABEL_LEVEL_MAX allows. *out is
 * finished by the caller; part_count 0: no part comes near, there is nothing to publish. Any
 * thread. -ENOMEM; -EFBIG: more than LABEL_SETS_MAX sets of parts in one group. */
must_check int label_patch_group(struct label_group *out, const struct label_source *source,
				 const struct lattice *lattice, const struct patch_mesh *patches,
				 uint32_t patch_count, float cell_m);

#endif
