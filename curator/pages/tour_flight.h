/* A tour as the terminal flies it, for the page in the browser: the curve of geometry/tour_path,
 * and what a build says about it. */
#ifndef GOPURA_CURATOR_PAGES_TOUR_FLIGHT_H
#define GOPURA_CURATOR_PAGES_TOUR_FLIGHT_H

#include "base/diagnostics.h"
#include "curator/session/site.h"

struct cJSON;

/* Makes {"problems": [...]} and, if the content has no faults, "step_ms", "duration_ms",
 * "poses": [eye x, y, z, target x, y, z, ...] in metres, one every step_ms, "at": [number of the
 * stop from 0, ...] and "stops": [{"eye", "target"}], all of tour `id` of a tours.json with this
 * text. Compares the path with every triangle of the scan, as tour_check does. *out is owned by the
 * caller; NULL on failure. -ENOENT: no such tour. -ENOMEM, -EIO. With a diagnostic. */
must_check int tour_flight(struct cJSON **out, struct site *site, const char *id,
			   struct bytes tours, struct diagnostics *diagnostics);

#endif
