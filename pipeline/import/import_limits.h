/* How much memory and how many threads an import may use. Private to pipeline/import/import*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_LIMITS_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_LIMITS_H

#include "base/bytes.h"
#include "base/parallel.h"
#include "pipeline/import/import.h"

/* Returns how much memory decoding may use. Unless the options set it, it grows with the file,
 * because a small file should not need much. */
static inline uint64_t import_memory_bytes(const struct import_options *options,
					   uint64_t file_bytes)
{
	return options->memory_bytes ? options->memory_bytes : (1ull << 30) + 64 * file_bytes;
}

static inline uint32_t import_jobs(const struct import_options *options)
{
	return options->jobs ? options->jobs : parallel_cores();
}

#endif
