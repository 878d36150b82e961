/* Publishes the coarse part of the master: cuts it, reduces the precision of normals and colours,
 * and makes the hierarchy page. */
#include "pipeline/release/publish_hierarchy.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "format/patch.h"
#include "pipeline/hierarchy/master_cut.h"
#include "pipeline/hierarchy/normal_cone.h"
#include "pipeline/release/publish_precision.h"

/* Returns the smallest share that contains the top group. */
static double share_of_top(const struct master *master)
{
	const struct hierarchy *hierarchy = &master->hierarchy;
	uint64_t triangles = 0;

	for (uint32_t i = 0; i < hierarchy->groups[0].patch_count; i++)
		triangles += hierarchy->patches[i].triangle_count;
	return ((double)triangles + 0.5) / (double)master->source_triangles;
}

static int make_cut(struct master_cut *cut, const struct master *master, double share)
{
	int rc = master_cut_create(cut, master, share);

	if (rc != -ERANGE)
		return rc;
	log_warn("pipeline",
		 "the coarsest cut alone is %.1f %% of the scan's %" PRIu64
		 " triangles, more than the share of %.1f %% that may be published",
		 100.0 * share_of_top(master), master->source_triangles, 100.0 * share);
	return master_cut_create(cut, master, share_of_top(master));
}

/* Vertex colours are seen only where there is no image, and need no more precision. */
enum { COLOUR_BITS = 5, OPEN_BITS = 4, NORMAL_BITS = 5 };

static void round_colours(uint8_t colour[4])
{
	for (int i = 0; i < 4; i++)
		colour[i] = patch_round_colour(colour[i], i < 3 ? COLOUR_BITS : OPEN_BITS);
}

static void round_normal(int8_t normal[2])
{
	for (int i = 0; i < 2; i++)
		normal[i] = patch_round_normal(normal[i], NORMAL_BITS);
}

struct patch_error {
	float error_m;
	uint32_t triangle_count;
};

static int compare_errors(const void *a, const void *b)
{
	float left = ((const struct patch_error *)a)->error_m;
	float right = ((const struct patch_error *)b)->error_m;

	return (left > right) - (left < right);
}

/* Sets *out to the error of the finest that a release shows: half of the triangles that nothing
 * published refines are at least as wrong. */
static int median_error(float *out, const struct master *master, const struct master_cut *cut)
{
	const struct hierarchy *hierarchy = &cut->hierarchy;
	struct patch_error *errors = calloc(hierarchy->patch_count, sizeof(*errors));
	uint64_t triangles = 0, below = 0;
	uint32_t count = 0;

	if (!errors)
		return -ENOMEM;
	for (uint32_t p = 0; p < hierarchy->patch_count; p++) {
		const struct hierarchy_patch *patch = &hierarchy->patches[p];
		const struct hierarchy_group *whole =
			&master->hierarchy.groups[cut->groups[patch->group]];
		uint32_t at = p - hierarchy->groups[patch->group].first_patch;
		uint32_t finer = master->hierarchy.patches[whole->first_patch + at].finer;

		if (patch->finer != HIERARCHY_NONE)
			continue;
		errors[count++] = (struct patch_error){
			finer == HIERARCHY_NONE ? 0 : master->hierarchy.groups[finer].error_m,
			patch->triangle_count
		};
		triangles += patch->triangle_count;
	}
	qsort(errors, count, sizeof(*errors), compare_errors);
	*out = 0;
	for (uint32_t i = 0; 2 * below < triangles; i++) {
		below += errors[i].triangle_count;
		*out = errors[i].error_m;
	}
	free(errors);
	return 0;
}

/* Spheres must hold what rounding moves; all grow alike, so those that enclose others still do. */
static void grow_spheres(struct hierarchy *hierarchy, double step_m, int zeros)
{
	float by_m = zeros > 0 ? (float)(0.87 * step_m * (1 << zeros)) : 0; /* sqrt(3) / 2 */

	for (uint32_t i = 0; i < hierarchy->group_count; i++)
		hierarchy->groups[i].radius_m += by_m;
	for (uint32_t i = 0; i < hierarchy->patch_count; i++)
		hierarchy->patches[i].radius_m += by_m;
}

