/* Takes one face of one sampling point: renders it, fills the background, cuts it into tiles at
 * every level and encodes them (docs/samples.md). Every call is from the thread that owns the GL
 * context. */
#ifndef GOPURA_PIPELINE_SAMPLES_FACE_RENDERER_H
#define GOPURA_PIPELINE_SAMPLES_FACE_RENDERER_H

#include "format/samples.h"
#include "format/tile.h"
#include "pipeline/samples/drawing.h"
#include "pipeline/samples/pyramid.h"

struct face_renderer_options {
	struct drawing *drawing;      /* borrowed for as long as the shooter lives */
	struct drawing_options drawn; /* what it was made with: surfaces if procedural */
	uint32_t level_count;         /* 1 .. SAMPLE_LEVELS_MAX */
	int quality;
};

struct shot {
	uint64_t covered, backs; /* rendered pixels that show anything, and that show its back */
	uint16_t coverage;       /* as brick_page.coverage; 0: nothing, and no tiles */
	float near_m, far_m;
	uint32_t tile_count;
	uint16_t tiles[FACE_TILES_MAX];  /* face_tile_index, rising */
	uint32_t end_of[FACE_TILES_MAX]; /* in objects: where each tile's bytes end */
	struct buffer objects;           /* encoded tiles, one after another; owned */
};

struct face_renderer;

must_check int face_renderer_create(struct face_renderer **out,
				    const struct face_renderer_options *options);
void face_renderer_destroy(struct face_renderer *renderer); /* NULL is fine */

void shot_init(struct shot *shot);
void shot_finish(struct shot *shot);
/* Into shot, which may have been used before. */
must_check int face_renderer_take(struct face_renderer *renderer, struct shot *shot,
				  const float point_m[3], int face);

#endif
