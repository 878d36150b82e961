/* What a streaming mesh takes: bench_stream MASTER SHARE, as bench_patch. Its mesh is the finest
 * level of what is published: all patches that nothing published replaces, their equal vertices
 * merged. Processor time of one thread, the best of several rounds; JSON to standard output. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "format/hierarchy.h"
#include "format/patch.h"
#include "format/stream.h"
#include "pipeline/hierarchy/stream_encode.h"
#include "pipeline/release/publish_hierarchy.h"

enum { ROUNDS = 10 };

static void need_ok(int rc, const char *what)
{
	if (rc < 0) {
		fprintf(stderr, "%s: %s\n", what, strerror(-rc));
		exit(EXIT_FAILURE);
	}
}

struct soup {
	struct patch_vertex *vertices; /* three for each triangle */
	uint32_t *corners, *numbers;
	uint32_t corner_count, vertex_count;
};

static const struct patch_vertex *compared;

static int compare_corners(const void *a, const void *b)
{
	return memcmp(&compared[*(const uint32_t *)a], &compared[*(const uint32_t *)b],
		      sizeof(*compared));
}

static void add_patch(struct soup *soup, const struct patch_mesh *mesh)
{
	for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++)
		soup->vertices[soup->corner_count++] = mesh->vertices[mesh->indices[i]];
}

/* Rounding makes some triangles flat: two of their corners are one vertex. They are left out. */
static void drop_flat(struct soup *soup)
{
	uint32_t kept = 0;

	for (uint32_t i = 0; i < soup->corner_count; i += 3) {
		uint32_t *n = &soup->numbers[i];

		if (n[0] == n[1] || n[1] == n[2] || n[2] == n[0])
			continue;
		memmove(&soup->numbers[kept], n, 3 * sizeof(*n));
		kept += 3;
	}
	soup->corner_count = kept;
}

/* Equal vertices get one number. */
static void merge(struct soup *soup)
{
	struct patch_vertex *merged = calloc(soup->corner_count, sizeof(*merged));

	soup->corners = malloc(soup->corner_count * sizeof(*soup->corners));
	soup->numbers = malloc(soup->corner_count * sizeof(*soup->numbers));
	for (uint32_t i = 0; i < soup->corner_count; i++)
		soup->corners[i] = i;
	compared = soup->vertices;
	qsort(soup->corners, soup->corner_count, sizeof(*soup->corners), compare_corners);
	for (uint32_t i = 0; i < soup->corner_count; i++) {
		if (i == 0 || compare_corners(&soup->corners[i - 1], &soup->corners[i]) != 0)
			merged[soup->vertex_count++] = soup->vertices[soup->corners[i]];
		soup->numbers[soup->corners[i]] = soup->vertex_count - 1;
	}
	free(soup->vertices);
	soup->vertices = merged;
}

static void read_published(struct soup *soup, const struct master *master, double share)
{
	struct object_store *store;
	struct published_patches published;
	struct hierarchy hierarchy;
	struct page_child child;
	struct buffer object;
	struct page page;

	buffer_init(&object, OBJECT_BYTES_MAX);
	need_ok(object_store_create(&store), "objects");
	need_ok(publish_hierarchy(store, master, share, &child, &published), "publish");
	need_ok(object_store_read(store, child.hash, &object), "page");
	need_ok(page_decode(&page, buffer_bytes(&object)), "page");
	need_ok(hierarchy_decode(&hierarchy, page.payload), "hierarchy");
	soup->vertices = calloc(3 * published.triangle_count, sizeof(*soup->vertices));
	for (uint32_t g = 0; g < hierarchy.group_count; g++) {
		struct patch_mesh meshes[GROUP_PATCHES_MAX];
		uint32_t count;

		buffer_clear(&object);
		need_ok(object_store_read(store, page.children[g].hash, &object), "group");
		need_ok(patch_group_decode(meshes, &count, buffer_bytes(&object)), "decode");
		for (uint32_t p = 0; p < count; p++) {
			if (hierarchy.patches[hierarchy.groups[g].first_patch + p].finer ==
			    HIERARCHY_NONE)
				add_patch(soup, &meshes[p]);
			patch_mesh_finish(&meshes[p]);
		}
	}
	hierarchy_finish(&hierarchy);
	page_finish(&page);
	buffer_finish(&object);
	object_store_destroy(store);
}

int main(int argc, char **argv)
{
	int64_t best[3] = { INT64_MAX, INT64_MAX, INT64_MAX }, encode_us;
	struct soup soup = { 0 };
	struct stream_stats stats;
	struct master *master;
	struct buffer out;
	double base_bytes;

	if (argc != 3) {
		fprintf(stderr, "usage: bench_stream MASTER SHARE\n");
		return EXIT_FAILURE;
	}
	need_ok(master_open(&master, argv[1], NULL), argv[1]);
	read_published(&soup, master, strtod(argv[2], NULL));
	merge(&soup);
	drop_flat(&soup);
	buffer_init(&out, OBJECT_BYTES_MAX);
	encode_us = clock_thread_us();
	need_ok(stream_make(&out, &stats, soup.vertices, soup.vertex_count,
			    (const uint32_t(*)[3])soup.numbers, soup.corner_count / 3),
		"stream");
	encode_us = clock_thread_us() - encode_us;
	for (int round = 0; round < ROUNDS; round++) {
		struct stream_decoder *decoder;
		int64_t at_us[4];

		need_ok(stream_decoder_create(&decoder), "decoder");
		at_us[0] = clock_thread_us();
		need_ok(stream_decoder_advance(decoder, buffer_bytes(&out)), "decode");
		at_us[1] = clock_thread_us();
		stream_decoder_show(decoder, 0);
		at_us[2] = clock_thread_us();
		stream_decoder_show(decoder, stats.record_count);
		at_us[3] = clock_thread_us();
		for (int i = 0; i < 3; i++)
			if (at_us[i + 1] - at_us[i] < best[i])
				best[i] = at_us[i + 1] - at_us[i];
		stream_decoder_destroy(decoder);
	}
	/* The base is the first block, after the header. */
	base_bytes = 37.0 + 16 + out.data[37] + (out.data[38] << 8) + (out.data[39] << 16);
	printf("{\"vertices\": %" PRIu32 ", \"triangles\": %" PRIu32 ", \"base_vertices\": %" PRIu32
	       ", \"base_triangles\": %" PRIu32 ", \"records\": %" PRIu32 ", \"pieces\": %" PRIu32
	       ", \"bytes\": %zu, \"base_bytes\": %.0f, \"bytes_a_record\": %.2f, "
	       "\"bytes_a_record_before_coding\": %d, \"decoded_and_applied_per_s\": %.0f, "
	       "\"undone_per_s\": %.0f, \"applied_per_s\": %.0f, \"encode_s\": %.2f}\n",
	       soup.vertex_count, soup.corner_count / 3, stats.base_vertices, stats.base_triangles,
	       stats.record_count, stats.piece_count, out.size, base_bytes,
	       ((double)out.size - base_bytes) / stats.record_count, STREAM_RECORD_BYTES,
	       1e6 * stats.record_count / (double)best[0],
	       1e6 * stats.record_count / (double)best[1],
	       1e6 * stats.record_count / (double)best[2], (double)encode_us / 1e6);
	return EXIT_SUCCESS;
}