/* Reduces precision equally for equal vertices, so that neighbours still agree (docs/patch.md has
 * the figures). The group's rows receive the normal cones of what is left: rounding turns a
 * triangle that is hardly larger than a step. */
static int round_group(struct buffer *object, struct hierarchy *hierarchy, uint32_t group,
		       int zeros, int32_t places)
{
	struct hierarchy_patch *rows = &hierarchy->patches[hierarchy->groups[group].first_patch];
	struct patch_mesh meshes[GROUP_PATCHES_MAX];
	uint32_t count;
	int rc = patch_group_decode(meshes, &count, buffer_bytes(object));

	if (rc < 0)
		return rc;
	for (uint32_t p = 0; p < count; p++) {
		for (uint32_t v = 0; v < meshes[p].vertex_count; v++) {
			precision_round_position(meshes[p].vertices[v].position, zeros, places);
			round_colours(meshes[p].vertices[v].colour);
			round_normal(meshes[p].vertices[v].normal);
		}
		if (zeros > 0 && p < hierarchy->groups[group].patch_count)
			normal_cone_bound(&rows[p], &meshes[p]);
	}
	buffer_clear(object);
	rc = patch_group_encode(object, meshes, count);
	for (uint32_t p = 0; p < count; p++)
		patch_mesh_finish(&meshes[p]);
	return rc;
}

static int add_groups(struct object_store *objects, const struct master *master,
		      struct master_cut *cut, int zeros, struct page_child *children)
{
	int32_t places = 1 << (LATTICE_BITS + master->lattice.fine_bits);
	struct hierarchy *hierarchy = &cut->hierarchy;
	struct buffer object;
	int rc = 0;

	buffer_init(&object, OBJECT_BYTES_MAX);
	for (uint32_t i = 0; rc == 0 && i < hierarchy->group_count; i++) {
		buffer_clear(&object);
		rc = master_read_group(master, cut->groups[i], &object);
		if (rc == 0)
			rc = round_group(&object, hierarchy, i, zeros, places);
		if (rc == 0)
			rc = object_store_add(objects, buffer_bytes(&object), &children[i]);
	}
	buffer_finish(&object);
	return rc;
}

static int add_page(struct object_store *objects, const struct hierarchy *hierarchy,
		    struct page_child *children, struct page_child *out)
{
	struct page page = { .kind = PAGE_HIERARCHY,
			     .child_count = hierarchy->group_count,
			     .children = children };
	struct buffer payload;
	int rc;

	buffer_init(&payload, PAGE_BYTES_MAX);
	rc = hierarchy_encode(&payload, hierarchy);
	page.payload = buffer_bytes(&payload);
	if (rc == 0)
		rc = object_store_add_page(objects, &page, out);
	buffer_finish(&payload);
	return rc;
}

int publish_hierarchy(struct object_store *objects, const struct master *master, double share,
		      struct page_child *out, struct published_patches *published)
{
	struct page_child *children = NULL;
	struct master_cut cut = { 0 };
	float error_m = 0;
	int rc = make_cut(&cut, master, share), zeros = 0;

	if (rc == 0)
		rc = median_error(&error_m, master, &cut);
	if (rc == 0) {
		/* The same for the whole release, so that neighbours still meet. */
		zeros = precision_zeros_for(error_m, master->lattice.step_m);
		grow_spheres(&cut.hierarchy, master->lattice.step_m, zeros);
		children = calloc(cut.hierarchy.group_count, sizeof(*children));
		rc = children ? add_groups(objects, master, &cut, zeros, children) : -ENOMEM;
	}
	if (rc == 0)
		rc = add_page(objects, &cut.hierarchy, children, out);
	if (rc < 0)
		log_error("pipeline", "the hierarchy: %s%s", strerror(-rc),
			  rc == -EFBIG ? "; publish a smaller share" : "");
	*published = (struct published_patches){ .triangle_count = cut.triangle_count };
	for (uint32_t i = 0; rc == 0 && i < cut.hierarchy.group_count; i++)
		published->bytes += children[i].size;
	master_cut_finish(&cut);
	free(children);
	return rc;
}
