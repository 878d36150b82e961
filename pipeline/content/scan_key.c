/* Lists a scan's files, their sizes and times. */
#include "pipeline/content/scan_key.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/transient.h"

/* The file is named relative to the folder, because the folder's own path may change. One that is
 * not there has no size or time; one that cannot be seen now has no key. */
static int put_file(struct buffer *text, const struct content *content, const char *path)
{
	const char *name = path + strlen(content->folder);
	struct stat status;

	buffer_put(text, name, strlen(name) + 1);
	if (stat(path, &status) < 0)
		return is_transient(-errno) ? -errno : 0;
	buffer_put_u64(text, (uint64_t)status.st_size);
	buffer_put_u64(text, (uint64_t)status.st_mtim.tv_sec);
	buffer_put_u64(text, (uint64_t)status.st_mtim.tv_nsec);
	return 0;
}

/* Where scans lie beside temple.ini, these folders beside them belong to pages, scenes and parts: a
 * picture of a page changes no scan. */
static bool is_for_pages(const struct content *content, const char *path)
{
	const char *name = path + strlen(content->folder);

	for (const char *const *folder = content_folders; *folder; folder++)
		if (name[0] == '/' && strcmp(name + 1, *folder) == 0)
			return true;
	return false;
}

/* Selects what the import may read (pipeline/import/import_files.h): nothing hidden. */
static int is_visible(const struct dirent *entry)
{
	return entry->d_name[0] != '.';
}

/* Whether a scan may refer to such a file. */
static bool is_companion(const char *path)
{
	static const char *const extensions[] = { ".mtl", ".jpg", ".jpeg", ".png",
						  ".bin", ".wrl", ".wrz" };
	const char *dot = strrchr(path, '.');

	for (size_t i = 0; dot && i < ARRAY_COUNT(extensions); i++)
		if (strcasecmp(dot, extensions[i]) == 0)
			return true;
	return false;
}

enum { DEPTH_MAX = 16, NAME_ROOM = NAME_MAX + 2 /* and a slash and an end */ };

static int put_folder(struct buffer *text, const struct content *content, char *path, int depth);

/* path has room for NAME_ROOM bytes more than CONTENT_PATH_BYTES. */
static int put_entry(struct buffer *text, const struct content *content, char *path, int depth)
{
	struct stat status;

	if (is_companion(path))
		return put_file(text, content, path);
	if (depth == DEPTH_MAX || strlen(path) >= CONTENT_PATH_BYTES || lstat(path, &status) < 0 ||
	    !S_ISDIR(status.st_mode) || is_for_pages(content, path))
		return 0;
	return put_folder(text, content, path, depth + 1);
}

/* Puts the companions in the folder at path and below. A folder below that cannot be listed is as
 * good as empty, because the import cannot read in it either. */
static int put_folder(struct buffer *text, const struct content *content, char *path, int depth)
{
	const size_t length = strlen(path);
	struct dirent **entries;
	int count, rc = 0;

	count = scandir(path, &entries, is_visible, alphasort);
	if (count < 0)
		return depth == 0 || is_transient(-errno) ? -errno : 0;
	for (int i = 0; i < count; i++) {
		snprintf(path + length, NAME_ROOM, "/%s", entries[i]->d_name);
		if (rc == 0)
			rc = put_entry(text, content, path, depth);
		free(entries[i]);
	}
	path[length] = '\0';
	free(entries);
	return rc;
}

static int put_companions(struct buffer *text, const struct content *content, const char *scan)
{
	char path[CONTENT_PATH_BYTES + NAME_ROOM];

	snprintf(path, CONTENT_PATH_BYTES, "%.*s", (int)(strrchr(scan, '/') - scan), scan);
	return put_folder(text, content, path, 0);
}

static void put_transform(struct buffer *text, const struct transform *transform)
{
	for (int k = 0; k < 12; k++)
		buffer_put_f64(text, transform->rows[k / 4][k % 4]);
}

static bool lie_in_one_folder(const char *a, const char *b)
{
	const size_t length = (size_t)(strrchr(a, '/') - a) + 1;

	return strncmp(a, b, length) == 0 && !strchr(b + length, '/');
}

/* Returns 1 if the files that a scan may name are to be put: they are not where an earlier scan of
 * its folder may name them too. A hundred scans beside thousands of pictures would be a hundred
 * times as many. */
static int is_first_to_name(const struct content *content, uint32_t scan)
{
	int rc = import_names_files(content->scans[scan]);

	for (uint32_t i = 0; i < scan && rc > 0; i++) {
		const int earlier = lie_in_one_folder(content->scans[scan], content->scans[i])
					    ? import_names_files(content->scans[i])
					    : 0;

		rc = earlier < 0 ? earlier : !earlier;
	}
	return rc;
}

int scan_key_put(struct buffer *text, const struct content *content, uint32_t scan)
{
	int rc = put_file(text, content, content->scans[scan]);

	if (rc < 0)
		return rc;
	if (content->transforms[scan])
		put_transform(text, content->transforms[scan]);
	rc = is_first_to_name(content, scan);
	return rc > 0 ? put_companions(text, content, content->scans[scan]) : rc;
}
