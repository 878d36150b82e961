/* What reading and signing of metadata share. Private to format/metadata*.c. */
#ifndef GOPURA_FORMAT_METADATA_PARTS_H
#define GOPURA_FORMAT_METADATA_PARTS_H

#include "format/metadata.h"

/* "format" in every payload: raised when an old reader could misunderstand a new file. */
#define PAYLOAD_FORMAT 1

/* Indexed by enum meta_role; as payloads and signed messages say them. */
extern const char *const metadata_role_names[];

/* What a role's signatures are over. out is initialised here, and finished by the caller also on
 * failure. */
must_check int metadata_message(struct buffer *out, enum meta_role role, struct bytes payload);

#endif
