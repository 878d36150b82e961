/* Figures that a program tells of itself, as lines of Prometheus's text format 0.0.4: what one
 * program writes another reads, and gopura-health passes it on as it is. docs/health.md lists the
 * figures.
 *
 * Writing never fails at once: out keeps the failure (base/bytes.h). */
#ifndef GOPURA_BASE_METRICS_H
#define GOPURA_BASE_METRICS_H

#include "base/bytes.h"

enum {
	METRICS_BYTES_MAX = 16 * 1024, /* of one program */
	METRICS_NAME_MAX = 128,        /* bytes, the end included */
};

struct figure_label {
	const char *name, *value; /* any text; what is no UTF-8 or a control becomes "?" */
};

/* ---- writing: HELP, TYPE and one sample. name and help are literals. */

void metrics_gauge(struct buffer *out, const char *name, const char *help, double value);
void metrics_counter(struct buffer *out, const char *name, const char *help, double value);
/* What is no number: labels, and the value 1. */
void metrics_info(struct buffer *out, const char *name, const char *help,
		  const struct figure_label *labels, size_t count);

/* ---- reading */

/* The whole text is lines of the format, at least one, each of them about a name that begins with
 * prefix. Nothing else of a program that was captured may be passed on. */
bool metrics_valid(struct bytes text, const char *prefix);
/* The first sample of that name; false: there is none, *out stays. Text that is not valid is fine.
 */
bool metrics_find(struct bytes text, const char *name, double *out);
/* A label of that sample, cut where it does not fit; false: there is none, and out is "". */
bool metrics_label(struct bytes text, const char *name, const char *label, char *out,
		   size_t out_bytes);

#endif
