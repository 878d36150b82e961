#include "pipeline/folder.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <ini.h>

#include "base/bytes.h"

struct reading {
	struct folder *folder;
	struct fault *fault;
	char path[PATH_MAX];
	FILE *file;
	unsigned line;
	const char *section, *key;
	int rc;
};

static int complain(struct reading *reading, const char *value, const char *cure)
{
	reading->rc =
		fault_set(reading->fault, -EINVAL, "%s, line %u: [%s] %s = %s: %s", reading->path,
			  reading->line, reading->section, reading->key, value, cure);
	return 0;
}

static int read_text(struct reading *reading, char *out, size_t size, const char *value)
{
	if (strlen(value) >= size)
		return complain(reading, value, "too long");
	memcpy(out, value, strlen(value) + 1);
	return 1;
}

/* Words between blanks and commas, each into a row of `size` bytes. */
static int read_words(struct reading *reading, char *rows, size_t size, uint32_t most,
		      uint32_t *count, const char *value)
{
	const char *at = value;

	*count = 0;
	while (*(at += strspn(at, " \t,"))) {
		size_t length = strcspn(at, " \t,");

		if (length >= size || *count == most)
			return complain(reading, value, "too many names, or one too long");
		memcpy(rows + *count * size, at, length);
		rows[*count * size + length] = '\0';
		++*count;
		at += length;
	}
	return *count ? 1 : complain(reading, value, "give at least one name");
}

static int read_numbers(struct reading *reading, float *out, int count, const char *value)
{
	const char *at = value;

	for (int i = 0; i < count; i++) {
		char *end;

		out[i] = strtof(at, &end);
		if (end == at || !isfinite(out[i]))
			return complain(reading, value, "give numbers with blanks between them");
		at = end + strspn(end, " \t,");
	}
	return *at ? complain(reading, value, "too many numbers") : 1;
}

static int read_count(struct reading *reading, uint32_t *out, uint32_t least, uint32_t most,
		      const char *value)
{
	char *end, cure[80];
	unsigned long number = strtoul(value, &end, 10);

	snprintf(cure, sizeof(cure), "give a whole number from %u to %u", least, most);
	if (end == value || *end || *value == '-' || number < least || number > most)
		return complain(reading, value, cure);
	*out = (uint32_t)number;
	return 1;
}

static int read_yes(struct reading *reading, bool *out, const char *value)
{
	if (strcmp(value, "yes") != 0 && strcmp(value, "no") != 0)
		return complain(reading, value, "give yes or no");
	*out = *value == 'y';
	return 1;
}

static int read_colour(struct reading *reading, uint8_t out[3], const char *value)
{
	unsigned rgb[3];
	char rest;

	if (sscanf(value, "#%2x%2x%2x%c", &rgb[0], &rgb[1], &rgb[2], &rest) != 3 ||
	    strlen(value) != 7)
		return complain(reading, value, "give a colour such as #b0a488");
	for (int i = 0; i < 3; i++)
		out[i] = (uint8_t)rgb[i];
	return 1;
}

static int read_colours(struct reading *reading, const char *value)
{
	struct folder *folder = reading->folder;

	if (*value == '"' || *value == '#') {
		char bare[16] = "";

		sscanf(value, "%*[\"]%15[^\"]", bare);
		folder->colours = FOLDER_ONE_COLOUR;
		return read_colour(reading, folder->colour, *value == '"' ? bare : value);
	}
	if (strcmp(value, "scan") != 0 && strcmp(value, "procedural") != 0)
		return complain(reading, value,
				"give scan, procedural or a colour such as #b0a488");
	folder->colours = *value == 's' ? FOLDER_SCAN_COLOURS : FOLDER_PROCEDURAL;
	return 1;
}

static int read_sun(struct reading *reading, const char *value)
{
	float *sun = reading->folder->sun, size;

	if (!read_numbers(reading, sun, 3, value))
		return 0;
	size = sqrtf(sun[0] * sun[0] + sun[1] * sun[1] + sun[2] * sun[2]);
	if (!(size > 0))
		return complain(reading, value, "give a direction towards the sun");
	for (int i = 0; i < 3; i++)
		sun[i] /= size;
	return 1;
}

/* "eye x y z target x y z" */
static int read_start(struct reading *reading, const char *value)
{
	static const char cure[] = "give: eye x y z target x y z";
	struct folder *folder = reading->folder;
	float *e = folder->start_eye_m, *t = folder->start_target_m;
	char rest;

	if (sscanf(value, "eye %f %f %f target %f %f %f %c", &e[0], &e[1], &e[2], &t[0], &t[1],
		   &t[2], &rest) != 6)
		return complain(reading, value, cure);
	for (int i = 0; i < 3; i++)
		if (!isfinite(e[i]) || !isfinite(t[i]))
			return complain(reading, value, cure);
	folder->has_start = true;
	return 1;
}

static int read_model(struct reading *reading, const char *key, const char *value)
{
	struct folder *folder = reading->folder;
	bool yes;

	if (strcmp(key, "name") == 0)
		return read_text(reading, folder->name, sizeof(folder->name), value);
	if (strcmp(key, "scans") == 0)
		return read_words(reading, folder->scans[0], FOLDER_TEXT_BYTES, FOLDER_SCANS_MOST,
				  &folder->scan_count, value);
	if (strcmp(key, "up") == 0)
		return import_axis_named(value, &folder->import.up) ||
		       complain(reading, value, "give z, y or x");
	if (strcmp(key, "unit") == 0)
		return import_unit_named(value, &folder->import.metres_per_unit) ||
		       complain(reading, value, "give m, cm, mm, in or metres in one unit");
	if (strcmp(key, "colours") == 0)
		return read_colours(reading, value);
	if (strcmp(key, "sun") == 0)
		return read_sun(reading, value);
	if (strcmp(key, "background") == 0)
		return read_colour(reading, folder->background, value);
	if (strcmp(key, "lit") != 0)
		return complain(reading, value, "no such key");
	if (!read_yes(reading, &yes, value))
		return 0;
	folder->lit = yes ? FOLDER_YES : FOLDER_NO;
	return 1;
}

