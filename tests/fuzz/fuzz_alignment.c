/* An alignment of scans: what begins with '<' as MeshLab's project, with '{' as a manifest, with
 * 'b' as a registration, all else as text. It is refused with its name, or every scan of it lies in
 * its folder and has a matrix that can be applied. */
#include <math.h>

#include "pipeline/import/alignment.h"
#include "tests/fuzz/scratch.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static bool is_placed(const struct alignment_scan *scan)
{
	const double corner[3] = { 1000, -1000, 1 };
	double place[3];

	transform_point(&scan->transform, corner, place);
	return strncmp(scan->path, scratch, strlen(scratch)) == 0 && !strstr(scan->path, "/../") &&
	       isfinite(place[0]) && isfinite(place[1]) && isfinite(place[2]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const char *name = size > 0 && data[0] == '<'   ? "site.mlp"
			   : size > 0 && data[0] == '{' ? "site.json"
			   : size > 0 && data[0] == 'b' ? "site.conf"
							: "site.aln";
	struct diagnostics diagnostics = { 0 };
	struct alignment alignment;
	char path[128];

	if (!scratch[0]) {
		scratch_begin();
		scratch_write("a.ply", (const uint8_t *)"ply\n", 4);
	}
	scratch_write(name, data, size);
	snprintf(path, sizeof(path), "%s", scratch_path(name));
	if (alignment_read(&alignment, path, &diagnostics) < 0) {
		if (alignment.count || strncmp(diagnostics.first.text, path, strlen(path)) != 0)
			abort();
		return 0;
	}
	if (alignment.count == 0 || alignment.count > ALIGNMENT_SCANS_MAX || diagnostics.count > 0)
		abort();
	for (uint32_t i = 0; i < alignment.count; i++)
		if (!is_placed(&alignment.scans[i]))
			abort();
	alignment_finish(&alignment);
	return 0;
}
