/* Any bytes as the octree of where an eye may be: refused, or an octree that encodes to the same
 * bytes and answers every question. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/solid_space.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void ask(const struct solid *solid)
{
	const float side_m = solid->cell_m * (float)(1 << solid->depth);
	const float way[3] = { 0.6f, 0, -0.8f };

	for (int i = 0; i < 27; i++) {
		const float share[3] = { (float)(i % 3) * 0.45f, (float)(i / 3 % 3) * 0.45f,
					 (float)(i / 9) * 0.45f };
		float point[3], out[3], reach;

		for (int axis = 0; axis < 3; axis++)
			point[axis] = solid->low_m[axis] + share[axis] * side_m;
		reach = solid_reach(solid, point, way, 2 * side_m, NULL);
		if (!(reach >= 0) || (reach > 0 && !solid_is_free(solid, point)))
			abort();
		if (i % 9 == 0 && solid_nearest_free(solid, point, 2 * side_m, out) &&
		    !isfinite(out[0]))
			abort();
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct buffer again;
	struct solid solid;

	if (solid_decode(&solid, (struct bytes){ data, size }) < 0)
		return 0;
	ask(&solid);
	buffer_init(&again, size + 1);
	if (solid_encode(&again, &solid) < 0 || again.size != size ||
	    memcmp(again.data, data, size) != 0)
		abort();
	buffer_finish(&again);
	solid_finish(&solid);
	return 0;
}
