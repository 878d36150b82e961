/* The settings of temple.ini. Private to the reader of a content folder. */
#ifndef GOPURA_PIPELINE_CONTENT_CONTENT_SETTINGS_H
#define GOPURA_PIPELINE_CONTENT_CONTENT_SETTINGS_H

#include "pipeline/content/content.h"

enum { CONTENT_SETTINGS = 29 };

/* Returns the CONTENT_SETTINGS settings, whose target is a struct content. Its names of scans are
 * those in the file, not yet paths. */
const struct setting *content_settings(void);

#endif
