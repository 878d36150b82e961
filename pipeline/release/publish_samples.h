/* Turns the rendered samples into the samples page of a release and its objects. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_SAMPLES_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_SAMPLES_H

#include "pipeline/release/object_store.h"
#include "pipeline/samples/sample_store.h"

/* Adds the samples page with its brick and face pages. Tiles stay where the sampler wrote them, and
 * are those of the qualities that were chosen in the store, which is read from its first face on.
 * Errors are logged. */
must_check int publish_samples(struct object_store *objects, struct samples_store *store,
			       struct page_child *out);

#endif
