/* What the import reported of each scan, in a file: DIR/.work/imported. */
#ifndef GOPURA_PIPELINE_CONTENT_SCAN_REPORTS_H
#define GOPURA_PIPELINE_CONTENT_SCAN_REPORTS_H

#include "pipeline/content/content.h"

/* Writes the file whole. key: of the scans. Returns a negative errno. */
must_check int scan_reports_save(const char *path, struct hash key, struct import_report *reports,
				 uint32_t count);
/* reports has room for CONTENT_SCANS_MAX. Returns how many there are; -ENOENT: there is no file, it
 * is damaged or has another key; -ENOMEM and errors of the disk. */
must_check int scan_reports_load(struct import_report *reports, const char *path, struct hash key);

#endif
