/* gopura-kiosk as one struct: the modules it wires, and what it decides between them. Private to
 * app. One thread; the modules' workers answer through descriptors. */
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

/* Of the program, beside success and failure: it is well, but must begin anew, from what it has
 * cached, for another panel or since the GPU lost its context. The service manager is to start it
 * at once; the former is no crash, the latter none unless it comes again and again. */
enum { KIOSK_STATUS_ANEW = 75, KIOSK_STATUS_LOST_GPU = 76 };

enum {
	SESSION_KEPT_MAX = 4096,
	FRAME_BUDGET_US = 16667, /* what a panel of 60 Hz leaves */
};

/* One release as it is shown: its pictures and its words. */
struct session {
	struct scene *scene;
	struct information_view *view;
	struct hash root;
	uint32_t root_bytes;
	bool root_here;
	bool syncing;                  /* its objects are being written durably */
	bool synced;                   /* that was asked for, for its first whole picture */
	bool remembering;              /* it is being written down itself, to be shown then */
	int64_t shown_ms, pictured_ms; /* since it is on the panel, and to be seen there; 0: not */
	struct hash kept[SESSION_KEPT_MAX]; /* the fetcher is to keep these */
	uint32_t kept_count;
	bool was_settled;         /* what came since its first whole picture may go again */
	struct scene_frame frame; /* of the last time it was drawn */
};

/* The panel over the day: when it is on, where the picture lies on it, and what the service manager
 * is told of it. */
struct panel {
	int64_t well_ms;    /* of the last frame that the service manager was told of; 0: of none */
	int64_t look_ms;    /* at the clock on the wall next; 0: at once */
	int64_t touched_ms; /* last; 0: never */
	bool closed;        /* by the hours, as last looked at */
	bool asleep;
	uint32_t taken;  /* contacts, a bit each, whose touch was for the panel alone */
	int shift_px[2]; /* of the picture: right and up */
};

/* What tells the exhibit engineer on the panel what is wrong with gopura.conf. */
struct setup_page {
	struct bitmap bitmap; /* no surface: nothing is to be said */
	int64_t since_ms;     /* when it came onto the panel; 0: not yet */
	int64_t leaves_ms;    /* when it began to go; 0: it stays */
};

/* What a visitor holds of the tools that the content gives: a raking light and a section.
 * docs/tools.md. */
struct tools {
	struct scene_tools now;
	enum overlay_handle held; /* by the one finger that may */
	uint32_t contact;         /* which that is */
	float grabbed_at[2];      /* where on the disc it came down */
	float grabbed_push_m;
};

struct kiosk {
	struct options options; /* of the command line; then of gopura.conf */
	struct provision provision;
	struct profile profile;
	struct setup_page setup_page;

	int epoll_fd, signal_fd;
	struct display *display;
	struct session shown;  /* its scene and story are NULL before the first release */
	struct session coming; /* the next release, warming up unseen; NULL: none */
	int64_t coming_since_ms, coming_drawn_ms;
	bool coming_held;  /* its objects are not asked for at this time of day */
	bool coming_waits; /* to be drawn again by itself, not only when something arrives */
	struct gl_target warm_target; /* where it is drawn */
	struct quads *quads;
	struct touch *touch;
	struct net_client *net;
	struct updater *updater;        /* of releases */
	struct metrics_socket *metrics; /* NULL: not offered */
	struct usage *usage;            /* of what visitors look at */
	struct capture *capture;        /* NULL: a kiosk, not a measurement */

	struct wants wants;
	struct navigator navigator;
	bool navigator_ready; /* a release's box is known */
	struct gesture_recogniser gestures;
	bool finger_on_words;     /* the gesture began on a page or card */
	uint32_t fingers_on_keys; /* a bit a contact */
	uint32_t answers;         /* contacts, a bit each, that only said that somebody is there */
	struct presence presence;
	enum presence_state presence_said; /* as the log has it */
	int asked_s;                       /* as the words have it */
	struct tour tour;                  /* a visitor's, or nobody's */
	struct tools tools;                /* a visitor's */
	struct way_back way_back;          /* the same */
	struct attract_camera attract;
	int64_t attract_camera_since_ms; /* the eye's way without a visitor began, or will */

