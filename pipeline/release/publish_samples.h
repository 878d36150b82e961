/* Turns the rendered samples into the samples page of a release and its objects. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_SAMPLES_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_SAMPLES_H

#include "pipeline/release/object_store.h"

/* Adds the samples page with its brick and face pages. Tiles stay where the sampler wrote them.
 * Returns -ENOENT if sampling is not complete. Errors are logged. */
must_check int publish_samples(struct object_store *objects, const char *content,
			       struct page_child *out);

#endif
