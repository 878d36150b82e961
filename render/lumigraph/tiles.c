/* Manages the slots of the atlas and of the faces, and keeps the indirection texture up to date. */
#include "render/lumigraph/tiles.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"

#define NO_SLOT UINT32_MAX

/* With the first tile, not at the start: a driver that draws on the processor fills it with zeros,
 * which takes longer than the first picture. */
static int make_atlas(struct tiles *tiles)
{
	const struct gl_texture_options atlas = { .width_px = tiles->atlas_px,
						  .height_px = tiles->atlas_px,
						  .format = GL_RGB,
						  .filter = GL_LINEAR,
						  .repeat = tiles->repeats };
	return tiles->atlas ? 0 : gl_texture_create(&tiles->atlas, &atlas);
}

static int make_indirection(struct tiles *tiles)
{
	const struct gl_texture_options indirection = {
		.width_px = TILES_CELLS * (int)tiles->faces_across,
		.height_px = TILES_CELLS * (int)tiles->face_rows,
		.format = GL_RGBA,
		.filter = GL_NEAREST,
	};
	return gl_texture_create(&tiles->indirection, &indirection);
}

/* Drivers store RGB with four bytes a pixel. */
static bool fits(int side_px, uint64_t budget_bytes)
{
	return 4ull * (uint64_t)side_px * (uint64_t)side_px <= budget_bytes;
}

/* Chooses as many slots as board and budget allow, at least four in a row. */
static void choose_size(struct tiles *tiles, uint64_t budget_bytes)
{
	enum { LEAST = 4 };
	int side_px = gl_texture_most_px();
	tiles->repeats = !gl_has_highp();
	if (tiles->repeats) {
		while (side_px / 2 >= LEAST * SAMPLE_IMAGE_PX && !fits(side_px, budget_bytes))
			side_px /= 2;
		tiles->slots_before = side_px / 2 / SAMPLE_IMAGE_PX;
		tiles->slots_across = 2 * tiles->slots_before;
		tiles->atlas_px = side_px;
		return;
	}
	tiles->slots_across = side_px / SAMPLE_IMAGE_PX;
	while (tiles->slots_across > LEAST &&
	       !fits(tiles->slots_across * SAMPLE_IMAGE_PX, budget_bytes))
		tiles->slots_across--;
	tiles->atlas_px = tiles->slots_across * SAMPLE_IMAGE_PX;
}

int tiles_init(struct tiles *tiles, uint64_t budget_bytes, uint32_t faces_across,
	       uint32_t face_rows)
{
	memset(tiles, 0, sizeof(*tiles));
	tiles->faces_across = faces_across;
	tiles->face_rows = face_rows;
	tiles->face_count = faces_across * face_rows;
	choose_size(tiles, budget_bytes);
	tiles->slot_count = (uint32_t)(tiles->slots_across * tiles->slots_across);
	tiles->slot_name = calloc(tiles->slot_count, sizeof(*tiles->slot_name));
	tiles->slot_stamp = calloc(tiles->slot_count, sizeof(*tiles->slot_stamp));
	tiles->slot_season = calloc(tiles->slot_count, sizeof(*tiles->slot_season));
	tiles->faces = calloc(tiles->face_count, sizeof(*tiles->faces));
	tiles->keys = calloc(tiles->face_count, sizeof(*tiles->keys));
	bool ok = tiles->slot_name && tiles->slot_stamp && tiles->slot_season && tiles->faces &&
		  tiles->keys;
	int rc = ok ? make_indirection(tiles) : -ENOMEM;
	if (rc < 0)
		tiles_finish(tiles);
	return rc;
}

void tiles_finish(struct tiles *tiles)
{
	if (tiles->atlas)
		glDeleteTextures(1, &tiles->atlas);
	if (tiles->indirection)
		glDeleteTextures(1, &tiles->indirection);
	free(tiles->slot_name);
	free(tiles->slot_stamp);
	free(tiles->slot_season);
	free(tiles->faces);
	free(tiles->keys);
	map_finish(&tiles->slot_of);
	map_finish(&tiles->face_of);
	map_finish(&tiles->declined);
	memset(tiles, 0, sizeof(*tiles));
}

