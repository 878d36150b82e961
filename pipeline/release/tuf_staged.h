/* One metadata file of The Update Framework on its way to a release folder: its content, and the
 * signatures that it has so far. */
#ifndef GOPURA_PIPELINE_RELEASE_TUF_STAGED_H
#define GOPURA_PIPELINE_RELEASE_TUF_STAGED_H

#include "pipeline/keys/signing.h"
#include "pipeline/release/tuf_folder.h"

struct tuf_staged {
	char name[128]; /* of the file, without its folder; "": nothing is staged */
	enum tuf_type type;
	const struct cJSON *keys, *role; /* who may sign it; borrowed from a tuf_folder */
	struct buffer message;           /* the content in its canonical form */
	struct cJSON *signatures;        /* owned */
	struct buffer file;              /* all of it; see tuf_staged_write */
};

/* Takes a content, also on failure; NULL: there was no memory for it. name carries its version.
 * version and role as tuf_folder says. tuf_staged_finish frees *out, also after a failure. */
must_check int tuf_staged_init(struct tuf_staged *out, const struct tuf_folder *folder,
			       enum tuf_type type, uint32_t version, struct cJSON *content);
/* Reads a staged file and the signatures in NAME.*.sig beside it, each a signature's bytes. Returns
 * -ENOENT: there is none; other errors are logged. */
must_check int tuf_staged_read(struct tuf_staged *out, const struct tuf_folder *folder,
			       const char *staged_folder, enum tuf_type type, uint32_t version);
/* Finds whose targets are staged in a folder, by the name of VERSION.ROLE.json; "" for those of the
 * top, or none. -EINVAL: of several; errors are logged. */
must_check int tuf_staged_role(char *out, size_t out_bytes, const char *staged_folder);
void tuf_staged_finish(struct tuf_staged *staged); /* Zeroed is fine. */

/* Has the signers of the keys' folder sign it. Errors are logged. */
must_check int tuf_staged_sign(struct tuf_staged *staged, const struct signing *signing);
/* Makes staged->file of what there is. */
must_check int tuf_staged_write(struct tuf_staged *staged);
/* Returns whether staged->file has enough signatures. */
bool tuf_staged_is_signed(const struct tuf_staged *staged);
/* Returns 0 if staged->file has enough signatures; else -EKEYREJECTED, logged. */
must_check int tuf_staged_check(const struct tuf_staged *staged);
/* Writes staged->file and its bytes to be signed into a folder, which is made. Errors are logged.
 */
must_check int tuf_staged_keep(const struct tuf_staged *staged, const char *staged_folder);

#endif
