/* What the patches of a release take: bench_patch MASTER SHARE [ROUNDS], the folder of a master
 * below a content folder's .work and the share of its triangles to publish; 0: the master's own
 * groups. Publishes them into memory, encodes and decodes every group, once as they come from the
 * codec and once as the kiosk makes them ready to draw. Processor time of one thread, the best
 * round of each; JSON to standard output. */
#include <errno.h>
#include <inttypes.h>
#include <meshoptimizer.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "format/patch.h"
#include "pipeline/release/publish_hierarchy.h"
#include "render/patches/pool.h"

enum { ROUNDS = 10, CACHE_VERTICES = 16 };

static void need_ok(int rc, const char *what)
{
	if (rc < 0) {
		fprintf(stderr, "%s: %s\n", what, strerror(-rc));
		exit(EXIT_FAILURE);
	}
}

struct groups {
	struct buffer *objects; /* count of them */
	uint32_t count;
};

static void groups_init(struct groups *groups, uint32_t count)
{
	groups->count = count;
	groups->objects = calloc(count, sizeof(*groups->objects));
	need_ok(groups->objects ? 0 : -ENOMEM, "groups");
	for (uint32_t g = 0; g < count; g++)
		buffer_init(&groups->objects[g], OBJECT_BYTES_MAX);
}

static void read_master(struct groups *groups, const struct master *master)
{
	groups_init(groups, master->hierarchy.group_count);
	for (uint32_t g = 0; g < groups->count; g++)
		need_ok(master_read_group(master, g, &groups->objects[g]), "master");
}

static void read_published(struct groups *groups, const struct master *master, double share)
{
	struct object_store *store;
	struct published_patches published;
	struct page_child child;
	struct buffer object;
	struct page page;

	buffer_init(&object, OBJECT_BYTES_MAX);
	need_ok(object_store_create(&store), "objects");
	need_ok(publish_hierarchy(store, master, share, &child, &published), "publish");
	need_ok(object_store_read(store, child.hash, &object), "page");
	need_ok(page_decode(&page, buffer_bytes(&object)), "page");
	groups_init(groups, page.child_count);
	for (uint32_t g = 0; g < groups->count; g++)
		need_ok(object_store_read(store, page.children[g].hash, &groups->objects[g]),
			"group");
	page_finish(&page);
	buffer_finish(&object);
	object_store_destroy(store);
}

/* Vertices that a cache of CACHE_VERTICES loads for a list of triangles. */
static double loads(const uint16_t *indices, uint32_t triangle_count, uint32_t vertex_count)
{
	unsigned int *wide = malloc(3 * (size_t)triangle_count * sizeof(*wide));
	double count;

	need_ok(wide ? 0 : -ENOMEM, "indices");
	for (uint32_t i = 0; i < 3 * triangle_count; i++)
		wide[i] = indices[i];
	count = meshopt_analyzeVertexCache(wide, 3 * (size_t)triangle_count, vertex_count,
					   CACHE_VERTICES, 0, 0)
			.vertices_transformed;
	free(wide);
	return count;
}

struct figures {
	uint64_t vertices, triangles, bytes;
	int64_t decode_us, encode_us, ready_us;
	double loads, ready_loads;
};

/* One round over all groups: the codec. Counts are the same in every round. */
static void code(struct figures *out, const struct groups *groups)
{
	struct buffer again;

	*out = (struct figures){ 0 };
	buffer_init(&again, OBJECT_BYTES_MAX);
	for (uint32_t g = 0; g < groups->count; g++) {
		struct patch_mesh meshes[GROUP_PATCHES_MAX];
		int64_t start_us = clock_thread_us(), decoded_us;
		uint32_t count;

		need_ok(patch_group_decode(meshes, &count, buffer_bytes(&groups->objects[g])),
			"decode");
		decoded_us = clock_thread_us();
		out->decode_us += decoded_us - start_us;
		buffer_clear(&again);
		need_ok(patch_group_encode(&again, meshes, count), "encode");
		out->encode_us += clock_thread_us() - decoded_us;
		out->bytes += groups->objects[g].size;
		for (uint32_t p = 0; p < count; p++) {
			out->vertices += meshes[p].vertex_count;
			out->triangles += meshes[p].triangle_count;
			out->loads += loads(meshes[p].indices, meshes[p].triangle_count,
					    meshes[p].vertex_count);
			patch_mesh_finish(&meshes[p]);
		}
	}
	buffer_finish(&again);
}

/* One round over all groups: what a worker of the kiosk does with each. */
static void make_ready(struct figures *out, const struct groups *groups, struct pool *pool)
{
	out->ready_us = 0;
	out->ready_loads = 0;
	for (uint32_t g = 0; g < groups->count; g++) {
		int64_t start_us = clock_thread_us();
		struct pool_answer answer;

		need_ok(pool_give(pool, POOL_GROUP, g, buffer_bytes(&groups->objects[g])), "pool");
		out->ready_us += clock_thread_us() - start_us;
		need_ok(pool_take(pool, &answer) ? answer.error : -ENOENT, "pool");
		for (uint32_t p = 0; p < answer.patch_count; p++)
			out->ready_loads += loads(answer.patches[p].mesh.indices,
						  answer.patches[p].mesh.triangle_count,
						  answer.patches[p].mesh.vertex_count);
		pool_answer_finish(&answer);
	}
}

static int64_t sooner(int64_t a_us, int64_t b_us)
{
	return a_us < b_us ? a_us : b_us;
}

int main(int argc, char **argv)
{
	struct figures best = { .decode_us = INT64_MAX }, now;
	struct master *master;
	struct groups groups;
	struct pool *pool;
	double share;

	if (argc < 3) {
		fputs("usage: bench_patch DIR/.work/master SHARE [ROUNDS]\n", stderr);
		return 2;
	}
	need_ok(master_open(&master, argv[1], NULL), argv[1]);
	share = strtod(argv[2], NULL);
	if (share > 0)
		read_published(&groups, master, share);
	else
		read_master(&groups, master);
	need_ok(pool_create(&pool, 0), "pool");
	pool_set_lattice(pool, &master->lattice);
	for (long round = argc > 3 ? strtol(argv[3], NULL, 10) : ROUNDS; round > 0; round--) {
		code(&now, &groups);
		make_ready(&now, &groups, pool);
		if (best.decode_us < INT64_MAX) {
			now.decode_us = sooner(now.decode_us, best.decode_us);
			now.encode_us = sooner(now.encode_us, best.encode_us);
			now.ready_us = sooner(now.ready_us, best.ready_us);
		}
		best = now;
	}
	printf("{\"groups\": %u, \"vertices\": %lu, \"triangles\": %lu, \"bytes\": %lu, "
	       "\"bits_per_vertex\": %.2f,\n \"decode_mtri_per_s\": %.2f, "
	       "\"encode_mtri_per_s\": %.2f, \"ready_mtri_per_s\": %.2f,\n \"loads_per_triangle\": "
	       "%.3f, \"ready_loads_per_triangle\": %.3f}\n",
	       groups.count, best.vertices, best.triangles, best.bytes,
	       8.0 * (double)best.bytes / (double)best.vertices,
	       (double)best.triangles / (double)best.decode_us,
	       (double)best.triangles / (double)best.encode_us,
	       (double)best.triangles / (double)best.ready_us, best.loads / (double)best.triangles,
	       best.ready_loads / (double)best.triangles);
	pool_destroy(pool);
	for (uint32_t g = 0; g < groups.count; g++)
		buffer_finish(&groups.objects[g]);
	free(groups.objects);
	master_destroy(master);
	return EXIT_SUCCESS;
}
