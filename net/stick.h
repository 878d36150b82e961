/* A release on a USB stick that somebody plugs in: the same files as on the museum server, and as
 * little trusted. Its metadata goes to the kiosk, which checks it; objects are checked by whoever
 * asks for them. Files are read at once, as the cache's are: a call may wait for the stick. Only
 * plain files are opened, and never through a link. One thread. */
#ifndef GOPURA_NET_STICK_H
#define GOPURA_NET_STICK_H

#include "format/message.h"

struct stick; /* private to stick.c */

struct stick_options {
	const char *folder; /* copied; where the stick is mounted: the release, or release/ in it */
	void (*meta)(void *data, enum meta_role role, uint32_t version, struct bytes bytes);
	void *data;
};

/* *out is owned by the caller. -ENOMEM. */
must_check int stick_create(struct stick **out, const struct stick_options *options);
void stick_destroy(struct stick *stick); /* NULL is fine, as for each call */

/* Looks now and then: what came, or is another one, is told by meta. true: objects may be had that
 * could not be had before. */
must_check bool stick_work(struct stick *stick);
int64_t stick_due_ms(const struct stick *stick); /* of stick_work; INT64_MAX: never */
/* At the next stick_work all is told again: another kiosk asks. */
void stick_forget(struct stick *stick);

/* The version of the trust root that the kiosk has: roots are told from the one after it on. */
void stick_trust(struct stick *stick, uint32_t root_version);

/* The bytes of a want, where the stick's locator of this release says; unchecked. -ENOENT: not
 * there. */
must_check int stick_get(struct stick *stick, struct hash root, const struct message_want *want,
			 struct buffer *out);

#endif
