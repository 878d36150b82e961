/* gopura-kiosk as one struct: the modules it connects and the state it keeps between them. Private
 * to app. One thread; worker threads of the modules answer through descriptors. */
#ifndef GOPURA_APP_KIOSK_H
#define GOPURA_APP_KIOSK_H

#include "app/navigator.h"
#include "app/options.h"
#include "app/release/provision.h"
#include "app/visit/attract_camera.h"
#include "app/visit/information_view.h"
#include "app/visit/presence.h"
#include "app/visit/tour.h"
#include "app/visit/way_back.h"
#include "app/wants.h"
#include "board/profile.h"
#include "input/gesture.h"
#include "input/touch.h"
#include "net/client.h"
#include "render/display/display.h"
#include "render/display/gl.h"
#include "render/display/quads.h"
#include "render/scene/scene.h"
#include "storage/usage.h"
#include "ui/bitmap.h"
#include "ui/overlay.h"

struct capture;
struct metrics_socket;
struct updater;

/* Exit statuses beside success and failure: the program works, but must restart with what it has
 * cached, because another panel was connected (ANEW) or the GPU lost its context (LOST_GPU). The
 * service manager restarts it at once. ANEW is not counted as a crash; LOST_GPU only if it repeats.
 */
enum { KIOSK_STATUS_ANEW = 75, KIOSK_STATUS_LOST_GPU = 76 };

enum {
	SESSION_KEPT_MAX = 4096,
	FRAME_BUDGET_US = 16667, /* duration of a frame at 60 Hz */
};

/* One release as it is shown: its scene and its overlay. */
struct session {
	struct scene *scene;
	struct information_view *view;
	struct hash root;
	uint32_t root_bytes;
	bool root_here;
	bool syncing;                  /* waiting for the fetcher to sync its objects to disk */
	bool synced;                   /* the sync after its first complete picture was requested */
	bool remembering;              /* state_writer is storing it; it is shown after that */
	int64_t shown_ms, pictured_ms; /* when it was put on the panel, and when it was first
					  visible; 0: not yet */
	struct hash kept[SESSION_KEPT_MAX]; /* objects that the fetcher is to keep in its cache */
	uint32_t kept_count;
	bool was_settled; /* its first picture was complete; what arrives after it may be evicted */
	struct scene_frame frame; /* result of the last draw */
};

/* State of the panel: whether it is on, how the picture is shifted, and what the service manager
 * was told. */
struct panel {
	int64_t well_ms;    /* time of the last frame reported to the service manager; 0: none */
	int64_t look_ms;    /* when to check the opening hours next; 0: at once */
	int64_t touched_ms; /* time of the last touch; 0: never */
	bool closed;        /* closed according to the opening hours at the last check */
	bool asleep;
	uint32_t taken;  /* bit mask of contacts whose touch only wakes the panel */
	int shift_px[2]; /* shift of the picture: right and up */
};

/* The page that tells the exhibit engineer what is wrong with gopura.conf. */
struct setup_page {
	struct bitmap bitmap; /* surface NULL: there is nothing to show */
	int64_t since_ms;     /* when it was first drawn; 0: not yet */
	int64_t leaves_ms;    /* when it began to fade out; 0: it stays */
};

/* The visitor's use of the tools that the content offers: a raking light and a section. See
 * docs/tools.md. */
struct tools {
	struct scene_tools now;
	enum overlay_handle held; /* the handle that a finger holds; one at a time */
	uint32_t contact;         /* the contact of that finger */
	float grabbed_at[2];      /* where on the disc the finger came down */
	float grabbed_push_m;
};

struct kiosk {
	struct options options; /* from the command line, completed from gopura.conf */
	struct provision provision;
	struct profile profile;
	struct setup_page setup_page;

	int epoll_fd, signal_fd;
	struct display *display;
	struct session shown;  /* scene and view are NULL before the first release */
	struct session coming; /* the next release, drawn off screen; scene NULL: none */
	int64_t coming_since_ms, coming_drawn_ms;
	bool coming_held;  /* its objects are not requested at this time of day */
	bool coming_waits; /* draw it again after a time, not only when an object arrives */
	struct gl_target warm_target; /* the target it is drawn to */
	struct quads *quads;
	struct touch *touch;
	struct net_client *net;
	struct updater *updater;        /* follows the releases */
	struct metrics_socket *metrics; /* NULL: not requested */
	struct usage *usage;            /* counts what visitors look at */
	struct capture *capture;        /* NULL: normal operation */

