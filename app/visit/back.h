/* The back button of the bar: records the visitor's place before each step, and returns to it one
 * step at a time. */
#ifndef GOPURA_APP_VISIT_BACK_H
#define GOPURA_APP_VISIT_BACK_H

#include "app/view/eye.h"
#include "app/visit/tour_player.h"
#include "app/visit/way_back.h"

/* What the button works with; borrowed. */
struct back_env {
	const struct exhibit *shown;
	struct eye *eye;
	struct tour_player *tours;
};

struct back {
	struct back_env env;
	struct way_back way;
};

void back_init(struct back *back, const struct back_env *env);
/* Records the current place before a step that leads elsewhere. Needs an overlay. */
void back_note(struct back *back);
/* Closes an open picture or the choice of tours, otherwise goes back one step. Needs an overlay. */
void back_press(struct back *back);
/* Forgets all steps, for the next visitor. */
void back_forget(struct back *back);
/* Another release is shown, which has other parts: forgets all steps. data is the back button. */
void back_on_release(void *data, const struct exhibit_change *change);
/* Called before each frame: tells the overlay whether the button has something to undo. */
void back_show(struct back *back);

#endif