void tiles_clear(struct tiles *tiles)
{
	memset(tiles->slot_name, 0, tiles->slot_count * sizeof(*tiles->slot_name));
	memset(tiles->faces, 0, tiles->face_count * sizeof(*tiles->faces));
	map_clear(&tiles->slot_of);
	map_clear(&tiles->face_of);
	map_clear(&tiles->declined);
	tiles->key_count = 0;
}

void tiles_constants(char out[TILES_CONSTANTS_BYTES], const struct tiles *tiles)
{
	const float atlas_px = (float)tiles->atlas_px;
	snprintf(out, TILES_CONSTANTS_BYTES,
		 "#define CELLS %d.0\n"
		 "#define CELL_GRID vec2(%d.0, %d.0)\n"
		 "#define IMAGE %.9f\n"
		 "#define APRON %.9f\n"
		 "#define TILE %.9f\n"
		 "#define MIDDLE %d.0\n",
		 TILES_CELLS, (int)tiles->faces_across * TILES_CELLS,
		 (int)tiles->face_rows * TILES_CELLS, (double)(SAMPLE_IMAGE_PX / atlas_px),
		 (double)(SAMPLE_APRON_PX / atlas_px), (double)(SAMPLE_TILE_PX / atlas_px),
		 tiles->slots_before);
}

void tiles_begin(struct tiles *tiles)
{
	tiles->stamp++;
}

/* ---- cells */

/* The cells that a tile covers: a square of `side` cells at (row, column) * side. */
struct cells {
	int side, row, column;
};

static struct cells cells_of(struct tile_name name)
{
	int side = TILES_CELLS >> name.level;
	return (struct cells){ side, name.row * side, name.column * side };
}

static void cover(struct tiles_face *face, struct tile_name name, uint32_t slot, int64_t now_ms)
{
	struct cells cells = cells_of(name);
	for (int y = cells.row; y < cells.row + cells.side; y++) {
		for (int x = cells.column; x < cells.column + cells.side; x++) {
			if (face->level[y][x] >= (int)name.level)
				continue;
			/* Only a cell that was empty fades in; a sharper picture replaces the old
			 * one at once. */
			if (face->level[y][x] < 0)
				face->born_ms[y][x] = now_ms;
			face->level[y][x] = (int8_t)name.level;
			face->slot[y][x] = (uint16_t)slot;
		}
	}
	face->fading = face->dirty = true;
}

/* After a tile was dropped, finds which coarser tile now covers its cells. */
static void uncover(struct tiles *tiles, struct tiles_face *face, struct tile_name gone)
{
	struct cells cells = cells_of(gone);
	for (int y = cells.row; y < cells.row + cells.side; y++) {
		for (int x = cells.column; x < cells.column + cells.side; x++) {
			if (face->level[y][x] != (int)gone.level)
				continue;
			int level = gone.level - 1;
			for (; level >= 0; level--) {
				int side = TILES_CELLS >> level;
				struct tile_name name = { .face = gone.face,
							  .level = (uint8_t)level,
							  .row = (uint8_t)(y / side),
							  .column = (uint8_t)(x / side) };
				uint64_t slot = map_get(&tiles->slot_of, tile_name_pack(name));
				if (slot == MAP_NONE)
					continue;
				face->slot[y][x] = (uint16_t)slot;
				break;
			}
			face->level[y][x] = (int8_t)level;
		}
	}
	face->dirty = true;
}

/* ---- slots */

static struct tiles_face *face_of(const struct tiles *tiles, face_key key)
{
	uint64_t at = map_get(&tiles->face_of, key);
	return at == MAP_NONE ? NULL : &tiles->faces[at];
}

static void drop_face(struct tiles *tiles, struct tiles_face *face)
{
	map_remove(&tiles->face_of, face->key);
	for (uint32_t i = 0; i < tiles->key_count; i++)
		if (tiles->keys[i] == face->key)
			tiles->keys[i] = tiles->keys[--tiles->key_count];
	face->used = false;
}

