/* What is predicted of a tiny build, against that build: counts and sizes, never times. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/estimate.h"
#include "tests/check.h"
#include "tests/pipeline/temple_folder.h"

static struct estimate estimate_now(void)
{
	const struct build_options options = { .keys = temple.keys };
	struct estimate estimate;
	struct content content;

	temple_read(&content);
	CHECK(estimate_build(&estimate, &content, &options) == 0);
	content_release(&content);
	return estimate;
}

static bool within(double a, double b, double factor)
{
	return a <= b * factor && b <= a * factor;
}

/* Counts faces and tiles of what was sampled. */
static void count_samples(uint64_t *faces, uint64_t *tiles)
{
	struct samples_store *store;
	struct sample_face face;

	*faces = *tiles = 0;
	CHECK(samples_store_open(&store, temple.folder) == 0);
	while (samples_store_next(store, &face) == 1) {
		++*faces;
		*tiles += face.tile_count;
	}
	samples_store_close(store);
}

static void predicts_counts_and_sizes(void **state)
{
	const struct build_options options = { .keys = temple.keys };
	struct estimate before = estimate_now(), after;
	struct build_report report;
	struct content content;
	uint64_t faces, tiles;
	char path[128];

	(void)state;
	CHECK(before.work.is_counted && before.work.points_done == 0);
	snprintf(path, sizeof(path), "%s/.work/samples", temple.folder);
	CHECK(access(path, F_OK) < 0); /* nothing was built */
	CHECK(access(temple.keys, F_OK) < 0);
	temple_read(&content);
	CHECK(build_content(&report, &content, &options) == 0);
	content_release(&content);
	CHECK(before.work.triangle_count == report.source_triangles);
	count_samples(&faces, &tiles);
	CHECK(within((double)before.work.face_count, (double)faces, 1.5));
	CHECK(within((double)before.work.tile_count, (double)tiles, 1.5));
	CHECK(within((double)before.release_bytes, (double)report.publish.release_bytes, 2));
	for (int i = ESTIMATE_IMPORT; i < ESTIMATE_STAGES; i++)
		CHECK(!before.stages[i].is_done && before.stages[i].processor_s > 0 &&
		      before.stages[i].memory_bytes > 0);

	after = estimate_now();
	CHECK(after.work.points_done == before.work.point_count);
	CHECK(after.stages[ESTIMATE_IMPORT].is_done && after.stages[ESTIMATE_HIERARCHY].is_done);
	CHECK(after.stages[ESTIMATE_SAMPLES].is_done);
	CHECK(after.time_s < before.time_s);
	/* of what is there, the sizes are known */
	CHECK(within((double)after.release_bytes, (double)report.publish.release_bytes, 1.5));
}

static void prints_a_table(void **state)
{
	static const char *const words[] = { "import", "hierarchy", "samples", "publishing",
					     "all",    "release: ", "disk: ",  "memory: " };
	struct estimate estimate = { .time_s = 7300,
				     .disk_free_bytes = 1000,
				     .disk_peak_bytes = 5000000,
				     .memory_bytes = 1 << 30,
				     .memory_free_bytes = 1 << 20,
				     .work = { .is_counted = true, .triangle_count = 12 } };
	char *text = NULL;
	size_t size;
	FILE *to = open_memstream(&text, &size);

	(void)state;
	estimate_print(to, &estimate);
	fclose(to);
	for (size_t i = 0; i < ARRAY_COUNT(words); i++) {
		char line[32];

		snprintf(line, sizeof(line), "\n%s", words[i]);
		CHECK(strstr(text, line) != NULL);
	}
	CHECK(strncmp(text, "12 triangles", 12) == 0);
	CHECK(strstr(text, "2.0 h") && strstr(text, "free some before you build"));
	CHECK(strstr(text, "use fewer --jobs"));
	free(text);
}

static void refuses_faults_of_the_content(void **state)
{
	const struct build_options options = { .keys = temple.keys };
	struct estimate estimate;
	struct content content;

	(void)state;
	temple_put("parts.json", "{");
	temple_read(&content);
	CHECK(estimate_build(&estimate, &content, &options) == -EINVAL);
	content_release(&content);
	temple_put("parts.json", "{\"parts\":[]}");
	temple_put("temple.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
	temple_read(&content);
	CHECK(estimate_build(&estimate, &content, &options) == -EBADMSG);
	content_release(&content);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(predicts_counts_and_sizes),
		cmocka_unit_test(prints_a_table),
		cmocka_unit_test(refuses_faults_of_the_content),
	};

	return cmocka_run_group_tests(tests, temple_make, temple_remove);
}
