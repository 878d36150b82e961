/* The rendered samples of a content folder, DIR/.work/samples/: one file `grid`, and one file a
 * sampling point, written whole or not at all, so that sampling can be stopped anywhere, resumed,
 * and done by many machines on one file system. Every file carries the key of what it was made
 * from (hash of geometry and settings); files of another key count as not there.
 *
 * The sampler writes with put, the publisher reads with open and next. docs/samples.md has the
 * bytes. One thread a store; several processes may put different points at once. */
#ifndef GOPURA_PIPELINE_SAMPLES_SAMPLE_STORE_H
#define GOPURA_PIPELINE_SAMPLES_SAMPLE_STORE_H

#include "format/hash.h"
#include "format/samples.h"

/* What was found at a sampling point. */
enum sample_state {
	SAMPLE_RENDERED,
	SAMPLE_EMPTY,  /* nothing of the model in any face */
	SAMPLE_INSIDE, /* in solid matter */
	SAMPLE_GROUND, /* below it */
	SAMPLE_STATES
};

struct sample_grid {
	float origin_m[3], spacing_m[3];
	uint32_t count[3];    /* points a side, 1 .. SAMPLE_GRID_MAX */
	uint32_t level_count; /* of the finest face */
};

/* One face that shows something of the model. */
struct sample_face {
	uint32_t point[3]; /* x, y, z on the grid */
	int face;
	uint32_t level_count;
	uint16_t coverage;           /* as brick_page.coverage; never 0 */
	float near_m, far_m;         /* as brick_page.near_m */
	uint32_t tile_count;         /* at least 1 */
	const uint16_t *tiles;       /* face_tile_index of each, rising; borrowed */
	const struct bytes *objects; /* encoded tiles; borrowed */
	/* From samples_store_next: the file the tiles lie in, and where; both borrowed. */
	const char *path;
	const uint64_t *offsets;
};

struct samples_store;

/* Opens what the sampler left for reading. *out is NULL on failure. -ENOENT: nothing was sampled,
 * or points are missing still (logged with the cure). -EBADMSG: damaged (logged). */
must_check int samples_store_open(struct samples_store **out, const char *content_dir);
/* NULL is fine. */
void samples_store_close(struct samples_store *store);

const struct sample_grid *samples_store_grid(const struct samples_store *store);
/* Changes when anything that was sampled changes. */
struct hash samples_store_key(const struct samples_store *store);

/* The next face: brick by brick (bricks z, y, x, the last runs fastest), in a brick point by point
 * (likewise), then by face; so a brick page and its face pages can be written as they come. 1: *out
 * is set, borrowed until the next call. 0: that was all. -EBADMSG: a file is damaged (logged with
 * its name; `sample` makes it anew). */
must_check int samples_store_next(struct samples_store *store, struct sample_face *out);
/* From the first face again. */
void samples_store_rewind(struct samples_store *store);
/* How many points are in each state; for reports. */
void samples_store_states(const struct samples_store *store, uint32_t counts[SAMPLE_STATES]);

/* ---- the sampler's side */

/* Writes `grid`, unless one of the same bytes is there. */
must_check int samples_store_begin(const char *content_dir, const struct sample_grid *grid,
				   struct hash key);
/* Is the point there, whole, with that key? */
bool samples_store_has(const char *content_dir, const uint32_t point[3], struct hash key);
/* faces: face_count of them, by rising face, for SAMPLE_RENDERED; none for other states. */
must_check int samples_store_put(const char *content_dir, struct hash key, enum sample_state state,
				 const uint32_t point[3], const struct sample_face *faces,
				 uint32_t face_count);

#endif
