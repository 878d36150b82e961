/* Work in a child process behind walls, so that a foreign parser that crashes, hangs, eats the
 * memory or is taken over by a file becomes an error message.
 *
 * The child can compute, use the memory and the processor time it was given, and read what its
 * parent opens for it. It can open, make or change no file, start no program or process, reach no
 * network and no other process: pipeline/import/lockdown.h. */
#ifndef GOPURA_PIPELINE_IMPORT_SANDBOX_H
#define GOPURA_PIPELINE_IMPORT_SANDBOX_H

#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"
#include "base/fault.h"

struct sandbox_options {
	uint32_t timeout_s;    /* wall clock and processor time */
	uint64_t memory_bytes; /* address space; resident memory in a build with AddressSanitizer,
				* which reserves terabytes of address space */
	int result_fd;         /* stays open in the child, for its result; 0: none */
	/* Runs in the parent when the child calls sandbox_open. Gives a descriptor, which is taken,
	 * or a negative errno. It must judge the name: the child may be in foreign hands. NULL:
	 * nothing can be opened. */
	int (*open)(void *data, const char *name);
	void *open_data;
};

/* What the child does. Of the descriptors of the parent it has result_fd and standard output and
 * error, which lead nowhere; of memory it gets a copy, and what it changes there is lost but in
 * shared. Gives 0, or a negative errno and a fault. */
typedef int (*sandbox_work)(void *shared, struct fault *fault);

/* In the child: a file of that name, as options.open of the parent gives it. Owned by the caller.
 * Negative errno. */
must_check int sandbox_open(const char *name);

/* For what the child gives back; zeroed. Believe nothing of it: not even that a string ends. NULL:
 * no memory. */
void *sandbox_shared_create(size_t size);
void sandbox_shared_destroy(void *shared, size_t size); /* NULL is fine */

/* Gives work's result. -ETIMEDOUT, -ENOMEM, -EBADMSG (it crashed): fault is "NAME: ..." then. */
must_check int sandbox_run(sandbox_work work, void *shared, const struct sandbox_options *options,
			   const char *name, struct fault *fault);

#endif
