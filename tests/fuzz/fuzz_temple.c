/* temple.ini: refused with its faults, or a content whose values keep to their
 * limits. */
#include <math.h>

#include "pipeline/content/content.h"
#include "tests/fuzz/scratch.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char alignment[] = "2\nscan.ply\n#\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
				"b.obj\n#\n1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n0\n";

static bool keeps_its_limits(const struct content *c)
{
	const float length = c->sun[0] * c->sun[0] + c->sun[1] * c->sun[1] + c->sun[2] * c->sun[2];
	bool good = c->scan_count >= 1 && c->scan_count <= CONTENT_SCANS_MAX &&
		    strlen(c->name) < sizeof(c->name) && c->import.metres_per_unit > 0 &&
		    isfinite(c->import.metres_per_unit) && fabsf(length - 1) < 0.01f &&
		    c->grid_points >= 4 && c->grid_points <= 32 && c->face_px >= 128 &&
		    c->face_px <= 4096 && c->quality >= 1 && c->quality <= 100 &&
		    (c->patch_triangles == 0 ||
		     (c->patch_triangles >= 256 && c->patch_triangles <= 4000)) &&
		    (c->block_triangles == 0 ||
		     (c->block_triangles >= 2000 && c->block_triangles <= 16000000)) &&
		    (c->lattice_mm == 0 || (c->lattice_mm >= 0.05 && c->lattice_mm <= 100)) &&
		    c->publish_share > 0 && c->publish_share <= 1 && c->language_count >= 1 &&
		    c->language_count <= CONTENT_LANGUAGES_MAX;

	for (int k = 0; k < 3 && c->has_start; k++)
		good = good && isfinite(c->start_eye_m[k]) && isfinite(c->start_target_m[k]);
	for (uint32_t i = 0; good && i < c->scan_count; i++)
		good = strncmp(c->scans[i], scratch, strlen(scratch)) == 0 &&
		       !strstr(c->scans[i], "/../");
	return good;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	struct content content;

	if (!scratch[0]) {
		scratch_begin();
		scratch_write("scan.ply", (const uint8_t *)"ply\n", 4);
		scratch_write("b.obj", (const uint8_t *)"#\n", 2);
		scratch_write("s.aln", (const uint8_t *)alignment, strlen(alignment));
	}
	scratch_write("temple.ini", data, size);
	if (content_read(&content, scratch, &diagnostics) == 0) {
		if (!keeps_its_limits(&content))
			abort();
	} else if (diagnostics.count == 0 || content.scan_count) {
		abort();
	}
	content_release(&content);
	diagnostics_finish(&diagnostics);
	return 0;
}
