/* Shows the progress of long work: on a terminal a bar with rate and time left, otherwise a log
 * line every 15 seconds. Work that ends within two seconds shows nothing. Output goes to standard
 * error. */
#ifndef GOPURA_BASE_PROGRESS_H
#define GOPURA_BASE_PROGRESS_H

#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"

struct progress;

/* Starts a progress display. what: such as "sampling"; unit: such as "faces"; both are copied.
 * total 0: not known. The result is owned by the caller, who ends it with progress_end; NULL if
 * there is no memory, which every function below accepts and shows nothing. */
struct progress *progress_start(const char *what, const char *unit, uint64_t total);
/* Adds to what is done, and prints when it is time. Any thread. */
void progress_add(struct progress *progress, uint64_t done);
/* Changes the total. Any thread. */
void progress_set_total(struct progress *progress, uint64_t total);
/* Logs how much was done in what time, if progress was shown before; frees. NULL is fine. */
void progress_end(struct progress *progress);

/* Writes the line as it would be shown, without carriage return, for tests and other outputs.
 * columns: its width; elapsed_ms: since the start. progress must not be NULL. */
void progress_line(const struct progress *progress, char *out, size_t out_bytes, int columns,
		   int64_t elapsed_ms);

#endif
