/* Reads a coarse cut of the published patches as one mesh, encodes it as a stream, and divides the
 * stream into a page with the base and an object for each block. */
#include "pipeline/release/publish_stream.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "format/hierarchy.h"
#include "format/patch.h"
#include "format/stream_page.h"
#include "pipeline/release/publish_precision.h"

/* ---- the cut */

/* Returns whether a patch is shown while the first group_count groups are refined. */
static bool is_shown(const struct hierarchy_patch *patch, uint32_t group_count)
{
	return patch->group < group_count &&
	       (patch->finer == HIERARCHY_NONE || patch->finer >= group_count);
}

static uint32_t cut_triangles(const struct hierarchy *hierarchy, uint32_t group_count)
{
	uint32_t triangles = 0;

	for (uint32_t p = 0; p < hierarchy->patch_count; p++)
		if (is_shown(&hierarchy->patches[p], group_count))
			triangles += hierarchy->patches[p].triangle_count;
	return triangles;
}

/* Every number of first groups is a valid cut: a group comes after those it depends on. */
static uint32_t choose_groups(const struct hierarchy *hierarchy, uint32_t most_triangles)
{
	uint32_t count = 1;

	while (count < hierarchy->group_count &&
	       cut_triangles(hierarchy, count + 1) <= most_triangles)
		count++;
	return count;
}

/* Returns the mean error of the cut's triangles; what nothing refines counts as exact. */
static float cut_error_m(const struct hierarchy *hierarchy, uint32_t group_count)
{
	double sum = 0, triangles = 0;

	for (uint32_t p = 0; p < hierarchy->patch_count; p++) {
		const struct hierarchy_patch *patch = &hierarchy->patches[p];

		if (!is_shown(patch, group_count))
			continue;
		triangles += patch->triangle_count;
		if (patch->finer != HIERARCHY_NONE)
			sum += (double)patch->triangle_count *
			       (double)hierarchy->groups[patch->finer].error_m;
	}
	return triangles > 0 ? (float)(sum / triangles) : 0;
}

/* ---- its mesh */

struct soup {
	struct patch_vertex *corners; /* owned; three for each triangle */
	uint32_t *order, *numbers;    /* owned; for each corner */
	uint32_t count;
};

static void soup_finish(struct soup *soup)
{
	free(soup->corners);
	free(soup->order);
	free(soup->numbers);
}

static int soup_init(struct soup *soup, uint32_t triangles)
{
	size_t room = 3 * (size_t)triangles + 1;

	*soup = (struct soup){ .corners = malloc(room * sizeof(*soup->corners)),
			       .order = malloc(room * sizeof(*soup->order)),
			       .numbers = malloc(room * sizeof(*soup->numbers)) };
	return soup->corners && soup->order && soup->numbers ? 0 : -ENOMEM;
}

static int add_group(struct soup *soup, struct object_store *objects, struct hash name,
		     const struct hierarchy_patch *patches, uint32_t group_count, uint32_t room)
{
	struct patch_mesh meshes[GROUP_PATCHES_MAX];
	uint32_t count;
	int rc = object_store_read_group(objects, name, meshes, &count);

	for (uint32_t i = 0; i < count; i++) {
		const uint32_t corners = 3 * meshes[i].triangle_count;

		if (rc == 0 && is_shown(&patches[i], group_count)) {
			rc = soup->count + corners <= room ? 0 : -EBADMSG;
			for (uint32_t c = 0; rc == 0 && c < corners; c++)
				soup->corners[soup->count++] =
					meshes[i].vertices[meshes[i].indices[c]];
		}
		patch_mesh_finish(&meshes[i]);
	}
	return rc;
}

static int by_place(const void *a, const void *b, void *data)
{
	const struct patch_vertex *corners = data;

	return memcmp(corners[*(const uint32_t *)a].position,
		      corners[*(const uint32_t *)b].position, sizeof(corners->position));
}

