/* Turns the information of a content folder into the information page of a release and its
 * objects. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_INFO_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_INFO_H

#include "pipeline/content/info_build.h"
#include "pipeline/release/object_store.h"

/* Adds the information page: the database, then the pictures of the content folder by hash. Errors
 * are logged. */
must_check int publish_info(struct object_store *objects, const struct info_built *info,
			    const char *folder, struct page_child *out);

#endif
