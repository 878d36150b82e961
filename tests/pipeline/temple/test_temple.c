#include "pipeline/temple/temple.h"
#include "pipeline/temple/temple_compose.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "geometry/vec.h"
#include "pipeline/commands.h"
#include "pipeline/temple/temple_plan.h"
#include "tests/check.h"

/* The file a temple_write of these options gives. */
struct temple {
	uint8_t *bytes; /* owned */
	size_t size;
	uint32_t vertex_count, triangle_count;
	const uint8_t *vertices, *triangles; /* 16 and 13 bytes each */
};

static void build_with(struct temple *out, struct temple_bodies *bodies, uint64_t triangles,
		       uint32_t seed)
{
	struct temple_options options = { .triangles = triangles, .seed = seed, .bodies = bodies };
	char *text = NULL;
	FILE *file = open_memstream(&text, &out->size);

	CHECK(file != NULL);
	CHECK(temple_write(file, &options) == 0);
	fclose(file);
	out->bytes = (uint8_t *)text;
	const char *vertices = strstr(text, "element vertex "), *end = strstr(text, "end_header\n");
	const char *faces = strstr(text, "element face ");
	CHECK(vertices && faces && end);
	out->vertex_count = (uint32_t)strtoul(vertices + 15, NULL, 10);
	out->triangle_count = (uint32_t)strtoul(faces + 13, NULL, 10);
	out->vertices = (const uint8_t *)end + 11;
	out->triangles = out->vertices + 16 * (size_t)out->vertex_count;
	CHECK(out->size ==
	      (size_t)(out->triangles - out->bytes) + 13 * (size_t)out->triangle_count);
}

static void build(struct temple *out, uint64_t triangles, uint32_t seed)
{
	build_with(out, NULL, triangles, seed);
}

static void vertex(const struct temple *temple, uint32_t index, float out[3])
{
	memcpy(out, temple->vertices + 16 * (size_t)index, 12);
}

static void corners(const struct temple *temple, uint32_t triangle, uint32_t out[3])
{
	const uint8_t *bytes = temple->triangles + 13 * (size_t)triangle;

	CHECK(bytes[0] == 3);
	memcpy(out, bytes + 1, 12);
}

static void has_the_triangles_asked_for(void **state)
{
	static const uint32_t asked[] = { 10000, 37000, 100000 };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(asked); i++) {
		struct temple temple;
		build(&temple, asked[i], 1);
		CHECK(fabs((double)temple.triangle_count / asked[i] - 1) <= 0.02);
		free(temple.bytes);
	}
}

static void is_the_same_for_the_same_seed_alone(void **state)
{
	struct temple first, again, other;

	(void)state;
	build(&first, 20000, 5);
	build(&again, 20000, 5);
	build(&other, 20000, 6);
	CHECK(first.size == again.size && memcmp(first.bytes, again.bytes, first.size) == 0);
	CHECK(other.size != first.size || memcmp(first.bytes, other.bytes, first.size) != 0);
	free(first.bytes);
	free(again.bytes);
	free(other.bytes);
}

static double area2_m2(const float a[3], const float b[3], const float c[3])
{
	double u[3], v[3];

	for (int k = 0; k < 3; k++) {
		u[k] = (double)b[k] - a[k];
		v[k] = (double)c[k] - a[k];
	}
	double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2],
	       z = u[0] * v[1] - u[1] * v[0];
	return sqrt(x * x + y * y + z * z);
}

static void has_only_sound_triangles(void **state)
{
	static const uint32_t asked[] = { 10000, 250000 };

	(void)state;
	for (size_t n = 0; n < ARRAY_COUNT(asked); n++) {
		struct temple temple;
		build(&temple, asked[n], 2);
		for (uint32_t t = 0; t < temple.triangle_count; t++) {
			uint32_t at[3];
			float p[3][3];
			corners(&temple, t, at);
			for (int k = 0; k < 3; k++) {
				CHECK(at[k] < temple.vertex_count);
				vertex(&temple, at[k], p[k]);
			}
			CHECK(at[0] != at[1] && at[1] != at[2] && at[2] != at[0]);
			CHECK(area2_m2(p[0], p[1], p[2]) > 1e-9);
		}
		free(temple.bytes);
	}
}

