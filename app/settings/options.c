/* Parses the command line of gopura-kiosk with getopt_long, checks each value, and prints the help
 * text. */
#include "app/settings/options.h"

#include <ctype.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/visit/presence.h"
#include "base/log.h"
#include "board/profile.h"
#include "sound/speaker.h"

static const char help_text[] =
	"gopura-kiosk: shows a temple on a touch panel\n"
	"\n"
	"usage: gopura-kiosk [OPTIONS]\n"
	"\n"
	"Release:\n"
	"  --release URL        where the release is: https://..., http://... or a folder\n"
	"  --trust FILE         root/1.json of the release, or tuf/1.root.json (docs/tuf.md); needed for\n"
	"                       the first start only\n"
	"  --target PATH        which target of The Update Framework is the release\n"
	"                       (default: release.json)\n"
	"  --ca FILE            certificate authority of the server (default: the system's)\n"
	"  --stick DIR          folder in which a USB stick with a release may be mounted\n"
	"  --state DIR          folder of the state and the cache\n"
	"                       (default: $XDG_STATE_HOME/gopura or ~/.local/state/gopura)\n"
	"  --poll-s SECONDS     interval of looking for a new release, 1 to 86400\n"
	"                       (default: the fetcher's)\n"
	"  --download HH:MM-HH:MM\n"
	"                       time of day for downloading a new release (default: any)\n"
	"  --fetch FILE         gopura-fetch to start (default: beside this program)\n"
	"  --socket FILE        connect to a gopura-fetch that is already running\n"
	"\n"
	"Terminal:\n"
	"  --conf FILE          gopura.conf of the terminal (docs/terminal.md); options on the command\n"
	"                       line take precedence; if given several times, the first file that\n"
	"                       exists is read\n"
	"  --boards DIR         board profiles that gopura.conf may name\n"
	"                       (default: /usr/share/gopura/board)\n"
	"  --board FILE         profile of the board (docs/board.md)\n"
	"  --budget-triangles N most triangles drawn in a frame, 10000 to 20000000 (default: triangles\n"
	"                       in the board's profile)\n"
	"  --display KIND       drm, window, headless or auto (default)\n"
	"  --device FILE        KMS device, such as /dev/dri/card0 (default: the first with a panel)\n"
	"  --size WxH[@HZ]      size of the window or picture, or mode of the panel\n"
	"  --hours TEXT         hours in which the panel is on, such as\n"
	"                       \"Mo-Fr 09:00-18:00, Sa 10:00-17:00\" (default: always); at other\n"
	"                       times a touch turns it on for a while\n"
	"  --wake-min MINUTES   length of that while (default: 5; 0: a touch does not turn it on)\n"
	"  --shift              shift the picture by a pixel now and then, against burn-in\n"
	"  --idle-s SECONDS     time without a touch before the visitor is asked whether anybody is\n"
	"                       still there, 5 to 3600 (default: 60)\n"
	"  --loudness N         how loud spoken texts are, 1 to 100; 0: they are not offered (default:\n"
	"                       as gopura.conf says, else 0; docs/sound.md)\n"
	"  --language CODE      language at the start of a visit, such as km\n"
	"  --locale DIR         catalogues of the kiosk's own texts (default: locale beside this\n"
	"                       program, otherwise /usr/share/locale)\n"
	"\n"
	"Operation:\n"
	"  --metrics FILE       socket on which metrics are offered (docs/health.md)\n"
	"  --visits FILE        file for a copy of the visit counts, which the health page reads\n"
	"                       (docs/visitors.md)\n"
	"  --log LEVEL          error, warn, info (default) or debug\n"
	"  --self-test          check panel, GPU, touch, storage and trust root, print a line for\n"
	"                       each, and exit; exit status 0 if all is well (docs/display.md)\n"
	"  --safe-page          show only the page that says the terminal will be back, without GPU\n"
	"                       and release (docs/display.md); with --capture, write it to\n"
	"                       safe-0.png and safe-1.png\n"
	"\n"
	"Tests:\n"
	"  --mode MODE          lumigraph (default); polygons or corners for comparison\n"
	"  --touch-replay FILE  read touches from a file instead of the panel (docs/input.md)\n"
	"  --quit-after-replay  exit when the file ends\n"
	"  --views FILE         draw these views and exit; one view a line: eye x y z, target x y z,\n"
	"                       vertical field of view in degrees (metres, z up)\n"
	"  --capture DIR        folder for pictures: view-0000.png ... and views.jsonl, or the\n"
	"                       screenshots\n"
	"  --shots FILE         take screenshots during a replay; one a line: milliseconds and name\n"
	"  --film               take pictures of a view while it loads, too, named by milliseconds\n"
	"  --overlay            draw the user interface on pictures of --views too\n"
	"\n"
	"  --help, --version\n"
	"\n"
	"Examples:\n"
	"  gopura-kiosk --release https://museum.example/temple --trust root.json\n"
	"  gopura-kiosk --display window --release build/demo/release \\\n"
	"               --trust build/demo/release/root/1.json\n"
	"  gopura-kiosk --display headless --size 1280x720 --release build/demo/release \\\n"
	"               --trust build/demo/release/root/1.json --views views.txt --capture out\n";

