/* What a release folder holds of The Update Framework, for the publisher: the files that a terminal
 * would read, checked against the newest root: that of the keys' folder, or of the release folder
 * if keys were exchanged elsewhere. Expiry is not judged: what has expired is what a publisher
 * signs anew. */
#ifndef GOPURA_PIPELINE_RELEASE_TUF_FOLDER_H
#define GOPURA_PIPELINE_RELEASE_TUF_FOLDER_H

#include "pipeline/keys/keys.h"
#include "tuf/tuf_metadata.h"

enum { TUF_FOLDER_FILE_BYTES_MAX = 64 << 10 /* what terminals take */ };

/* Where a content folder's release is published; strings are borrowed. */
struct tuf_place {
	const char *release;     /* the release folder */
	const char *keys_folder; /* has tuf/1.root.json and those after it */
	const char *target;      /* path among the targets; "": release.json */
	const char *role; /* to which the top's targets delegate the path; "": the top itself */
};

struct tuf_folder {
	struct tuf_place place;
	struct tuf_file root;
	bool is_ahead; /* root is of the release folder, the keys' folder has not got it yet */
	/* Empty where there is none yet. own: the role's file, empty for the top itself, which is
	 * targets.json. */
	struct tuf_file timestamp, snapshot, top, own;
	/* Timestamp, snapshot and top may be signed by keys that the root does not name any more.
	 * is_signed: by its keys; was_signed: by those of an earlier root. The top is one of both.
	 */
	bool snapshot_is_signed, snapshot_was_signed, top_is_signed;
	/* The versions that were published last, also of files that the root's keys have not
	 * signed; 0: none. */
	uint32_t top_version, own_version;
};

/* Reads it. Nothing may be there but a root in the keys' folder. Returns 0; -ENOENT: no root;
 * -EKEYREJECTED: the root's keys have not signed what must be carried on; -EBADMSG: a file is
 * damaged, or missing though another names it. Errors are logged. tuf_folder_finish frees it, also
 * after a failure. */
must_check int tuf_folder_open(struct tuf_folder *out, const struct tuf_place *place);
void tuf_folder_finish(struct tuf_folder *folder);

/* The path of the target, never empty. */
const char *tuf_folder_target(const struct tuf_place *place);
/* The file that names the release: the role's, or that of the top. Its content may be empty. */
const struct tuf_file *tuf_folder_naming(const struct tuf_folder *folder);
uint32_t tuf_folder_naming_version(const struct tuf_folder *folder);
/* Name of that file without its version, "targets" or the role's. */
const char *tuf_folder_naming_name(const struct tuf_folder *folder);
/* Which keys may sign it, as tuf_file_verify takes them. */
void tuf_folder_naming_keys(const struct tuf_folder *folder, const struct cJSON **keys,
			    const struct cJSON **role);

/* What targets.json delegates, as the specification says; NULL: nothing. */
const struct cJSON *tuf_folder_delegations(const struct tuf_folder *folder);
/* The role of that name among delegations, or NULL. */
struct cJSON *tuf_folder_role_in(const struct cJSON *delegations, const char *name);
/* Returns whether terminals that look for the target come to the role. */
bool tuf_folder_role_has_path(const struct cJSON *role, const char *target);
/* Parses the last file of a role, whoever signed it. *out stays empty where it has published none.
 * *version is what the snapshot says, 0: none. Errors are logged. */
must_check int tuf_folder_read_role(const struct tuf_folder *folder, const char *name,
				    struct tuf_file *out, uint32_t *version);

/* Returns when the timestamp was signed. 0: there is none, it does not say, or the root's keys have
 * not signed it. */
int64_t tuf_folder_issued_s(const struct tuf_folder *folder);

/* What becomes of other releases and roles must not be decided by a key that was exchanged. Returns
 * whether targets.json is signed by such a key, and has more than one release. */
bool tuf_folder_needs_renewal(const struct tuf_folder *folder);

/* Reads the release that is published now into *out and its release.json into *file, cleared first.
 * -ENOENT: none is; or one that is signed by keys that were exchanged, which *out is then. Other
 * errors are logged. */
must_check int tuf_folder_current(const struct tuf_folder *folder, struct release *out,
				  struct buffer *file);
/* The same for an earlier version of the file that names the release. -ENOENT: there is none, or
 * that version was made for something else and has the release of an earlier one. */
must_check int tuf_folder_at(const struct tuf_folder *folder, uint64_t version, struct release *out,
			     struct buffer *file);

#endif