static void stands_on_its_ground_and_has_its_size(void **state)
{
	struct temple temple;
	float low[3] = { 1e9f, 1e9f, 1e9f }, high[3] = { -1e9f, -1e9f, -1e9f };

	(void)state;
	build(&temple, 50000, 1);
	for (uint32_t i = 0; i < temple.vertex_count; i++) {
		float p[3];
		vertex(&temple, i, p);
		for (int k = 0; k < 3; k++) {
			CHECK(isfinite(p[k]));
			low[k] = fminf(low[k], p[k]);
			high[k] = fmaxf(high[k], p[k]);
		}
	}
	for (int k = 0; k < 2; k++)
		CHECK(fabsf(low[k] + 21) < 0.5f && fabsf(high[k] - 21) < 0.5f);
	CHECK(low[2] > -0.3f && high[2] > 23 && high[2] < 25);
	free(temple.bytes);
}

/* Most triangles lie where there is something to see. */
static void spends_its_triangles_on_carving(void **state)
{
	struct plan plan;
	uint64_t carved = 0, all = 0;

	(void)state;
	CHECK(plan_create(&plan, 1) == 0);
	for (uint32_t i = 0; i < plan.count; i++) {
		uint32_t columns, rows;
		const struct sheet *sheet = &plan.sheets[i];
		sheet_stations(sheet, 8, NULL, &columns, NULL, &rows, 0);
		uint64_t triangles = sheet_triangles(sheet, columns, rows);
		bool ornate = relief_varies_across(sheet->relief.kind) &&
			      sheet->relief.kind != RELIEF_BLOCKS;
		for (uint32_t s = 0; s < sheet->profile->count; s++)
			ornate = ornate || relief_varies_across(sheet->profile->points[s].relief);
		carved += ornate ? triangles : 0;
		all += triangles;
		if (!relief_varies_across(sheet->relief.kind) && sheet->profile->count == 2 &&
		    !sheet_wraps(sheet) && sheet->profile->points[0].relief == RELIEF_SHEET)
			CHECK(triangles <= 18); /* a flat wall or floor */
	}
	CHECK(carved > all * 8 / 10);
	plan_destroy(&plan);
}

static int discard(void *cookie)
{
	(void)cookie;
	return 0;
}

static ssize_t count_bytes(void *cookie, const char *bytes, size_t size)
{
	(void)bytes;
	*(uint64_t *)cookie += size;
	return (ssize_t)size;
}

/* Four times the triangles: not a megabyte more. */
static void needs_no_more_memory_for_more_triangles(void **state)
{
	static const uint64_t asked[] = { 100000, 400000 };
	struct rusage before, after;
	uint64_t bytes = 0;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(asked); i++) {
		struct temple_options options = { .triangles = asked[i], .seed = 1 };
		FILE *file = fopencookie(
			&bytes, "w",
			(cookie_io_functions_t){ .write = count_bytes, .close = discard });
		CHECK(file != NULL);
		getrusage(RUSAGE_SELF, &before);
		CHECK(temple_write(file, &options) == 0);
		getrusage(RUSAGE_SELF, &after);
		fclose(file);
	}
	CHECK(bytes > 10000000);
	CHECK(after.ru_maxrss - before.ru_maxrss < 6 * 1024); /* kilobytes; rows grow a little */
}

static ssize_t refuse(void *cookie, const char *bytes, size_t size)
{
	(void)cookie;
	(void)bytes;
	(void)size;
	errno = ENOSPC;
	return 0;
}

