/* Reads temple.ini, fills in defaults, and builds paths inside the
 * content folder. */
#include "pipeline/content/content.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/log.h"
#include "pipeline/content/content_settings.h"
#include "pipeline/import/alignment.h"
#include "storage/info_tools.h"

const char *const content_folders[] = { "pages", "pictures", "regions", "scenes", NULL };

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

static int check_name(const struct content *content, const char *name,
		      char path[CONTENT_PATH_BYTES], struct diagnostics *diagnostics)
{
	struct stat status;
	int rc = content_file_path(content, name, path);

	if (rc < 0)
		return diagnostics_add(diagnostics, rc, NULL, 0, "scans: %s: %s", name,
				       strerror(-rc));
	if (stat(path, &status) < 0)
		return diagnostics_add(diagnostics, -errno, NULL, 0,
				       "scans: %s: %s; put it into %s, or correct its name", name,
				       strerror(errno), content->folder);
	if (!S_ISREG(status.st_mode))
		return diagnostics_add(diagnostics, -EINVAL, NULL, 0,
				       "scans: %s is not a regular file", name);
	return 0;
}

/* Adds a scan. path is copied; transform is copied, or NULL. */
static int add_scan(struct content *content, const char *path, const struct transform *transform,
		    struct diagnostics *diagnostics)
{
	const uint32_t i = content->scan_count;

	if (i == CONTENT_SCANS_MAX)
		return diagnostics_add(diagnostics, -EFBIG, NULL, 0,
				       "over %d scans with those that alignments name; join some",
				       CONTENT_SCANS_MAX);
	content->scans[i] = strdup(path);
	content->transforms[i] = transform ? malloc(sizeof(*transform)) : NULL;
	content->scan_count++;
	if (!content->scans[i] || (transform && !content->transforms[i]))
		return -ENOMEM;
	if (transform)
		*content->transforms[i] = *transform;
	return 0;
}

/* Adds the scans that an alignment names. */
static int add_alignment(struct content *content, const char *path, struct diagnostics *diagnostics)
{
	struct alignment alignment;
	int rc = alignment_read(&alignment, path, diagnostics);

	for (uint32_t i = 0; i < alignment.left_out.count; i++)
		log_warn("pipeline", "%s", diagnostics_get(&alignment.left_out, i)->text);
	if (rc == 0 && alignment.y_is_up && content->import.up != IMPORT_Y_UP)
		rc = diagnostics_add(diagnostics, -EINVAL, NULL, 0,
				     "scans: in %s, a manifest, y is up: write 'up = y' into "
				     "[model]",
				     path);
	for (uint32_t i = 0; rc == 0 && i < alignment.count; i++)
		rc = add_scan(content, alignment.scans[i].path, &alignment.scans[i].transform,
			      diagnostics);
	alignment_finish(&alignment);
	return rc;
}

/* Replaces the names by paths of scans. */
static int complete(struct content *content, struct diagnostics *diagnostics)
{
	char *names[CONTENT_SCANS_MAX], path[CONTENT_PATH_BYTES];
	const uint32_t count = content->scan_count;
	int rc = 0;

	if (count == 0)
		return diagnostics_add(
			diagnostics, -EBADMSG, NULL, 0,
			"it names no scan; add 'scans = FILE' to its [model] section");
	if (content->tools & INFO_TOOL_MEASURE && content->error_mm <= 0)
		return diagnostics_add(diagnostics, -EBADMSG, NULL, 0,
				       "who measures must be told how exact the scan is: add "
				       "'error_mm = MILLIMETRES' to its [model] section, as the "
				       "scan's report says, or take 'measure' out of tools");
	memcpy(names, content->scans, sizeof(names));
	memset(content->scans, 0, sizeof(content->scans));
	content->scan_count = 0;
	for (uint32_t i = 0; i < count; i++) {
		int failed = check_name(content, names[i], path, diagnostics);

		if (failed == 0)
			failed = alignment_is_named(path)
					 ? add_alignment(content, path, diagnostics)
					 : add_scan(content, path, NULL, diagnostics);
		rc = rc == 0 || failed == -ENOMEM ? failed : rc;
		free(names[i]);
	}
	return rc;
}

int content_read(struct content *out, const char *folder, struct diagnostics *diagnostics)
{
	char ini[CONTENT_PATH_BYTES + 16];
	struct stat status;
	int rc;

	*out = (struct content){ 0 };
	if (strlen(folder) == 0 || strlen(folder) > CONTENT_PATH_BYTES / 2)
		return diagnostics_add(diagnostics, -EINVAL, NULL, 0,
				       "'%.100s' is no content folder; give one", folder);
	set_defaults(out, folder);
	snprintf(ini, sizeof(ini), "%s/temple.ini", out->folder);
	if (stat(ini, &status) == 0) {
		out->settings_bytes = (uint64_t)status.st_size;
		out->settings_time = status.st_mtim;
	}
	rc = settings_read_file(ini, content_settings(), CONTENT_SETTINGS, out, diagnostics);
	if (rc == 0)
		rc = complete(out, diagnostics);
	if (rc < 0)
		content_release(out);
	return rc;
}

void content_release(struct content *content)
{
	if (!content)
		return;
	for (uint32_t i = 0; i < content->scan_count; i++) {
		free(content->scans[i]);
		free(content->transforms[i]);
	}
	*content = (struct content){ 0 };
}

bool content_is_lit(const struct content *content, bool has_pictures)
{
	if (content->lit == CONTENT_LIT_AUTO)
		return !has_pictures || content->colours != CONTENT_COLOURS_SCAN;
	return content->lit == CONTENT_LIT_YES;
}

/* ---- paths */

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
