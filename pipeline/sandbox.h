/* Work in a child process with limits, so that a foreign parser that crashes, hangs or eats the
 * memory becomes an error message. */
#ifndef GOPURA_PIPELINE_SANDBOX_H
#define GOPURA_PIPELINE_SANDBOX_H

#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"
#include "base/fault.h"

struct sandbox_options {
	uint32_t timeout_s;    /* wall clock and processor time */
	uint64_t memory_bytes; /* address space; resident memory in a build with AddressSanitizer,
				* which reserves terabytes of address space */
};

/* What the child does. Descriptors that are open in the parent are open in it; of memory it gets a
 * copy, and what it changes there is lost but in shared. Gives 0, or a negative errno and a fault.
 */
typedef int (*sandbox_work)(void *shared, struct fault *fault);

/* For what the child gives back; zeroed. NULL: no memory. */
void *sandbox_shared_create(size_t size);
void sandbox_shared_destroy(void *shared, size_t size); /* NULL is fine */

/* Gives work's result. -ETIMEDOUT, -ENOMEM, -EBADMSG (it crashed): fault is "NAME: ..." then. */
must_check int sandbox_run(sandbox_work work, void *shared, const struct sandbox_options *options,
			   const char *name, struct fault *fault);

#endif
