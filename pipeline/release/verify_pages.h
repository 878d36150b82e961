/* What each kind of page must hold: the checks of `gopura-content verify`. */
#ifndef GOPURA_PIPELINE_RELEASE_VERIFY_PAGES_H
#define GOPURA_PIPELINE_RELEASE_VERIFY_PAGES_H

#include "pipeline/release/verify_walk.h"

/* Verify a page of each kind, and those of its children that are not pages. */
must_check int verify_root_page(struct verify_walk *walk, const struct verify_page *page);
must_check int verify_hierarchy_page(struct verify_walk *walk, const struct verify_page *page);
must_check int verify_samples_page(struct verify_walk *walk, const struct verify_page *page);
must_check int verify_brick_page(struct verify_walk *walk, const struct verify_page *page);
must_check int verify_face_page(struct verify_walk *walk, const struct verify_page *page);
must_check int verify_info_page(struct verify_walk *walk, const struct verify_page *page);
must_check int verify_labels_page(struct verify_walk *walk, const struct verify_page *page);
must_check int verify_stream_page(struct verify_walk *walk, const struct verify_page *page);

#endif
