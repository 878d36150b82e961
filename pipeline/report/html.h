/* Writes pieces of HTML: escaped text, numbers for people, files as data URIs. Failures are those
 * of the stream, to be checked at its end. */
#ifndef GOPURA_PIPELINE_REPORT_HTML_H
#define GOPURA_PIPELINE_REPORT_HTML_H

#include <stdio.h>

#include "base/bytes.h"

/* Writes text with what HTML reserves escaped, also inside an attribute. */
void html_text(FILE *to, const char *text);
/* Writes 1234567 as 1 234 567, with narrow spaces that do not break. */
void html_count(FILE *to, uint64_t count);
/* Writes bytes as kB, MB or GB. */
void html_bytes(FILE *to, uint64_t bytes);
/* Writes a length in metres as m, cm, mm or thousandths of one. */
void html_length(FILE *to, double metres);
/* Writes milliseconds as s, min or h. */
void html_time(FILE *to, int64_t ms);
/* Writes a data URI; type: such as "image/jpeg". */
void html_data(FILE *to, const char *type, struct bytes file);
/* Writes a cell of a table with a bar of that share (0..1) behind its text, which the caller
 * writes next; html_bar_end closes it. */
void html_bar(FILE *to, double share);
void html_bar_end(FILE *to);

#endif
