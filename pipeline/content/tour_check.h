/* Whether the tours of a content folder lead through a wall: their way, as the kiosk flies it,
 * against the scan's surface. docs/tours.md. */
#ifndef GOPURA_PIPELINE_CONTENT_TOUR_CHECK_H
#define GOPURA_PIPELINE_CONTENT_TOUR_CHECK_H

#include "pipeline/content/info_build.h"
#include "pipeline/import/mesh.h"

enum { TOUR_MINUTES_MAX = 10 };

struct tour_check_options {
	const struct mesh *mesh; /* of all scans; borrowed */
	info_complaint *complaint;
	void *complaint_data;
};

/* built: as info_build made it. -EINVAL: there are faults; each leg's worst was complained about.
 * -ENOMEM; -EBADMSG: the database cannot be read. */
must_check int tour_check(const struct info_built *built, const struct tour_check_options *options);

#endif
