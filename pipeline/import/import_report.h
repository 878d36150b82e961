/* Prints the report of an import. */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_REPORT_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_REPORT_H

#include "pipeline/import/import.h"

/* Prints a summary for people: what was read, and one line for each kind of repair. */
void import_report_print(FILE *to, const char *path, const struct import_report *report);

#endif
