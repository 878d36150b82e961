/* A release on a USB stick. It has the same files as the museum server and is trusted as little:
 * the kiosk checks its metadata, and objects are checked by their hash. A separate thread reads the
 * stick (net/stick_reader.h), one job at a time, so a device that hangs blocks only that thread. A
 * job that takes longer than patience_ms is given up: its requests are answered with -ENOENT, and
 * the stick is not used until the thread has come back and one minute has passed. Make all calls
 * from one thread. None blocks, except stick_destroy, for up to 2 s. */
#ifndef GOPURA_NET_STICK_H
#define GOPURA_NET_STICK_H

#include "format/message.h"

struct stick; /* private to stick.c */

struct stick_options {
	/* copied; mount point of the stick; the release is there or in release/ below it */
	const char *folder;
	uint32_t patience_ms; /* time limit of a job; 0: 10000 */
	/* Metadata of a stick that was plugged in; not checked. Bytes are borrowed for the call. */
	void (*meta)(void *data, enum meta_role role, uint32_t version, struct bytes bytes);
	/* The answer to stick_request; bytes are borrowed. rc 0: the bytes are correct. -ENOENT:
	 * the object is not there. -EBADMSG: it is there, but damaged. Another errno: it could not
	 * be read now. */
	void (*object)(void *data, struct hash hash, int rc, struct bytes bytes);
	/* The answer to stick_ask_file; everything in *file is borrowed for the call. */
	void (*file)(void *data, const struct message_file *file);
	/* Called before an object is read, because the want may have been dropped. */
	bool (*is_wanted)(void *data, struct hash hash);
	void *data;
};

/* *out is owned by the caller; it is NULL on failure. -ENOMEM, or a negative errno if no thread
 * could be started. */
must_check int stick_create(struct stick **out, const struct stick_options *options);
void stick_destroy(struct stick *stick); /* NULL is fine, as for every call here. */

/* Readable when a job has ended; then call stick_clear_event and stick_work. -1 if stick is NULL.
 * Borrowed. */
int stick_fd(const struct stick *stick);
/* Clears the event of stick_fd. */
void stick_clear_event(struct stick *stick);
/* Handles a finished job and starts the next one; looks for a stick every 3 s. A new or changed
 * stick is reported with the meta event. has_room: objects may be read. Returns true if a stick was
 * plugged in, so objects may be available that were not before. */
must_check bool stick_work(struct stick *stick, bool has_room);
/* Returns when stick_work has timed work to do (clock_now_ms); INT64_MAX: never. */
int64_t stick_due_ms(const struct stick *stick, bool has_room);
/* Reports everything again at the next look, because another kiosk asks. */
void stick_forget(struct stick *stick);
/* Sets the version of the kiosk's trust root. Roots after this version are reported; with
 * MESSAGE_TRUST_TUF, tuf/timestamp.json is reported alone. Another version than before forgets too,
 * and what a look that is under way reads is not reported. */
void stick_trust(struct stick *stick, uint32_t root_version);

/* Requests an object, to be found by the locators of these releases (newest first). The releases of
 * the last call apply to all open requests. Returns false if there is no stick; then no answer
 * follows. */
must_check bool stick_request(struct stick *stick, const struct hash *roots, size_t count,
			      const struct message_want *want);
/* Asks for a file of the stick's folder tuf/; *file is copied. A file that was asked for before and
 * is not answered yet is dropped. Without a stick the answer is FILE_NOT_THERE. */
void stick_ask_file(struct stick *stick, const struct message_file *file);

#endif