	struct wants wants;
	struct navigator navigator;
	bool navigator_ready; /* a release is loaded, so its bounding box is known */
	struct gesture_recogniser gestures;
	bool finger_on_words;     /* the gesture began on the overlay, such as a page or card */
	uint32_t fingers_on_keys; /* bit mask of contacts */
	uint32_t answers;         /* bit mask of contacts that only answered the question */
	struct presence presence;
	enum presence_state presence_said; /* the state logged last */
	int asked_s;              /* the countdown that the overlay shows, in seconds; -1: none */
	struct tour tour;         /* of a visitor, or the looping one while nobody is there */
	struct tools tools;       /* the visitor's tools */
	struct way_back way_back; /* the visitor's steps for the back button */
	struct attract_camera attract;
	int64_t attract_camera_since_ms; /* when the attract camera began, or will begin */

	float px_per_mm;      /* of the panel; estimated if its size is not known */
	struct camera camera; /* camera of the last frame */
	struct message_status status;
	int64_t started_ms, last_frame_ms;
	struct panel panel;
	bool frame_wanted, words_move, eye_moves;
	uint32_t frame_us;              /* CPU time of this thread for the last frame */
	uint64_t frames, late_frames;   /* frames drawn; those with frame_us over FRAME_BUDGET_US */
	uint64_t object_count;          /* objects given to the scene since start */
	bool hidden[OVERLAY_PARTS_MAX]; /* whether each anchor was hidden when last tested */
	uint32_t next_anchor;           /* the anchor tested last */
	uint32_t anchors_to_look;       /* anchors still to test before the picture is final */
	uint32_t looked_triangles;      /* triangles drawn when anchors were last tested */
	bool pictured;                  /* the model was drawn at least once */
	bool memory_given_back;         /* done since the picture last settled */
	struct camera said;             /* the camera that was logged last */
	int64_t said_ms;
	bool quit;
};

/* loop.c */
/* Starts all modules. Returns 0 or a negative errno; kiosk_stop is to be called in either case. */
must_check int kiosk_start(struct kiosk *kiosk);
/* Runs the loop until quit is set. Returns 0, or a negative errno (logged) if it cannot continue;
 * -ENOTRECOVERABLE (the GPU lost its context) and -ESTALE (another panel): a new process can. */
must_check int kiosk_run(struct kiosk *kiosk);
/* Stops and frees all modules in reverse order; any of them may be missing. */
void kiosk_stop(struct kiosk *kiosk);
/* Returns the earlier of two timeouts in milliseconds; -1 means none. */
static inline int sooner(int a_ms, int b_ms)
{
	if (a_ms < 0 || b_ms < 0)
		return a_ms < 0 ? b_ms : a_ms;
	return a_ms < b_ms ? a_ms : b_ms;
}

/* kiosk.c: what every part uses. */
/* Requests a frame, because the picture has changed. */
void kiosk_redraw(struct kiosk *kiosk);
/* Adds fd to the epoll set, until fd is closed. fd -1: does nothing. Returns 0 or a negative errno.
 */
must_check int kiosk_watch(struct kiosk *kiosk, int fd);
/* Size of the picture as the visitor sees it, in pixels: width and height are exchanged if the
 * panel is rotated by 90 or 270 degrees. */
int kiosk_width_px(const struct kiosk *kiosk);
int kiosk_height_px(const struct kiosk *kiosk); /* likewise */
/* Convert a point from the visitor's pixels to the framebuffer's, and back, in place. The two
 * differ if the panel is rotated. */
void viewport_to_panel(const struct kiosk *kiosk, float *x_px, float *y_px);
/* The reverse of viewport_to_panel. */
void viewport_from_panel(const struct kiosk *kiosk, float *x_px, float *y_px);
/* Converts a point on the glass to the point of the picture shown there, both in the visitor's
 * pixels and in place. The picture may be shifted by a few pixels to spare the panel. */
void viewport_unshift(const struct kiosk *kiosk, float *x_px, float *y_px);

