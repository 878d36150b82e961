/* Keeps the two ends of a measured line. */
#include "app/visit/measuring.h"

#include <math.h>

#include "geometry/vec.h"

void measuring_add(struct measuring *measuring, const struct measured_end *end)
{
	if (measuring->count == 2)
		measuring->count = 0;
	measuring->ends[measuring->count++] = *end;
}

float measuring_length_m(const struct measuring *measuring)
{
	return vec_distance(measuring->ends[0].at_m, measuring->ends[1].at_m);
}

float measuring_error_m(const struct measuring *measuring, float scan_error_m)
{
	const float ends = hypotf(measuring->ends[0].error_m, measuring->ends[1].error_m);

	return hypotf(ends, (float)M_SQRT2 * scan_error_m);
}
