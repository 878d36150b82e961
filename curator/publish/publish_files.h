/* What the web process and the publisher tell each other, as files in DIR/.curator/publish:
 *
 *   request.json   by the web process: what to publish; a number that grows
 *   state.json     by the publisher: the last request that it took, and what became of it
 *   releases.json  by the publisher: all releases, the newest first
 *   log            by the publisher: what gopura-content printed for that request
 *   renewal.log    by the publisher: what it printed when it signed anew last
 *   lock           held by the publisher while it runs
 *
 * Each but the logs is replaced whole, so a kill at any moment leaves the old one or the new one.
 */
#ifndef GOPURA_CURATOR_PUBLISH_PUBLISH_FILES_H
#define GOPURA_CURATOR_PUBLISH_PUBLISH_FILES_H

#include <limits.h>
#include <stdbool.h>

#include "base/bytes.h"
#include "base/diagnostics.h"
#include "curator/accounts/role.h"

enum {
	PUBLISH_COMMENT_BYTES = 200, /* with its end; a release has room for 255 */
	PUBLISH_MESSAGE_BYTES = 512,
	PUBLISH_RELEASES_MAX = 1000, /* in the list; the newest */
	PUBLISH_FILE_BYTES_MAX = 1 << 20,
	PUBLISH_LOG_BYTES_MAX = 64 << 10, /* of the log's end, for the page */
};

struct publish_request {
	uint64_t number;   /* 0: there is none */
	uint64_t sequence; /* the release to go back to; 0: the content as it is */
	int64_t at_s;      /* when it was made */
	char by[ACCOUNT_NAME_BYTES];
	char comment[PUBLISH_COMMENT_BYTES]; /* UTF-8, one line */
};

enum publish_step { PUBLISH_IDLE, PUBLISH_RUNNING, PUBLISH_DONE, PUBLISH_FAILED };

struct publish_state {
	struct publish_request request; /* the last one that was taken */
	enum publish_step step;
	int64_t begun_s, ended_s;
	uint64_t before, after; /* the current release when it began and when it ended; 0: none */
	char message[PUBLISH_MESSAGE_BYTES]; /* why it failed */
};

struct publish_release {
	uint64_t sequence;
	char root[33];               /* of its root page, in hexadecimal */
	char comment[256];           /* of the release */
	char by[ACCOUNT_NAME_BYTES]; /* "": not known, as of one made on the command line */
	int64_t at_s;                /* 0: not known */
};

struct publish_releases {
	struct publish_release *list; /* owned; the newest first */
	uint32_t count, room;
};

/* Makes DIR/.curator/publish if it is missing. */
must_check int publish_files_make(const char *folder, struct diagnostics *diagnostics);
/* Builds the path of a file there. -ENAMETOOLONG. */
must_check int publish_file_path(char path[PATH_MAX], const char *folder, const char *name);

/* Read the files. No file: zeroed, and 0. -EBADMSG: it is not such a file. Errors of reading. */
must_check int publish_request_read(struct publish_request *out, const char *folder);
must_check int publish_state_read(struct publish_state *out, const char *folder);
/* *out is for publish_releases_finish. */
must_check int publish_releases_read(struct publish_releases *out, const char *folder);
void publish_releases_finish(struct publish_releases *releases); /* zeroed is fine */

/* Replace them. Errors of the disk. */
must_check int publish_request_write(const struct publish_request *request, const char *folder);
must_check int publish_state_write(const struct publish_state *state, const char *folder);
must_check int publish_releases_write(const struct publish_releases *releases, const char *folder);

/* Removes what a process that was killed left half written of a file. Only for the one that writes
 * it. */
void publish_drop_leftovers(const char *folder, const char *name);

/* The parsers alone: the publisher trusts nothing that the web process wrote. -EBADMSG, -ENOMEM. */
must_check int publish_request_parse(struct publish_request *out, struct bytes text);
must_check int publish_state_parse(struct publish_state *out, struct bytes text);
must_check int publish_releases_parse(struct publish_releases *out, struct bytes text);

/* Returns whether a comment is UTF-8 of one line that fits. */
bool publish_comment_is_valid(const char *comment);
/* Returns whether a request waits, or is being worked on. */
bool publish_is_pending(const struct publish_request *request, const struct publish_state *state);
/* Returns "idle", "running", "done" or "failed". */
const char *publish_step_name(enum publish_step step);

/* Takes the publisher's lock. Returns a descriptor, owned by the caller, whose closing gives it
 * back; -EBUSY: another one has it. */
must_check int publish_lock(const char *folder);
/* Returns whether a publisher runs. */
bool publish_has_publisher(const char *folder);

#endif
