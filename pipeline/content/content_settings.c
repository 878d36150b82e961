/* The settings of temple.ini: which there are, and how each is parsed into struct content. */
#include "pipeline/content/content_settings.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "storage/info.h"
#include "storage/info_tools.h"

static bool set_name(const struct setting *setting, void *target, const char *value)
{
	struct content *content = target;

	(void)setting;
	return snprintf(content->name, sizeof(content->name), "%s", value) <
	       (int)sizeof(content->name);
}

/* Stores the names only. Paths are built when the whole file has been read. */
static bool set_scans(const struct setting *setting, void *target, const char *value)
{
	struct content *content = target;

	(void)setting;
	while (*(value += strspn(value, " \t,"))) {
		size_t length = strcspn(value, " \t,");
		char *name = strndup(value, length);

		if (!name)
			return false;
		if (content->scan_count == CONTENT_SCANS_MAX || !content_name_is_safe(name)) {
			free(name);
			return false;
		}
		content->scans[content->scan_count++] = name;
		value += length;
	}
	return content->scan_count > 0;
}

static bool set_up(const struct setting *setting, void *target, const char *value)
{
	(void)setting;
	return import_axis_named(value, &((struct content *)target)->import.up);
}

static bool set_unit(const struct setting *setting, void *target, const char *value)
{
	(void)setting;
	return import_unit_named(value, &((struct content *)target)->import.metres_per_unit);
}

/* Reads #rrggbb. */
static bool read_colour(const char *value, uint8_t rgb[3])
{
	uint8_t read[3];
	int length = 0;

	if (sscanf(value, "#%2hhx%2hhx%2hhx%n", &read[0], &read[1], &read[2], &length) != 3 ||
	    length != 7 || value[7])
		return false;
	memcpy(rgb, read, 3);
	return true;
}

static bool set_colours(const struct setting *setting, void *target, const char *value)
{
	struct content *content = target;

	const enum substance_kind substance = substance_named(value);

	(void)setting;
	content->colours = strcasecmp(value, "scan") == 0         ? CONTENT_COLOURS_SCAN
			   : strcasecmp(value, "procedural") == 0 ? CONTENT_COLOURS_PROCEDURAL
								  : CONTENT_COLOURS_ONE;
	if (substance != SUBSTANCE_NONE && substance != SUBSTANCE_KINDS) {
		content->colours = CONTENT_COLOURS_PROCEDURAL;
		content->substance = substance;
	}
	if (content->colours != CONTENT_COLOURS_ONE)
		return true;
	content->import.override_colour = true;
	return read_colour(value, content->import.default_colour);
}

static bool set_cut(const struct setting *setting, void *target, const char *value)
{
	const enum substance_kind kind = substance_named(value);

	(void)setting;
	if (kind == SUBSTANCE_KINDS)
		return false;
	((struct content *)target)->cut = kind;
	return true;
}

static bool set_lit(const struct setting *setting, void *target, const char *value)
{
	bool yes;

	(void)setting;
	if (!settings_read_yes_no(value, &yes))
		return false;
	((struct content *)target)->lit = yes ? CONTENT_LIT_YES : CONTENT_LIT_NO;
	return true;
}

static bool set_sun(const struct setting *setting, void *target, const char *value)
{
	struct content *content = target;
	double v[3], length;

	if (!settings_numbers(setting, value, v, 3))
		return false;
	length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	if (!(length > 1e-9) || !isfinite(length))
		return false;
	for (int k = 0; k < 3; k++)
		content->sun[k] = (float)(v[k] / length);
	return true;
}

static bool set_background(const struct setting *setting, void *target, const char *value)
{
	(void)setting;
	return read_colour(value, ((struct content *)target)->background);
}

/* Reads "eye 1 2 3 target 4 5 6"; the words may be omitted. */
static bool set_start(const struct setting *setting, void *target, const char *value)
{
	struct content *content = target;
	char numbers[256];
	double v[6];
	size_t at = 0;

	for (; *value && at < sizeof(numbers) - 1; value++) {
		if (strncmp(value, "eye", 3) == 0)
			value += 3;
		else if (strncmp(value, "target", 6) == 0)
			value += 6;
		if (!*value)
			break;
		numbers[at++] = *value;
	}
	numbers[at] = '\0';
	if (!settings_numbers(setting, numbers, v, 6) ||
	    (v[0] == v[3] && v[1] == v[4] && v[2] == v[5]))
		return false;
	for (int k = 0; k < 3; k++) {
		content->start_eye_m[k] = (float)v[k];
		content->start_target_m[k] = (float)v[3 + k];
	}
	content->has_start = true;
	return true;
}

