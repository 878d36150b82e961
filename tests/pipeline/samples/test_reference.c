/* Reference pictures of a square whose pixels can be worked out by hand. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/picture.h"
#include "pipeline/samples/reference.h"
#include "tests/check.h"

static char dir[64]; /* DIR/content and DIR/out, where a picture is none of the scan's */
static char content_dir[96];

static void put_bytes(const char *name, struct bytes bytes)
{
	char path[128];

	snprintf(path, sizeof(path), "%s/content/%s", dir, name);
	CHECK(bytes_write_file(bytes, path) == 0);
}

static void put(const char *name, const char *text)
{
	put_bytes(name, (struct bytes){ (const uint8_t *)text, strlen(text) });
}

/* A square -1..1 at y = 0 that looks towards -y: left half red, right half blue. */
static int make_dir(void **state)
{
	(void)state;
	snprintf(dir, sizeof(dir), "/tmp/gopura-reference-XXXXXX");
	if (!mkdtemp(dir))
		return -1;
	snprintf(content_dir, sizeof(content_dir), "%s/content", dir);
	if (mkdir(content_dir, 0777) < 0)
		return -1;
	put("scan.ply", "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\n"
			"property float y\nproperty float z\nproperty uchar red\n"
			"property uchar green\nproperty uchar blue\nelement face 2\n"
			"property list uchar int vertex_indices\nend_header\n"
			"-1 0 -1 200 0 0\n0 0 -1 200 0 0\n0 0 1 200 0 0\n-1 0 1 200 0 0\n"
			"0 0 -1 0 0 100\n1 0 -1 0 0 100\n1 0 1 0 0 100\n0 0 1 0 0 100\n"
			"4 0 1 2 3\n4 4 5 6 7\n");
	put("temple.ini", "[model]\nscans = scan.ply\nlit = no\n");
	return 0;
}

static int remove_dir(void **state)
{
	char command[128];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf %s", dir);
	return system(command);
}

static int read_views(struct camera **views, uint32_t *count, const char *text,
		      struct diagnostics *diagnostics)
{
	const struct bytes bytes = { (const uint8_t *)text, strlen(text) };

	return reference_views(views, count, bytes, "views.txt", diagnostics);
}

static void reads_views(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct camera *views;
	uint32_t count;

	(void)state;
	CHECK(read_views(&views, &count,
			 "# a path\n\neye 1 2 3 target 4 5 6 45 # first\n1,2,3  4,5,7  60",
			 &diagnostics) == 0);
	CHECK(count == 2 && views[0].fov_deg == 45 && views[1].target_m[2] == 7);
	CHECK(views[1].eye_m[1] == 2 && views[0].up[2] == 1);
	free(views);
}

static void refuses_bad_views(void **state)
{
	static const char *const bad[] = { "# x\n1 2 3 4 5 6\n",        "# x\n1 2 3 4 5 6 7 8\n",
					   "# x\n1 2 3 1 2 3 45\n",     "# x\n1 2 3 4 5 6 0.1\n",
					   "# x\n1 2 three 4 5 6 45\n", "# x\nnan 2 3 4 5 6 45\n" };
	struct camera *views;
	uint32_t count;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
		struct diagnostics diagnostics = { 0 };

		CHECK(read_views(&views, &count, bad[i], &diagnostics) == -EINVAL && !views);
		CHECK(strstr(diagnostics.first.text, "views.txt, line 2:"));
	}
	CHECK(read_views(&views, &count, "# nothing\n", NULL) == -EINVAL && !views);
}

/* Returns how many pictures were drawn, or a negative errno. */
static int try_to_draw(const char *views_text, int side, uint32_t supersample)
{
	struct reference_options options = { .width_px = side,
					     .height_px = side,
					     .supersample = supersample };
	struct reference_report report;
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	struct content content;
	struct scans *scans;
	struct camera *views;
	char out_dir[128];
	uint32_t count;
	int rc;

	snprintf(out_dir, sizeof(out_dir), "%s/out", dir);
	options.out_dir = out_dir;
	CHECK(read_views(&views, &count, views_text, &diagnostics) == 0);
	CHECK(content_read(&content, content_dir, &diagnostics) == 0);
	CHECK(scans_create(&scans, &content) == 0);
	rc = reference_draw(scans, views, count, &options, &report, &diagnostics);
	if (rc == 0) {
		CHECK(report.drawn + report.kept == count);
		rc = (int)report.drawn;
	}
	scans_destroy(scans);
	content_release(&content);
	diagnostics_finish(&diagnostics);
	free(views);
	return rc;
}

