/* Renders one face of one sampling point, fills its background, cuts it into tiles at every level
 * and encodes them (docs/samples.md). If there are textures, call everything from the thread that
 * owns the GL context; otherwise no context is needed. */
#ifndef GOPURA_PIPELINE_SAMPLES_FACE_RENDERER_H
#define GOPURA_PIPELINE_SAMPLES_FACE_RENDERER_H

#include "format/samples.h"
#include "format/tile.h"
#include "pipeline/samples/drawing.h"
#include "pipeline/samples/pyramid.h"
#include "pipeline/samples/sample_store.h"

struct face_renderer_options {
	struct model *model;                 /* borrowed for the renderer's lifetime */
	const struct mesh_texture *textures; /* borrowed while the renderer is made */
	uint32_t texture_count;
	struct drawing_options drawn;
	uint32_t level_count; /* 1 .. SAMPLE_LEVELS_MAX */
	/* of tile_encode */
	int quality; /* 1..100 */
	enum tile_effort effort;
	/* As in sample_grid: more than one quality instead, and whether feature points are counted
	 * (of scans without pictures only). */
	uint32_t choice_count;
	uint8_t qualities[SAMPLE_CHOICES_MAX];
	uint32_t scale_count;
};

struct shot {
	uint64_t covered,
		backs;     /* rendered samples that show anything, and those that show a back */
	uint16_t coverage; /* as in brick_page; 0: nothing shows, and there are no tiles */
	/* As in brick_page. */
	float near_m, far_m;
	uint32_t tile_count;
	uint16_t tiles[FACE_TILES_MAX]; /* face_tile_index of each, ascending */
	/* Where each tile ends in objects at each quality, tile by tile. */
	uint32_t end_of[FACE_TILES_MAX * SAMPLE_CHOICES_MAX];
	uint32_t features[FACE_TILES_MAX][SAMPLE_SCALES_MAX]; /* of each tile */
	/* With more than one quality, as in sample_face. */
	uint16_t windows[FACE_TILES_MAX];
	uint32_t losses[FACE_TILES_MAX * SAMPLE_CHOICES_MAX];
	struct buffer objects; /* owned; the encoded tiles one after the other */
};

struct face_renderer;

/* *out is owned by the caller; NULL on failure. Returns -ENOMEM or the errors of GL. */
must_check int face_renderer_create(struct face_renderer **out,
				    const struct face_renderer_options *options);
void face_renderer_destroy(struct face_renderer *renderer); /* NULL is fine */

/* Returns what chooses the pieces that are drawn: call sight_look for each point first. Borrowed
 * for the renderer's lifetime. */
struct sight *face_renderer_sight(struct face_renderer *renderer);

/* Prepares an empty shot. */
void shot_init(struct shot *shot);
/* Frees the encoded tiles. */
void shot_finish(struct shot *shot);
/* Renders a face (0..5, format/cube.h) at point_m into shot, which may have been used before. What
 * shows nothing has the colour of the background (sRGB), or without one the colours nearby. Returns
 * -ENOMEM, or the errors of GL and the encoder. */
must_check int face_renderer_take(struct face_renderer *renderer, struct shot *shot,
				  const float point_m[3], int face, const uint8_t *background);

#endif