static void says_what_went_wrong(void **state)
{
	struct temple_options options = { .triangles = 9999 };
	FILE *full = fopencookie(NULL, "w", (cookie_io_functions_t){ .write = refuse });

	(void)state;
	CHECK(full != NULL);
	CHECK(temple_write(full, &options) == -ERANGE);
	options.triangles = TEMPLE_TRIANGLES_MAX + 1ull;
	CHECK(temple_write(full, &options) == -ERANGE);
	options.triangles = 10000;
	CHECK(temple_write(full, &options) == -EIO);
	fclose(full);
}

/* The hood of the naga on the right of who comes from the east, 1.5 m wide, and the lion below it.
 */
static void knows_which_faces_a_carving_is(void **state)
{
	static const struct {
		const char *id;
		float middle[3], reach_m;
	} known[] = { { "naga-3", { 18, 2.35f, 3.3f }, 1.2f },
		      { "lion-16", { 20.1f, 1.58f, 1.3f }, 0.8f } };
	struct temple_bodies bodies;
	struct temple temple;
	uint32_t found = 0;

	(void)state;
	build_with(&temple, &bodies, 100000, 1);
	CHECK(bodies.count > 20);
	for (uint32_t i = 0; i < bodies.count; i++) {
		const struct temple_body *body = &bodies.bodies[i];
		const uint32_t end = body->first_face + body->face_count;
		CHECK(body->face_count > 0 && end <= temple.triangle_count);
		CHECK(i == 0 || body->first_face >= body[-1].first_face + body[-1].face_count);
		for (size_t k = 0; k < ARRAY_COUNT(known); k++) {
			if (strcmp(body->id, known[k].id) != 0)
				continue;
			found++;
			for (uint32_t face = body->first_face; face < end; face++) {
				uint32_t at[3];
				float p[3];
				corners(&temple, face, at);
				vertex(&temple, at[0], p);
				CHECK(vec_distance(p, known[k].middle) < known[k].reach_m);
			}
		}
	}
	CHECK(found == ARRAY_COUNT(known));
	free(bodies.bodies);
	free(temple.bytes);
}

static int command(char *triangles, char *regions, char *out)
{
	char *argv[] = { "temple", "--triangles", triangles, "--regions",
			 regions,  "--out",       out,       NULL };

	optind = 0; /* getopt starts anew */
	return command_temple(7, argv);
}

static void leaves_a_whole_file_or_none(void **state)
{
	char folder[] = "/tmp/gopura-temple-XXXXXX", path[96], part[112], regions[64], list[80];

	(void)state;
	CHECK(mkdtemp(folder) != NULL);
	snprintf(path, sizeof(path), "%s/scan.ply", folder);
	snprintf(part, sizeof(part), "%s.part", path);
	snprintf(regions, sizeof(regions), "%s/regions", folder);
	snprintf(list, sizeof(list), "%s/naga-3.faces", regions);
	CHECK(command("12", regions, path) == 2);
	CHECK(command("many", regions, path) == 2);
	CHECK(command("-10000", regions, path) == 2);
	CHECK(command("200000000", regions, path) == 2);
	CHECK(command("10000", regions, "/nonexistent/scan.ply") == 1);
	CHECK(access(path, F_OK) != 0 && access(regions, F_OK) != 0);
	CHECK(command("10000", "/nonexistent/regions", path) == 1);
	CHECK(command("10000", regions, path) == 0);
	CHECK(access(path, F_OK) == 0 && access(part, F_OK) != 0 && access(list, F_OK) == 0);
	unlink(path);
	snprintf(path, sizeof(path), "rm -r %s", regions);
	CHECK(system(path) == 0);
	CHECK(rmdir(folder) == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(needs_no_more_memory_for_more_triangles),
		cmocka_unit_test(has_the_triangles_asked_for),
		cmocka_unit_test(is_the_same_for_the_same_seed_alone),
		cmocka_unit_test(has_only_sound_triangles),
		cmocka_unit_test(stands_on_its_ground_and_has_its_size),
		cmocka_unit_test(spends_its_triangles_on_carving),
		cmocka_unit_test(knows_which_faces_a_carving_is),
		cmocka_unit_test(says_what_went_wrong),
		cmocka_unit_test(leaves_a_whole_file_or_none),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