static bool set_tools(const struct setting *setting, void *target, const char *value)
{
	unsigned *tools = &((struct content *)target)->tools;

	(void)setting;
	*tools = 0;
	while (*(value += strspn(value, " \t,"))) {
		const size_t length = strcspn(value, " \t,");
		const unsigned tool = info_tool_named(value, length);

		if (tool == 0 || *tools & tool)
			return false;
		*tools |= tool;
		value += length;
	}
	return true;
}

static bool set_error_mm(const struct setting *setting, void *target, const char *value)
{
	return settings_numbers(setting, value, &((struct content *)target)->error_mm, 1);
}

static bool set_face_px(const struct setting *setting, void *target, const char *value)
{
	const uint32_t *px = &((struct content *)target)->face_px;

	return settings_whole(setting, target, value) && (*px & (*px - 1)) == 0;
}

static bool set_effort(const struct setting *setting, void *target, const char *value)
{
	bool quick = strcasecmp(value, "quick") == 0;

	(void)setting;
	((struct content *)target)->effort = quick ? TILE_QUICK : TILE_THOROUGH;
	return quick || strcasecmp(value, "thorough") == 0;
}

static bool set_quality_rule(const struct setting *setting, void *target, const char *value)
{
	struct content *content = target;

	(void)setting;
	content->quality_rule = strcasecmp(value, "features") == 0  ? CONTENT_QUALITY_FEATURES
				: strcasecmp(value, "uniform") == 0 ? CONTENT_QUALITY_UNIFORM
								    : CONTENT_QUALITY_GAIN;
	return content->quality_rule != CONTENT_QUALITY_GAIN || strcasecmp(value, "gain") == 0;
}

static bool set_kind(const struct setting *setting, void *target, const char *value)
{
	struct content *content = target;

	(void)setting;
	content->binary_tree = strcasecmp(value, "tree") == 0;
	return content->binary_tree || strcasecmp(value, "groups") == 0;
}

static bool set_simplify(const struct setting *setting, void *target, const char *value)
{
	struct content *content = target;

	(void)setting;
	content->simplify_features = strcasecmp(value, "features") == 0;
	return content->simplify_features || strcasecmp(value, "quadric") == 0;
}

static bool set_surface(const struct setting *setting, void *target, const char *value)
{
	const bool is_octree = strcasecmp(value, "octree") == 0;

	(void)setting;
	((struct content *)target)->surface =
		is_octree ? CONTENT_SURFACE_OCTREE : CONTENT_SURFACE_SCAN;
	return is_octree || strcasecmp(value, "scan") == 0;
}

static bool set_cell_mm(const struct setting *setting, void *target, const char *value)
{
	return settings_numbers(setting, value, &((struct content *)target)->cell_mm, 1);
}

static bool set_lattice_mm(const struct setting *setting, void *target, const char *value)
{
	return settings_numbers(setting, value, &((struct content *)target)->lattice_mm, 1);
}

static bool set_publish_share(const struct setting *setting, void *target, const char *value)
{
	return settings_numbers(setting, value, &((struct content *)target)->publish_share, 1);
}

/* For example "en", "km" or "pt-BR". */
static bool is_language(const char *tag, size_t length)
{
	if (length < 2 || length >= CONTENT_LANGUAGE_BYTES)
		return false;
	for (size_t i = 0; i < length; i++)
		if (!((tag[i] >= 'a' && tag[i] <= 'z') || (tag[i] >= 'A' && tag[i] <= 'Z') ||
		      (tag[i] == '-' && i > 1)))
			return false;
	return true;
}

static bool set_languages(const struct setting *setting, void *target, const char *value)
{
	struct content *content = target;

	(void)setting;
	content->language_count = 0;
	while (*(value += strspn(value, " \t,"))) {
		size_t length = strcspn(value, " \t,");

		if (content->language_count == CONTENT_LANGUAGES_MAX || !is_language(value, length))
			return false;
		memset(content->languages[content->language_count], 0, CONTENT_LANGUAGE_BYTES);
		memcpy(content->languages[content->language_count++], value, length);
		value += length;
	}
	return content->language_count > 0;
}

static bool set_metadata(const struct setting *setting, void *target, const char *value)
{
	struct content *content = target;

	(void)setting;
	content->tuf_alone = strcasecmp(value, "tuf") == 0;
	return content->tuf_alone || strcasecmp(value, "both") == 0;
}

#define PATH_CHARS "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-"

/* A path without empty parts and parts that begin with a dot. */
static bool set_target(const struct setting *setting, void *target, const char *value)
{
	struct content *content = target;
	const size_t size = strlen(value);

	(void)setting;
	if (size == 0 || size >= sizeof(content->tuf_target) ||
	    value[strspn(value, PATH_CHARS "/")] || *value == '.' || *value == '/' ||
	    value[size - 1] == '/' || strstr(value, "//") || strstr(value, "/."))
		return false;
	memcpy(content->tuf_target, value, size + 1);
	return true;
}