static int by_corners(const void *a, const void *b)
{
	return memcmp(a, b, 3 * sizeof(uint32_t));
}

/* Numbers the places; the vertex that came first at a place gives normal and colour. */
static void merge(struct soup *soup, struct stream_cut *out)
{
	for (uint32_t i = 0; i < soup->count; i++)
		soup->order[i] = i;
	qsort_r(soup->order, soup->count, sizeof(*soup->order), by_place, soup->corners);
	for (uint32_t i = 0; i < soup->count; i++) {
		const struct patch_vertex *corner = &soup->corners[soup->order[i]];

		if (i == 0 || by_place(&soup->order[i - 1], &soup->order[i], soup->corners) != 0)
			out->vertices[out->vertex_count++] = *corner;
		soup->numbers[soup->order[i]] = out->vertex_count - 1;
	}
}

/* Takes the triangles that are not flat, each once, its least corner first. */
static void take_triangles(struct stream_cut *out, const uint32_t *numbers, uint32_t count)
{
	uint32_t kept = 0;

	for (uint32_t i = 0; i < count; i += 3) {
		const uint32_t *n = &numbers[i];
		uint32_t least = n[0] < n[1] ? (n[0] < n[2] ? 0 : 2) : (n[1] < n[2] ? 1 : 2);

		if (n[0] == n[1] || n[1] == n[2] || n[2] == n[0])
			continue;
		for (uint32_t c = 0; c < 3; c++)
			out->triangles[out->triangle_count][c] = n[(least + c) % 3];
		out->triangle_count++;
	}
	qsort(out->triangles, out->triangle_count, sizeof(*out->triangles), by_corners);
	for (uint32_t t = 0; t < out->triangle_count; t++)
		if (t == 0 || by_corners(out->triangles[t], out->triangles[kept - 1]) != 0)
			memmove(out->triangles[kept++], out->triangles[t], sizeof(*out->triangles));
	out->triangle_count = kept;
}

/* The errors of the coarsest groups may be far above what is seen, so there is a limit: a step is
 * at most a 2048th of the longest side, about a pixel. */
static int zeros_for(const struct lattice *lattice, float error_m)
{
	const int zeros = precision_zeros_for(error_m, lattice->step_m);
	const int most = LATTICE_BITS + lattice->fine_bits - 11;

	return zeros < most ? zeros : most;
}

static int read_cut(struct stream_cut *out, struct object_store *objects,
		    const struct lattice *lattice, const struct page *page,
		    const struct hierarchy *hierarchy, uint32_t most_triangles)
{
	const int32_t places = 1 << (LATTICE_BITS + lattice->fine_bits);
	const uint32_t groups = choose_groups(hierarchy, most_triangles);
	const uint32_t triangles = cut_triangles(hierarchy, groups);
	const int zeros = zeros_for(lattice, cut_error_m(hierarchy, groups));
	struct soup soup;
	int rc = soup_init(&soup, triangles);

	out->group_count = groups;
	out->vertices = malloc((3 * (size_t)triangles + 1) * sizeof(*out->vertices));
	out->triangles = malloc(((size_t)triangles + 1) * sizeof(*out->triangles));
	if (!out->vertices || !out->triangles)
		rc = -ENOMEM;
	for (uint32_t g = 0; rc == 0 && g < groups; g++)
		rc = add_group(&soup, objects, page->children[g].hash,
			       &hierarchy->patches[hierarchy->groups[g].first_patch], groups,
			       3 * triangles);
	for (uint32_t i = 0; rc == 0 && i < soup.count; i++)
		precision_round_position(soup.corners[i].position, zeros, places);
	if (rc == 0) {
		merge(&soup, out);
		take_triangles(out, soup.numbers, soup.count);
	}
	soup_finish(&soup);
	return rc;
}

