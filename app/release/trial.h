/* Whether a new release works: it is on trial from when it is first shown. It passes once its
 * picture has been on the panel for a while. It fails if nothing of it can be seen although nothing
 * more is awaited. Pure: all times are passed in, in milliseconds of clock_now_ms. */
#ifndef GOPURA_APP_RELEASE_TRIAL_H
#define GOPURA_APP_RELEASE_TRIAL_H

#include <stdbool.h>
#include <stdint.h>

struct trial {
	/* Since when the release is on the panel, without the time that it was dark; 0: none is. */
	int64_t shown_ms;
	int64_t pictured_ms; /* when it was first visible; 0: not yet */
	bool was_dark;       /* the panel, when the trial was judged last */
};

/* What the kiosk sees of the release that is shown. */
struct trial_sight {
	bool on_trial;    /* it is not yet known to work */
	bool has_before;  /* there is one before it that worked */
	bool is_replaced; /* the next one is loading, so nothing is decided against this one */
	bool is_pictured; /* the last frame shows the model */
	bool is_broken;   /* an object of it could not be decoded */
	bool is_complete; /* its root page is here, and nothing more is awaited. While objects are,
			     the network may be down, which is no fault of the release. */
	bool is_dark;     /* the panel is off or missing, so a frame is not visible */
	int64_t frame_ms; /* time of the last frame */
};

enum trial_verdict {
	TRIAL_GOES_ON,
	TRIAL_PASSED,
	TRIAL_FAILED_BROKEN, /* its objects cannot be decoded */
	TRIAL_FAILED_BLANK,  /* nothing of it was visible for a minute */
};

/* Another release is shown since now_ms. */
void trial_begin(struct trial *trial, int64_t now_ms);
/* Returns what is known of the release that is shown. */
enum trial_verdict trial_judge(struct trial *trial, const struct trial_sight *sight,
			       int64_t now_ms);
/* Returns in how many milliseconds the verdict changes by time alone; -1: never. */
int trial_wait_ms(const struct trial *trial, const struct trial_sight *sight, int64_t now_ms);

#endif