const char content_role_rule[] =
	"a role is up to 64 letters, digits and ._- that do not begin with "
	"a point, and not root, timestamp, snapshot or targets";

bool content_role_is_valid(const char *name)
{
	static const char *const reserved[] = { "root", "timestamp", "snapshot", "targets" };
	const size_t size = strlen(name);

	for (size_t i = 0; i < ARRAY_COUNT(reserved); i++)
		if (strcmp(name, reserved[i]) == 0)
			return false;
	return size > 0 && size < CONTENT_ROLE_BYTES && *name != '.' &&
	       !name[strspn(name, PATH_CHARS)];
}

static bool set_role(const struct setting *setting, void *target, const char *value)
{
	struct content *content = target;

	(void)setting;
	if (!content_role_is_valid(value))
		return false;
	memcpy(content->tuf_role, value, strlen(value) + 1);
	return true;
}

#define SETTING(section, name, expects, set)                                                       \
	{                                                                                          \
		section, name, expects, set, 0, 0, 0, false, false                                 \
	}
#define NUMBERS(section, name, expects, set, field, least, most)                                   \
	{                                                                                          \
		section, name, expects, set, offsetof(struct content, field), least, most, false,  \
			false                                                                      \
	}

static const struct setting settings[CONTENT_SETTINGS] = {
	{ .section = "model",
	  .name = "name",
	  .expects = "the model's name, under 128 bytes",
	  .set = set_name,
	  .free_text = true },
	SETTING("model", "scans",
		"up to 256 file names, separated by spaces, relative to this folder and inside it",
		set_scans),
	SETTING("model", "up", "z, y or x: the axis that points up in the scans", set_up),
	SETTING("model", "unit", "m, cm, mm, in, or metres in one unit of the scans", set_unit),
	SETTING("model", "colours",
		"scan, procedural, marble, wood, sandstone, laterite, or one colour as #rrggbb",
		set_colours),
	SETTING("model", "cut", "marble, wood, sandstone, laterite or none", set_cut),
	SETTING("model", "lit", "yes or no", set_lit),
	NUMBERS("model", "sun", "three numbers x y z, pointing to the sun", set_sun, sun, -FLT_MAX,
		FLT_MAX),
	SETTING("model", "background", "a colour as #rrggbb", set_background),
	NUMBERS("model", "error_mm", "millimetres above 0, up to 10000", set_error_mm, error_mm,
		1e-6, 10000),
	NUMBERS("view", "start", "eye X Y Z target X Y Z in metres, two different places",
		set_start, start_eye_m, -FLT_MAX, FLT_MAX),
	SETTING("view", "tools", "light, section, measure and walk, or some of them, each once",
		set_tools),
	NUMBERS("grid", "points", NULL, settings_whole, grid_points, 4, 32),
	NUMBERS("grid", "face_px", "128, 256, 512, 1024, 2048 or 4096", set_face_px, face_px, 128,
		4096),
	NUMBERS("grid", "quality", NULL, settings_whole, quality, 1, 100),
	SETTING("grid", "effort", "thorough or quick", set_effort),
	SETTING("samples", "quality", "gain, uniform or features", set_quality_rule),
	SETTING("hierarchy", "kind", "groups or tree", set_kind),
	SETTING("hierarchy", "simplify", "quadric or features", set_simplify),
	SETTING("hierarchy", "surface", "scan or octree", set_surface),
	NUMBERS("hierarchy", "cell_mm", "millimetres from 0.001 to 100000", set_cell_mm, cell_mm,
		0.001, 100000),
	NUMBERS("hierarchy", "patch_triangles", NULL, settings_whole, patch_triangles, 256, 4000),
	NUMBERS("hierarchy", "block_triangles", NULL, settings_whole, block_triangles, 2000,
		16000000),
	NUMBERS("hierarchy", "lattice_mm", "millimetres from 0.05 to 100", set_lattice_mm,
		lattice_mm, 0.05, 100),
	NUMBERS("release", "publish_share", "a share above 0, at most 1", set_publish_share,
		publish_share, 1e-6, 1),
	SETTING("release", "metadata", "both, or tuf: the form of The Update Framework alone",
		set_metadata),
	SETTING("release", "target",
		"a path of up to 96 letters, digits and ._-/, such as angkor/release.json",
		set_target),
	SETTING("release", "role", "a name of up to 64 letters, digits and ._-, such as angkor",
		set_role),
	SETTING("release", "languages", "language tags, separated by spaces: en fr km ja",
		set_languages),
};

const struct setting *content_settings(void)
{
	return settings;
}
