/* The demo's parts and pages belong to the temple that the generator writes. */
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "base/bytes.h"
#include "pipeline/content/scenes.h"
#include "pipeline/temple/temple_compose.h"
#include "tests/check.h"

static const char *const languages[] = { "en", "fr", "km", "ja" };

static char *read_text(const char *path)
{
	struct buffer buffer;

	buffer_init(&buffer, 1 << 20);
	if (buffer_read_file(&buffer, path) != 0)
		fail_msg("cannot read %s", path);
	buffer_put_u8(&buffer, 0);
	CHECK(buffer.error == 0);
	return (char *)buffer.data; /* malloc'd */
}

static cJSON *read_parts(void)
{
	char *text = read_text("demo/content/parts.json");
	cJSON *root = cJSON_Parse(text);

	free(text);
	CHECK(root != NULL);
	return root;
}

static void numbers(const cJSON *array, int count, float *out)
{
	CHECK(cJSON_GetArraySize(array) == count);
	for (int i = 0; i < count; i++)
		out[i] = (float)cJSON_GetArrayItem(array, i)->valuedouble;
}

static bool prism_contains(const cJSON *region, const float p[3])
{
	const cJSON *corners = cJSON_GetObjectItem(region, "corners");
	int count = cJSON_GetArraySize(corners);
	bool in = false;

	if (p[2] < cJSON_GetObjectItem(region, "floor")->valuedouble ||
	    p[2] > cJSON_GetObjectItem(region, "roof")->valuedouble)
		return false;
	for (int i = 0, j = count - 1; i < count; j = i++) {
		float a[2], b[2];
		numbers(cJSON_GetArrayItem(corners, i), 2, a);
		numbers(cJSON_GetArrayItem(corners, j), 2, b);
		if ((a[1] > p[1]) != (b[1] > p[1]) &&
		    p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0])
			in = !in;
	}
	return in;
}

/* To the nearest of the points a quad is sampled at, 0.2 m apart at most. */
static float quad_distance_m(float q[4][3], const float p[3])
{
	float wide = hypotf(hypotf(q[1][0] - q[0][0], q[1][1] - q[0][1]), q[1][2] - q[0][2]);
	float high = hypotf(hypotf(q[2][0] - q[0][0], q[2][1] - q[0][1]), q[2][2] - q[0][2]);
	int nu = (int)ceilf(wide / 0.2f) + 1, nv = (int)ceilf(high / 0.2f) + 1;
	float nearest = INFINITY;

	for (int k = 0; k <= 2; k++) /* most are far away */
		if (fabsf(q[0][k] - p[k]) > wide + high + 1)
			return INFINITY;
	for (int j = 0; j <= nv; j++) {
		for (int i = 0; i <= nu; i++) {
			float u = (float)i / (float)nu, v = (float)j / (float)nv, d[3];
			for (int k = 0; k < 3; k++)
				d[k] = (q[0][k] * (1 - u) + q[1][k] * u) * (1 - v) +
				       (q[2][k] * (1 - u) + q[3][k] * u) * v - p[k];
			nearest = fminf(nearest, hypotf(hypotf(d[0], d[1]), d[2]));
		}
	}
	return nearest;
}

/* To count sheets from first. */
static float surface_distance_m(const struct plan *plan, uint32_t first, uint32_t count,
				const float p[3])
{
	enum { MOST = 4096 };
	static struct station across[MOST], up[MOST];
	float nearest = INFINITY;

	for (uint32_t i = first; i < first + count; i++) {
		const struct sheet *sheet = &plan->sheets[i];
		uint32_t columns, rows;
		sheet_stations(sheet, 3, across, &columns, up, &rows, MOST);
		CHECK(columns <= MOST && rows <= MOST);
		uint32_t quads = sheet_wraps(sheet) ? columns : columns ? columns - 1 : 0;
		for (uint32_t k = 0; k < quads * (rows - 1); k++) {
			float q[4][3], hollow;
			for (uint32_t c = 0; c < 4; c++)
				sheet_at(sheet, &across[(k % quads + (c & 1)) % columns],
					 &up[k / quads + (c >> 1)], q[c], &hollow);
			nearest = fminf(nearest, quad_distance_m(q, p));
		}
	}
	return nearest;
}

/* file: of one of the generator's carvings. */
static bool body_contains(const char *file, const struct plan *plan, const float p[3])
{
	for (uint32_t i = 0; i < plan->body_count; i++) {
		const struct body *body = &plan->bodies[i];
		char name[64];
		snprintf(name, sizeof(name), "regions/%s-%u.faces", body->kind, body->number);
		if (strcmp(file, name) == 0)
			return surface_distance_m(plan, body->first, body->count, p) < 0.3f;
	}
	fail_msg("%s: the generator writes no such list", file);
	return false;
}

static bool contains(const cJSON *region, const struct plan *plan, const float p[3])
{
	const char *kind = cJSON_GetObjectItem(region, "kind")->valuestring;
	float centre[3], half[3];

	if (strcmp(kind, "faces") == 0)
		return body_contains(cJSON_GetObjectItem(region, "file")->valuestring, plan, p);
	if (strcmp(kind, "prism") == 0)
		return prism_contains(region, p);
	numbers(cJSON_GetObjectItem(region, "centre"), 3, centre);
	float d[3] = { p[0] - centre[0], p[1] - centre[1], p[2] - centre[2] };
	if (strcmp(kind, "sphere") == 0)
		return sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) <=
		       cJSON_GetObjectItem(region, "radius")->valuedouble;
	CHECK(strcmp(kind, "box") == 0);
	CHECK(cJSON_GetObjectItem(region, "turn")->valuedouble == 0);
	numbers(cJSON_GetObjectItem(region, "half"), 3, half);
	return fabsf(d[0]) <= half[0] && fabsf(d[1]) <= half[1] && fabsf(d[2]) <= half[2];
}

