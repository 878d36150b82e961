/* Lists a scan's files, their sizes and times. */
#include "pipeline/content/scan_key.h"

#include <dirent.h>
#include <errno.h>
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
	int count, rc = 0;

	snprintf(folder, sizeof(folder), "%.*s", (int)(slash - scan), scan);
	count = scandir(folder, &entries, is_companion, alphasort);
	if (count < 0)
		return -errno;
	for (int i = 0; i < count; i++) {
		snprintf(path, sizeof(path), "%s/%s", folder, entries[i]->d_name);
		if (rc == 0)
			rc = put_file(text, content, path);
		free(entries[i]);
	}
	free(entries);
	return rc;
}

static void put_transform(struct buffer *text, const struct transform *transform)
{
	for (int k = 0; k < 12; k++)
		buffer_put_f64(text, transform->rows[k / 4][k % 4]);
}

int scan_key_put(struct buffer *text, const struct content *content, uint32_t scan)
{
	const int rc = put_file(text, content, content->scans[scan]);

	if (rc < 0)
		return rc;
	if (content->transforms[scan])
		put_transform(text, content->transforms[scan]);
	return put_companions(text, content, content->scans[scan]);
}
