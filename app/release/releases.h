/* Which release is shown: connects the fetcher, the updater, the sessions and the trial. Objects
 * and metadata that arrive go where they belong; what is decided is carried out. One thread. */
#ifndef GOPURA_APP_RELEASE_RELEASES_H
#define GOPURA_APP_RELEASE_RELEASES_H

#include "app/release/sessions.h"
#include "app/release/trial.h"
#include "app/release/updater.h"
#include "app/release/wants.h"
#include "net/client.h"

struct releases_options {
	const char *state_path; /* as for struct updater_options; borrowed for releases_init */
	const char *trust_path; /* likewise */
	const char *target;     /* likewise */
	/* Its trust root and events are set here; strings are borrowed for releases_init. */
	struct net_client_options net;
	/* Its net, updater and wants are set here. */
	struct sessions_options sessions;
	/* Called with sessions.data for each object that arrived, and for each status of the
	 * fetcher; NULL: no one is interested. */
	void (*object_arrived)(void *data);
	void (*status_arrived)(void *data);
};

struct releases {
	struct releases_options options;
	struct net_client *net;
	struct message_status status; /* the fetcher's last */
	struct updater *updater;
	struct wants wants;
	struct sessions sessions;
	struct trial trial;
};

/* Starts the fetcher. Returns 0 or a negative errno; call releases_finish in either case. */
must_check int releases_init(struct releases *releases, const struct releases_options *options);
/* Closes the releases and ends the fetcher; a zeroed struct is fine. */
void releases_finish(struct releases *releases);
/* Begins with the stored release, if there is one. */
void releases_start(struct releases *releases);

/* Called once per turn of the loop: judges a release on trial, and requests a frame when the next
 * one is to be drawn. frame_ms: when the last frame was drawn. is_dark: the panel is off or
 * missing, so that frame is not visible. */
void releases_turn(struct releases *releases, int64_t frame_ms, bool is_dark);
/* Returns in how many milliseconds the next release is to be drawn again; -1: only when something
 * arrives. */
int releases_wait_ms(const struct releases *releases);
/* Returns in how many milliseconds a trial is decided by time alone; -1: never. Arguments as for
 * releases_turn. */
int releases_trial_wait_ms(const struct releases *releases, int64_t frame_ms, bool is_dark);
/* Another release is shown: its trial begins. data is the releases. */
void releases_on_release(void *data, const struct exhibit_change *change);

#endif
