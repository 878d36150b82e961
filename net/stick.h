/* A release on a USB stick that somebody plugs in: the same files as on the museum server, and as
 * little trusted. Its metadata goes to the kiosk, which checks it; objects are checked by their
 * hash. A thread of its own reads the stick (net/stick_reader.h), one job at a time: a device that
 * hangs holds up that thread alone. A job that takes longer than patience_ms is given up: what was
 * asked for is answered as not there, and the stick is left alone until the thread comes back and a
 * minute has passed. All calls from one thread; none waits, but stick_destroy for a moment. */
#ifndef GOPURA_NET_STICK_H
#define GOPURA_NET_STICK_H

#include "format/message.h"

struct stick; /* private to stick.c */

struct stick_options {
	const char *folder; /* copied; where the stick is mounted: the release, or release/ in it */
	uint32_t patience_ms; /* 0: 10000 */
	void (*meta)(void *data, enum meta_role role, uint32_t version, struct bytes bytes);
	/* The answer to stick_ask. rc 0: these are its bytes, of the right hash. -ENOENT: not
	 * there. -EBADMSG: there, but damaged. */
	void (*object)(void *data, struct hash hash, int rc, struct bytes bytes);
	/* Asked before an object is read: who wanted it may have gone. */
	bool (*is_wanted)(void *data, struct hash hash);
	void *data;
};

/* *out is owned by the caller. -ENOMEM, or that there is no thread to be had. */
must_check int stick_create(struct stick **out, const struct stick_options *options);
void stick_destroy(struct stick *stick); /* NULL is fine, as for each call */

/* Readable when a job has ended: stick_heard, then stick_work. -1 of NULL. */
int stick_fd(const struct stick *stick);
void stick_heard(struct stick *stick);
/* Looks now and then: what came, or is another one, is told by meta. Passes on what was read, and
 * begins the next job; has_room: objects may be among it. true: objects may be had that could not
 * be had before. */
must_check bool stick_work(struct stick *stick, bool has_room);
/* When stick_work has something to do by time alone; INT64_MAX: never. */
int64_t stick_due_ms(const struct stick *stick, bool has_room);
/* At the next stick_work all is told again: another kiosk asks. */
void stick_forget(struct stick *stick);
/* The version of the trust root that the kiosk has: roots are told from the one after it on. */
void stick_trust(struct stick *stick, uint32_t root_version);

/* Has the object looked for by the locators of these releases, newest first; those of the last call
 * hold for all. false: there is no stick, and no answer comes. */
must_check bool stick_ask(struct stick *stick, const struct hash *roots, size_t count,
			  const struct message_want *want);

#endif