static void anchors_lie_on_the_temple_and_in_their_regions(void **state)
{
	cJSON *root = read_parts();
	const cJSON *part;
	struct plan plan;

	(void)state;
	CHECK(plan_create(&plan, 1) == 0);
	CHECK(cJSON_GetArraySize(cJSON_GetObjectItem(root, "parts")) >= 12);
	cJSON_ArrayForEach(part, cJSON_GetObjectItem(root, "parts"))
	{
		const char *id = cJSON_GetObjectItem(part, "id")->valuestring;
		float anchor[3];
		numbers(cJSON_GetObjectItem(part, "anchor"), 3, anchor);
		if (!contains(cJSON_GetObjectItem(part, "region"), &plan, anchor))
			fail_msg("%s: the anchor is outside the region", id);
		float distance = surface_distance_m(&plan, 0, plan.count, anchor);
		if (distance > 0.5f)
			fail_msg("%s: the anchor is %.2f m off the temple", id, distance);
	}
	plan_destroy(&plan);
	cJSON_Delete(root);
}

static bool is_part(const cJSON *root, const char *id, size_t length)
{
	const cJSON *part;

	cJSON_ArrayForEach(part, cJSON_GetObjectItem(root, "parts"))
	{
		const char *name = cJSON_GetObjectItem(part, "id")->valuestring;
		if (strlen(name) == length && strncmp(name, id, length) == 0)
			return true;
	}
	return false;
}

/* Every src and part link of a page leads somewhere. */
static void check_links(const cJSON *root, const char *path, const char *page)
{
	for (const char *at = page; (at = strstr(at, "href=\"")); at++) {
		const char *target = at + 6;
		if (strncmp(target, "tour:round\"", 11) == 0)
			continue; /* is there: tests/e2e/tours.sh flies it */
		CHECK(strncmp(target, "part:", 5) == 0);
		if (!is_part(root, target + 5, strcspn(target + 5, "\"")))
			fail_msg("%s: a link to no part: %.40s", path, target);
	}
	for (const char *at = page; (at = strstr(at, "src=\"")); at++) {
		char file[256];
		snprintf(file, sizeof(file), "demo/content/%.*s", (int)strcspn(at + 5, "\""),
			 at + 5);
		free(read_text(file));
	}
}

static void every_part_has_its_page_in_every_language(void **state)
{
	cJSON *root = read_parts();
	const cJSON *part;

	(void)state;
	cJSON_ArrayForEach(part, cJSON_GetObjectItem(root, "parts"))
	{
		for (size_t i = 0; i < ARRAY_COUNT(languages); i++) {
			const char *id = cJSON_GetObjectItem(part, "id")->valuestring;
			char path[256], heading[256];
			snprintf(path, sizeof(path), "demo/content/pages/%s.%s.html", id,
				 languages[i]);
			char *page = read_text(path);
			const cJSON *title = cJSON_GetObjectItem(cJSON_GetObjectItem(part, "title"),
								 languages[i]);
			const cJSON *caption = cJSON_GetObjectItem(
				cJSON_GetObjectItem(part, "caption"), languages[i]);
			CHECK(cJSON_IsString(title) && cJSON_IsString(caption));
			snprintf(heading, sizeof(heading), "<h1>%s</h1>", title->valuestring);
			if (!strstr(page, heading))
				fail_msg("%s: its heading is not the part's title", path);
			check_links(root, path, page);
			free(page);
		}
	}
	cJSON_Delete(root);
}

static void pictures_are_small(void **state)
{
	DIR *folder = opendir("demo/content/pictures");
	struct dirent *entry;

	(void)state;
	CHECK(folder != NULL);
	while ((entry = readdir(folder))) {
		char path[512];
		struct buffer picture;
		if (entry->d_name[0] == '.')
			continue;
		snprintf(path, sizeof(path), "demo/content/pictures/%s", entry->d_name);
		buffer_init(&picture, 60 * 1024);
		if (buffer_read_file(&picture, path) != 0)
			fail_msg("%s is larger than 60 KiB", path);
		CHECK(picture.size > 1000 && picture.data[0] == 0xff && picture.data[1] == 0xd8);
		buffer_finish(&picture);
	}
	closedir(folder);
}

/* A roof in the second of two layers, and a door that a touch opens, in every language. */
static void the_scenes_are_whole(void **state)
{
	struct content content = { .folder = "demo/content",
				   .language_count = ARRAY_COUNT(languages) };
	struct diagnostics told = { 0 };
	struct scenery scenery;

	(void)state;
	for (uint32_t i = 0; i < content.language_count; i++)
		snprintf(content.languages[i], sizeof(content.languages[i]), "%s", languages[i]);
	if (scenes_read(&scenery, &content, &told) != 0 || told.count > 0)
		fail_msg("%s", diagnostics_cause(&told, 0));
	CHECK(scenery.layer_count == 2 && scenery.title_count == 8);
	CHECK(scenery.motion_count == 1 && scenery.motions[0].returns && scenery.touch_count == 1);
	CHECK(scenery_triangles(&scenery) > 10000);
	scenery_finish(&scenery);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(anchors_lie_on_the_temple_and_in_their_regions),
		cmocka_unit_test(every_part_has_its_page_in_every_language),
		cmocka_unit_test(pictures_are_small),
		cmocka_unit_test(the_scenes_are_whole),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
