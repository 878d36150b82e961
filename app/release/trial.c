/* Measures how long a release has been visible, or blank. */
#include "app/release/trial.h"

enum {
	PASSES_MS = 10000, /* visible for so long without a crash: it works */
	BLANK_MS = 60000,  /* everything wanted has arrived, but nothing is visible */
};

static int left_ms(int64_t since_ms, int64_t most_ms, int64_t now_ms)
{
	const int64_t left = since_ms + most_ms - now_ms;

	return left > 0 ? (int)left : 0;
}

void trial_begin(struct trial *trial, int64_t now_ms)
{
	*trial = (struct trial){ .shown_ms = now_ms };
}

static bool is_judged(const struct trial *trial, const struct trial_sight *sight)
{
	return sight->on_trial && trial->shown_ms != 0;
}

static bool is_blank(const struct trial_sight *sight)
{
	return !sight->is_pictured && sight->is_complete && !sight->is_dark;
}

static bool may_fail(const struct trial_sight *sight)
{
	return sight->has_before && !sight->is_replaced;
}

enum trial_verdict trial_judge(struct trial *trial, const struct trial_sight *sight, int64_t now_ms)
{
	if (!is_judged(trial, sight))
		return TRIAL_GOES_ON;
	if (sight->is_dark || trial->was_dark)
		trial->shown_ms = now_ms; /* nothing could be seen until now */
	trial->was_dark = sight->is_dark;
	if (sight->is_pictured && trial->pictured_ms == 0 && sight->frame_ms >= trial->shown_ms &&
	    !sight->is_dark)
		trial->pictured_ms = sight->frame_ms;
	if (trial->pictured_ms > 0 && left_ms(trial->pictured_ms, PASSES_MS, now_ms) == 0)
		return TRIAL_PASSED;
	if (!may_fail(sight))
		return TRIAL_GOES_ON;
	if (!sight->is_pictured && sight->is_broken)
		return TRIAL_FAILED_BROKEN;
	if (is_blank(sight) && left_ms(trial->shown_ms, BLANK_MS, now_ms) == 0)
		return TRIAL_FAILED_BLANK;
	return TRIAL_GOES_ON;
}

int trial_wait_ms(const struct trial *trial, const struct trial_sight *sight, int64_t now_ms)
{
	if (!is_judged(trial, sight))
		return -1;
	if (trial->pictured_ms > 0)
		return left_ms(trial->pictured_ms, PASSES_MS, now_ms);
	if (may_fail(sight) && is_blank(sight))
		return left_ms(trial->shown_ms, BLANK_MS, now_ms);
	return -1;
}
