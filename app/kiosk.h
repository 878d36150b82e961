/* gopura-kiosk as one struct: the modules it wires, and what it decides between them. Private to
 * app. One thread; the modules' workers answer through descriptors. */
#ifndef GOPURA_APP_KIOSK_H
#define GOPURA_APP_KIOSK_H

#include "app/navigator.h"
#include "app/options.h"
#include "app/story.h"
#include "app/wants.h"
#include "board/profile.h"
#include "input/gesture.h"
#include "input/touch.h"
#include "net/client.h"
#include "render/display.h"
#include "render/quads.h"
#include "render/scene.h"

struct capture;
struct follow;

struct kiosk {
	struct options options;
	struct profile profile;

	int epoll_fd, signal_fd;
	struct display *display;
	struct scene *scene;
	struct quads *quads;
	struct touch *touch;
	struct net_client *net;
	struct story *story;
	struct follow *follow;   /* of releases */
	struct capture *capture; /* NULL: a kiosk, not a measurement */

	struct wants wants;
	struct navigator navigator;
	bool navigator_ready; /* a release's box is known */
	struct gesture_recogniser gestures;
	bool finger_on_words; /* the gesture began on a page or card */

	struct camera camera; /* of the last frame */
	struct scene_frame frame;
	struct message_status status;
	int64_t last_frame_ms;
	bool frame_wanted, words_move, eye_moves;
	uint32_t frame_us;               /* work of the last frame, this thread */
	uint64_t object_count;           /* given to the scene since start */
	bool hidden[OVERLAY_PARTS_MOST]; /* anchors behind stone, as last looked at */
	uint32_t next_anchor;            /* to look at */
	uint32_t anchors_to_look;        /* at, before a picture at rest is right */
	bool quit;
};

/* kiosk.c: start, run, stop (the reverse; any part may be missing). */
must_check int kiosk_start(struct kiosk *kiosk);
must_check int kiosk_run(struct kiosk *kiosk);
void kiosk_stop(struct kiosk *kiosk);
/* The picture changes: draw soon. */
void kiosk_redraw(struct kiosk *kiosk);
/* Of the picture as the visitor sees it. */
int kiosk_width_px(const struct kiosk *kiosk);
int kiosk_height_px(const struct kiosk *kiosk);

/* frame.c */
must_check int frame_draw(struct kiosk *kiosk);
/* Where the eye is now, with the panel's fields filled in. */
void frame_camera(const struct kiosk *kiosk, struct camera *out);
/* From the visitor's pixels to the framebuffer's, and back: they differ where the panel is turned.
 */
void frame_to_panel(const struct kiosk *kiosk, float *x_px, float *y_px);
void frame_from_panel(const struct kiosk *kiosk, float *x_px, float *y_px);

/* fingers.c */
void fingers_init(struct kiosk *kiosk);
void fingers_on_touch(void *data, const struct touch_event *event);
void fingers_on_pointer(void *data, enum pointer_kind kind, float x_px, float y_px, float steps);
void fingers_go_home(struct kiosk *kiosk);

#endif