/* session.c: the release that is shown, and the next one. */
/* Returns the scene options that a board's profile asks for. */
struct scene_options kiosk_scene_options(const struct profile *profile, enum scene_mode mode);
/* Frees scene and view, and zeroes the session; zeroed is fine. */
void session_close(struct session *session);
/* Gives an object that arrived to the session. Returns true if the fetcher should keep it in its
 * cache: it is an index page, or belongs to the first complete picture. */
bool session_give(struct session *session, struct hash hash, struct bytes object);
/* Begins to load the release; in the background if another one is shown. A release that was loading
 * before is dropped. If the release is already shown, it stays. */
void session_begin(struct kiosk *kiosk, struct hash root, uint32_t root_bytes);
/* Called for each frame: draws the next release off screen, and has it stored once it can be shown
 * completely. */
void session_warm(struct kiosk *kiosk);
/* Handles the answer to net_client_sync. done: the objects survive a power cut; otherwise the disk
 * failed. */
void session_synced(struct kiosk *kiosk, bool done);
/* Called after each frame: asks the fetcher to sync the objects of the first release, once its
 * picture is complete or has had time. */
void session_keep_first(struct kiosk *kiosk);
/* Returns whether objects of the next release may be requested: it is the time of day for it, the
 * release is on a stick, or the clock is not set. */
bool session_may_load(const struct kiosk *kiosk);
/* Called when the release was stored, or could not be (rc < 0). If it is the next one and was
 * stored, it is shown. */
void session_remembered(struct kiosk *kiosk, struct hash root, int rc);
/* Returns in how many milliseconds the next release is to be drawn again; -1: only when something
 * arrives. */
int session_wait_ms(const struct kiosk *kiosk);

/* panel.c */
/* Called once per turn of the loop: opening hours, picture shift, service manager. Returns 0 or a
 * negative errno of display_dispatch, display_sleep or frame_unseen. */
must_check int panel_turn(struct kiosk *kiosk);
/* Returns in how many milliseconds panel_turn has something to do; -1: only after an event. */
int panel_wait_ms(const struct kiosk *kiosk);
/* Handles a touch. Returns true if it wakes the panel, or belongs to a finger that did, and must
 * have no other effect. */
bool panel_takes_touch(struct kiosk *kiosk, const struct touch_event *event);

/* setup_page.c: the page stays for half a minute if a release can be shown then; otherwise until
 * the terminal is restarted. */
/* Draws the page into its bitmap if there is something to say. Call it when the panel's size is
 * known and the stored release has been opened. Returns 0 or a negative errno. */
must_check int setup_page_show(struct kiosk *kiosk);
/* Frees the bitmap; one that was never drawn is fine. */
void setup_page_finish(struct kiosk *kiosk);
/* Draws the page over everything else in the frame, and fades it out when its time has passed.
 * Returns 0 or a negative errno. */
must_check int setup_page_draw(struct kiosk *kiosk, int64_t now_ms);
/* Returns whether the page is shown and not yet fading: touch has no effect then. */
bool setup_page_covers(const struct kiosk *kiosk);
/* Returns in how many milliseconds it changes by itself; -1: not by time. */
int setup_page_wait_ms(const struct kiosk *kiosk);

/* vitals.c: opens the metrics socket, if the options ask for one. Returns 0 or a negative errno
 * (logged). */
must_check int vitals_offer(struct kiosk *kiosk);

/* visitor.c: whether a visitor is there. */
/* Called once per turn of the loop: asks whether the visitor is still there, resets everything
 * after a visit, and starts the tour or the attract camera. */
void visitor_watch(struct kiosk *kiosk);
/* Returns in how many milliseconds visitor_watch has something to do by time alone; -1: never. */
int visitor_wait_ms(const struct kiosk *kiosk);
/* Moves the eye along a tour or the attract camera, if no visitor controls it. Returns true if it
 * keeps moving. */
bool visitor_leads_eye(struct kiosk *kiosk, int64_t now_ms);
/* Records a touch. Returns true if it answers the question whether somebody is there, and must have
 * no other effect. */
bool visitor_takes_touch(struct kiosk *kiosk, const struct touch_event *event);
/* Returns the milliseconds until the visitor counts as gone; 0: nobody is there, or nothing is
 * shown that a visitor could look at. */
int visitor_left_ms(const struct kiosk *kiosk);

