/* Asks for the text, gives it to the speaker when it has arrived, and compares times with cues. */
#include "app/visit/listening.h"

#include <errno.h>
#include <string.h>

#include "base/clock.h"
#include "base/log.h"

enum {
	LOOK_MS = 50,      /* how often the speaker is asked */
	PROGRESS_MS = 500, /* how often the bar moves */
};

int listening_init(struct listening *listening, const struct listening_env *env, uint32_t loudness)
{
	*listening = (struct listening){ .env = *env };
	return loudness > 0 ? speaker_create(&listening->speaker, loudness) : 0;
}

void listening_finish(struct listening *listening)
{
	speaker_destroy(listening->speaker);
	*listening = (struct listening){ 0 };
}

static struct overlay *overlay_of(const struct listening *listening)
{
	return exhibit_overlay(listening->env.shown);
}

void listening_end(struct listening *listening)
{
	struct overlay *overlay = overlay_of(listening);

	if (!listening->on)
		return;
	if (listening->speaks)
		speaker_stop(listening->speaker);
	listening->on = listening->speaks = false;
	if (overlay)
		overlay_show_spoken(overlay, NULL);
	redraw_ask(listening->env.redraw);
	log_debug("app", "listening ends");
}

void listening_press(struct listening *listening)
{
	struct info_spoken spoken;
	struct bytes bytes;

	if (listening->on) {
		listening_end(listening);
		return;
	}
	if (!listening->speaker ||
	    information_view_spoken(listening->env.shown->view, &spoken, &bytes) < 0)
		return;
	listening->on = true;
	listening->part = overlay_page(overlay_of(listening));
	listening->hash = spoken.hash;
	listening->cue = 0;
	listening->shown_ms = 0;
	log_debug("app", "listening begins");
	listening_turn(listening);
}

int listening_wait_ms(const struct listening *listening)
{
	return listening->on ? LOOK_MS : -1;
}

/* Returns 1 + the number of the cue that is said then; 0: none. */
static uint32_t cue_at(const struct info_spoken *spoken, uint32_t at_ms)
{
	uint32_t found = 0;

	for (uint32_t n = 0; n < spoken->cue_count && spoken->cues[n].begin_ms <= at_ms; n++)
		if (spoken->cues[n].end_ms > at_ms)
			found = n + 1;
	return found;
}

static void show(struct listening *listening, const struct info_spoken *spoken, uint32_t at_ms)
{
	const uint32_t cue = cue_at(spoken, at_ms);
	const int64_t now_ms = clock_now_ms();
	const struct overlay_spoken state = {
		.words = cue > 0 ? spoken->cues[cue - 1].text : "",
		.share =
			at_ms < spoken->duration_ms ? (float)at_ms / (float)spoken->duration_ms : 1,
	};

	if (cue == listening->cue && listening->shown_ms > 0 &&
	    now_ms - listening->shown_ms < PROGRESS_MS)
		return;
	if (cue != listening->cue)
		log_debug("app", "words %u of %u", cue, spoken->cue_count);
	listening->cue = cue;
	listening->shown_ms = now_ms;
	overlay_show_spoken(overlay_of(listening), &state);
	redraw_ask(listening->env.redraw);
}

/* Whether the page is still the one whose text was begun. */
static bool is_current(const struct listening *listening, const struct info_spoken *spoken)
{
	return overlay_page(overlay_of(listening)) == listening->part &&
	       hash_equal(spoken->hash, listening->hash);
}

void listening_turn(struct listening *listening)
{
	struct speaker_state state;
	struct info_spoken spoken;
	struct bytes bytes;

	if (!listening->on)
		return;
	if (!overlay_of(listening) ||
	    information_view_spoken(listening->env.shown->view, &spoken, &bytes) < 0 ||
	    !is_current(listening, &spoken)) {
		listening_end(listening);
		return;
	}
	if (!listening->speaks && bytes.size > 0) {
		listening->speaks = true;
		if (speaker_start(listening->speaker, bytes) < 0) {
			log_error("app", "out of memory for a spoken text");
			listening_end(listening);
			return;
		}
	}
	state = speaker_state(listening->speaker);
	if (listening->speaks && !state.speaks) {
		listening_end(listening);
		if (state.failed)
			overlay_offer_spoken(overlay_of(listening), false);
		return;
	}
	show(listening, &spoken, listening->speaks ? state.at_ms : 0);
}

void listening_on_release(void *data, const struct exhibit_change *change)
{
	(void)change;
	listening_end(data);
}