/* Reads the last picture. */
static void draw(struct picture *out, const char *views_text, int side, uint32_t supersample,
		 uint32_t expected_drawn)
{
	uint32_t views = 0;
	struct buffer file;
	char path[160];

	for (const char *c = views_text; *c; c++)
		views += *c == '\n';
	assert_int_equal(try_to_draw(views_text, side, supersample), expected_drawn);
	snprintf(path, sizeof(path), "%s/out/view-%04u.png", dir, views - 1);
	buffer_init(&file, 1 << 20);
	CHECK(buffer_read_file(&file, path) == 0);
	CHECK(picture_decode(out, buffer_bytes(&file)) == 0);
	CHECK(out->width == (uint32_t)side && out->height == (uint32_t)side);
	buffer_finish(&file);
}

/* From 2 m at 90 degrees a pixel of 16 is a quarter of a metre: the square fills 4..11. */
static const char front[] = "0 -2 0  0 0 0  90\n";

static void draws_what_analysis_says(void **state)
{
	(void)state;
	for (uint32_t n = 1; n <= 4; n++) {
		struct picture picture;

		draw(&picture, front, 16, n, 1);
		for (int i = 0; i < 16 * 16; i++) {
			int x = i % 16, y = i / 16;
			bool there = x >= 4 && x < 12 && y >= 4 && y < 12;
			const uint8_t *p = picture.rgba + 4 * i;

			CHECK(p[3] == (there ? 255 : 0));
			CHECK(p[0] == (there && x < 8 ? 200 : 0) && p[1] == 0);
			CHECK(p[2] == (there && x >= 8 ? 100 : 0));
		}
		picture_finish(&picture);
	}
}

/* In 5 pixels the middle one holds both halves, and rims are covered by a part. */
static void averages_colour_apart_from_coverage(void **state)
{
	struct picture picture;
	const uint8_t *p;

	(void)state;
	draw(&picture, front, 5, 8, 1);
	p = picture.rgba + 4 * (2 * 5 + 2);
	CHECK(p[3] == 255 && p[0] == 100 && p[2] == 50);
	p = picture.rgba + 4 * (2 * 5 + 1); /* -1.2 .. -0.4: 0.6 of 0.8 m */
	CHECK(p[3] > 184 && p[3] < 198 && p[0] == 200 && p[2] == 0);
	CHECK(picture.rgba[4 * (2 * 5) + 3] == 0);
	picture_finish(&picture);
}

/* At 2048 pixels and 4 x 4 samples the frame holds 2 x 2 and the rest is jitter; at 512 all fit
 * into one frame. Seen from four times nearer by field of view, pixel by pixel the same. */
static void jitter_equals_a_larger_frame(void **state)
{
	struct picture large;
	long red = 0, blue = 0, all = 0;

	(void)state;
	draw(&large, "0.3 -2 0.1  0 0 0  90\n", 2048, 4, 1);
	for (size_t i = 0; i < (size_t)2048 * 2048; i++) {
		const uint8_t *p = large.rgba + 4 * i;

		all += p[3];
		red += p[3] * (p[0] == 200);
		blue += p[3] * (p[2] == 100);
	}
	picture_finish(&large);
	draw(&large, "0.3 -2 0.1  0 0 0  90\n", 512, 4, 1);
	for (size_t i = 0; i < (size_t)512 * 512; i++) {
		const uint8_t *p = large.rgba + 4 * i;

		all -= 16L * p[3];
		red -= 16L * p[3] * (p[0] == 200);
		blue -= 16L * p[3] * (p[2] == 100);
	}
	picture_finish(&large);
	/* Of 67 million quarter parts; a rim shifted by half a pixel would be half a million. */
	CHECK(labs(all) < 60000);
	CHECK(labs(red) < 400000 && labs(blue) < 400000); /* less the mixed pixels in the middle */
}

static void keeps_what_is_there(void **state)
{
	struct picture picture;

	(void)state;
	draw(&picture, front, 16, 2, 1);
	picture_finish(&picture);
	draw(&picture, front, 16, 2, 0);
	picture_finish(&picture);
	draw(&picture, "0 -2 0  0 0 0  90\n0 -3 0 0 0 0 90\n", 16, 2, 1);
	CHECK(picture.rgba[4 * (8 * 16 + 4) + 3] == 0); /* farther, so smaller */
	picture_finish(&picture);
	put("temple.ini", "[model]\nscans = scan.ply\nlit = yes\nsun = 0 -1 0\n");
	draw(&picture, front, 16, 2, 1);
	picture_finish(&picture);
}

