/* Worker threads that decode what arrived: tiles into pixels, patch groups into meshes that rays
 * and GPU can use, their labels. One thread gives and takes; answers are told through an eventfd.
 */
#ifndef GOPURA_RENDER_PATCHES_POOL_H
#define GOPURA_RENDER_PATCHES_POOL_H

#include "format/label.h"
#include "format/samples.h"
#include "format/tile.h"
#include "geometry/patch_bvh.h"

enum pool_kind { POOL_TILE, POOL_GROUP, POOL_LABELS };

/* A patch as decoded: mesh and the tree over it. */
struct pool_patch {
	struct patch_mesh mesh;
	struct patch_bvh bvh;
};

struct pool_answer {
	enum pool_kind kind;
	uint64_t id;  /* as given */
	int error;    /* 0, -EBADMSG, -ENOMEM */
	uint8_t *rgb; /* tile: SAMPLE_IMAGE_PX square. Owned by who took the answer, like patches */
	struct pool_patch *patches;
	uint32_t patch_count;
	struct label_group labels;
};

struct pool;

/* Without workers the thread that gives decodes at once: answers come in the order of the gifts. */
must_check int pool_create(struct pool **out, uint32_t worker_count);
void pool_destroy(struct pool *pool); /* waits for the work at hand */

/* Of all patches. Only while idle or after pool_forget. */
void pool_set_lattice(struct pool *pool, const struct lattice *lattice);
/* The object is copied. -ENOMEM. */
must_check int pool_give(struct pool *pool, enum pool_kind kind, uint64_t id, struct bytes object);
/* false: nothing is done. */
bool pool_take(struct pool *pool, struct pool_answer *answer);
void pool_answer_finish(struct pool_answer *answer);
uint32_t pool_busy(const struct pool *pool); /* given and not yet taken */
/* Drops what was given and not taken, waiting for the work at hand. */
void pool_forget(struct pool *pool);
/* Readable from when work was done until pool_quiet. */
int pool_fd(const struct pool *pool);
/* The descriptor is readable no more until another answer comes; answers stay. */
void pool_quiet(struct pool *pool);

#endif
