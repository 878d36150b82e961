/* What pictures cost a curator's session (curator/session/painter.h): each view sharp, then fast,
 * 1280 x 720, with the region empty and what was drawn last still decoded.
 *
 *   bench_curator CONTENT < views
 *
 * CONTENT has a master (`gopura-content hierarchy`). A view is a line: eye, target (metres, z up),
 * field of view (degrees). Prints a row of JSON: the processors it may use, and medians in
 * milliseconds, the picture's encoding included. */
#include <errno.h>
#include <stdio.h>

#include "base/clock.h"
#include "base/diagnostics.h"
#include "base/parallel.h"
#include "curator/session/painter.h"
#include "tests/bench/stage.h"

enum { VIEWS_MAX = 256, PICTURE_BYTES_MAX = 16 << 20 };

static double draw(struct painter *painter, const struct camera *camera, bool sharp)
{
	const int64_t begun_us = clock_now_us();
	struct buffer picture;

	buffer_init(&picture, PICTURE_BYTES_MAX);
	stage_must(painter_draw(painter, camera, sharp, &picture), "a picture");
	buffer_finish(&picture);
	return (double)(clock_now_us() - begun_us) / 1000;
}

int main(int argc, char **argv)
{
	static double sharp_ms[VIEWS_MAX], fast_ms[VIEWS_MAX];
	struct diagnostics diagnostics = { 0 };
	struct region_set set;
	struct painter *painter;
	struct site site;
	uint32_t count = 0;
	char line[256];

	if (argc != 2) {
		fprintf(stderr, "usage: bench_curator CONTENT < views\n");
		return 2;
	}
	stage_must(site_open(&site, argv[1], &diagnostics), argv[1]);
	stage_must(region_set_init(&set, site.mesh->triangle_count), "a region");
	stage_must(painter_create(&painter, &site, &set), "a painter");
	while (count < VIEWS_MAX && fgets(line, sizeof(line), stdin)) {
		struct camera c = { .up = { 0, 0, 1 },
				    .near_m = 0.02f,
				    .far_m = 1000,
				    .width_px = 1280,
				    .height_px = 720 };

		if (sscanf(line, "%f %f %f %f %f %f %f", &c.eye_m[0], &c.eye_m[1], &c.eye_m[2],
			   &c.target_m[0], &c.target_m[1], &c.target_m[2], &c.fov_deg) != 7)
			continue;
		draw(painter, &c, true); /* decodes */
		sharp_ms[count] = draw(painter, &c, true);
		fast_ms[count++] = draw(painter, &c, false);
	}
	stage_must(count > 0 ? 0 : -EINVAL, "no line is a view");
	printf("{\"processors\": %u, \"triangles\": %u, \"views\": %u, \"sharp_ms\": %.1f, "
	       "\"fast_ms\": %.1f}\n",
	       parallel_cores(), site.mesh->triangle_count, count, stage_median(sharp_ms, count),
	       stage_median(fast_ms, count));
	painter_destroy(painter);
	region_set_finish(&set);
	site_close(&site);
	return 0;
}
