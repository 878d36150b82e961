/* A range image, a cloud of points or a mesh: it is refused with its name, or every point of it has
 * a place, a unit normal and a weight. */
#include <math.h>
#include <stdio.h>

#include "pipeline/octree/range_scan.h"
#include "tests/fuzz/scratch.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static bool is_unit_or_zero(const float v[3])
{
	const float squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];

	return squared == 0 || fabsf(squared - 1) < 1e-3f;
}

static bool is_sound(const struct range_point *point)
{
	for (int k = 0; k < 3; k++)
		if (!isfinite(point->at[k]))
			return false;
	return point->weight > 0 && isfinite(point->weight) && point->spacing >= 0 &&
	       is_unit_or_zero(point->normal) && is_unit_or_zero(point->towards) &&
	       (point->normal[0] != 0 || point->normal[1] != 0 || point->normal[2] != 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct diagnostics diagnostics = { 0 };
	struct range_scan scan;
	char path[128];

	if (!scratch[0])
		scratch_begin();
	scratch_write("one.ply", data, size);
	snprintf(path, sizeof(path), "%s", scratch_path("one.ply"));
	if (range_scan_read(&scan, path, NULL, RANGE_SIGHT_AUTO, &diagnostics) < 0) {
		if (scan.points || strncmp(diagnostics.first.text, path, strlen(path)) != 0)
			abort();
		return 0;
	}
	if (scan.count == 0)
		abort();
	for (uint32_t i = 0; i < scan.count; i++)
		if (!is_sound(&scan.points[i]))
			abort();
	range_scan_finish(&scan);
	return 0;
}
