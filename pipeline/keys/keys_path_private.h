/* Paths in a folder of keys, and what is said of them. Private to pipeline/keys. */
#ifndef GOPURA_PIPELINE_KEYS_KEYS_PATH_PRIVATE_H
#define GOPURA_PIPELINE_KEYS_KEYS_PATH_PRIVATE_H

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

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

#endif
