/* Reads from a mounted stick, for net/stick.c. Every call may block on the device (forever, if it
 * hangs), so calls belong on a separate thread. A stick may contain anything: only regular files
 * are opened, and never through a link in any component of the path. */
#ifndef GOPURA_NET_STICK_READER_H
#define GOPURA_NET_STICK_READER_H

#include "format/locator.h"
#include "format/message.h"

enum {
	STICK_ROOTS_MAX = 16, /* per look */
	STICK_FILES_MAX = STICK_ROOTS_MAX + 2,
};

struct stick_release {
	struct hash root; /* zero: unused */
	struct locator locator;
	bool readable; /* false: the locator is missing or damaged */
};

struct stick_reader {
	const char *folder;   /* owned */
	const char *below;    /* subfolder of the release: "" or "release/" */
	struct buffer stamp;  /* the timestamp as last reported; empty: no stick */
	bool reports_again;   /* at the next look */
	uint32_t looks_again; /* how often that was for a transient failure */
	struct buffer file;   /* the file that was read last */
	struct stick_release releases[MESSAGE_RELEASES_MAX];
	size_t next_release; /* slot to be overwritten next */
	struct hash pack;    /* the pack that is open */
	int pack_fd;         /* -1: none */
};

/* Result of stick_reader_look: nothing changed, no stick, or a new or changed stick. */
enum stick_change { STICK_UNCHANGED, STICK_REMOVED, STICK_INSERTED };

struct stick_file {
	enum meta_role role;
	uint32_t version; /* only for META_ROOT */
	struct buffer bytes;
};

/* folder is copied. -ENOMEM; even then the reader must be finished. */
must_check int stick_reader_init(struct stick_reader *reader, const char *folder);
void stick_reader_finish(struct stick_reader *reader); /* A zeroed struct is fine. */

/* Makes the next look report everything again. */
void stick_reader_forget(struct stick_reader *reader);
/* Looks for a stick. On STICK_INSERTED, files[0 .. *count) holds what to report, in this order; the
 * caller owns their buffers. After a failure that may pass, the next look reports everything again.
 * Roots are those after root_version; with MESSAGE_TRUST_TUF there is tuf/timestamp.json alone. */
enum stick_change stick_reader_look(struct stick_reader *reader, uint32_t root_version,
				    struct stick_file files[STICK_FILES_MAX], size_t *count);

/* Reads a file of the release's folder tuf/ into out, whose ceiling is its size at most. */
enum file_answer stick_reader_file(struct stick_reader *reader, const char *name,
				   struct buffer *out);

/* Reads a wanted object into *out, at the place given by the locator of one of these releases
 * (tried in order). -ENOENT: it is not there. -EBADMSG: it is there, but the bytes do not match the
 * hash. -EIO, -ENOMEM and others: it could not be read now. */
must_check int stick_reader_get(struct stick_reader *reader, const struct hash *roots, size_t count,
				const struct message_want *want, struct buffer *out);

#endif