enum {
	OPTION_CONF = 256,
	OPTION_BOARDS,
	OPTION_RELEASE,
	OPTION_TRUST,
	OPTION_TARGET,
	OPTION_CA,
	OPTION_STATE,
	OPTION_DISPLAY,
	OPTION_DEVICE,
	OPTION_SIZE,
	OPTION_BOARD,
	OPTION_BUDGET_TRIANGLES,
	OPTION_MODE,
	OPTION_LANGUAGE,
	OPTION_TOUCH_REPLAY,
	OPTION_QUIT_AFTER_REPLAY,
	OPTION_VIEWS,
	OPTION_CAPTURE,
	OPTION_SHOTS,
	OPTION_FILM,
	OPTION_OVERLAY,
	OPTION_POLL,
	OPTION_DOWNLOAD,
	OPTION_STICK,
	OPTION_FETCH,
	OPTION_LOCALE,
	OPTION_SOCKET,
	OPTION_METRICS,
	OPTION_FIGURES,
	OPTION_VISITS,
	OPTION_LOG,
	OPTION_HOURS,
	OPTION_WAKE,
	OPTION_IDLE,
	OPTION_LOUDNESS,
	OPTION_SHIFT,
	OPTION_SELF_TEST,
	OPTION_SAFE_PAGE,
	OPTION_HELP,
	OPTION_VERSION
};

static const struct option long_options[] = {
	{ "conf", required_argument, NULL, OPTION_CONF },
	{ "boards", required_argument, NULL, OPTION_BOARDS },
	{ "release", required_argument, NULL, OPTION_RELEASE },
	{ "trust", required_argument, NULL, OPTION_TRUST },
	{ "target", required_argument, NULL, OPTION_TARGET },
	{ "ca", required_argument, NULL, OPTION_CA },
	{ "state", required_argument, NULL, OPTION_STATE },
	{ "display", required_argument, NULL, OPTION_DISPLAY },
	{ "device", required_argument, NULL, OPTION_DEVICE },
	{ "size", required_argument, NULL, OPTION_SIZE },
	{ "board", required_argument, NULL, OPTION_BOARD },
	{ "budget-triangles", required_argument, NULL, OPTION_BUDGET_TRIANGLES },
	{ "mode", required_argument, NULL, OPTION_MODE },
	{ "language", required_argument, NULL, OPTION_LANGUAGE },
	{ "touch-replay", required_argument, NULL, OPTION_TOUCH_REPLAY },
	{ "quit-after-replay", no_argument, NULL, OPTION_QUIT_AFTER_REPLAY },
	{ "views", required_argument, NULL, OPTION_VIEWS },
	{ "capture", required_argument, NULL, OPTION_CAPTURE },
	{ "shots", required_argument, NULL, OPTION_SHOTS },
	{ "film", no_argument, NULL, OPTION_FILM },
	{ "overlay", no_argument, NULL, OPTION_OVERLAY },
	{ "poll-s", required_argument, NULL, OPTION_POLL },
	{ "stick", required_argument, NULL, OPTION_STICK },
	{ "download", required_argument, NULL, OPTION_DOWNLOAD },
	{ "fetch", required_argument, NULL, OPTION_FETCH },
	{ "locale", required_argument, NULL, OPTION_LOCALE },
	{ "socket", required_argument, NULL, OPTION_SOCKET },
	{ "visits", required_argument, NULL, OPTION_VISITS },
	{ "metrics", required_argument, NULL, OPTION_METRICS },
	{ "figures", required_argument, NULL, OPTION_FIGURES }, /* its name before */
	{ "log", required_argument, NULL, OPTION_LOG },
	{ "hours", required_argument, NULL, OPTION_HOURS },
	{ "wake-min", required_argument, NULL, OPTION_WAKE },
	{ "idle-s", required_argument, NULL, OPTION_IDLE },
	{ "loudness", required_argument, NULL, OPTION_LOUDNESS },
	{ "shift", no_argument, NULL, OPTION_SHIFT },
	{ "self-test", no_argument, NULL, OPTION_SELF_TEST },
	{ "safe-page", no_argument, NULL, OPTION_SAFE_PAGE },
	{ "help", no_argument, NULL, OPTION_HELP },
	{ "version", no_argument, NULL, OPTION_VERSION },
	{ NULL, 0, NULL, 0 },
};

