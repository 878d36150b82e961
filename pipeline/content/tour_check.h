/* Checks the tours of a content folder: whether the path, as the kiosk flies it, is too near to the
 * scan's surface, leaves the camera's limits, or turns too fast. docs/tours.md. */
#ifndef GOPURA_PIPELINE_CONTENT_TOUR_CHECK_H
#define GOPURA_PIPELINE_CONTENT_TOUR_CHECK_H

#include "pipeline/content/info_build.h"
#include "pipeline/import/mesh.h"

enum { TOUR_MINUTES_MAX = 10 };

struct tour_check_options {
	const struct mesh *mesh;         /* all scans; borrowed */
	struct diagnostics *diagnostics; /* gets every fault; borrowed */
};

/* Hashes everything that the check depends on: the ways, and the scans by their key. Errors as
 * below. */
must_check int tour_check_key(struct hash *out, const struct info_built *built, struct hash scans);

/* built is the result of info_build. -EINVAL: there are faults; for each leg the worst one was
 * added to the diagnostics. -ENOMEM. -EBADMSG: the database cannot be read. */
must_check int tour_check(const struct info_built *built, const struct tour_check_options *options);

#endif
