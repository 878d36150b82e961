/* Importing small scans that stand in a test. */
#ifndef GOPURA_TESTS_PIPELINE_IMPORT_IMPORT_TEXT_H
#define GOPURA_TESTS_PIPELINE_IMPORT_IMPORT_TEXT_H

#include <math.h>

#include "pipeline/import/import.h"
#include "tests/check.h"
#include "tests/pipeline/import/scan_text.h"

/* Imports text as a file of that name; a fault must name the file. */
static inline int import_text(struct mesh *mesh, struct import_report *report, const char *name,
			      const char *text, const struct import_options *options,
			      struct diagnostics *diagnostics)
{
	char path[256];
	int rc;

	*diagnostics = (struct diagnostics){ 0 };
	scan_write(path, name, text, strlen(text));
	rc = import_scan(mesh, path, options, report, diagnostics);
	if (rc < 0 && !strstr(diagnostics->first.text, name))
		fail_msg("the fault does not name %s: '%s'", name, diagnostics->first.text);
	scan_remove(path);
	return rc;
}

static inline bool is_near(const float a[3], float x, float y, float z)
{
	return fabsf(a[0] - x) < 1e-5f && fabsf(a[1] - y) < 1e-5f && fabsf(a[2] - z) < 1e-5f;
}

#endif
