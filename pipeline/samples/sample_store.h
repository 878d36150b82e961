/* The rendered samples of a content folder, DIR/.work/samples/: one file `grid`, and one file per
 * sampling point. Files are written completely or not at all. So sampling can be stopped at any
 * time, resumed, and shared by many machines on one file system. Every file carries the key of its
 * sources (a hash of geometry and settings); files with another key count as missing.
 *
 * The sampler writes with put; the publisher reads with open and next. docs/samples.md describes
 * the bytes. One thread per store; several processes may put different points at once. */
#ifndef GOPURA_PIPELINE_SAMPLES_SAMPLE_STORE_H
#define GOPURA_PIPELINE_SAMPLES_SAMPLE_STORE_H

#include <sys/stat.h>

#include "format/hash.h"
#include "format/samples.h"

/* What was found at a sampling point. */
enum sample_state {
	SAMPLE_RENDERED,
	SAMPLE_EMPTY,  /* nothing of the model in any face */
	SAMPLE_INSIDE, /* inside solid matter */
	SAMPLE_GROUND, /* below the ground */
	SAMPLE_STATES
};

enum { SAMPLE_CHOICES_MAX = 5, SAMPLE_SCALES_MAX = 5 };

struct sample_grid {
	float origin_m[3], spacing_m[3];
	uint32_t count[3];    /* points per axis, 1 .. SAMPLE_GRID_MAX */
	uint32_t level_count; /* levels of a face */
	/* Vantage points (format/samples.h). */
	uint32_t vantage_count; /* 0 .. SAMPLE_VANTAGES_MAX */
	float vantage_m[SAMPLE_VANTAGES_MAX][3];
	uint8_t background[3]; /* of what they see, sRGB */
	/* For a release that has to meet a number of bytes, each tile is stored at several
	 * qualities, ascending, of which one is published. 0 or 1: there is one, no choice. */
	uint32_t choice_count;
	uint8_t qualities[SAMPLE_CHOICES_MAX]; /* 1..100; valid if there is a choice */
	/* With a choice: scales at which the feature points of tiles were counted; 0: they were
	 * not. */
	uint32_t scale_count;
};

/* Returns how many points there are: those of the grid, then the vantage points. */
uint32_t sample_grid_points(const struct sample_grid *grid);
/* Sets out to the n-th of them: x, y, z on the grid. Vantage points are those of one more brick, on
 * top of the first. */
void sample_grid_point(const struct sample_grid *grid, uint32_t n, uint32_t out[3]);
/* The inverse. The point must exist. */
uint32_t sample_grid_number(const struct sample_grid *grid, const uint32_t point[3]);
/* Returns the number of a vantage point, or -1 for a point of the grid. */
int sample_grid_vantage(const struct sample_grid *grid, const uint32_t point[3]);

/* One face that shows something of the model. */
struct sample_face {
	uint32_t point[3]; /* see sample_grid_point */
	int face;
	uint32_t level_count;
	uint16_t coverage;     /* as in brick_page; never 0 */
	float near_m, far_m;   /* as in brick_page */
	uint32_t tile_count;   /* at least 1 */
	const uint16_t *tiles; /* face_tile_index of each, ascending; borrowed */
	/* For samples_store_put: encoded tiles, each at all qualities of the grid, one after the
	 * other; borrowed. */
	const struct bytes *objects;
	/* Feature points of each tile at each scale of the grid; borrowed; NULL: no scales. */
	const uint32_t (*features)[SAMPLE_SCALES_MAX];
	/* With a choice: how many windows of each tile show something, and what is lost of them
	 * (tile_loss.h), [i * SAMPLE_CHOICES_MAX + c]; borrowed. */
	const uint16_t *windows;
	const uint32_t *losses;
	/* Set by samples_store_next instead: hashes and sizes of the encoded tiles, the file that
	 * holds them, and their offsets in it; all borrowed. */
	const struct hash *hashes;
	const uint32_t *sizes;
	const char *path;
	const uint64_t *offsets;
	/* The sizes of tile i at quality c of the grid, [i * SAMPLE_CHOICES_MAX + c]; borrowed. */
	const uint32_t *choice_sizes;
};

struct samples_store;

/* Opens the sampler's results for reading. *out is owned by the caller; NULL on failure. Returns
 * -ENOENT if nothing was sampled or points are still missing, stale or damaged (logged with the
 * remedy); -EBADMSG if `grid` is damaged (logged). A point's file is read only if its size or time
 * is not as `index` says, and `index` is then written anew. */
must_check int samples_store_open(struct samples_store **out, const char *content_dir);
/* NULL is fine. */
void samples_store_close(struct samples_store *store);

/* Borrowed until the store is closed. */
const struct sample_grid *samples_store_grid(const struct samples_store *store);
/* Returns the key of the sources; it changes if anything that was sampled changes. */
struct hash samples_store_key(const struct samples_store *store);

/* Gives the next face: brick by brick (order z, y, x, the last runs fastest), in a brick point by
 * point (likewise), then by face. So a brick page and its face pages can be written as they come.
 * Returns 1 if *out is set, borrowed until the next call; 0 at the end. */
must_check int samples_store_next(struct samples_store *store, struct sample_face *out);
/* Starts again with the first face. */
void samples_store_rewind(struct samples_store *store);
/* Returns the state of a point of a store that samples_store_open has opened. */
enum sample_state samples_store_state(const struct samples_store *store, const uint32_t point[3]);
/* Chooses a quality of the grid for each tile, counted in the order of samples_store_next, which
 * then gives those. At first they are those that were kept, or else the best. choices are copied.
 * Returns -ENOMEM. */
must_check int samples_store_choose(struct samples_store *store, const uint8_t *choices,
				    uint32_t count);
/* Keeps what was chosen for the next samples_store_open, in the file `chosen`. Errors of the disk.
 */
must_check int samples_store_keep_choice(const struct samples_store *store);
/* Counts the points in each state, for reports. */
void samples_store_states(const struct samples_store *store, uint32_t counts[SAMPLE_STATES]);

/* ---- for the sampler */

/* Writes `grid`, unless it has the same bytes already. Creates the folders. */
must_check int samples_store_begin(const char *content_dir, const struct sample_grid *grid,
				   struct hash key);
/* Removes the files of points that the grid does not have, those of other first views and of a grid
 * with more points. Nothing else is touched; what cannot be removed stays. */
void samples_store_sweep(const char *content_dir, const struct sample_grid *grid);
/* Opens the store though points may be missing, and looks at none of them. Errors as above. */
must_check int samples_store_look(struct samples_store **out, const char *content_dir);
/* Returns true if the point's file exists, is complete and has the key of the grid. */
bool samples_store_has(struct samples_store *store, const uint32_t point[3]);
/* Gets the size and the time of change of a point's file. -ENOENT and other errors of stat. */
must_check int samples_store_stat(const struct samples_store *store, const uint32_t point[3],
				  struct stat *out);
/* Writes the file of a point of this grid. faces: face_count of them, in ascending order of face,
 * for SAMPLE_RENDERED; none for other states. */
must_check int samples_store_put(const char *content_dir, struct hash key,
				 const struct sample_grid *grid, enum sample_state state,
				 const uint32_t point[3], const struct sample_face *faces,
				 uint32_t face_count);

#endif
