#include "board/profile.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <ini.h>

#include "base/log.h"

const struct profile profile_default = {
	.triangles = 400000,
	.texture_mib = 96,
	.geometry_mib = 64,
	.error_px = 2,
	.upload_us = 4000,
	.workers = 2,
	.cache_mib = 256,
};

enum profile_type { TYPE_INT, TYPE_QUARTERS, TYPE_FLOAT, TYPE_MATRIX };

struct profile_key {
	const char *section, *name;
	enum profile_type type;
	size_t offset;
	double least, most;
};

#define KEY(section, name, type, field, least, most)                                               \
	{                                                                                          \
		section, name, type, offsetof(struct profile, field), least, most                  \
	}

static const struct profile_key keys[] = {
	KEY("panel", "rotation", TYPE_QUARTERS, rotation_deg, 0, 270),
	KEY("panel", "width_mm", TYPE_INT, width_mm, 0, 5000),
	KEY("touch", "matrix", TYPE_MATRIX, matrix, -10, 10),
	KEY("touch", "edge_mm", TYPE_FLOAT, edge_mm, 0, 50),
	KEY("touch", "palm_mm", TYPE_FLOAT, palm_mm, 0, 200),
	KEY("render", "triangles", TYPE_INT, triangles, 10000, 20000000),
	KEY("render", "texture_mib", TYPE_INT, texture_mib, 8, 1024),
	KEY("render", "geometry_mib", TYPE_INT, geometry_mib, 8, 1024),
	KEY("render", "error_px", TYPE_FLOAT, error_px, 0.25, 64),
	KEY("render", "thrift", TYPE_FLOAT, thrift, 0, 100000),
	KEY("render", "upload_us", TYPE_INT, upload_us, 200, 100000),
	KEY("render", "workers", TYPE_INT, workers, 1, 8),
	KEY("cache", "mib", TYPE_INT, cache_mib, 8, 65536),
};

struct profile_reading {
	struct profile *profile;
	FILE *file;
	const char *path;
	unsigned line;
	bool failed;
};

static char *read_line(char *text, int bytes, void *stream)
{
	struct profile_reading *reading = stream;

	reading->line++;
	return fgets(text, bytes, reading->file);
}

static void complain(struct profile_reading *reading, const char *what, const char *name)
{
	reading->failed = true;
	log_error("board", "board bug: %s, line %u: %s '%s' (see docs/board.md)", reading->path,
		  reading->line, what, name);
}

/* As many numbers within the key's limits as wanted, and nothing else. */
static bool read_numbers(const struct profile_key *key, const char *text, double *out, int wanted)
{
	for (int i = 0; i < wanted; i++) {
		char *end;

		out[i] = strtod(text, &end);
		if (end == text || !(out[i] >= key->least && out[i] <= key->most))
			return false;
		text = end + strspn(end, " \t,");
	}
	return *text == '\0';
}

static bool set_key(struct profile *profile, const struct profile_key *key, const char *text)
{
	void *to = (char *)profile + key->offset;
	double numbers[6];

	if (!read_numbers(key, text, numbers, key->type == TYPE_MATRIX ? 6 : 1))
		return false;
	switch (key->type) {
	case TYPE_INT:
		*(int *)to = (int)numbers[0];
		return numbers[0] == floor(numbers[0]);
	case TYPE_QUARTERS:
		*(int *)to = (int)numbers[0];
		return fmod(numbers[0], 90) == 0;
	case TYPE_FLOAT:
		*(float *)to = (float)numbers[0];
		return true;
	case TYPE_MATRIX:
		for (int i = 0; i < 6; i++)
			((float *)to)[i] = (float)numbers[i];
		return true;
	}
	return false;
}

static int on_entry(void *data, const char *section, const char *name, const char *value)
{
	struct profile_reading *reading = data;

	for (size_t i = 0; i < ARRAY_COUNT(keys); i++) {
		if (strcmp(keys[i].section, section) != 0 || strcmp(keys[i].name, name) != 0)
			continue;
		if (!set_key(reading->profile, &keys[i], value))
			complain(reading, "this value does not do:", value);
		return 1;
	}
	complain(reading, "no such entry:", name);
	return 1;
}

int profile_read(struct profile *out, const char *path)
{
	struct profile_reading reading = { .profile = out, .path = path };
	int rc;

	*out = profile_default;
	if (!path)
		return 0;
	reading.file = fopen(path, "re");
	if (!reading.file) {
		rc = -errno;
		log_error("board", "board bug: %s: %s", path, strerror(-rc));
		return rc;
	}
	rc = ini_parse_stream(read_line, &reading, on_entry, &reading);
	if (rc > 0) {
		reading.line = (unsigned)rc;
		complain(&reading, "neither a [section] nor name = value", "");
	}
	fclose(reading.file);
	return reading.failed ? -EINVAL : rc < 0 ? -EIO : 0;
}
