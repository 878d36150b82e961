/* The invitation to touch, in all languages at once, for when no visitor is present. */
#ifndef GOPURA_UI_INVITATION_VIEW_H
#define GOPURA_UI_INVITATION_VIEW_H

#include "ui/fade.h"
#include "ui/languages.h"
#include "ui/layers.h"
#include "ui/screen.h"

struct invitation_view {
	struct fade fade; /* on: it invites */
	struct sprite sprite;
};

void invitation_view_init(struct invitation_view *view, uint32_t *next_id);
void invitation_view_finish(struct invitation_view *view);

/* Returns true if that changes anything. */
bool invitation_view_show(struct invitation_view *view, bool on);
/* Draws it if it is on: after it was turned on, and when the size of type changes. One line per
 * language; a text that two languages share appears once. theme is the screen's; its language
 * changes during the call and is restored. */
void invitation_view_draw(struct invitation_view *view, const struct screen *screen,
			  struct theme *theme, const struct languages *languages);
/* Returns its place. Its size is that of its last drawing. */
struct rect invitation_view_rect(const struct invitation_view *view, const struct screen *screen);
/* Advances by step_ms. Returns true if something still moves. */
bool invitation_view_update(struct invitation_view *view, int64_t step_ms);
void invitation_view_layers(const struct invitation_view *view, const struct screen *screen,
			    struct layers *layers);

#endif
