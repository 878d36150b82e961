/* Paths in a folder of keys, and what is said of them. Private to pipeline/keys. */
#ifndef GOPURA_PIPELINE_KEYS_KEYS_PATH_PRIVATE_H
#define GOPURA_PIPELINE_KEYS_KEYS_PATH_PRIVATE_H

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/log.h"

/* Logs an error of a file, why or else that of rc, and returns rc. */
static inline int keys_complain(const char *folder, const char *name, int rc, const char *why)
{
	log_error("pipeline", "%s/%s: %s", folder, name, why ? why : strerror(-rc));
	return rc;
}

/* Sets path to FOLDER/NAME. -ENAMETOOLONG, which is logged. */
static inline int keys_join(char path[PATH_MAX], const char *folder, const char *name)
{
	return snprintf(path, PATH_MAX, "%s/%s", folder, name) < PATH_MAX
		       ? 0
		       : keys_complain(folder, name, -ENAMETOOLONG, NULL);
}

/* Returns 1 if FOLDER/NAME is there, 0 if not, or a negative errno, logged: what cannot be seen is
 * not missing. */
static inline int keys_has(const char *folder, const char *name)
{
	char path[PATH_MAX];
	struct stat status;
	const int rc = keys_join(path, folder, name);

	if (rc < 0)
		return rc;
	if (lstat(path, &status) == 0)
		return 1;
	return errno == ENOENT || errno == ENOTDIR ? 0 : keys_complain(folder, name, -errno, NULL);
}

#endif
