/* Makes the octree of where an eye may be (docs/solid.md) from the finest published patches, which
 * are what a kiosk draws near to the eye. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_SOLID_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_SOLID_H

#include "format/root_page.h"
#include "format/solid.h"
#include "pipeline/release/object_store.h"
#include "storage/info.h"

enum { SOLID_BYTES_MOST = 200000 /* of the object: its cells become as small as that allows */ };

/* Adds the object. hierarchy is the hierarchy page in objects. The start view of root and the stops
 * of info's tours are places where an eye is known to be. Returns 1 if *out is set, 0 if the model
 * cannot be described (logged): a kiosk then keeps off by rays. Errors are logged. */
must_check int publish_solid(struct object_store *objects, const struct root_page *root,
			     const struct page_child *hierarchy, const struct info *info,
			     struct page_child *out);

#endif
