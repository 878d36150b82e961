/* The release that is shown, and the next one while it loads. The next release is drawn small and
 * off screen, with the visitor's camera, until nothing is missing; then it is stored, and it
 * replaces the other between two frames. One thread. */
#ifndef GOPURA_APP_RELEASE_SESSIONS_H
#define GOPURA_APP_RELEASE_SESSIONS_H

#include "app/release/updater.h"
#include "app/release/wants.h"
#include "app/view/eye.h"
#include "app/view/redraw.h"
#include "base/daily.h"
#include "render/display/gl.h"

enum { SESSION_KEPT_MAX = 4096 };

struct session {
	struct exhibit exhibit; /* scene NULL: there is none */
	bool root_here;
	bool syncing;       /* waiting for the fetcher to sync its objects to disk */
	bool synced;        /* the sync after its first complete picture was requested */
	bool remembering;   /* state_writer is storing it; it is shown after that */
	bool lacks_objects; /* the disk refused some; it is loaded again before it is shown */
	bool was_settled; /* its first picture was complete; what arrives after it may be evicted */
	struct hash kept[SESSION_KEPT_MAX]; /* objects that the fetcher is to keep in its cache */
	uint32_t kept_count;
};

struct sessions_options {
	struct scene_options scene;
	struct information_view_options view; /* its language is borrowed */
	struct daily download;                /* time of day for loading a new release */
	/* What they work with; borrowed. */
	struct net_client *net;
	struct updater *updater;
	struct wants *wants;
	struct eye *eye;
	struct redraw *redraw;
	/* Returns the milliseconds until no visitor is looking; a new release waits for that. */
	int (*visitor_left_ms)(void *data);
	/* Another release is shown, or none because it cannot be opened. */
	void (*changed)(void *data, const struct exhibit_change *change);
	void *data;
};

struct sessions {
	struct sessions_options options;
	struct session shown;
	struct session coming; /* the next release, drawn off screen */
	int64_t coming_since_ms, coming_drawn_ms;
	bool coming_held;  /* its objects are not requested at this time of day */
	bool coming_waits; /* draw it again after a time, not only when an object arrives */
	/* A release that could not be opened, and when that is tried again; 0: none. */
	struct hash again_root;
	uint32_t again_bytes;
	int64_t again_ms;
	/* When the release that is shown is stored again, because the disk failed; 0: it is not. */
	int64_t store_again_ms;
	int64_t loaded_again_ms; /* when the next one was, because the disk failed; 0: it was not */
	struct gl_target warm_target; /* the target it is drawn to */
	int epoll_fd;                 /* holds the descriptors of the scenes; 0: not created */
};

/* Copies the options. Returns 0 or a negative errno; call sessions_finish in either case. */
must_check int sessions_init(struct sessions *sessions, const struct sessions_options *options);
/* Closes both releases. A zeroed struct is fine. */
void sessions_finish(struct sessions *sessions);

/* Begins to load the release; in the background if another one is shown. A release that was loading
 * before is dropped. If the release is already shown, it stays. What cannot be opened, for want of
 * memory, is tried again every second. */
void sessions_begin(struct sessions *sessions, struct hash root, uint32_t root_bytes);
/* Gives an object that arrived to both releases. The fetcher is to keep it in its cache if it is an
 * index page, or belongs to a first complete picture. */
void sessions_give(struct sessions *sessions, struct hash hash, struct bytes object);
/* Called for each frame: draws the next release off screen, and has it stored once it can be shown
 * completely. */
void sessions_warm(struct sessions *sessions);
/* Called after each frame: asks the fetcher to sync the objects of the first release, once its
 * picture is complete or has had time since pictured_ms, when it was first visible; 0: not yet. */
void sessions_keep_first(struct sessions *sessions, int64_t pictured_ms);
/* Called after each frame: tells the fetcher what is wanted. */
void sessions_ask(struct sessions *sessions);
/* Handles the answer to net_client_sync. done: the objects survive a power cut; otherwise the disk
 * failed, and it is tried again, until the disk takes them; then what it refused is loaded again.
 */
void sessions_synced(struct sessions *sessions, bool done);
/* Called when the release was stored, or could not be (rc < 0): then it is tried again. If it is
 * the next one and was stored, it is shown. */
void sessions_remembered(struct sessions *sessions, struct hash root, int rc);
/* Returns in how many milliseconds sessions_warm has something to do; -1: only when something
 * arrives. */
int sessions_wait_ms(const struct sessions *sessions);

/* Returns a descriptor, borrowed, that is readable when a scene has decoded something. */
int sessions_fd(const struct sessions *sessions);
/* Tells the scenes, and requests a frame. Returns 0 or a negative errno. */
must_check int sessions_dispatch(struct sessions *sessions);

#endif
