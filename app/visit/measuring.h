/* What a visitor measures: two places on the surface and the straight line between them. Pure. See
 * docs/tools.md. */
#ifndef GOPURA_APP_VISIT_MEASURING_H
#define GOPURA_APP_VISIT_MEASURING_H

#include <stdbool.h>

struct measured_end {
	float at_m[3];
	float error_m; /* by how much it is beside the surface of the scan */
};

struct measuring {
	bool on;
	unsigned count; /* of ends that are set: 0 to 2 */
	struct measured_end ends[2];
};

/* Sets the next end; after the second one measuring begins anew. */
void measuring_add(struct measuring *measuring, const struct measured_end *end);
/* Returns the distance between the two ends, in metres. */
float measuring_length_m(const struct measuring *measuring);
/* Returns how far off that may be, in metres: the errors of both ends and of the scan at each, as
 * the root of the sum of squares (GUM, JCGM 100:2008, 5.1.2: they are independent). */
float measuring_error_m(const struct measuring *measuring, float scan_error_m);

#endif
