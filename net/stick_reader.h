/* What is read of a stick, for net/stick.c. Every call may wait for the device, for good where it
 * hangs, so they are for a thread of their own. A stick may hold anything: only regular files are
 * opened, and none through a link, whatever component of its path it is. */
#ifndef GOPURA_NET_STICK_READER_H
#define GOPURA_NET_STICK_READER_H

#include "format/locator.h"
#include "format/message.h"

enum {
	STICK_ROOTS_MAX = 16, /* in one look */
	STICK_FILES_MAX = STICK_ROOTS_MAX + 2,
};

struct stick_release {
	struct hash root; /* zero: none */
	struct locator locator;
	bool readable; /* else there is none, or it is damaged */
};

struct stick_reader {
	const char *folder;  /* owned */
	const char *below;   /* in it lies the release: "" or "release/" */
	struct buffer stamp; /* timestamp.json as it was told; empty: no stick */
	struct buffer file;  /* read last */
	struct stick_release releases[MESSAGE_RELEASES_MAX];
	size_t next_release; /* to be overwritten */
	struct hash pack;    /* that is open */
	int pack_fd;         /* -1: none */
};

enum stick_news { STICK_AS_BEFORE, STICK_GONE, STICK_CAME };

struct stick_file {
	enum meta_role role;
	uint32_t version; /* of META_ROOT */
	struct buffer bytes;
};

/* -ENOMEM. */
must_check int stick_reader_init(struct stick_reader *reader, const char *folder);
void stick_reader_finish(struct stick_reader *reader); /* zeroed is fine */

/* From now on all is news. */
void stick_reader_forget(struct stick_reader *reader);
/* STICK_CAME: files has what is to be told, in this order, owned by the caller; the roots are those
 * after root_version. */
enum stick_news stick_reader_look(struct stick_reader *reader, uint32_t root_version,
				  struct stick_file files[STICK_FILES_MAX], size_t *count);

/* The bytes of a want, where the locator of one of these releases says. -ENOENT: not there.
 * -EBADMSG: there, but they are not of its hash. */
must_check int stick_reader_get(struct stick_reader *reader, const struct hash *roots, size_t count,
				const struct message_want *want, struct buffer *out);

#endif
