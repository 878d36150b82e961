/* Adds the one object of scenery. */
#include "pipeline/release/publish_scenery.h"

#include <string.h>

#include "base/log.h"
#include "format/scenery_code.h"

int publish_scenery(struct object_store *objects, struct sources *sources, struct page_child *out)
{
	const struct scenery *scenery;
	struct buffer object;
	int rc = sources_scenery(sources, &scenery);

	if (rc < 0 || scenery->node_count == 0)
		return rc;
	buffer_init(&object, OBJECT_BYTES_MAX);
	rc = scenery_encode(&object, scenery);
	if (rc == 0)
		rc = object_store_add(objects, buffer_bytes(&object), out);
	if (rc < 0)
		log_error("pipeline", "the scenery: %s", strerror(-rc));
	buffer_finish(&object);
	return rc < 0 ? rc : 1;
}
