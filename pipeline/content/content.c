/* Reads temple.ini with its table of keys, fills in defaults, and builds paths inside the content
 * folder. */
#include "pipeline/content/content.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/ini.h"
#include "storage/info.h"

/* ---- keys */

static bool set_name(void *target, const char *value)
{
	struct content *content = target;

	return *value && snprintf(content->name, sizeof(content->name), "%s", value) <
				 (int)sizeof(content->name);
}

/* Stores the names only. Paths are built when the whole file has been read. */
static bool set_scans(void *target, const char *value)
{
	struct content *content = target;

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

static bool set_up(void *target, const char *value)
{
	return import_axis_named(value, &((struct content *)target)->import.up);
}

static bool set_unit(void *target, const char *value)
{
	return import_unit_named(value, &((struct content *)target)->import.metres_per_unit);
}

static bool set_colours(void *target, const char *value)
{
	static const char *const names[] = { "scan", "procedural", NULL };
	struct content *content = target;
	int which;

	if (ini_choice(value, names, &which)) {
		content->colours = (enum content_colours)which;
		return true;
	}
	content->colours = CONTENT_COLOURS_ONE;
	content->import.override_colour = true;
	return ini_colour(value, content->import.default_colour);
}

static bool set_lit(void *target, const char *value)
{
	bool yes;

	if (!ini_yes_no(value, &yes))
		return false;
	((struct content *)target)->lit = yes ? CONTENT_LIT_YES : CONTENT_LIT_NO;
	return true;
}

static bool set_sun(void *target, const char *value)
{
	struct content *content = target;
	double v[3], length;
	size_t count;

	if (!ini_numbers(value, v, 3, &count) || count != 3)
		return false;
	length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	if (!(length > 1e-9) || !isfinite(length))
		return false;
	for (int k = 0; k < 3; k++)
		content->sun[k] = (float)(v[k] / length);
	return true;
}

static bool set_background(void *target, const char *value)
{
	return ini_colour(value, ((struct content *)target)->background);
}

/* Reads "eye 1 2 3 target 4 5 6"; the words may be omitted. */
static bool set_start(void *target, const char *value)
{
	struct content *content = target;
	char numbers[256];
	double v[6];
	size_t count, at = 0;

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
	if (!ini_numbers(numbers, v, 6, &count) || count != 6 ||
	    (v[0] == v[3] && v[1] == v[4] && v[2] == v[5]))
		return false;
	for (int k = 0; k < 6; k++)
		if (!(fabs(v[k]) <= FLT_MAX))
			return false;
	for (int k = 0; k < 3; k++) {
		content->start_eye_m[k] = (float)v[k];
		content->start_target_m[k] = (float)v[3 + k];
	}
	content->has_start = true;
	return true;
}

static bool set_tools(void *target, const char *value)
{
	unsigned *tools = &((struct content *)target)->tools;

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

static bool set_whole(const char *value, long least, long most, uint32_t *out)
{
	long number;

	if (!ini_whole(value, least, most, &number))
		return false;
	*out = (uint32_t)number;
	return true;
}

static bool set_points(void *target, const char *value)
{
	return set_whole(value, 4, 32, &((struct content *)target)->grid_points);
}

static bool set_face_px(void *target, const char *value)
{
	uint32_t *px = &((struct content *)target)->face_px;

	return set_whole(value, 128, 4096, px) && (*px & (*px - 1)) == 0;
}

static bool set_quality(void *target, const char *value)
{
	return set_whole(value, 1, 100, &((struct content *)target)->quality);
}

static bool set_kind(void *target, const char *value)
{
	static const char *const names[] = { "groups", "tree", NULL };
	int which;

	if (!ini_choice(value, names, &which))
		return false;
	((struct content *)target)->binary_tree = which == 1;
	return true;
}

static bool set_patch_triangles(void *target, const char *value)
{
	return set_whole(value, 256, 4000, &((struct content *)target)->patch_triangles);
}

static bool set_publish_share(void *target, const char *value)
{
	return ini_number(value, 1e-6, 1, &((struct content *)target)->publish_share);
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

static bool set_languages(void *target, const char *value)
{
	struct content *content = target;

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

static const struct ini_key keys[] = {
	{ "model", "name", "the model's name, under 128 bytes", set_name },
	{ "model", "scans",
	  "up to 64 file names, separated by spaces, relative to this folder and inside it",
	  set_scans },
	{ "model", "up", "z, y or x: the axis that points up in the scans", set_up },
	{ "model", "unit", "m, cm, mm, in, or metres in one unit of the scans", set_unit },
	{ "model", "colours", "scan, procedural, or one colour as #rrggbb", set_colours },
	{ "model", "lit", "yes or no", set_lit },
	{ "model", "sun", "three numbers x y z, pointing to the sun", set_sun },
	{ "model", "background", "a colour as #rrggbb", set_background },
	{ "view", "start", "eye X Y Z target X Y Z in metres, two different places", set_start },
	{ "view", "tools", "light, section, both, each once, or nothing", set_tools },
	{ "grid", "points", "a whole number from 4 to 32", set_points },
	{ "grid", "face_px", "128, 256, 512, 1024, 2048 or 4096", set_face_px },
	{ "grid", "quality", "a whole number from 1 to 100", set_quality },
	{ "hierarchy", "kind", "groups or tree", set_kind },
	{ "hierarchy", "patch_triangles", "a whole number from 256 to 4000", set_patch_triangles },
	{ "release", "publish_share", "a share above 0, at most 1", set_publish_share },
	{ "release", "languages", "language tags, separated by spaces: en fr km ja",
	  set_languages },
};

/* ---- the whole */

static void set_defaults(struct content *content, const char *folder)
{
	const char *slash;
	size_t length;

	*content = (struct content){
		.import.metres_per_unit = 1,
		.sun = { 0.45f, -0.55f, 0.7036f },
		.background = { 0x2b, 0x33, 0x3d },
		.grid_points = 8,
		.face_px = 512,
		.quality = 80,
		.patch_triangles = 0,
		.publish_share = 0.10,
		.language_count = 1,
		.languages = { "en" },
	};
	snprintf(content->folder, sizeof(content->folder), "%s", folder);
	for (length = strlen(content->folder); length > 1 && content->folder[length - 1] == '/';)
		content->folder[--length] = '\0';
	slash = strrchr(content->folder, '/');
	snprintf(content->name, sizeof(content->name), "%.100s",
		 slash && slash[1] ? slash + 1 : content->folder);
}

static int complete_scan(struct content *content, uint32_t i, const char *ini, struct fault *fault)
{
	char path[CONTENT_PATH_BYTES];
	struct stat status;
	int rc = content_file_path(content, content->scans[i], path);
	char *owned;

	if (rc < 0)
		return fault_set(fault, rc, "%s: scans: %s: %s", ini, content->scans[i],
				 strerror(-rc));
	if (stat(path, &status) < 0)
		return fault_set(fault, -errno,
				 "%s: scans: %s: %s; put it into %s, or correct its name", ini,
				 content->scans[i], strerror(errno), content->folder);
	if (!S_ISREG(status.st_mode))
		return fault_set(fault, -EINVAL, "%s: scans: %s is not a regular file", ini,
				 content->scans[i]);
	owned = strdup(path);
	if (!owned)
		return -ENOMEM;
	free(content->scans[i]);
	content->scans[i] = owned;
	return 0;
}

int content_read(struct content *out, const char *folder, struct fault *fault)
{
	char ini[CONTENT_PATH_BYTES + 16];
	int rc;

	*out = (struct content){ 0 };
	if (strlen(folder) == 0 || strlen(folder) > CONTENT_PATH_BYTES / 2)
		return fault_set(fault, -EINVAL, "'%.100s': give a content folder", folder);
	set_defaults(out, folder);
	snprintf(ini, sizeof(ini), "%s/temple.ini", out->folder);
	rc = ini_read(ini, keys, ARRAY_COUNT(keys), out, fault);
	if (rc == 0 && out->scan_count == 0)
		rc = fault_set(fault, -EBADMSG,
			       "%s: it names no scan; add 'scans = FILE' to its [model] section",
			       ini);
	for (uint32_t i = 0; rc == 0 && i < out->scan_count; i++)
		rc = complete_scan(out, i, ini, fault);
	if (rc < 0)
		content_release(out);
	return rc;
}

void content_release(struct content *content)
{
	if (!content)
		return;
	for (uint32_t i = 0; i < content->scan_count; i++)
		free(content->scans[i]);
	*content = (struct content){ 0 };
}

bool content_is_lit(const struct content *content, bool has_textures)
{
	if (content->lit == CONTENT_LIT_AUTO)
		return !has_textures;
	return content->lit == CONTENT_LIT_YES;
}

/* ---- paths */

bool content_name_is_safe(const char *name)
{
	if (name[0] == '\0' || name[0] == '/')
		return false;
	for (const char *c = name; *c; c++)
		if ((unsigned char)*c < 0x20 || *c == 0x7f || *c == '\\')
			return false;
	for (const char *c = name; *c;) {
		size_t length = strcspn(c, "/");

		if (length == 0 || (c[0] == '.' && (length == 1 || (length == 2 && c[1] == '.'))))
			return false;
		c += length;
		if (*c == '/' && *++c == '\0')
			return false;
	}
	return true;
}

static int join(const struct content *content, const char *between, const char *name,
		char out[CONTENT_PATH_BYTES])
{
	if (!content_name_is_safe(name))
		return -EINVAL;
	return snprintf(out, CONTENT_PATH_BYTES, "%s/%s%s", content->folder, between, name) <
			       CONTENT_PATH_BYTES
		       ? 0
		       : -ENAMETOOLONG;
}

int content_file_path(const struct content *content, const char *name, char out[CONTENT_PATH_BYTES])
{
	return join(content, "", name, out);
}

int content_work_path(const struct content *content, const char *name, char out[CONTENT_PATH_BYTES])
{
	int rc = join(content, "", ".work", out);

	if (rc == 0 && mkdir(out, 0777) < 0 && errno != EEXIST)
		return -errno;
	return rc < 0 ? rc : join(content, ".work/", name, out);
}
