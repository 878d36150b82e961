/* Lines of a Stanford registration file (.conf): "bmesh NAME tx ty tz qx qy qz qw". Private to
 * pipeline/import/alignment*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_ALIGNMENT_CONF_H
#define GOPURA_PIPELINE_IMPORT_ALIGNMENT_CONF_H

#include <stdbool.h>

struct alignment_conf_line {
	char name[512];
	bool is_optional; /* "mesh" instead of "bmesh": Stanford's tools skip it if it is missing */
	double matrix[16]; /* rows; turns the scan, then moves it */
};

/* Parses one line, without white space around it. Returns 1 and fills *out if it places a scan; 0
 * for lines of other words (camera and the like) and empty ones; -EBADMSG if it should place a scan
 * but lacks a number, or its quaternion has no length. */
int alignment_conf_parse(struct alignment_conf_line *out, const char *line);

#endif
