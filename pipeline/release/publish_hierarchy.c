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
enum { COLOUR_BITS = 6, OPEN_BITS = 4 };

static void round_colours(uint8_t colour[4])
{
	for (int i = 0; i < 4; i++)
		colour[i] = patch_round_colour(colour[i], i < 3 ? COLOUR_BITS : OPEN_BITS);
}

/* Rounds to multiples of 4, halves away from zero. -128 is no valid normal. */
static void round_normal(int8_t normal[2])
{
	for (int i = 0; i < 2; i++) {
		int value = (normal[i] + (normal[i] < 0 ? -2 : 2)) / 4 * 4;

		normal[i] = (int8_t)(value > 124 ? 124 : value < -124 ? -124 : value);
	}
}

/* Reduces precision equally for equal vertices, so that neighbours still agree. Positions stay
 * unchanged: they decide which image is seen where (docs/patch.md has the figures). */
static int round_group(struct buffer *object)
{
	struct patch_mesh meshes[GROUP_PATCHES_MAX];
	uint32_t count;
	int rc = patch_group_decode(meshes, &count, buffer_bytes(object));

	if (rc < 0)
		return rc;
	for (uint32_t p = 0; p < count; p++) {
		for (uint32_t v = 0; v < meshes[p].vertex_count; v++) {
			round_colours(meshes[p].vertices[v].colour);
			round_normal(meshes[p].vertices[v].normal);
		}
	}
	buffer_clear(object);
	rc = patch_group_encode(object, meshes, count);
	for (uint32_t p = 0; p < count; p++)
		patch_mesh_finish(&meshes[p]);
	return rc;
}

static int add_groups(struct object_store *objects, const struct master *master,
		      const struct master_cut *cut, struct page_child *children)
{
	struct buffer object;
	int rc = 0;

	buffer_init(&object, OBJECT_BYTES_MAX);
	for (uint32_t i = 0; rc == 0 && i < cut->hierarchy.group_count; i++) {
		buffer_clear(&object);
		rc = master_read_group(master, cut->groups[i], &object);
		if (rc == 0)
			rc = round_group(&object);
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
	int rc = make_cut(&cut, master, share);

	if (rc == 0) {
		children = calloc(cut.hierarchy.group_count, sizeof(*children));
		rc = children ? add_groups(objects, master, &cut, children) : -ENOMEM;
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
