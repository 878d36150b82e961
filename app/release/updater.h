/* Follows the releases of the museum server: remembers which one is shown (state.db), checks the
 * signed metadata, and has the next release brought in the background and remembered before it is
 * shown. One that is new is on trial until follow_prove; where it is not seen to work, the one
 * before it is returned to. No call but follow_create waits for a disk. */
#ifndef GOPURA_APP_RELEASE_UPDATER_H
#define GOPURA_APP_RELEASE_UPDATER_H

#include "base/refusal.h"
#include "net/client.h"

struct follow;

struct follow_options {
	const char *state_path; /* state.db; copied */
	const char *trust_path; /* root/1.json to pin where the state has none; NULL: none */
	/* Bring this release: at the start the remembered one, later each new one, or the one
	 * before. Once it can be shown whole, follow_remember is to be called. */
	void (*begin)(void *data, struct hash root, uint32_t root_bytes);
	/* The release is remembered, durably: show it. rc < 0: it is not; stay with what is shown,
	 * and ask again later. */
	void (*remembered)(void *data, struct hash root, int rc);
	void *data;
};

must_check int follow_create(struct follow **out, const struct follow_options *options);
void follow_destroy(struct follow *follow); /* NULL is fine */

/* Begins: shows the remembered release, if there is one. */
void follow_start(struct follow *follow);
void follow_meta(struct follow *follow, enum meta_role role, uint32_t version, struct bytes bytes,
		 enum meta_source source);
/* Of the trust root in use; 0: none. */
uint32_t follow_root_version(const struct follow *follow);
/* The release that is being brought was offered by a stick. */
bool follow_next_on_stick(const struct follow *follow);
/* The release with this root can be shown whole: has it remembered. `remembered` is called from
 * follow_dispatch when the disk has it, or at once where there is nothing to write. */
void follow_remember(struct follow *follow, struct hash root);
/* Of the release that is remembered last; 0: none yet. */
uint64_t follow_sequence(const struct follow *follow);
/* The release that is remembered was not seen to work yet. */
bool follow_on_trial(const struct follow *follow);
/* There is one that worked before it. */
bool follow_has_before(const struct follow *follow);
/* It works. */
void follow_prove(struct follow *follow);
/* It does not (why: for people): it is refused, and the one before it begun, if there is one. */
void follow_fall_back(struct follow *follow, const char *why);
/* The release that is being brought cannot be shown: refused, and not begun again. */
void follow_refuse(struct follow *follow, struct hash root, const char *why);
/* What was refused last of the releases that were offered. Borrowed; the counter tells of news. */
const struct refusal *follow_refusal(const struct follow *follow);
/* Readable when follow_dispatch has something to do. */
int follow_fd(const struct follow *follow);
must_check int follow_dispatch(struct follow *follow);

#endif
