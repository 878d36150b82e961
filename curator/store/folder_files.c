/* Lists documents by name. */
#include "curator/store/folder_files.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/array.h"
#include "base/transient.h"
#include "pipeline/content/content.h"

enum { FILES_MAX = 1 << 20 };

static const char *const roots[] = { "parts.json", "tours.json" };
static const char *const folders[] = { "pages", "pictures", "regions" };

void folder_files_finish(struct folder_files *files)
{
	if (!files)
		return;
	free(files->list);
	*files = (struct folder_files){ 0 };
}

/* Whether bytes_write_file may have left it, or an editor. */
static bool is_temporary(const char *name)
{
	const char *end = strrchr(name, '.');
	size_t n = 0;

	if (name[0] && name[strlen(name) - 1] == '~')
		return true;
	while (end && isalnum((unsigned char)end[1 + n]))
		n++;
	return n == 6 && !end[1 + n];
}

bool document_name_is_valid(const char *name)
{
	const size_t bytes = strlen(name);

	if (bytes >= DOCUMENT_NAME_BYTES || !content_name_is_safe(name))
		return false;
	for (size_t n = 0; n < ARRAY_COUNT(roots); n++)
		if (strcmp(name, roots[n]) == 0)
			return true;
	for (size_t n = 0; n < ARRAY_COUNT(folders); n++) {
		const size_t head = strlen(folders[n]);
		const char *rest = name + head + 1;

		if (bytes > head + 1 && strncmp(name, folders[n], head) == 0 && name[head] == '/')
			return rest[0] != '.' && !strchr(rest, '/') && !is_temporary(rest);
	}
	return false;
}

bool file_mark_read(struct file_mark *out, const char *path)
{
	struct stat status;

	*out = (struct file_mark){ 0 };
	if (lstat(path, &status) < 0 || !S_ISREG(status.st_mode))
		return false;
	*out = (struct file_mark){ .inode = status.st_ino,
				   .size_bytes = (uint64_t)status.st_size,
				   .changed_ns = (int64_t)status.st_ctim.tv_sec * 1000000000 +
						 status.st_ctim.tv_nsec };
	return true;
}

bool file_mark_equals(const struct file_mark *a, const struct file_mark *b)
{
	return a->inode == b->inode && a->size_bytes == b->size_bytes &&
	       a->changed_ns == b->changed_ns;
}

/* Returns where a name is, or belongs. */
static uint32_t place_of(const struct folder_files *files, const char *name)
{
	uint32_t low = 0, high = files->count;

	while (low < high) {
		const uint32_t middle = (low + high) / 2;

		if (strcmp(files->list[middle].name, name) < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

struct folder_file *folder_files_find(const struct folder_files *files, const char *name)
{
	const uint32_t at = place_of(files, name);

	return at < files->count && strcmp(files->list[at].name, name) == 0 ? &files->list[at]
									    : NULL;
}

int folder_files_set(struct folder_files *files, const struct folder_file *file)
{
	const uint32_t at = place_of(files, file->name);
	int rc = 0;

	if (at == files->count || strcmp(files->list[at].name, file->name) != 0) {
		rc = ARRAY_RESERVE(files->list, files->room, files->count + 1, FILES_MAX);
		if (rc < 0)
			return rc;
		memmove(files->list + at + 1, files->list + at,
			(files->count++ - at) * sizeof(*files->list));
	}
	files->list[at] = *file;
	return 0;
}

void folder_files_remove(struct folder_files *files, const char *name)
{
	const struct folder_file *file = folder_files_find(files, name);
	const uint32_t at = file ? (uint32_t)(file - files->list) : files->count;

	if (file)
		memmove(files->list + at, files->list + at + 1,
			(--files->count - at) * sizeof(*files->list));
}

static int add(struct folder_files *files, const char *folder, const char *name)
{
	char path[CONTENT_PATH_BYTES + DOCUMENT_NAME_BYTES];
	struct folder_file file = { 0 };

	if (!document_name_is_valid(name))
		return 0;
	snprintf(path, sizeof(path), "%s/%s", folder, name);
	snprintf(file.name, sizeof(file.name), "%s", name);
	errno = 0;
	if (!file_mark_read(&file.mark, path)) /* one that cannot be seen now is not removed */
		return is_transient(-errno) ? -errno : 0;
	if (file.mark.size_bytes > DOCUMENT_BYTES_MAX)
		return 0;
	return folder_files_set(files, &file);
}

static int add_folder(struct folder_files *files, const char *folder, const char *room)
{
	char path[CONTENT_PATH_BYTES + 16], name[CONTENT_PATH_BYTES];
	const struct dirent *entry;
	DIR *entries;
	int rc = 0;

	snprintf(path, sizeof(path), "%s/%s", folder, room);
	entries = opendir(path);
	if (!entries)
		return errno == ENOENT || errno == ENOTDIR ? 0 : -errno;
	do {
		errno = 0;
		entry = readdir(entries);
		rc = entry ? 0 : -errno;
		if (entry) {
			snprintf(name, sizeof(name), "%s/%s", room, entry->d_name);
			rc = add(files, folder, name);
		}
	} while (rc == 0 && entry);
	closedir(entries);
	return rc;
}

int folder_files_scan(struct folder_files *out, const char *folder)
{
	int rc = 0;

	*out = (struct folder_files){ 0 };
	for (size_t n = 0; rc == 0 && n < ARRAY_COUNT(roots); n++)
		rc = add(out, folder, roots[n]);
	for (size_t n = 0; rc == 0 && n < ARRAY_COUNT(folders); n++)
		rc = add_folder(out, folder, folders[n]);
	return rc;
}
