/* What reading and signing of metadata share. Private to format/metadata*.c. */
#ifndef GOPURA_FORMAT_METADATA_PARTS_H
#define GOPURA_FORMAT_METADATA_PARTS_H

#include "format/metadata.h"

/* The member "format" of every payload. Raise it when an old reader could misunderstand a new
 * file. */
#define PAYLOAD_FORMAT 1

/* The names in payloads and signed messages, indexed by enum meta_role. */
extern const char *const metadata_role_names[];

/* Makes the message that a role's signatures cover. Initialises out; the caller finishes it, also
 * on failure. Returns -ENOMEM or -EFBIG. */
must_check int metadata_message(struct buffer *out, enum meta_role role, struct bytes payload);

#endif
