/* What is measured on the model: two ends with knobs that a finger can drag, and a line between
 * them. At the top it says how long that is and how exact, or what to touch next, to measure or to
 * walk. */
#ifndef GOPURA_UI_MEASURE_VIEW_H
#define GOPURA_UI_MEASURE_VIEW_H

#include "ui/action.h"
#include "ui/fade.h"
#include "ui/layers.h"
#include "ui/overlay_data.h"
#include "ui/screen.h"

enum { MEASURE_TEXT_BYTES = 160 };

struct measure_view {
	struct overlay_measure now;
	struct fade fade; /* on: there is something to say and nothing takes the whole panel */
	bool measures, walks, no_way;
	bool dirty; /* type or language changed */
	char text[MEASURE_TEXT_BYTES];
	int drawn_width_px; /* of the scene for which the text was drawn */
	float text_at_px[2];
	struct sprite words, knob, mark, stem, line;
};

void measure_view_init(struct measure_view *view, uint32_t *next_id);
void measure_view_finish(struct measure_view *view);

/* Sets what is shown; copied. NULL: no tool is on. */
void measure_view_set(struct measure_view *view, const struct overlay_tools *state);
/* Writes a length with its error, as "2.35 m ± 2 cm". The error is rounded up to one digit, and the
 * length has no digits below it. Lengths from 1 m on are in metres, from 1 cm on in centimetres;
 * below that in millimetres. The decimal sign is that of the language. */
void measure_view_text(char *out, size_t size, const char *language, float length_m, float error_m);
/* Returns the end whose knob is at that point, or OVERLAY_HANDLE_NONE. */
enum overlay_handle measure_view_handle_at(const struct measure_view *view,
					   const struct screen *screen, float x_px, float y_px);
/* Draws what changed and advances by step_ms. shows: nothing takes the whole panel. The words keep
 * off the place `taken`. Returns true if something still moves. */
bool measure_view_update(struct measure_view *view, const struct screen *screen, bool shows,
			 struct rect taken, int64_t step_ms);
void measure_view_layers(const struct measure_view *view, const struct screen *screen,
			 struct layers *layers);

#endif
