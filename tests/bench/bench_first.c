/* What a visitor waits for when a terminal is new: the first view of a release from an empty cache,
 * over a line on the stage's clock.
 *
 *   bench_first RELEASE VIEWS TRUTH --kbit N [--rtt MS] [--most S] [--size WxH] [--stream yes|no]
 *               [--window BYTES] [--film FOLDER]
 *
 * Prints a line of JSON: the milliseconds until the model is on the panel, until the picture has 25
 * and 30 dB against the truth (view-0000.png in TRUTH), and until it settles, each from the start
 * of the fetcher, and the bytes by 25 and 30 dB; -1: not within S seconds (600); and the decibels
 * at the end. What comes before the first page is counted too: signed metadata, the locator, and
 * round trips for each of these and for the connection. FOLDER gets a picture after 1, 2, 4, 8 ...
 * seconds. Without the stream everything is as in a release that has none. --window: what is asked
 * for ahead; without it, what the line carries in half a second, as the fetcher does. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "app/settings/scene_settings.h"
#include "render/scene/scene_parts.h"
#include "tests/bench/stage.h"

enum {
	METADATA_BYTES = 5500,    /* before the locator, as measured with the real programs */
	METADATA_TRIPS = 5,       /* likewise */
	LOOK_MS = 40,             /* between looks at first; later a thirtieth of the time */
	TURN_BYTES_MIN = 6 << 10, /* as net/downloader.c */
};

struct bench {
	const char *views, *truth, *film;
	struct stage_options options;
	struct stage stage;
	struct camera camera;
	bool no_stream;
	double most_s;
	int64_t began_us, start_us; /* began_us on the clock; start_us: what came before */
	uint64_t start_bytes;
	int64_t first_ms, db_ms[2], settled_ms;
	uint64_t db_bytes[2];
	int64_t looked_ms;
	uint32_t filmed;
};

static const double goals_db[2] = { 25, 30 };

static void read_option(struct bench *bench, const char *name, const char *value)
{
	if (!strcmp(name, "--kbit"))
		bench->options.bits_a_second = strtoull(value, NULL, 10) * 1000;
	else if (!strcmp(name, "--rtt"))
		bench->options.latency_us = (uint32_t)strtoul(value, NULL, 10) * 1000;
	else if (!strcmp(name, "--most"))
		bench->most_s = strtod(value, NULL);
	else if (!strcmp(name, "--size"))
		sscanf(value, "%dx%d", &bench->options.width_px, &bench->options.height_px);
	else if (!strcmp(name, "--window"))
		bench->options.window_bytes = strtoull(value, NULL, 10);
	else if (!strcmp(name, "--stream"))
		bench->no_stream = !strcmp(value, "no");
	else if (!strcmp(name, "--film"))
		bench->film = value;
	else
		stage_die(name, -EINVAL);
}

static void parse(struct bench *bench, int argc, char **argv)
{
	*bench = (struct bench){ .most_s = 600 };
	bench->options = (struct stage_options){
		.width_px = 1280,
		.height_px = 720,
		.frame_us = 50000,
		.latency_us = 40000,
		.scene = scene_settings(&profile_default, SCENE_LUMIGRAPH),
	};
	if (argc < 4)
		stage_die("RELEASE VIEWS TRUTH are needed", -EINVAL);
	bench->options.release = argv[1];
	bench->views = argv[2];
	bench->truth = argv[3];
	for (int i = 4; i + 1 < argc; i += 2)
		read_option(bench, argv[i], argv[i + 1]);
	if (bench->options.bits_a_second == 0)
		stage_die("--kbit is needed", -EINVAL);
	if (bench->options.window_bytes == 0)
		bench->options.window_bytes = bench->options.bits_a_second / 16;
	if (bench->options.window_bytes < TURN_BYTES_MIN)
		bench->options.window_bytes = TURN_BYTES_MIN;
}

static int64_t now_ms(const struct bench *bench)
{
	return (stage_now_us() - bench->began_us + bench->start_us) / 1000;
}