	float px_per_mm;      /* of the panel, or a guess where nothing knows its size */
	struct camera camera; /* of the last frame */
	struct message_status status;
	int64_t started_ms, last_frame_ms;
	struct panel panel;
	bool frame_wanted, words_move, eye_moves;
	uint32_t frame_us;              /* work of the last frame, this thread */
	uint64_t frames, late_frames;   /* drawn; of them with more work than a frame may take */
	uint64_t object_count;          /* given to the scene since start */
	bool hidden[OVERLAY_PARTS_MAX]; /* anchors behind stone, as last looked at */
	uint32_t next_anchor;           /* to look at */
	uint32_t anchors_to_look;       /* at, before a picture at rest is right */
	uint32_t looked_triangles;      /* drawn when the anchors were looked at */
	bool pictured;                  /* the model was on the panel */
	bool memory_given_back;         /* since the picture settled last */
	struct camera said;             /* the eye, as the log has it last */
	int64_t said_ms;
	bool quit;
};

/* loop.c: start, run, stop (the reverse; any part may be missing). */
must_check int kiosk_start(struct kiosk *kiosk);
/* Until quit is set; negative errno (logged) where going on makes no sense; -ENOTRECOVERABLE,
 * -ESTALE: a new process does. */
must_check int kiosk_run(struct kiosk *kiosk);
void kiosk_stop(struct kiosk *kiosk);
/* Returns the earlier of two timeouts in milliseconds; -1 means none. */
static inline int sooner(int a_ms, int b_ms)
{
	if (a_ms < 0 || b_ms < 0)
		return a_ms < 0 ? b_ms : a_ms;
	return a_ms < b_ms ? a_ms : b_ms;
}

/* kiosk.c: what every part needs. */
/* Asks for a frame: the picture has changed. */
void kiosk_redraw(struct kiosk *kiosk);
/* Makes the loop wait for fd too, until fd is closed. fd -1: does nothing. */
must_check int kiosk_watch(struct kiosk *kiosk, int fd);
/* Size of the picture as the visitor sees it, which is turned where the panel is. */
int kiosk_width_px(const struct kiosk *kiosk);
int kiosk_height_px(const struct kiosk *kiosk);
/* Turns the visitor's pixels into the framebuffer's, and back. They differ on a panel that is
 * turned. */
void viewport_to_panel(const struct kiosk *kiosk, float *x_px, float *y_px);
void viewport_from_panel(const struct kiosk *kiosk, float *x_px, float *y_px);
/* Turns a place on the glass into the place of the picture there, both in the visitor's pixels: the
 * picture is shifted by a few pixels to spare the panel. */
void viewport_unshift(const struct kiosk *kiosk, float *x_px, float *y_px);

/* session.c: what is shown, and what comes next. */
/* What a board's profile asks of a scene. */
struct scene_options kiosk_scene_options(const struct profile *profile, enum scene_mode mode);
void session_close(struct session *session);
/* An object came. true: without it what is cached could not be found, or would be no picture. */
bool session_give(struct session *session, struct hash hash, struct bytes object);
/* Begins with the release, in the background where another one is shown. What was coming before is
 * given up; the release that is on the panel just stays there. */
void session_begin(struct kiosk *kiosk, struct hash root, uint32_t root_bytes);
/* Draws a little of what is coming, and has it remembered once it can be shown whole. */
void session_warm(struct kiosk *kiosk);
/* Its objects survive a power cut now (done), or the disk failed: net_client_sync's answer. */
void session_synced(struct kiosk *kiosk, bool done);
void session_keep_first(struct kiosk *kiosk); /* after each frame */
/* The objects of what is coming may be asked for: the network's time of day, or a stick's. */
bool session_may_load(const struct kiosk *kiosk);
/* The release was written down, or could not be: shows it, if it is what is coming. */
void session_remembered(struct kiosk *kiosk, struct hash root, int rc);
/* When what is coming is to be drawn again, milliseconds from now; -1: when something arrives. */
int session_wait_ms(const struct kiosk *kiosk);

/* panel.c */
/* Once a turn of the loop. Negative errno as of display_dispatch and display_sleep. */
must_check int panel_turn(struct kiosk *kiosk);
/* In how many milliseconds the next turn is due; -1: when something happens. */
int panel_wait_ms(const struct kiosk *kiosk);
/* A finger on the glass. true: it wakes the panel, or did, and means nothing else. */
bool panel_takes_touch(struct kiosk *kiosk, const struct touch_event *event);

/* setup_page.c: it stays for half a minute where there is a release to be shown then, else until
 * the terminal is started anew. */
/* Draws it, if there is something to say. Needs the panel's size, and whether a release is
 * remembered. */