struct choice {
	const char *name;
	int value;
};

static const struct choice displays[] = { { "auto", DISPLAY_AUTO },
					  { "drm", DISPLAY_DRM },
					  { "window", DISPLAY_WINDOW },
					  { "headless", DISPLAY_HEADLESS },
					  { NULL, 0 } };
static const struct choice modes[] = { { "lumigraph", SCENE_LUMIGRAPH },
				       { "polygons", SCENE_POLYGONS },
				       { "corners", SCENE_CORNERS },
				       { NULL, 0 } };

static const struct choice levels[] = { { "error", LOG_LEVEL_ERROR },
					{ "warn", LOG_LEVEL_WARN },
					{ "info", LOG_LEVEL_INFO },
					{ "debug", LOG_LEVEL_DEBUG },
					{ NULL, 0 } };

static bool choose(const struct choice *choices, const char *name, int *value)
{
	for (; choices->name; choices++)
		if (strcmp(choices->name, name) == 0) {
			*value = choices->value;
			return true;
		}
	return false;
}

static bool parse_size(const char *text, struct options *o)
{
	char end;
	int count;

	o->hz = 0;
	count = sscanf(text, "%dx%d%c%d%c", &o->width_px, &o->height_px, &end, &o->hz, &end);
	if (count != 2 && (count != 4 || !strchr(text, '@') || o->hz < 10 || o->hz > 500))
		return false;
	return o->width_px >= 64 && o->width_px <= 8192 && o->height_px >= 64 &&
	       o->height_px <= 8192;
}

static bool parse_seconds(const char *text, uint32_t *out)
{
	char *end;
	unsigned long value = strtoul(text, &end, 10);

	*out = (uint32_t)value;
	return *text && !*end && value >= 1 && value <= 86400;
}

static bool parse_whole(const char *text, unsigned long least, unsigned long most, int *out)
{
	char *end;
	unsigned long value = strtoul(text, &end, 10);

	*out = (int)value;
	return isdigit((unsigned char)text[0]) && !*end && value >= least && value <= most;
}

static bool set_text(struct options *o, int option, const char *text)
{
	const struct {
		int option;
		const char **to;
	} texts[] = {
		{ OPTION_BOARDS, &o->boards_dir },
		{ OPTION_STICK, &o->stick_dir },
		{ OPTION_RELEASE, &o->release_url },
		{ OPTION_TRUST, &o->trust_path },
		{ OPTION_TARGET, &o->target },
		{ OPTION_CA, &o->ca_path },
		{ OPTION_STATE, &o->state_dir },
		{ OPTION_DEVICE, &o->device },
		{ OPTION_BOARD, &o->board_path },
		{ OPTION_LANGUAGE, &o->language },
		{ OPTION_TOUCH_REPLAY, &o->touch_replay_path },
		{ OPTION_VIEWS, &o->views_path },
		{ OPTION_CAPTURE, &o->capture_dir },
		{ OPTION_SHOTS, &o->shots_path },
		{ OPTION_FETCH, &o->fetch_program },
		{ OPTION_SOCKET, &o->socket_path },
		{ OPTION_METRICS, &o->metrics_path },
		{ OPTION_VISITS, &o->visits_path },
		{ OPTION_LOCALE, &o->locale_dir },
	};

	for (size_t i = 0; i < ARRAY_COUNT(texts); i++)
		if (texts[i].option == option) {
			*texts[i].to = text;
			return true;
		}
	return false;
}

