/* Lists a scan's files, their sizes and times. */
#include "pipeline/content/scan_key.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

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
	static const char *const extensions[] = { ".mtl", ".jpg", ".jpeg", ".png",
						  ".bin", ".wrl", ".wrz" };
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

static void put_transform(struct buffer *text, const struct transform *transform)
{
	for (int k = 0; k < 12; k++)
		buffer_put_f64(text, transform->rows[k / 4][k % 4]);
}

int scan_key_put(struct buffer *text, const struct content *content, uint32_t scan)
{
	put_file(text, content, content->scans[scan]);
	if (content->transforms[scan])
		put_transform(text, content->transforms[scan]);
	return put_companions(text, content, content->scans[scan]);
}
