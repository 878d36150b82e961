/* Runs a program that signs: what a hardware key, a service or another machine needs is its own
 * affair. */
#ifndef GOPURA_PIPELINE_KEYS_SIGNER_PROGRAM_H
#define GOPURA_PIPELINE_KEYS_SIGNER_PROGRAM_H

#include "base/bytes.h"

/* Runs the program with the message as its standard input, and appends what it writes to its
 * standard output to *out, which has a ceiling. Its one argument is `name`, the file that is
 * signed; its standard error is ours, so that it can ask for a touch or a PIN. After timeout_s
 * seconds it is killed. Returns 0; -EIO: it ended with another status than 0; -ETIMEDOUT; -EFBIG:
 * it writes more than the ceiling; or the errno of starting it. */
must_check int signer_program_run(struct buffer *out, const char *path, const char *name,
				  struct bytes message, int timeout_s);

#endif
