/* Imports the scans of a content folder into one mesh and caches it. */
#include "pipeline/content/content.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/bytes.h"
#include "pipeline/import/mesh_file.h"

/* IMPORT_VERSION must be raised whenever the import gives another mesh for the same files. */
enum { IMPORT_VERSION = 2, KEY_TEXT_MAX = 1 << 22 };

/* The file is named relative to the folder, because the folder's own path may change. */
static void put_file(struct buffer *text, const struct content *content, const char *path)
{
	const char *name = path + strlen(content->folder);
	struct stat status;

	buffer_put(text, name, strlen(name) + 1);
	if (stat(path, &status) < 0)
		return;
	buffer_put_u64(text, (uint64_t)status.st_size);
	buffer_put_u64(text, (uint64_t)status.st_mtim.tv_sec);
	buffer_put_u64(text, (uint64_t)status.st_mtim.tv_nsec);
}

/* Selects files that a scan may refer to. */
static int is_companion(const struct dirent *entry)
{
	static const char *const extensions[] = { ".mtl", ".jpg", ".jpeg", ".png", ".bin" };
	const char *dot = strrchr(entry->d_name, '.');

	for (size_t i = 0; dot && i < ARRAY_COUNT(extensions); i++)
		if (strcasecmp(dot, extensions[i]) == 0)
			return 1;
	return 0;
}

static int put_companions(struct buffer *text, const struct content *content, const char *scan)
{
	char folder[CONTENT_PATH_BYTES], path[CONTENT_PATH_BYTES + 256];
	const char *slash = strrchr(scan, '/');
	struct dirent **entries;
	int count;

	snprintf(folder, sizeof(folder), "%.*s", (int)(slash - scan), scan);
	count = scandir(folder, &entries, is_companion, alphasort);
	if (count < 0)
		return -errno;
	for (int i = 0; i < count; i++) {
		snprintf(path, sizeof(path), "%s/%s", folder, entries[i]->d_name);
		put_file(text, content, path);
		free(entries[i]);
	}
	free(entries);
	return 0;
}

int content_scans_key(const struct content *content, struct hash *out, struct fault *fault)
{
	const struct import_options *import = &content->import;
	struct buffer text;
	int rc = 0;

	buffer_init(&text, KEY_TEXT_MAX);
	buffer_put_u32(&text, IMPORT_VERSION);
	buffer_put_u32(&text, import->up);
	buffer_put_f64(&text, import->metres_per_unit);
	buffer_put(&text, import->default_colour, sizeof(import->default_colour));
	buffer_put_u8(&text, import->override_colour);
	for (uint32_t i = 0; i < content->scan_count && rc == 0; i++) {
		put_file(&text, content, content->scans[i]);
		rc = put_companions(&text, content, content->scans[i]);
	}
	if (rc == 0)
		rc = text.error;
	if (rc < 0)
		fault_set(fault, rc, "%s: its files cannot be listed: %s", content->folder,
			  strerror(-rc));
	else
		*out = hash_of(buffer_bytes(&text));
	buffer_finish(&text);
	return rc;
}

/* Refuses to join a scan with vertex colours to one with pictures, because faces of the joint mesh
 * take their colours from pictures. */
static int judge_mix(const struct content *content, const struct mesh *mesh,
		     const struct import_report *reports, uint32_t count, struct fault *fault)
{
	if (!mesh->textures)
		return 0;
	for (uint32_t i = 0; i < count; i++)
		if (reports[i].textures == 0 && reports[i].had_colours)
			return fault_set(
				fault, -EINVAL,
				"%s has colours of its own, another scan of the folder has "
				"pictures: bake its colours into a picture too, or set "
				"'colours = #rrggbb'",
				content->scans[i]);
	return 0;
}

static int import_all(struct mesh *out, const struct content *content, struct content_scans *scans,
		      struct fault *fault)
{
	int rc = 0;

	for (uint32_t i = 0; i < content->scan_count && rc == 0; i++) {
		struct mesh mesh;

		rc = import_scan(&mesh, content->scans[i], &content->import, &scans->reports[i],
				 fault);
		if (rc < 0)
			break;
		scans->report_count = i + 1;
		if (i == 0) {
			*out = mesh;
			continue;
		}
		rc = mesh_append(out, &mesh);
		mesh_finish(&mesh);
		if (rc < 0)
			fault_set(fault, rc, "%s: too large together with the scans before it",
				  content->scans[i]);
	}
	if (rc == 0)
		rc = judge_mix(content, out, scans->reports, scans->report_count, fault);
	if (rc < 0)
		mesh_finish(out);
	return rc;
}

int content_import(struct mesh *out, const struct content *content, struct content_scans *scans,
		   struct fault *fault)
{
	struct content_scans *unwanted = scans ? NULL : calloc(1, sizeof(*unwanted));
	char path[CONTENT_PATH_BYTES];
	struct hash key;
	int rc;

	*out = (struct mesh){ 0 };
	if (!scans)
		scans = unwanted;
	if (!scans)
		return -ENOMEM;
	memset(scans, 0, sizeof(*scans));
	rc = content_scans_key(content, &key, fault);
	if (rc == 0)
		rc = content_work_path(content, "mesh", path);
	if (rc < 0)
		fault_set(fault, rc, "%s/.work: %s", content->folder, strerror(-rc));
	if (rc == 0 && mesh_file_load(out, key, path) == 0) {
		scans->from_cache = true;
	} else if (rc == 0) {
		rc = import_all(out, content, scans, fault);
		if (rc == 0)
			rc = mesh_file_save(out, key, path);
		if (rc < 0) {
			mesh_finish(out);
			fault_set(fault, rc, "%s: %s; is the disk full?", path, strerror(-rc));
		}
	}
	free(unwanted);
	return rc;
}
