/* A content folder to build information databases from, and what the builder said about it. */
#ifndef GOPURA_TESTS_PIPELINE_CONTENT_INFO_FOLDER_H
#define GOPURA_TESTS_PIPELINE_CONTENT_INFO_FOLDER_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "format/picture.h"
#include "pipeline/content/info_build.h"
#include "tests/check.h"

static char folder[64];
static struct diagnostics told = { .max = INFO_DIAGNOSTICS_MAX }; /* by the last build */

/* An error about file:line whose sentence holds words. */
static inline bool was_told(const char *file, unsigned line, const char *words)
{
	char place[200];

	snprintf(place, sizeof(place), line > 0 ? "%s:%u: " : "%s: ", file, line);
	for (uint32_t i = 0; i < told.count; i++) {
		const struct diagnostic *found = diagnostics_get(&told, i);

		if (found->error < 0 && found->line == line &&
		    found->place_bytes == strlen(place) &&
		    strncmp(found->text, place, strlen(place)) == 0 &&
		    strstr(found->text + found->place_bytes, words))
			return true;
	}
	return false;
}

static inline void write_file(const char *name, const void *data, size_t size)
{
	char path[200];

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	CHECK(bytes_write_file((struct bytes){ data, size }, path) == 0);
}

static inline void write_text(const char *name, const char *text)
{
	write_file(name, text, strlen(text));
}

static inline void write_picture(const char *name, uint32_t width, uint32_t height, uint8_t grey)
{
	struct picture picture = { width, height, malloc((size_t)width * height * 4) };
	struct buffer png;

	memset(picture.rgba, grey, (size_t)width * height * 4);
	buffer_init(&png, 1 << 20);
	CHECK(picture_encode_png(&png, &picture) == 0);
	write_file(name, png.data, png.size);
	buffer_finish(&png);
	picture_finish(&picture);
}

static const char good_parts[] =
	"{\"parts\": [\n"
	"  {\"id\": \"tower\", \"region\": {\"kind\": \"box\", \"centre\": [0, 1, 20],\n"
	"   \"half\": [3, 4, 5], \"turn\": 45}, \"anchor\": [0, 1, 25],\n"
	"   \"title\": {\"en\": \"Central tower\", \"km\": \"ប្រាង្គកណ្ដាល\"},\n"
	"   \"caption\": {\"en\": \"The mountain at the middle.\"},\n"
	"   \"thumbnail\": \"pictures/a.png\"},\n"
	"  {\"id\": \"gate\", \"region\": {\"kind\": \"prism\", \"floor\": 0, \"roof\": 4,\n"
	"   \"corners\": [[0, 0], [0, 2], [2, 2], [2, 0]]},\n"
	"   \"title\": {\"en\": \"Gate\", \"km\": \"ទ្វារ\"}},\n"
	"  {\"id\": \"naga\", \"anchor\": [5, 6, 7], \"page\": false,\n"
	"   \"title\": {\"en\": \"Naga\", \"km\": \"នាគ\"}}\n"
	"]}\n";

static inline void write_good_folder(void)
{
	write_text("parts.json", good_parts);
	write_text("pages/tower.en.html",
		   "<h1>Central tower</h1>\n<p>Above the <a href=\"part:gate\">gate</a>.</p>\n"
		   "<figure><img src=\"pictures/b.png\"><figcaption>East</figcaption></figure>");
	write_text("pages/tower.km.html", "<h1>ប្រាង្គ</h1><p>ភ្នំ</p>");
	write_text("pages/gate.en.html", "<p>One enters here.</p>");
	write_picture("pictures/a.png", 8, 6, 100);
	write_picture("pictures/b.png", 20, 10, 200);
}

static inline int set_up(void **state)
{
	char path[100];

	(void)state;
	snprintf(folder, sizeof(folder), "/tmp/gopura-info-XXXXXX");
	if (!mkdtemp(folder))
		return -1;
	snprintf(path, sizeof(path), "%s/pages", folder);
	mkdir(path, 0755);
	snprintf(path, sizeof(path), "%s/pictures", folder);
	mkdir(path, 0755);
	write_good_folder();
	return 0;
}

static inline int tear_down(void **state)
{
	char command[100];

	(void)state;
	diagnostics_finish(&told);
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	return system(command);
}

static inline int build(struct info_built *out)
{
	static const char *const languages[] = { "en", "km" };
	const struct info_build_options options = {
		.folder = folder, .languages = languages, .language_count = 2, .diagnostics = &told
	};

	diagnostics_finish(&told);
	return info_build(out, &options);
}

#endif
