/* Gives touches and gestures their meaning: on the model they move the eye; on the overlay they
 * scroll, type and zoom pictures; taps go to app/visit/actions.h. */
#ifndef GOPURA_APP_FINGERS_H
#define GOPURA_APP_FINGERS_H

#include "app/modes/setup_page.h"
#include "app/panel.h"
#include "app/visit/actions.h"
#include "app/visit/visitor.h"
#include "input/gesture.h"

/* Who may take a touch, in this order, and what gestures work with; borrowed. */
struct fingers_env {
	struct panel *panel;
	const struct setup_page *setup_page;
	struct visitor *visitor;
	struct tools *tools;
	const struct actions *actions;
	const struct exhibit *shown;
	struct eye *eye;
	struct tour_player *tours;
	const struct viewport *viewport;
	struct redraw *redraw;
};

struct fingers {
	struct fingers_env env;
	struct gesture_recogniser gestures;
	bool holds;       /* the gesture drags scenery, such as a bolt, and not the eye */
	bool on_words;    /* the gesture began on the overlay, such as a page or card */
	uint32_t on_keys; /* bit mask of contacts */
	enum overlay_action_kind tapped; /* what the last tap meant */
};

/* Copies env; the viewport's px_per_mm must be set. */
void fingers_init(struct fingers *fingers, const struct fingers_env *env);
/* Forgets the fingers on the glass: they belong to nobody. */
void fingers_reset(struct fingers *fingers);
/* Callback of the touchscreen: handles a touch in the visitor's pixels. data is the fingers. */
void fingers_on_touch(void *data, const struct touch_event *event);
/* Callback of the display: handles the pointer of a window, in the panel's pixels. steps > 0 of the
 * wheel zoom in. data is the fingers. */
void fingers_on_pointer(void *data, enum pointer_kind kind, float x_px, float y_px, float steps);

#endif