must_check int setup_page_show(struct kiosk *kiosk);
void setup_page_finish(struct kiosk *kiosk); /* one that was never shown is fine */
/* Over everything else that is in the frame. */
must_check int setup_page_draw(struct kiosk *kiosk, int64_t now_ms);
/* It is up: touch means nothing. */
bool setup_page_covers(const struct kiosk *kiosk);
/* In how many milliseconds it changes by itself; -1: not by time. */
int setup_page_wait_ms(const struct kiosk *kiosk);

/* vitals.c: offers how the terminal is, where the options ask for it. */
must_check int vitals_offer(struct kiosk *kiosk);

/* visitor.c: whether a visitor is there. */
/* Once a turn: asks, begins anew, shows the model. */
void visitor_watch(struct kiosk *kiosk);
/* When visitor_watch has something to do by time alone, milliseconds; -1: never. */
int visitor_wait_ms(const struct kiosk *kiosk);
/* Moves the eye where nobody else does. true: it moves on. */
bool visitor_leads_eye(struct kiosk *kiosk, int64_t now_ms);
/* A finger does something. true: it is the answer to the question, and means nothing else. */
bool visitor_takes_touch(struct kiosk *kiosk, const struct touch_event *event);
/* Until the panel counts as left alone, milliseconds; 0: it is. */
int visitor_left_ms(const struct kiosk *kiosk);

/* counting.c */
/* Wall clock, seconds since 1970; 0 while nobody has set it. */
int64_t counting_clock_s(void);
/* Counts that a visitor looked at the part; -1: at something that belongs to no part. */
void counting_part(struct kiosk *kiosk, enum usage_kind kind, int part);
/* The same by the id of what was looked at: a part, or a tour. */
void counting_id(struct kiosk *kiosk, enum usage_kind kind, const char *id);

/* tour_player.c: guided tours. */
void tour_player_start(struct kiosk *kiosk, int which); /* a visitor's; -1: none */
void tour_player_halt(struct kiosk *kiosk);
void tour_player_go_on(struct kiosk *kiosk);
void tour_player_end(struct kiosk *kiosk);
/* The bar's control: halts one, has it go on, starts the only one, or has the visitor choose. */
void tour_player_press(struct kiosk *kiosk);
/* The tour of who is not there. false: the release has none. */
bool tour_player_go_round(struct kiosk *kiosk);
/* Moves the eye along the way, if one is flown. true: it moves on. */
bool tour_player_leads_eye(struct kiosk *kiosk, int64_t now_ms);
/* What the words have of it. */
void tour_player_say(struct kiosk *kiosk);
/* The part that is lit, or -1. */
int tour_player_part(const struct kiosk *kiosk);

/* back.c: what the bar's way back undoes. */
/* A step begins that leads elsewhere. */
void back_note(struct kiosk *kiosk);
void back_press(struct kiosk *kiosk);
/* Another visitor, or another release. */
void back_forget(struct kiosk *kiosk);
/* Before each frame: whether there is a way back. */
void back_say(struct kiosk *kiosk);

/* tools.c: the light and the section that visitors hold. */
void tools_press(struct kiosk *kiosk, unsigned tool); /* enum overlay_tool: on, or off again */
void tools_end(struct kiosk *kiosk);                  /* all is as for whoever comes */
/* true: the finger is a tool's until it lifts. */
bool tools_take_touch(struct kiosk *kiosk, const struct touch_event *event);
/* Before each frame: what scene and words have of them. */
void tools_say(struct kiosk *kiosk);

/* trial.c: whether a new release works. */
/* A release that is on trial is proven by its picture on the panel, or the one before it taken. */
void trial_watch(struct kiosk *kiosk);
/* When trial_watch has something to do by time alone, milliseconds; -1: never. */
int trial_wait_ms(const struct kiosk *kiosk);
/* The session has an object that cannot be decoded. */
bool trial_is_broken(const struct session *session);

/* frame.c */
must_check int frame_draw(struct kiosk *kiosk);
/* What a frame does beside drawing, while there is nothing to draw on: brings the next release. */
must_check int frame_unseen(struct kiosk *kiosk);
/* Where the eye is now, with the panel's fields filled in. */
void frame_camera(const struct kiosk *kiosk, struct camera *out);

/* fingers.c */
void fingers_init(struct kiosk *kiosk);
void fingers_on_touch(void *data, const struct touch_event *event);
void fingers_on_pointer(void *data, enum pointer_kind kind, float x_px, float y_px, float steps);

#endif
