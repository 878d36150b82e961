/* How much memory and how many threads an import may use, and what it says if it lacks some.
 * Private to pipeline/import/import*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_LIMITS_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_LIMITS_H

#include <errno.h>
#include <string.h>

#include "base/bytes.h"
#include "base/parallel.h"
#include "base/spill.h"
#include "pipeline/import/import.h"

/* Of memory, for each byte of a scan and of the files that it names. */
enum { IMPORT_BYTES_PER_BYTE = 64 };

/* Returns how much memory decoding may use. Unless the options set it, it grows with the files,
 * because small ones should not need much. */
static inline uint64_t import_memory_bytes(const struct import_options *options,
					   uint64_t file_bytes)
{
	return options->memory_bytes ? options->memory_bytes
				     : (1ull << 30) + IMPORT_BYTES_PER_BYTE * file_bytes;
}

/* Returns how much more the pictures of a scan may take for each byte of their files. */
static inline uint32_t import_bytes_per_byte(const struct import_options *options)
{
	return options->memory_bytes ? 0 : IMPORT_BYTES_PER_BYTE;
}

static inline uint32_t import_jobs(const struct import_options *options)
{
	return options->jobs ? options->jobs : parallel_cores();
}

/* Returns what a failure that is no fault of the scan lacks, as a sentence. */
static inline const char *import_lack(int rc)
{
	if (rc == -ENOMEM)
		return "too large for this machine's memory";
	if (rc == -ENOSPC)
		return "the disk has no room for the imported mesh; make some, or set TMPDIR to a "
		       "larger disk";
	return spill_folder_cure(rc) ? spill_folder_cure(rc) : strerror(-rc);
}

#endif
