/* How far a long piece of work is: on a terminal a bar with rate and time left, elsewhere a log
 * line now and then. Work that ends within two seconds shows nothing. */
#ifndef GOPURA_BASE_PROGRESS_H
#define GOPURA_BASE_PROGRESS_H

#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"

struct progress;

/* what: "sampling"; unit: "faces". Both are copied. total 0: not known. Standard error. Running
 * out of memory gives NULL, which every function below takes for "show nothing". */
struct progress *progress_start(const char *what, const char *unit, uint64_t total);
/* Any thread. */
void progress_add(struct progress *progress, uint64_t done);
void progress_set_total(struct progress *progress, uint64_t total);
/* Says how much was done in what time, if anything was shown; frees. */
void progress_end(struct progress *progress);

/* The line as it would be shown, without colours or carriage return; for tests and other outputs.
 * columns: room for it. */
void progress_line(const struct progress *progress, char *out, size_t out_bytes, int columns,
		   int64_t elapsed_ms);

#endif
