/* Follows the releases of the museum server: remembers which one is shown (state.db), checks the
 * signed metadata, and has the next release brought in the background and remembered before it is
 * shown. One that is new is on trial until updater_prove; where it is not seen to work, the one
 * before it is returned to. No call but updater_create waits for a disk. */
#ifndef GOPURA_APP_RELEASE_UPDATER_H
#define GOPURA_APP_RELEASE_UPDATER_H

#include "base/refusal.h"
#include "net/client.h"

struct updater;

struct updater_options {
	const char *state_path; /* state.db; copied */
	const char *trust_path; /* root/1.json to pin where the state has none; NULL: none */
	/* Bring this release: at the start the remembered one, later each new one, or the one
	 * before. Once it can be shown whole, updater_remember is to be called. */
	void (*begin)(void *data, struct hash root, uint32_t root_bytes);
	/* The release is remembered, durably: show it. rc < 0: it is not; stay with what is shown,
	 * and ask again later. */
	void (*remembered)(void *data, struct hash root, int rc);
	void *data;
};

must_check int updater_create(struct updater **out, const struct updater_options *options);
void updater_destroy(struct updater *updater); /* NULL is fine */

/* Begins: shows the remembered release, if there is one. */
void updater_start(struct updater *updater);
void updater_meta(struct updater *updater, enum meta_role role, uint32_t version,
		  struct bytes bytes, enum meta_source source);
/* Of the trust root in use; 0: none. */
uint32_t updater_root_version(const struct updater *updater);
/* The release that is being brought was offered by a stick. */
bool updater_next_on_stick(const struct updater *updater);
/* The release with this root can be shown whole: has it remembered. `remembered` is called from
 * updater_dispatch when the disk has it, or at once where there is nothing to write. */
void updater_remember(struct updater *updater, struct hash root);
/* Of the release that is remembered last; 0: none yet. */
uint64_t updater_sequence(const struct updater *updater);
/* The release that is remembered was not seen to work yet. */
bool updater_on_trial(const struct updater *updater);
/* There is one that worked before it. */
bool updater_has_before(const struct updater *updater);
/* It works. */
void updater_prove(struct updater *updater);
/* It does not (why: for people): it is refused, and the one before it begun, if there is one. */
void updater_fall_back(struct updater *updater, const char *why);
/* The release that is being brought cannot be shown: refused, and not begun again. */
void updater_refuse(struct updater *updater, struct hash root, const char *why);
/* What was refused last of the releases that were offered. Borrowed; the counter tells of news. */
const struct refusal *updater_refusal(const struct updater *updater);
/* Readable when updater_dispatch has something to do. */
int updater_fd(const struct updater *updater);
must_check int updater_dispatch(struct updater *updater);

#endif
