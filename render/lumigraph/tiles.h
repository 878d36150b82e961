/* Image tiles on the GPU as a virtual texture for GLES2's eight units.
 *
 * Tiles lie in an atlas of slots. A face of a sampling point that has any tile owns a face slot:
 * 32 x 32 cells of an indirection texture, each naming the finest tile that covers it (atlas
 * column, row, tiles a side at its level, weight while it fades in), and a square of the depth
 * atlas (render/lumigraph/depth.h) of the same number. Past the budgets the face or tile used
 * longest ago goes first, never one that is in use now. */
#ifndef GOPURA_RENDER_LUMIGRAPH_TILES_H
#define GOPURA_RENDER_LUMIGRAPH_TILES_H

#include "render/display/gl.h"
#include "render/lumigraph/aim.h"
#include "render/plan/repository.h"

enum {
	TILES_CELLS = AIM_CELLS, /* a side: tiles of the finest level */
	TILES_FACES_MAX = 64,
	TILES_FADE_MS = 250,
};

struct tiles_face {
	face_key key;
	bool used;                    /* holds a face */
	uint32_t stamp;               /* last plan that used it */
	uint32_t tile_count, version; /* version: changes with every tile that comes or goes */
	int8_t level[TILES_CELLS][TILES_CELLS]; /* finest that is there, -1: none; [row][column] */
	uint16_t slot[TILES_CELLS][TILES_CELLS];
	int64_t born_ms[TILES_CELLS][TILES_CELLS];
	bool fading, dirty; /* the indirection texture lags behind */
};

struct tiles {
	GLuint atlas, indirection;
	int atlas_px, slots_across; /* the atlas is square */
	bool repeats;               /* without highp, so that coordinates are near 0 */
	int slots_before;           /* 0, a side: of those across */
	uint32_t slot_count;
	uint32_t faces_across, face_rows, face_count; /* slots of faces */
	/* Private. */
	uint64_t *slot_name; /* packed tile name + 1; 0: free. Owned, like all below. */
	uint32_t *slot_stamp;
	struct tiles_face *faces;
	uint32_t *slot_season; /* when it came */
	uint32_t season;
	struct map declined; /* tiles that came and went within a season */
	struct map slot_of, face_of;
	uint32_t stamp, version;
	face_key *keys; /* of the faces in use, dense */
	uint32_t key_count;
};

/* budget_bytes: for the atlas (3 bytes a pixel) alone. Rows of face slots: at most
 * TILES_FACES_MAX in all. */
must_check int tiles_init(struct tiles *tiles, uint64_t budget_bytes, uint32_t faces_across,
			  uint32_t face_rows);
void tiles_finish(struct tiles *tiles);
void tiles_clear(struct tiles *tiles); /* forgets all, keeps the textures */

/* A new round of use: what is not touched from here on may go. */
void tiles_begin(struct tiles *tiles);
/* Marks a resident face, and its tiles under the rectangle (-1..1), as in use. */
void tiles_touch(struct tiles *tiles, face_key face, float u0, float v0, float u1, float v1);

/* Uploaded and resident; whether it is in use does not matter. */
bool tiles_has(const struct tiles *tiles, struct tile_name name);
/* Uploads. -ENOSPC: everything there is in use. */
must_check int tiles_put(struct tiles *tiles, struct tile_name name, const uint8_t *rgb);
/* Face slot, -1: no tile of it is there. */
int tiles_face_slot(const struct tiles *tiles, face_key face);
/* Finest level at a place of a face (-1..1), -1: none. */
int tiles_level_at(const struct tiles *tiles, face_key face, float u, float v);
/* More is in use than there is room for: a tile that came and had to go again within a season, or
 * found no room, is not worth fetching until the next one. */
void tiles_begin_season(struct tiles *tiles);
bool tiles_is_declined(const struct tiles *tiles, struct tile_name name);
/* Room for so many more tiles without taking one that is in use. */
uint32_t tiles_room(const struct tiles *tiles);
/* Advances fades and uploads what changed. Returns whether any fade runs. */
bool tiles_tick(struct tiles *tiles);

#endif
