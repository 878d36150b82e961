/* A visit from the first touch to the farewell: whether a visitor is there, the question whether
 * one still is, and the reset for the next. While nobody is there, the model presents itself by a
 * tour or the attract camera. See docs/visit.md. */
#ifndef GOPURA_APP_VISIT_VISITOR_H
#define GOPURA_APP_VISIT_VISITOR_H

#include "app/visit/attract_camera.h"
#include "app/visit/back.h"
#include "app/visit/counting.h"
#include "app/visit/listening.h"
#include "app/visit/presence.h"
#include "app/visit/tools.h"
#include "app/visit/tour_player.h"

struct visitor_options {
	int idle_s;           /* without a touch until a visitor is asked */
	const char *language; /* for each new visitor; NULL: the release's first. Borrowed */
	bool off;             /* pictures of views are drawn: there are no visitors */
};

/* What it works with; borrowed. */
struct visitor_env {
	const struct exhibit *shown;
	struct eye *eye;
	struct tour_player *tours;
	const struct listening *listening;
	struct tools *tools;
	struct back *back;
	struct counting *counting;
	struct redraw *redraw;
	/* Called with data when a visit has ended: fingers still on the glass belong to nobody. */
	void (*ended)(void *data);
	void *data;
};

struct visitor {
	struct visitor_options options;
	struct visitor_env env;
	struct presence presence;
	enum presence_state logged; /* the state logged last */
	int asked_s;                /* the countdown that the overlay shows, in seconds; -1: none */
	uint32_t down;              /* bit mask of contacts that are on the glass */
	uint32_t answers;           /* bit mask of contacts that only answered the question */
	struct attract_camera attract;
	bool circles;             /* the attract camera, around this release */
	int64_t attract_since_ms; /* when the eye came to the attract camera's circle */
};

/* Copies both structs. Somebody may be there at first. */
void visitor_init(struct visitor *visitor, const struct visitor_options *options,
		  const struct visitor_env *env);
/* Called once per turn of the loop: asks whether the visitor is still there, resets everything
 * after a visit, and starts the tour or the attract camera. is_dark: the panel is off or missing,
 * so a tour on it is no sign of a visitor, nor is a spoken text. */
void visitor_turn(struct visitor *visitor, bool is_dark);
/* Returns in how many milliseconds visitor_turn has something to do by time alone; -1: never. */
int visitor_wait_ms(const struct visitor *visitor);
/* Moves the eye along a tour or the attract camera, if no visitor controls it. Returns true if it
 * keeps moving. */
bool visitor_lead_eye(struct visitor *visitor, int64_t now_ms);
/* Records a touch. Returns true if it answers the question whether somebody is there, and must have
 * no other effect. */
bool visitor_take_touch(struct visitor *visitor, const struct touch_event *event);
/* Records that a visitor did something else than touch, such as turning a wheel. */
void visitor_stay(struct visitor *visitor);
/* Another release is shown: it is in the visitor's language too, and its help stays away. data is
 * the visitor. */
void visitor_on_release(void *data, const struct exhibit_change *change);
/* Returns the milliseconds until the visitor counts as gone; 0: nobody is there, or nothing is
 * shown that a visitor could look at. */
int visitor_left_ms(const struct visitor *visitor);

#endif
