/* Image tiles on the GPU as a virtual texture, within the eight texture units of GLES2.
 *
 * Tiles lie in the slots of an atlas. A face of a sampling point that has any tile owns a face
 * slot: 32 x 32 cells of an indirection texture, and a square of the depth sheets
 * (render/lumigraph/depth.h) with the same number. Each cell names the finest tile that covers it
 * (atlas column and row, tiles per side at its level, and a weight while it fades in). Over the
 * budget, the face or tile used longest ago is dropped first, never one that is in use now. One
 * thread, with a current GL context. */
#ifndef GOPURA_RENDER_LUMIGRAPH_TILES_H
#define GOPURA_RENDER_LUMIGRAPH_TILES_H

#include "render/display/gl.h"
#include "render/lumigraph/aim.h"
#include "render/plan/repository.h"

enum {
	TILES_CELLS = AIM_CELLS, /* cells per side; as many as tiles of the finest level */
	TILES_FACES_MAX = 64,
	TILES_FADE_MS = 250,
	TILES_CONSTANTS_BYTES = 256,
};

struct tiles_face {
	face_key key;
	bool used;                    /* the slot holds a face */
	uint32_t stamp;               /* last round (tiles_begin) that used it */
	uint32_t tile_count, version; /* version changes with every tile that comes or goes */
	int8_t level[TILES_CELLS][TILES_CELLS]; /* finest level there, -1: none; [row][column] */
	uint16_t slot[TILES_CELLS][TILES_CELLS];
	int64_t born_ms[TILES_CELLS][TILES_CELLS];
	bool fading, dirty; /* the indirection texture must be updated */
};

struct tiles {
	GLuint atlas; /* 0: not made, because there was no tile yet */
	GLuint indirection;
	int atlas_px, slots_across; /* the atlas is square */
	bool repeats;               /* it repeats; without highp, to keep coordinates near 0 */
	int slots_before;           /* slots per side at negative coordinates; 0 with highp */
	uint32_t slot_count;
	uint32_t faces_across, face_rows, face_count; /* face slots */
	uint32_t version; /* changes with every tile that comes or goes */
	/* Private. */
	uint64_t *slot_name; /* packed tile name + 1; 0: free. Owned, like all below. */
	uint32_t *slot_stamp;
	struct tiles_face *faces;
	uint32_t *slot_season; /* season in which it came */
	uint32_t season;
	struct map declined; /* tiles that came and went within a season, or found no room */
	struct map slot_of, face_of;
	uint32_t stamp;
	face_key *keys; /* the faces in use, without gaps */
	uint32_t key_count;
};

/* Allocates the face slots; the atlas comes with the first tile. budget_bytes is for it alone,
 * counted as 4 bytes a pixel; it holds at least 4 x 4 slots. faces_across x face_rows is at most
 * TILES_FACES_MAX. -ENOMEM, or as gl_texture_create. */
must_check int tiles_init(struct tiles *tiles, uint64_t budget_bytes, uint32_t faces_across,
			  uint32_t face_rows);
/* Frees everything; zeroed is fine. */
void tiles_finish(struct tiles *tiles);
void tiles_clear(struct tiles *tiles); /* Drops all tiles and faces and keeps the textures. */

/* Writes the definitions with which a shader looks up a tile: CELLS a side of a face; CELL_GRID,
 * the cells of the indirection texture; IMAGE, APRON and TILE, sides within a slot, as shares of
 * the atlas; MIDDLE, slots before coordinate 0. */
void tiles_constants(char out[TILES_CONSTANTS_BYTES], const struct tiles *tiles);

/* Starts a new round of use: what is not touched from now on may be dropped. */
void tiles_begin(struct tiles *tiles);
/* Marks a resident face, and its tiles under the rectangle (-1..1), as in use. */
void tiles_touch(struct tiles *tiles, face_key face, float u0, float v0, float u1, float v1);

/* Returns whether a tile is resident, in use or not. */
bool tiles_has(const struct tiles *tiles, struct tile_name name);
/* Uploads a tile: rgb is SAMPLE_IMAGE_PX square, 3 bytes a pixel. A resident tile is ignored.
 * -ENOSPC: everything there is in use; or the atlas could not be made, as gl_texture_create. Then
 * it is declined. */
must_check int tiles_put(struct tiles *tiles, struct tile_name name, const uint8_t *rgb);
/* Returns the slot of a face, -1: none of its tiles is resident. */
int tiles_face_slot(const struct tiles *tiles, face_key face);
/* Returns the finest level at a place of a face (-1..1), -1: none. */
int tiles_level_at(const struct tiles *tiles, face_key face, float u, float v);
/* Starts a new season. A tile that came and was dropped within one season, or found no room, is
 * declined: it is not worth fetching until the next season, because more is in use than fits. */
void tiles_begin_season(struct tiles *tiles);
/* Returns whether a tile was declined in this season. */
bool tiles_is_declined(const struct tiles *tiles, struct tile_name name);
/* Returns how many more tiles fit without dropping one that is in use. */
uint32_t tiles_room(const struct tiles *tiles);
/* Advances fades and uploads changed cells. Returns whether any fade is in progress. */
bool tiles_tick(struct tiles *tiles);

#endif