/* What comes before the root page. */
static void count_start(struct bench *bench)
{
	const struct stage_options *o = &bench->options;

	struct buffer locator;

	buffer_init(&locator, 64 << 20);
	locator_encode(&locator, &bench->stage.locator);
	bench->start_bytes = METADATA_BYTES + locator.size;
	buffer_finish(&locator);
	bench->start_us = METADATA_TRIPS * (int64_t)o->latency_us +
			  (int64_t)(bench->start_bytes * 8000000 / o->bits_a_second);
}

/* Returns the decibels of what the panel shows. */
static double judge(struct bench *bench)
{
	uint8_t *rgba = stage_read_panel(&bench->stage);
	const double db = stage_psnr(&bench->stage, rgba, bench->stage.scene->root.background,
				     bench->truth, 0);

	for (int i = 0; i < 2; i++)
		if (bench->db_ms[i] < 0 && db >= goals_db[i]) {
			bench->db_ms[i] = now_ms(bench);
			bench->db_bytes[i] = bench->stage.bytes + bench->start_bytes;
		}
	const uint64_t *of = bench->stage.bytes_of;

	fprintf(stderr,
		"%8lld ms %8.0f KB %6.2f dB; KB of the stream %.0f, groups %.0f, bricks %.0f, "
		"faces %.0f, tiles %.0f\n",
		(long long)now_ms(bench), (double)(bench->stage.bytes + bench->start_bytes) / 1000,
		db, (double)(of[OBJECT_STREAM] + of[OBJECT_BLOCK]) / 1000,
		(double)of[OBJECT_GROUP] / 1000, (double)of[OBJECT_BRICK] / 1000,
		(double)of[OBJECT_FACE] / 1000, (double)of[OBJECT_TILE] / 1000);
	free(rgba);
	return db;
}

static void film(struct bench *bench)
{
	uint8_t *rgba;

	if (!bench->film || now_ms(bench) < 1000ll << bench->filmed)
		return;
	rgba = stage_read_panel(&bench->stage);
	stage_keep(&bench->stage, rgba, bench->film, bench->filmed++);
	free(rgba);
}

int main(int argc, char **argv)
{
	static struct bench bench;
	struct scene_frame frame = { 0 };
	double db;

	parse(&bench, argc, argv);
	stage_read_views(&bench.camera, 1, bench.views, bench.options.width_px,
			 bench.options.height_px);
	stage_open(&bench.stage, &bench.options);
	count_start(&bench);
	bench.began_us = stage_now_us();
	bench.first_ms = bench.db_ms[0] = bench.db_ms[1] = bench.settled_ms = -1;
	while (!frame.settled && (double)now_ms(&bench) < 1000 * bench.most_s) {
		stage_frame(&bench.stage, &bench.camera, &frame);
		if (bench.no_stream && !bench.stage.scene->stream.growth.decoder)
			bench.stage.scene->stream.over = bench.stage.scene->has_root;
		film(&bench);
		if (bench.first_ms < 0 && frame.patches + frame.stream_triangles > 0)
			bench.first_ms = now_ms(&bench);
		if (bench.first_ms < 0 || bench.db_ms[1] >= 0 ||
		    now_ms(&bench) <
			    bench.looked_ms + LOOK_MS + (now_ms(&bench) - bench.first_ms) / 30)
			continue;
		bench.looked_ms = now_ms(&bench);
		judge(&bench);
	}
	if (frame.settled)
		bench.settled_ms = now_ms(&bench);
	db = judge(&bench);
	printf("{\"kbit\": %llu, \"rtt_ms\": %u, \"stream\": %s, \"first_picture_ms\": %lld, "
	       "\"db25_ms\": %lld, \"db30_ms\": %lld, \"settled_ms\": %lld, \"bytes_db25\": %llu, "
	       "\"bytes_db30\": %llu, \"bytes\": %llu, \"db\": %.2f}\n",
	       (unsigned long long)(bench.options.bits_a_second / 1000),
	       bench.options.latency_us / 1000, bench.no_stream ? "false" : "true",
	       (long long)bench.first_ms, (long long)bench.db_ms[0], (long long)bench.db_ms[1],
	       (long long)bench.settled_ms, (unsigned long long)bench.db_bytes[0],
	       (unsigned long long)bench.db_bytes[1],
	       (unsigned long long)(bench.stage.bytes + bench.start_bytes), db);
	stage_close(&bench.stage);
	return 0;
}
