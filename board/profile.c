/* The default profile and the table of settings that an ini file may contain. */
#include "board/profile.h"

#include <math.h>
#include <stddef.h>

#include "base/log.h"
#include "base/settings.h"

const struct profile profile_default = {
	.triangles = 400000,
	.texture_mib = 96,
	.geometry_mib = 64,
	.scale_least = 0.5f,
	.error_px = 2,
	.upload_us = 4000,
	.workers = 2,
	.cache_mib = 1024,
};

static bool set_float(const struct setting *setting, void *target, const char *value)
{
	double number;

	if (!settings_numbers(setting, value, &number, 1))
		return false;
	*(float *)((char *)target + setting->offset) = (float)number;
	return true;
}

static bool set_quarters(const struct setting *setting, void *target, const char *value)
{
	double number;

	return settings_numbers(setting, value, &number, 1) && fmod(number, 90) == 0 &&
	       settings_whole(setting, target, value);
}

static bool set_matrix(const struct setting *setting, void *target, const char *value)
{
	double numbers[6];

	if (!settings_numbers(setting, value, numbers, 6))
		return false;
	for (int i = 0; i < 6; i++)
		((float *)((char *)target + setting->offset))[i] = (float)numbers[i];
	return true;
}

/* A name that was used before: refused, and `expects` says the one of now. */
static bool set_never(const struct setting *setting, void *target, const char *value)
{
	(void)setting;
	(void)target;
	(void)value;
	return false;
}

#define SETTING(section, name, expects, set, field, least, most)                                   \
	{                                                                                          \
		section, name, expects, set, offsetof(struct profile, field), least, most, false,  \
			false                                                                      \
	}

static const struct setting settings[] = {
	SETTING("panel", "rotation", "0, 90, 180 or 270", set_quarters, rotation_deg, 0, 270),
	SETTING("panel", "width_mm", NULL, settings_whole, width_mm, 0, 5000),
	SETTING("touch", "matrix", "six numbers from -10 to 10", set_matrix, matrix, -10, 10),
	SETTING("touch", "edge_mm", NULL, set_float, edge_mm, 0, 50),
	SETTING("touch", "palm_mm", NULL, set_float, palm_mm, 0, 200),
	SETTING("render", "triangles", NULL, settings_whole, triangles, PROFILE_TRIANGLES_LEAST,
		PROFILE_TRIANGLES_MOST),
	SETTING("render", "texture_mib", NULL, settings_whole, texture_mib, 8, 1024),
	SETTING("render", "geometry_mib", NULL, settings_whole, geometry_mib, 8, 1024),
	SETTING("render", "scale_least", NULL, set_float, scale_least, 0.25, 1),
	SETTING("render", "error_px", NULL, set_float, error_px, 0.25, 64),
	SETTING("render", "price_px_per_kb", NULL, set_float, price_px_per_kb, 0, 100000),
	SETTING("render", "thrift", "named price_px_per_kb", set_never, price_px_per_kb, 0, 0),
	SETTING("render", "upload_us", NULL, settings_whole, upload_us, 200, 100000),
	SETTING("render", "workers", NULL, settings_whole, workers, 1, 8),
	SETTING("cache", "mib", NULL, settings_whole, cache_mib, 8, 65536),
};

int profile_read(struct profile *out, const char *path)
{
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	int rc;

	*out = profile_default;
	if (!path)
		return 0;
	rc = settings_read_file(path, settings, ARRAY_COUNT(settings), out, &diagnostics);
	for (unsigned i = 0; i < diagnostics.count; i++)
		log_error("board", "board bug: %s, %s (see docs/board.md)", path,
			  diagnostics_get(&diagnostics, i)->text);
	diagnostics_finish(&diagnostics);
	return rc;
}