/* counting.c */
/* Returns the wall clock in seconds since 1970; 0 if it cannot be trusted. */
int64_t counting_clock_s(void);
/* Counts that a visitor looked at the part; -1: at something that belongs to no part. */
void counting_part(struct kiosk *kiosk, enum usage_kind kind, int part);
/* The same, by the id of a part or tour. */
void counting_id(struct kiosk *kiosk, enum usage_kind kind, const char *id);

/* tour_player.c: guided tours. */
/* Starts a tour for a visitor. which: its index; -1: does nothing. */
void tour_player_start(struct kiosk *kiosk, int which);
/* Halts a visitor's tour; ends the looping tour that runs while nobody is there. */
void tour_player_halt(struct kiosk *kiosk);
/* Continues a halted tour from where it was. */
void tour_player_go_on(struct kiosk *kiosk);
/* Ends the tour, if there is one. */
void tour_player_end(struct kiosk *kiosk);
/* The tour button of the bar: halts or continues a tour, starts it if the release has exactly one,
 * or opens or closes the choice of tours. */
void tour_player_press(struct kiosk *kiosk);
/* Starts the looping tour for the time while nobody is there. Returns false if the release has
 * none. */
bool tour_player_go_round(struct kiosk *kiosk);
/* Moves the eye along the tour, if one is running. Returns true if it keeps moving. */
bool tour_player_leads_eye(struct kiosk *kiosk, int64_t now_ms);
/* Tells the overlay the tour's state: caption, stop, paused. */
void tour_player_say(struct kiosk *kiosk);
/* Returns the part to highlight at the current stop, or -1. */
int tour_player_part(const struct kiosk *kiosk);

/* back.c: the back button of the bar. */
/* Records the current place before a step that leads elsewhere. */
void back_note(struct kiosk *kiosk);
/* Closes an open picture or the choice of tours, otherwise goes back one step. */
void back_press(struct kiosk *kiosk);
/* Forgets all steps: another visitor, or another release. */
void back_forget(struct kiosk *kiosk);
/* Called before each frame: tells the overlay whether the back button has something to undo. */
void back_say(struct kiosk *kiosk);

/* tools.c: the raking light and the section of a visitor. */
void tools_press(struct kiosk *kiosk, unsigned tool); /* switches it on or off; enum overlay_tool */
void tools_end(struct kiosk *kiosk);                  /* switches both off, for the next visitor */
/* Handles a touch on a tool's disc. Returns true if the finger belongs to the tool until it lifts.
 */
bool tools_take_touch(struct kiosk *kiosk, const struct touch_event *event);
/* Called before each frame: tells scene and overlay the tools' state. */
void tools_say(struct kiosk *kiosk);

/* trial.c: whether a new release works. */
/* Called once per turn of the loop: confirms a release on trial once its picture has been on the
 * panel for a while; if it does not work, falls back to the one before it. */
void trial_watch(struct kiosk *kiosk);
/* Returns in how many milliseconds trial_watch has something to do by time alone; -1: never. */
int trial_wait_ms(const struct kiosk *kiosk);
/* Returns whether an object of the session could not be decoded. */
bool trial_is_broken(const struct session *session);

/* frame.c */
/* Draws and presents one frame, and updates the wants. Returns 0; -ENOTRECOVERABLE: the GPU lost
 * its context; or a negative errno of the display. */
must_check int frame_draw(struct kiosk *kiosk);
/* Does what a frame does beside drawing, while no panel shows anything: loads the next release.
 * Returns 0; -ENOTRECOVERABLE: the GPU lost its context. */
must_check int frame_unseen(struct kiosk *kiosk);
/* Fills in *out: the navigator's camera, with size, rotation and shift of the panel. */
void frame_camera(const struct kiosk *kiosk, struct camera *out);

/* fingers.c */
/* Initialises gesture recognition; needs px_per_mm. */
void fingers_init(struct kiosk *kiosk);
/* Callback of the touchscreen: handles a touch in the visitor's pixels. data is the kiosk. */
void fingers_on_touch(void *data, const struct touch_event *event);
/* Callback of the display: handles the pointer of a window, in the panel's pixels. steps > 0 of the
 * wheel zoom in. data is the kiosk. */
void fingers_on_pointer(void *data, enum pointer_kind kind, float x_px, float y_px, float steps);

#endif