/* On lack of memory it may be fetched once more, which does no harm. */
static void decline(struct tiles *tiles, struct tile_name name)
{
	int rc = map_set(&tiles->declined, tile_name_pack(name), 1);
	(void)rc;
}

void tiles_begin_season(struct tiles *tiles)
{
	tiles->season++;
	if (tiles->declined.count > 0)
		map_clear(&tiles->declined);
}

bool tiles_is_declined(const struct tiles *tiles, struct tile_name name)
{
	return map_get(&tiles->declined, tile_name_pack(name)) != MAP_NONE;
}

static void drop_tile(struct tiles *tiles, uint32_t slot)
{
	struct tile_name name = tile_name_unpack(tiles->slot_name[slot] - 1);
	struct tiles_face *face = face_of(tiles, name.face);
	if (tiles->slot_season[slot] == tiles->season)
		decline(tiles, name);
	map_remove(&tiles->slot_of, tiles->slot_name[slot] - 1);
	tiles->slot_name[slot] = 0;
	if (!face)
		return;
	uncover(tiles, face, name);
	face->version = ++tiles->version;
	if (--face->tile_count == 0)
		drop_face(tiles, face);
}

/* Returns a free slot, else the one used longest ago outside this round. NO_SLOT: there is
 * none. */
static uint32_t take_slot(struct tiles *tiles)
{
	uint32_t best = NO_SLOT;
	for (uint32_t i = 0; i < tiles->slot_count; i++) {
		if (!tiles->slot_name[i])
			return i;
		if (tiles->slot_stamp[i] != tiles->stamp &&
		    (best == NO_SLOT || tiles->slot_stamp[i] < tiles->slot_stamp[best]))
			best = i;
	}
	if (best != NO_SLOT)
		drop_tile(tiles, best);
	return best;
}

static struct tiles_face *take_face(struct tiles *tiles, face_key key)
{
	struct tiles_face *best = NULL;
	for (uint32_t i = 0; i < tiles->face_count; i++) {
		struct tiles_face *face = &tiles->faces[i];
		if (!face->used) {
			best = face;
			break;
		}
		if (face->stamp != tiles->stamp && (!best || face->stamp < best->stamp))
			best = face;
	}
	if (!best)
		return NULL;
	if (best->used)
		for (uint32_t i = 0; i < tiles->slot_count && best->used; i++)
			if (tiles->slot_name[i] &&
			    tile_name_unpack(tiles->slot_name[i] - 1).face == best->key)
				drop_tile(tiles, i);
	memset(best, 0, sizeof(*best));
	memset(best->level, -1, sizeof(best->level));
	if (map_set(&tiles->face_of, key, (uint64_t)(best - tiles->faces)) < 0)
		return NULL;
	best->key = key;
	best->used = true;
	best->stamp = tiles->stamp;
	tiles->keys[tiles->key_count++] = key;
	return best;
}

bool tiles_has(const struct tiles *tiles, struct tile_name name)
{
	return map_get(&tiles->slot_of, tile_name_pack(name)) != MAP_NONE;
}

/* Returns the pixel position of a column or row of slots in the atlas. */
static int place_px(const struct tiles *tiles, int slot)
{
	int place = (slot - tiles->slots_before) * SAMPLE_IMAGE_PX;
	return place < 0 ? place + tiles->atlas_px : place;
}

int tiles_put(struct tiles *tiles, struct tile_name name, const uint8_t *rgb)
{
	if (tiles_has(tiles, name))
		return 0;
	int rc = make_atlas(tiles);
	if (rc < 0) {
		decline(tiles, name);
		return rc;
	}
	struct tiles_face *face = face_of(tiles, name.face);
	if (!face)
		face = take_face(tiles, name.face);
	if (!face) {
		decline(tiles, name);
		return -ENOSPC;
	}
	face->tile_count++; /* keeps the face while a slot is searched */
	uint32_t slot = take_slot(tiles);
	rc = slot == NO_SLOT ? -ENOSPC : map_set(&tiles->slot_of, tile_name_pack(name), slot);
	if (rc < 0) {
		if (--face->tile_count == 0)
			drop_face(tiles, face);
		decline(tiles, name);
		return rc;
	}
	tiles->slot_name[slot] = tile_name_pack(name) + 1;
	tiles->slot_stamp[slot] = tiles->stamp;
	tiles->slot_season[slot] = tiles->season;
	face->version = ++tiles->version;
	int x = place_px(tiles, (int)slot % tiles->slots_across);
	int y = place_px(tiles, (int)slot / tiles->slots_across);
	glBindTexture(GL_TEXTURE_2D, tiles->atlas);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
	glTexSubImage2D(GL_TEXTURE_2D, 0, x, y, SAMPLE_IMAGE_PX, SAMPLE_IMAGE_PX, GL_RGB,
			GL_UNSIGNED_BYTE, rgb);
	cover(face, name, slot, clock_now_ms());
	return 0;
}