static bool set_value(struct options *o, int option, const char *text)
{
	int value = 0;
	bool good;

	switch (option) {
	case OPTION_DISPLAY:
		good = choose(displays, text, &value);
		o->display = (enum display_kind)value;
		return good;
	case OPTION_MODE:
		good = choose(modes, text, &value);
		o->mode = (enum scene_mode)value;
		return good;
	case OPTION_LOG:
		good = choose(levels, text, &value);
		if (good)
			log_set_level((enum log_level)value);
		return good;
	case OPTION_SIZE:
		return parse_size(text, o);
	case OPTION_POLL:
		return parse_seconds(text, &o->poll_s);
	case OPTION_CONF:
		if (o->conf_count == OPTIONS_CONFS_MAX)
			return false;
		o->conf_paths[o->conf_count++] = text;
		return true;
	case OPTION_DOWNLOAD:
		return daily_parse(&o->download, text) == 0;
	case OPTION_FILM:
		o->capture_film = true;
		return true;
	case OPTION_OVERLAY:
		o->capture_overlay = true;
		return true;
	case OPTION_HOURS:
		return hours_parse(&o->hours, text);
	case OPTION_WAKE:
		return parse_whole(text, 0, 24 * 60, &o->wake_min);
	case OPTION_IDLE:
		return parse_whole(text, PRESENCE_IDLE_LEAST_S, PRESENCE_IDLE_MOST_S, &o->idle_s);
	case OPTION_LOUDNESS:
		return parse_whole(text, 0, SPEAKER_LOUDNESS_MAX, &o->loudness);
	case OPTION_BUDGET_TRIANGLES:
		return parse_whole(text, PROFILE_TRIANGLES_LEAST, PROFILE_TRIANGLES_MOST,
				   &o->budget_triangles);
	case OPTION_SHIFT:
		o->shift = true;
		return true;
	case OPTION_SELF_TEST:
		o->self_test = true;
		return true;
	case OPTION_SAFE_PAGE:
		o->safe_page = true;
		return true;
	case OPTION_QUIT_AFTER_REPLAY:
		o->quit_after_replay = true;
		return true;
	default:
		return set_text(o, option, text);
	}
}

static bool check_together(const struct options *o)
{
	if (o->safe_page || o->self_test)
		return true;
	if (!o->release_url && !o->stick_dir && !o->socket_path && o->conf_count == 0)
		fputs("gopura-kiosk: give --release or --conf; see gopura-kiosk --help\n", stderr);
	else if ((o->views_path || o->shots_path) && !o->capture_dir)
		fputs("gopura-kiosk: --views and --shots need --capture DIR\n", stderr);
	else if (o->quit_after_replay && !o->touch_replay_path)
		fputs("gopura-kiosk: --quit-after-replay needs --touch-replay FILE\n", stderr);
	else
		return true;
	return false;
}

enum options_result options_parse(struct options *out, int argc, char **argv)
{
	int option, which = 0;

	*out = (struct options){ .mode = SCENE_LUMIGRAPH,
				 .wake_min = -1,
				 .loudness = -1,
				 .boards_dir = "/usr/share/gopura/board" };
	hours_always(&out->hours);
	while ((option = getopt_long(argc, argv, "", long_options, &which)) != -1) {
		if (option == OPTION_HELP) {
			fputs(help_text, stdout);
			return OPTIONS_DONE;
		}
		if (option == OPTION_VERSION) {
			puts("gopura-kiosk " GOPURA_VERSION);
			return OPTIONS_DONE;
		}
		if (option == '?')
			return OPTIONS_BAD; /* getopt printed the reason */
		if (option == OPTION_FIGURES) {
			fputs("gopura-kiosk: --figures is called --metrics now\n", stderr);
			return OPTIONS_BAD;
		}
		if (!set_value(out, option, optarg)) {
			fprintf(stderr,
				"gopura-kiosk: --%s does not accept '%s'; see gopura-kiosk --help\n",
				long_options[which].name, optarg);
			return OPTIONS_BAD;
		}
	}
	if (optind < argc) {
		fprintf(stderr, "gopura-kiosk: '%s' is not an option; see gopura-kiosk --help\n",
			argv[optind]);
		return OPTIONS_BAD;
	}
	return check_together(out) ? OPTIONS_RUN : OPTIONS_BAD;
}
