/* The metrics of a program, as lines of Prometheus's text format 0.0.4. One program writes them,
 * another reads them, and gopura-health passes them on unchanged. docs/health.md lists the metrics.
 * A write failure is kept in the buffer (base/bytes.h), to be checked at the end. */
#ifndef GOPURA_BASE_METRICS_H
#define GOPURA_BASE_METRICS_H

#include "base/bytes.h"

enum {
	METRICS_BYTES_MAX = 16 * 1024, /* of one program's text */
	METRICS_NAME_MAX = 128,        /* bytes, with the terminator */
};

struct figure_label {
	const char *name, *value; /* any text; invalid UTF-8 and control characters become "?" */
};

/* ---- writing: each appends HELP, TYPE and one sample; name and help are literals */

/* Appends a value that may rise and fall. */
void metrics_gauge(struct buffer *out, const char *name, const char *help, double value);
/* Appends a value that only rises. */
void metrics_counter(struct buffer *out, const char *name, const char *help, double value);
/* Appends text as `count` labels; the value of the sample is 1. */
void metrics_info(struct buffer *out, const char *name, const char *help,
		  const struct figure_label *labels, size_t count);

/* ---- reading */

/* Returns whether the whole text is lines of the format, with at least one sample, and every name
 * begins with prefix. So nothing else that a compromised program sends is passed on. */
bool metrics_valid(struct bytes text, const char *prefix);
/* Finds the first sample of that name and writes its value to *out. Returns false if there is none;
 * *out is then unchanged. Invalid lines are skipped. */
bool metrics_find(struct bytes text, const char *name, double *out);
/* Writes a label of that sample to out, cut if it does not fit. Returns false if there is none; out
 * is then "". */
bool metrics_label(struct bytes text, const char *name, const char *label, char *out,
		   size_t out_bytes);

#endif
