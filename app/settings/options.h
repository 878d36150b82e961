/* The command line of gopura-kiosk. */
#ifndef GOPURA_APP_SETTINGS_OPTIONS_H
#define GOPURA_APP_SETTINGS_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/daily.h"
#include "render/display/display.h"
#include "render/scene/scene.h"
#include "system/hours.h"

enum { OPTIONS_CONFS_MAX = 4 };

/* Strings are borrowed: from argv, static, or, once provision_read has completed the options, from
 * its struct provision. */
struct options {
	const char *conf_paths[OPTIONS_CONFS_MAX]; /* gopura.conf: the first that exists */
	uint32_t conf_count;
	const char *boards_dir;  /* folder of the board profiles that gopura.conf names */
	const char *release_url; /* NULL: the release stored in the state, from the cache */
	/* Folder in which a USB stick with a release may appear; NULL: none. */
	const char *stick_dir;
	const char *trust_path; /* root/1.json for the first start; NULL: the stored root */
	/* Path of the release among the targets of The Update Framework; NULL: release.json. */
	const char *target;
	const char *ca_path;
	/* Hosts that the server may redirect to; set from gopura.conf. */
	const char *redirect_hosts;
	const char *state_dir;   /* folder of state.db and cache.db */
	const char *socket_path; /* of a running fetcher; NULL: the kiosk starts one */
	const char *fetch_program;
	const char *locale_dir;  /* catalogues of the kiosk's texts; NULL: folder.h finds them */
	const char *visits_path; /* file for a copy of the counts of what visitors look at; NULL:
				    none */
	/* Socket on which metrics are offered (docs/health.md); NULL: none. */
	const char *metrics_path;
	enum display_kind display;
	const char *device;      /* /dev/dri/cardN */
	int width_px, height_px; /* 0: the panel's preferred mode */
	int hz;                  /* 0: any */
	const char *board_path;
	int budget_triangles; /* most triangles per frame; 0: as the profile says */
	const char *touch_replay_path;
	const char *views_path; /* with capture_dir */
	const char *capture_dir;
	const char *shots_path; /* with capture_dir: "MS NAME" a line */
	bool capture_film;      /* take pictures of views while they load, too */
	bool capture_overlay;   /* draw the overlay on pictures of views too */
	enum scene_mode mode;
	const char *language;
	struct daily download; /* time of day for loading a new release; 0: always */
	uint32_t poll_s;       /* interval of looking for updates; 0: the fetcher's default */
	struct hours hours;    /* opening hours, in which the panel is on */
	int wake_min; /* minutes that a touch keeps it on outside them; 0: it does not; -1: as
			 gopura.conf says */
	int idle_s;   /* seconds without a touch until a visitor is asked; 0: as gopura.conf says */
	int loudness; /* of spoken texts, up to 100; 0: none; -1: as gopura.conf says */
	bool shift;   /* shift the picture by a pixel now and then */
	bool quit_after_replay;
	bool safe_page; /* run app/modes/safe_mode.h instead of the kiosk */
	bool self_test; /* run app/modes/self_test.h instead of the kiosk */
};

enum options_result { OPTIONS_RUN, OPTIONS_DONE, OPTIONS_BAD };

/* Parses the command line into *out. Returns OPTIONS_RUN; OPTIONS_DONE after printing help or
 * version; OPTIONS_BAD after printing what is wrong. */
enum options_result options_parse(struct options *out, int argc, char **argv);

#endif
