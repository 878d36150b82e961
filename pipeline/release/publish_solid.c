/* Reads the finest published patches, fills a grid with them, and makes its cells as small as is of
 * use, or as the bytes of the octree allow. */
#include "pipeline/release/publish_solid.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "geometry/tour_path.h"
#include "geometry/vec.h"
#include "pipeline/release/finest_patches.h"
#include "pipeline/release/solid_grid.h"
#include "storage/info_tour.h"

#define LEAST_SHARE 0.5f /* of the room: smaller cells bring the eye hardly nearer */
#define FIRST_SHARE                                                                                \
	512.f            /* of the longest side: cells of the first trial, unless they are larger */
#define GOAL_SHARE 0.93f /* of the bytes: what is aimed at */

enum { TRIALS = 6 };

struct surface {
	const struct root_page *root;
	const struct info *info;
	struct finest_patches patches;
	float clear_m; /* how far an eye stays from it */
};

static void add_patch(struct solid_grid *grid, const struct lattice *lattice,
		      const struct patch_mesh *mesh)
{
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		float corners[3][3];

		for (int c = 0; c < 3; c++) {
			double at[3];

			lattice_metres(at, lattice,
				       mesh->vertices[mesh->indices[3 * t + (uint32_t)c]].position);
			for (int axis = 0; axis < 3; axis++)
				corners[c][axis] = (float)at[axis];
		}
		solid_grid_add(grid, (const float(*)[3])corners);
	}
}

static void open_eyes(struct solid_grid *grid, const struct surface *surface)
{
	const uint32_t tours = surface->info ? info_tour_count(surface->info) : 0;

	solid_grid_open(grid, surface->root->start_eye_m);
	for (uint32_t i = 0; i < tours; i++) {
		const struct info_tour *tour = info_tour(surface->info, i);

		for (uint32_t k = 0; k < tour->stop_count; k++)
			solid_grid_open(grid, tour->stops[k].eye_m);
	}
}

static int make(const struct surface *surface, float cell_m, struct buffer *object)
{
	struct solid_grid_options options = { .cell_m = cell_m, .room_m = surface->clear_m };
	struct solid_grid *grid;
	struct solid solid = { 0 };
	int rc;

	memcpy(options.box_min_m, surface->root->box_min_m, sizeof(options.box_min_m));
	memcpy(options.box_max_m, surface->root->box_max_m, sizeof(options.box_max_m));
	rc = solid_grid_create(&grid, &options);
	if (rc < 0)
		return rc;
	for (uint32_t i = 0; i < surface->patches.count; i++)
		add_patch(grid, &surface->root->lattice, &surface->patches.meshes[i]);
	open_eyes(grid, surface);
	rc = solid_grid_tree(grid, &solid);
	if (rc == 0)
		rc = solid_encode(object, &solid);
	solid_finish(&solid);
	solid_grid_destroy(grid);
	return rc;
}

/* Tries cells of several sizes; best becomes the object with the smallest ones that fits. The bytes
 * grow with the surface in cells, so with the square of their number along a side. */
static int choose(const struct surface *surface, struct buffer *best)
{
	const struct root_page *root = surface->root;
	const float least_m = LEAST_SHARE * surface->clear_m;
	float longest_m = 0, cell_m;

	for (int axis = 0; axis < 3; axis++)
		longest_m = fmaxf(longest_m, root->box_max_m[axis] - root->box_min_m[axis]);
	cell_m = fmaxf(least_m, longest_m / FIRST_SHARE);
	for (int trial = 0; trial < TRIALS; trial++) {
		struct buffer object;
		float grow;
		int rc;

		buffer_init(&object, OBJECT_BYTES_MAX);
		rc = make(surface, cell_m, &object);
		grow = sqrtf((float)object.size / (GOAL_SHARE * SOLID_BYTES_MOST));
		if (rc == 0 && object.size <= SOLID_BYTES_MOST) {
			buffer_finish(best);
			*best = object;
			if (cell_m <= least_m || grow > 0.95f)
				return 0;
		} else {
			buffer_finish(&object);
			if (rc < 0 && rc != -EFBIG)
				return rc;
			if (best->size > 0)
				return 0;
			grow = rc < 0 ? 1.5f : fmaxf(grow, 1.03f);
		}
		cell_m = fmaxf(least_m, cell_m * grow);
	}
	return 0;
}

int publish_solid(struct object_store *objects, const struct root_page *root,
		  const struct page_child *hierarchy, const struct info *info,
		  struct page_child *out)
{
	const float diagonal_m = vec_distance(root->box_min_m, root->box_max_m);
	struct surface surface = { .root = root,
				   .info = info,
				   .clear_m = tour_path_clearance_m(diagonal_m) };
	struct buffer object;
	int rc = finest_patches_read(&surface.patches, objects, hierarchy);

	buffer_init(&object, OBJECT_BYTES_MAX);
	if (rc == 0)
		rc = surface.clear_m > 0 ? choose(&surface, &object) : -EINVAL;
	if (rc == 0 && object.size > 0)
		rc = object_store_add(objects, buffer_bytes(&object), out) < 0 ? -ENOMEM : 1;
	if (rc == 0 || rc == -EINVAL) {
		log_warn("pipeline",
			 "the space around the model cannot be described in %d bytes, "
			 "so the release does not say where an eye may be",
			 SOLID_BYTES_MOST);
		rc = 0;
	}
	if (rc < 0)
		log_error("pipeline", "the space around the model: %s", strerror(-rc));
	finest_patches_finish(&surface.patches);
	buffer_finish(&object);
	return rc;
}