static void another_substance_is_another_picture(void **state)
{
	struct picture picture;

	(void)state;
	put("temple.ini", "[model]\nscans = scan.ply\ncolours = marble\n");
	draw(&picture, front, 16, 1, 1);
	picture_finish(&picture);
	put("temple.ini", "[model]\nscans = scan.ply\ncolours = laterite\n");
	draw(&picture, front, 16, 1, 1);
	picture_finish(&picture);
}

/* Settings may go back to those of a picture that another one began to replace. */
static void a_picture_that_cannot_be_written_has_no_key(void **state)
{
	struct picture picture;
	char path[160];

	(void)state;
	put("temple.ini", "[model]\nscans = scan.ply\nlit = no\n");
	draw(&picture, "0 -4 0  0 0 0  90\n", 16, 1, 1);
	picture_finish(&picture);
	put("temple.ini", "[model]\nscans = scan.ply\nlit = yes\n");
	snprintf(path, sizeof(path), "%s/out/view-0000.png", dir);
	CHECK(unlink(path) == 0 && mkdir(path, 0777) == 0);
	CHECK(try_to_draw("0 -4 0  0 0 0  90\n", 16, 1) < 0);
	CHECK(rmdir(path) == 0);
	put("../out/view-0000.png", "what was half written\n");
	put("temple.ini", "[model]\nscans = scan.ply\nlit = no\n");
	draw(&picture, "0 -4 0  0 0 0  90\n", 16, 1, 1);
	picture_finish(&picture);
}

/* A cube with a picture of one grey, turned from the sun, becomes a closed surface: its colours are
 * those of the picture, which has its own light. */
static void a_surface_made_of_pictures_is_not_lit(void **state)
{
	struct picture grey = { .width = 8, .height = 8, .rgba = malloc(8 * 8 * 4) }, picture;
	struct buffer file;

	(void)state;
	CHECK(grey.rgba != NULL);
	for (int i = 0; i < 8 * 8 * 4; i++)
		grey.rgba[i] = i % 4 == 3 ? 255 : (uint8_t)(149 + i % 2);
	buffer_init(&file, 1 << 20);
	CHECK(picture_encode_png(&file, &grey) == 0);
	put_bytes("grey.png", buffer_bytes(&file));
	buffer_finish(&file);
	picture_finish(&grey);
	put("cube.ply", "ply\nformat ascii 1.0\ncomment TextureFile grey.png\nelement vertex 8\n"
			"property float x\nproperty float y\nproperty float z\nelement face 6\n"
			"property list uchar int vertex_indices\n"
			"property list uchar float texcoord\nend_header\n"
			"-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n"
			"4 0 3 2 1 8 0 0 1 0 1 1 0 1\n4 4 5 6 7 8 0 0 1 0 1 1 0 1\n"
			"4 0 1 5 4 8 0 0 1 0 1 1 0 1\n4 2 3 7 6 8 0 0 1 0 1 1 0 1\n"
			"4 1 2 6 5 8 0 0 1 0 1 1 0 1\n4 3 0 4 7 8 0 0 1 0 1 1 0 1\n");
	put("temple.ini", "[model]\nscans = cube.ply\nsun = 0 1 0\n[hierarchy]\n"
			  "surface = octree\ncell_mm = 100\n");
	draw(&picture, "0 -4 0  0 0 0  60\n", 16, 1, 1);
	CHECK(abs(picture.rgba[4 * (8 * 16 + 8)] - 149) <= 4);
	picture_finish(&picture);
}

static void shows_nothing_behind_the_eye(void **state)
{
	struct picture picture;

	(void)state;
	draw(&picture, "0 -2 0  0 -3 0  90\n", 16, 1, 1);
	for (int i = 0; i < 16 * 16 * 4; i++)
		CHECK(picture.rgba[i] == 0);
	picture_finish(&picture);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(reads_views),
		cmocka_unit_test(refuses_bad_views),
		cmocka_unit_test(draws_what_analysis_says),
		cmocka_unit_test(averages_colour_apart_from_coverage),
		cmocka_unit_test(jitter_equals_a_larger_frame),
		cmocka_unit_test(keeps_what_is_there),
		cmocka_unit_test(another_substance_is_another_picture),
		cmocka_unit_test(a_picture_that_cannot_be_written_has_no_key),
		cmocka_unit_test(a_surface_made_of_pictures_is_not_lit),
		cmocka_unit_test(shows_nothing_behind_the_eye),
	};

	return cmocka_run_group_tests(tests, make_dir, remove_dir);
}