int tiles_face_slot(const struct tiles *tiles, face_key face)
{
	uint64_t at = map_get(&tiles->face_of, face);
	return at == MAP_NONE ? -1 : (int)at;
}

static int cell_at(float place)
{
	int cell = (int)((place + 1) / 2 * TILES_CELLS);
	return cell < 0 ? 0 : cell >= TILES_CELLS ? TILES_CELLS - 1 : cell;
}

int tiles_level_at(const struct tiles *tiles, face_key face, float u, float v)
{
	const struct tiles_face *f = face_of(tiles, face);
	return f ? f->level[cell_at(-v)][cell_at(u)] : -1;
}

void tiles_touch(struct tiles *tiles, face_key face, float u0, float v0, float u1, float v1)
{
	struct tiles_face *f = face_of(tiles, face);
	if (!f)
		return;
	f->stamp = tiles->stamp;
	for (int y = cell_at(-v1); y <= cell_at(-v0); y++)
		for (int x = cell_at(u0); x <= cell_at(u1); x++)
			if (f->level[y][x] >= 0)
				tiles->slot_stamp[f->slot[y][x]] = tiles->stamp;
}

uint32_t tiles_room(const struct tiles *tiles)
{
	uint32_t room = 0;
	for (uint32_t i = 0; i < tiles->slot_count; i++)
		room += !tiles->slot_name[i] || tiles->slot_stamp[i] != tiles->stamp;
	return room;
}

/* ---- indirection */

static void write_cells(const struct tiles *tiles, struct tiles_face *face, int64_t now_ms,
			uint8_t out[TILES_CELLS][TILES_CELLS][4])
{
	face->fading = false;
	for (int y = 0; y < TILES_CELLS; y++) {
		for (int x = 0; x < TILES_CELLS; x++) {
			memset(out[y][x], 0, 4);
			if (face->level[y][x] < 0)
				continue;
			int64_t age = now_ms - face->born_ms[y][x];
			if (age < TILES_FADE_MS)
				face->fading = true;
			out[y][x][0] = (uint8_t)(face->slot[y][x] % tiles->slots_across);
			out[y][x][1] = (uint8_t)(face->slot[y][x] / tiles->slots_across);
			out[y][x][2] = (uint8_t)(1 << face->level[y][x]);
			out[y][x][3] =
				(uint8_t)(age < TILES_FADE_MS ? 255 * age / TILES_FADE_MS : 255);
		}
	}
}

bool tiles_tick(struct tiles *tiles)
{
	int64_t now_ms = clock_now_ms();
	bool fading = false, bound = false;
	for (uint32_t i = 0; i < tiles->face_count; i++) {
		struct tiles_face *face = &tiles->faces[i];
		if (!face->used || (!face->fading && !face->dirty))
			continue;
		uint8_t cells[TILES_CELLS][TILES_CELLS][4];
		write_cells(tiles, face, now_ms, cells);
		if (!bound)
			glBindTexture(GL_TEXTURE_2D, tiles->indirection);
		bound = true;
		glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
		glTexSubImage2D(GL_TEXTURE_2D, 0, (GLint)(i % tiles->faces_across) * TILES_CELLS,
				(GLint)(i / tiles->faces_across) * TILES_CELLS, TILES_CELLS,
				TILES_CELLS, GL_RGBA, GL_UNSIGNED_BYTE, cells);
		face->dirty = false;
		fading |= face->fading;
	}
	return fading;
}
