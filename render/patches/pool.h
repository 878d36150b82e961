/* Worker threads that decode objects: tiles into pixels, patch groups into meshes with a BVH,
 * labels, scenery, and the octree of where an eye may be. One thread gives and takes; an eventfd
 * reports answers. */
#ifndef GOPURA_RENDER_PATCHES_POOL_H
#define GOPURA_RENDER_PATCHES_POOL_H

#include "format/label.h"
#include "format/samples.h"
#include "format/scenery.h"
#include "format/solid.h"
#include "format/tile.h"
#include "geometry/patch_bvh.h"

enum pool_kind { POOL_TILE, POOL_GROUP, POOL_LABELS, POOL_SOLID, POOL_SCENERY };

/* A vertex as uploaded to the GPU: 12 bytes. */
struct packed_vertex {
	uint16_t position[3]; /* steps from the base of the BVH; 0 in a wide patch, see bvh.wide */
	int8_t normal[2];
	uint8_t colour[4];
};
_Static_assert(sizeof(struct packed_vertex) == 12, "the stride on the GPU");

/* A decoded patch: its mesh, whose vertices are packed, and the BVH over it. */
struct pool_patch {
	struct patch_mesh mesh;         /* its vertices are NULL */
	struct packed_vertex *vertices; /* owned; NULL after the upload */
	struct patch_bvh bvh;
};

/* Frees everything. Zeroed is fine. */
void pool_patch_finish(struct pool_patch *patch);

struct pool_answer {
	enum pool_kind kind;
	uint64_t id; /* as passed to pool_give */
	int error;   /* 0, -EBADMSG, -ENOMEM */
	/* tile: SAMPLE_IMAGE_PX square, 3 bytes a pixel. Owned by whoever took the answer, as is
	 * everything else. */
	uint8_t *rgb;
	struct pool_patch *patches;
	uint32_t patch_count;
	struct label_group labels;
	struct solid solid;
	struct scenery scenery;
};

struct pool;

/* Creates the pool with at most 16 threads. With worker_count 0 pool_give decodes at once, and
 * answers come in the order of the calls. The caller owns *out; it is NULL on failure. -ENOMEM, or
 * what eventfd and pthread_create report. */
must_check int pool_create(struct pool **out, uint32_t worker_count);
/* Waits for the jobs in progress and drops all others. NULL is fine. */
void pool_destroy(struct pool *pool);

/* Sets the lattice of all patches. Call it only while the pool is idle or after pool_forget. */
void pool_set_lattice(struct pool *pool, const struct lattice *lattice);
/* Queues an object for decoding; it is copied. id is returned with the answer. -ENOMEM. */
must_check int pool_give(struct pool *pool, enum pool_kind kind, uint64_t id, struct bytes object);
/* Takes the next answer; the caller then owns its contents. Returns false where none is ready. */
bool pool_take(struct pool *pool, struct pool_answer *answer);
/* Frees the contents of an answer; a zeroed one is fine. */
void pool_answer_finish(struct pool_answer *answer);
/* Returns how many objects were given and not yet taken. */
uint32_t pool_busy(const struct pool *pool);
/* Drops everything given and not taken; it waits for the jobs in progress. */
void pool_forget(struct pool *pool);
/* Returns a descriptor, borrowed, that is readable from the end of a job until pool_quiet. */
int pool_fd(const struct pool *pool);
/* Resets the descriptor until another answer comes; the answers stay. */
void pool_quiet(struct pool *pool);

#endif
