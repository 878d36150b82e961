/* Names of files in a content folder. */
#ifndef GOPURA_PIPELINE_CONTENT_CONTENT_NAME_H
#define GOPURA_PIPELINE_CONTENT_CONTENT_NAME_H

#include <stdbool.h>

/* Returns whether a name is relative, stays below the folder (no "..", absolute path or empty part)
 * and has no control characters or backslashes. Every file name in a content folder's files must
 * satisfy this. */
bool content_name_is_safe(const char *name);

#endif