int stream_cut_read(struct stream_cut *out, struct object_store *objects,
		    const struct lattice *lattice, const struct page_child *hierarchy,
		    uint32_t most_triangles)
{
	struct hierarchy decoded = { 0 };
	struct page page;
	struct buffer bytes;
	int rc = object_store_read_page(objects, hierarchy, &page, &bytes);

	*out = (struct stream_cut){ 0 };
	if (rc == 0)
		rc = hierarchy_decode(&decoded, page.payload);
	if (rc == 0)
		rc = read_cut(out, objects, lattice, &page, &decoded, most_triangles);
	hierarchy_finish(&decoded);
	page_finish(&page);
	buffer_finish(&bytes);
	if (rc < 0)
		stream_cut_finish(out);
	return rc;
}

void stream_cut_finish(struct stream_cut *cut)
{
	free(cut->vertices);
	free(cut->triangles);
	*cut = (struct stream_cut){ 0 };
}

/* ---- the page */

/* Divides the stream: its first part goes on the page, each further one is a child. */
static int add_page(struct object_store *objects, const struct stream_cut *cut,
		    const struct stream_stats *stats, const struct lattice *lattice,
		    struct bytes stream, struct page_child *out)
{
	const uint32_t blocks = stream_block_count(stats->record_count);
	struct page_child *children = calloc((size_t)blocks + 1, sizeof(*children));
	float *errors_m = calloc((size_t)blocks + 1, sizeof(*errors_m));
	struct page page = { .kind = PAGE_STREAM, .child_count = blocks, .children = children };
	struct bytes start = { stream.data, stream_start_bytes(stream) };
	struct buffer payload;
	size_t at = start.size;
	int rc = children && errors_m ? 0 : -ENOMEM;

	buffer_init(&payload, PAGE_BYTES_MAX);
	for (uint32_t i = 0; rc == 0 && i < blocks; i++) {
		struct bytes left = { stream.data + at, stream.size - at };
		struct bytes block = { left.data, stream_block_bytes(left) };

		rc = object_store_add(objects, block, &children[i]);
		at += block.size;
	}
	for (uint32_t i = 0; rc == 0 && i <= blocks; i++)
		errors_m[i] = (float)(stats->errors[i] * lattice->step_m);
	if (rc == 0) {
		stream_page_encode(&payload, cut->group_count, errors_m, blocks, start);
		page.payload = buffer_bytes(&payload);
		rc = payload.error ? payload.error : object_store_add_page(objects, &page, out);
	}
	buffer_finish(&payload);
	free(children);
	free(errors_m);
	return rc;
}

const struct stream_options stream_publish_options = { .base_vertices = 512, .loose = true };

int publish_stream(struct object_store *objects, const struct lattice *lattice,
		   const struct page_child *hierarchy, struct page_child *out)
{
	struct stream_cut cut = { 0 };
	struct stream_stats *stats = calloc(1, sizeof(*stats));
	struct buffer stream;
	int rc = stats ? stream_cut_read(&cut, objects, lattice, hierarchy, STREAM_CUT_TRIANGLES)
		       : -ENOMEM;

	buffer_init(&stream, OBJECT_BYTES_MAX);
	if (rc == 0 && cut.triangle_count > 0 && cut.vertex_count <= STREAM_PAGE_VERTICES_MAX) {
		rc = stream_make(&stream, stats, cut.vertices, cut.vertex_count,
				 (const uint32_t(*)[3])cut.triangles, cut.triangle_count,
				 &stream_publish_options);
		if (rc == 0)
			rc = add_page(objects, &cut, stats, lattice, buffer_bytes(&stream), out);
		if (rc == 0)
			rc = 1;
	}
	stream_cut_finish(&cut);
	if (rc == -EINVAL) {
		log_warn("pipeline", "the coarse cut cannot be encoded as a streaming mesh, so the "
				     "release has none");
		rc = 0;
	}
	if (rc < 0)
		log_error("pipeline", "the streaming mesh: %s", strerror(-rc));
	buffer_finish(&stream);
	free(stats);
	return rc;
}
