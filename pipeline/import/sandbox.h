/* Runs work in a restricted child process, so that a foreign parser that crashes, hangs, uses up
 * the memory or is taken over by a malicious file leads to an error message.
 *
 * The child can compute, use the memory and processor time it is given, and read what its parent
 * opens for it. It cannot open, create or change a file, start a program or process, or reach the
 * network or another process: pipeline/import/lockdown.h. */
#ifndef GOPURA_PIPELINE_IMPORT_SANDBOX_H
#define GOPURA_PIPELINE_IMPORT_SANDBOX_H

#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"
#include "base/diagnostics.h"

struct sandbox_limits {
	uint32_t timeout_s; /* of wall-clock time and of processor time */
	/* of the address space; of resident memory in a build with AddressSanitizer, which reserves
	 * terabytes of address space */
	uint64_t memory_bytes;
};

struct sandbox_options {
	struct sandbox_limits limits;
	int result_fd; /* stays open in the child, for its result; 0: none */
	/* Called in the parent when the child calls sandbox_open. Returns a descriptor, which is
	 * taken, or a negative errno. It must check the name, because the child may be under
	 * foreign control. It may raise *limits, because the child now has more to read. NULL:
	 * nothing can be opened. */
	int (*open)(void *data, const char *name, struct sandbox_limits *limits);
	void *open_data;
};

/* Returns a limit for memory_bytes: what this process has mapped, with which the child begins, and
 * so many bytes more. */
uint64_t sandbox_memory_bytes(uint64_t more_bytes);

/* The work of the child. Of the parent's descriptors it has only result_fd and the standard ones,
 * which lead to /dev/null (standard error stays open in a build with AddressSanitizer). Its memory
 * is a copy: changes are lost except in `shared`. Returns 0, or a negative errno with a diagnostic.
 */
typedef int (*sandbox_work)(void *shared, struct diagnostics *diagnostics);

/* In the child: opens a file through options.open in the parent. Returns a descriptor owned by the
 * caller, or a negative errno. */
must_check int sandbox_open(const char *name);

/* Runs work in a child and returns its result. -ETIMEDOUT: it took too long. -ENOMEM: it used too
 * much memory. -EBADMSG: it crashed. diagnostics then says "NAME: ...". `shared` comes from
 * shared_memory_create; do not trust what the child left in it, not even that a string has an end.
 */
must_check int sandbox_run(sandbox_work work, void *shared, const struct sandbox_options *options,
			   const char *name, struct diagnostics *diagnostics);

#endif