static int read_grid(struct reading *reading, const char *key, const char *value)
{
	struct folder *folder = reading->folder;

	if (strcmp(key, "points") == 0)
		return read_count(reading, &folder->grid_points, 2, 64, value);
	if (strcmp(key, "quality") == 0)
		return read_count(reading, &folder->quality, 1, 100, value);
	if (strcmp(key, "below_ground") == 0)
		return read_yes(reading, &folder->below_ground, value);
	if (strcmp(key, "face_px") != 0)
		return complain(reading, value, "no such key");
	if (!read_count(reading, &folder->face_px, 128, 2048, value))
		return 0;
	return (folder->face_px & (folder->face_px - 1)) == 0 ||
	       complain(reading, value, "give 128, 256, 512, 1024 or 2048");
}

static int read_release(struct reading *reading, const char *key, const char *value)
{
	struct folder *folder = reading->folder;
	float share;

	if (strcmp(key, "languages") == 0)
		return read_words(reading, folder->languages[0], sizeof(folder->languages[0]),
				  FOLDER_LANGUAGES_MOST, &folder->language_count, value);
	if (strcmp(key, "publish_share") != 0)
		return complain(reading, value, "no such key");
	if (!read_numbers(reading, &share, 1, value))
		return 0;
	folder->publish_share = (double)share;
	return (share >= 0.001f && share <= 1) || complain(reading, value, "give 0.001 to 1");
}

static int read_key(void *data, const char *section, const char *key, const char *value)
{
	struct reading *reading = data;

	reading->section = section;
	reading->key = key;
	if (reading->rc < 0)
		return 0;
	if (strcmp(section, "model") == 0)
		return read_model(reading, key, value);
	if (strcmp(section, "grid") == 0)
		return read_grid(reading, key, value);
	if (strcmp(section, "release") == 0)
		return read_release(reading, key, value);
	if (strcmp(section, "view") == 0 && strcmp(key, "start") == 0)
		return read_start(reading, value);
	if (strcmp(section, "hierarchy") == 0 && strcmp(key, "patch_triangles") == 0)
		return read_count(reading, &reading->folder->patch_triangles, 64, 4000, value);
	if (strcmp(section, "hierarchy") == 0 && strcmp(key, "kind") == 0) {
		reading->folder->tree = strcmp(value, "tree") == 0;
		return reading->folder->tree || strcmp(value, "groups") == 0 ||
		       complain(reading, value, "give groups or tree");
	}
	return complain(reading, value, "no such key");
}

static char *read_line(char *text, int bytes, void *stream)
{
	struct reading *reading = stream;

	reading->line++;
	return fgets(text, bytes, reading->file);
}

static const struct folder folder_default = {
	.name = "model",
	.import = { .metres_per_unit = 1 },
	.colour = { 0xb8, 0xa8, 0x8c },
	.sun = { 0.48f, -0.6f, 0.64f },
	.background = { 0xd8, 0xdf, 0xe6 },
	.grid_points = 8,
	.face_px = 512,
	.quality = 75,
	.patch_triangles = 4000,
	.publish_share = 0.10,
	.language_count = 1,
	.languages = { "en" },
};

int folder_open(struct folder *out, const char *dir, struct fault *fault)
{
	struct reading reading = { .folder = out, .fault = fault };
	int broken;

	*out = folder_default;
	if (strlen(dir) >= sizeof(out->dir))
		return fault_set(fault, -ENAMETOOLONG, "%.100s...: the name is too long", dir);
	memcpy(out->dir, dir, strlen(dir) + 1);
	snprintf(reading.path, sizeof(reading.path), "%s/temple.ini", dir);
	reading.file = fopen(reading.path, "re");
	if (!reading.file)
		return fault_set(fault, -errno, "%s: %s; a content folder holds a temple.ini",
				 reading.path, strerror(errno));
	broken = ini_parse_stream(read_line, &reading, read_key, &reading);
	fclose(reading.file);
	if (reading.rc < 0)
		return reading.rc;
	if (broken)
		return fault_set(fault, -EINVAL, "%s, line %d: give [sections] and key = value",
				 reading.path, broken);
	if (out->scan_count == 0)
		return fault_set(fault, -EINVAL,
				 "%s: [model] scans is missing: name the scan files", reading.path);
	memcpy(out->import.default_colour, out->colour, sizeof(out->colour));
	out->import.override_colour = out->colours == FOLDER_ONE_COLOUR;
	return 0;
}

bool folder_lit(const struct folder *folder, const struct mesh *mesh)
{
	if (folder->lit != FOLDER_BY_SCAN)
		return folder->lit == FOLDER_YES;
	return folder->colours != FOLDER_SCAN_COLOURS || mesh->texture_count == 0;
}

int folder_make_work(const struct folder *folder, const char *below)
{
	char path[PATH_MAX];

	snprintf(path, sizeof(path), "%s/.work", folder->dir);
	if (mkdir(path, 0777) < 0 && errno != EEXIST)
		return -errno;
	if (!below)
		return 0;
	if (snprintf(path, sizeof(path), "%s/.work/%s", folder->dir, below) >= PATH_MAX)
		return -ENAMETOOLONG;
	return mkdir(path, 0777) < 0 && errno != EEXIST ? -errno : 0;
}
