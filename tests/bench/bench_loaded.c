/* How much of a whole model a view needs: bench_loaded MASTER VIEWS, the folder of a master below a
 * content folder's .work and lines as tests/bench/path.txt has. For each view, 1280 x 720, the
 * groups of the cut in which nothing in the picture is wrong by more than a pixel, without a limit
 * of triangles, as if everything were published. JSON to standard output: the bytes of all groups,
 * the mean of a view's, those of all views together, and the triangles of a view. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/hierarchy/master.h"
#include "render/patches/cut.h"
#include "tests/bench/stage.h"

struct loads {
	uint64_t all, views, together; /* bytes; views: their sum */
	uint64_t triangles;            /* sum over the views */
};

static void load_view(struct loads *loads, const struct master *master, struct cut *cut,
		      const struct camera *camera, uint8_t *came)
{
	static const struct cut_options options = { .error_px = 1, .triangle_budget = INT32_MAX };
	const struct hierarchy *hierarchy = &master->hierarchy;
	uint8_t *none = calloc(hierarchy->group_count, 1);
	struct view view;

	stage_must(none ? 0 : -ENOMEM, "groups");
	view_from_camera(&view, camera);
	cut_update(cut, &view, none, &options);
	cut_desire(cut, &view, none, NULL, &options);
	for (uint32_t i = 0; i < cut->want_count; i++) {
		uint32_t group = cut->wants[i].group;

		loads->views += master->sizes[group];
		loads->together += came[group] ? 0 : master->sizes[group];
		came[group] = 1;
	}
	cut_update(cut, &view, cut->desired, &options);
	loads->triangles += cut->triangle_count;
	free(none);
}

int main(int argc, char **argv)
{
	static struct camera cameras[STAGE_VIEWS_MAX];
	struct loads loads = { 0 };
	struct master *master;
	struct cut cut;
	uint32_t views;
	uint8_t *came;

	if (argc != 3) {
		fputs("usage: bench_loaded DIR/.work/master VIEWS\n", stderr);
		return 2;
	}
	views = stage_read_views(cameras, STAGE_VIEWS_MAX, argv[2], 1280, 720);
	stage_must(master_open(&master, argv[1], NULL), argv[1]);
	stage_must(cut_init(&cut, &master->hierarchy), "cut");
	came = calloc(master->hierarchy.group_count, 1);
	stage_must(came ? 0 : -ENOMEM, "groups");
	for (uint32_t g = 0; g < master->hierarchy.group_count; g++)
		loads.all += master->sizes[g];
	for (uint32_t i = 0; i < views; i++)
		load_view(&loads, master, &cut, &cameras[i], came);
	printf("{\"views\": %u, \"bytes\": %" PRIu64 ", \"loaded_bytes\": %" PRIu64
	       ", \"loaded_share\": %.3f, \"together_bytes\": %" PRIu64
	       ", \"view_triangles\": %" PRIu64 "}\n",
	       views, loads.all, loads.views / views,
	       (double)loads.views / (double)loads.all / views, loads.together,
	       loads.triangles / views);
	free(came);
	cut_finish(&cut);
	master_destroy(master);
	return EXIT_SUCCESS;
}
