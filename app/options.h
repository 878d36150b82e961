/* The command line of gopura-kiosk. */
#ifndef GOPURA_APP_OPTIONS_H
#define GOPURA_APP_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/daily.h"
#include "render/display/display.h"
#include "render/scene/scene.h"
#include "system/hours.h"

enum { OPTIONS_CONFS_MAX = 4 };

/* Strings are borrowed from argv or static. */
struct options {
	const char *conf_paths[OPTIONS_CONFS_MAX]; /* gopura.conf: the first that is there */
	uint32_t conf_count;
	const char *boards_dir;  /* of the profiles that gopura.conf names */
	const char *release_url; /* NULL: whatever the state remembers, from the cache */
	const char *stick_dir;   /* a stick with a release may come to lie here; NULL: nowhere */
	const char *trust_path;  /* root/1.json pinned at the first start; NULL: the state's */
	const char *ca_path;
	const char *redirect_hosts; /* that the server may redirect to; as gopura.conf has it */
	const char *state_dir;      /* state.db and cache.db */
	const char *socket_path;    /* of a fetcher that runs; NULL: one is started */
	const char *fetch_program;
	const char *visits_path;  /* a copy of the counts of what visitors look at; NULL: none */
	const char *metrics_path; /* to offer figures on (docs/health.md); NULL: none */
	enum display_kind display;
	const char *device;      /* /dev/dri/cardN */
	int width_px, height_px; /* 0: what the panel prefers */
	int hz;                  /* 0: any */
	const char *board_path;
	const char *touch_replay_path;
	const char *views_path; /* with capture_dir */
	const char *capture_dir;
	const char *shots_path; /* with capture_dir: "MS NAME" a line */
	bool capture_overlay;   /* pictures of views with callouts and all */
	enum scene_mode mode;
	const char *language;
	struct daily download; /* when the objects of a new release are brought; 0: always */
	uint32_t poll_s;       /* for updates; 0: the fetcher's default */
	struct hours hours;    /* in which the panel is on */
	int wake_min;          /* how long a touch keeps it on outside them; 0: not at all; -1: as
				* gopura.conf has it */
	int idle_s; /* without a touch until a visitor is asked; 0: as gopura.conf has it */
	bool shift; /* the picture moves by a pixel now and then */
	bool quit_after_replay;
	bool safe_page; /* no kiosk: app/modes/safe_mode.h */
	bool self_test; /* likewise: app/modes/self_test.h */
};

enum options_result { OPTIONS_RUN, OPTIONS_DONE, OPTIONS_BAD };

/* Prints help, version or the fault itself. */
enum options_result options_parse(struct options *out, int argc, char **argv);

#endif
