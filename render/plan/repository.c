/* Decodes the pages of samples, bricks and faces, and answers where the object of a tile or page
 * lies. */
#include "render/plan/repository.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

/* The children of a page, with the offset at which each lies. */
struct children {
	struct hash page;
	struct page_child *child; /* owned */
	uint32_t *offset;         /* owned */
	uint32_t count;
};

struct brick_entry {
	struct children children;
	struct brick_page page;
};

struct face_entry {
	face_key key;
	struct children children;
	struct face_page page;
};

uint64_t tile_name_pack(struct tile_name name)
{
	return (uint64_t)name.face << 16 | (uint64_t)(name.level & 15u) << 12 |
	       (uint64_t)(name.row & 63u) << 6 | (name.column & 63u);
}

struct tile_name tile_name_unpack(uint64_t packed)
{
	return (struct tile_name){ .face = (face_key)(packed >> 16),
				   .level = packed >> 12 & 15,
				   .row = packed >> 6 & 63,
				   .column = packed & 63 };
}

/* ---- children */

static void children_finish(struct children *children)
{
	free(children->child);
	free(children->offset);
	memset(children, 0, sizeof(*children));
}

/* Takes ownership of the page's children. */
static int children_take(struct children *out, struct page *page, struct hash hash)
{
	*out = (struct children){ .page = hash, .child = page->children };
	page->children = NULL;
	out->count = page->child_count;
	page->child_count = 0;
	out->offset = malloc((out->count + 1) * sizeof(*out->offset));
	if (!out->offset) {
		children_finish(out);
		return -ENOMEM;
	}
	uint32_t at = 0;
	for (uint32_t i = 0; i < out->count; i++) {
		out->offset[i] = at;
		at += out->child[i].size;
	}
	return 0;
}

static bool children_want(const struct children *children, uint32_t child,
			  struct message_want *want)
{
	if (child >= children->count)
		return false;
	if (want)
		*want = (struct message_want){ .hash = children->child[child].hash,
					       .page = children->page,
					       .offset = children->offset[child],
					       .size = children->child[child].size };
	return true;
}

/* ---- pages as they arrive */

static void face_destroy(struct face_entry *face)
{
	if (face)
		children_finish(&face->children);
	free(face);
}

static void brick_destroy(struct brick_entry *brick)
{
	if (brick)
		children_finish(&brick->children);
	free(brick);
}

void repository_finish(struct repository *repository)
{
	for (uint32_t i = 0; repository->bricks && i < repository->page.child_count; i++)
		brick_destroy(repository->bricks[i]);
	for (uint32_t i = 0; i < repository->face_count; i++)
		face_destroy(repository->faces[i]);
	free(repository->bricks);
	free(repository->faces);
	map_finish(&repository->face_of);
	samples_page_finish(&repository->grid);
	page_finish(&repository->page);
	free(repository->page_bytes);
	memset(repository, 0, sizeof(*repository));
}

static uint32_t grid_points(const struct samples_page *grid)
{
	return (uint32_t)grid->count[0] * grid->count[1] * grid->count[2];
}

/* Every brick must refer to an existing child of the page; otherwise it could not be fetched. */
static bool bricks_are_sane(const struct repository *r)
{
	for (uint32_t i = 0; i < samples_page_bricks(&r->grid); i++)
		if (r->grid.brick_child[i] != SAMPLE_NONE &&
		    r->grid.brick_child[i] >= r->page.child_count)
			return false;
	for (int i = 0; i < 3; i++)
		if (r->grid.count[i] == 0 || r->grid.bricks[i] * BRICK_SIDE < r->grid.count[i])
			return false;
	return r->grid.level_count >= 1 && r->grid.level_count <= SAMPLE_LEVELS_MAX;
}

int repository_open(struct repository *repository, struct hash hash, struct bytes object)
{
	struct repository *r = repository;
	repository_finish(r);
	r->page_hash = hash;
	r->page_bytes = malloc(object.size + 1);
	if (!r->page_bytes)
		return -ENOMEM;
	if (object.size > 0)
		memcpy(r->page_bytes, object.data, object.size);
	int rc = page_decode(&r->page, (struct bytes){ r->page_bytes, object.size });
	if (rc == 0 && r->page.kind != PAGE_SAMPLES)
		rc = -EBADMSG;
	if (rc == 0)
		rc = samples_page_decode(&r->grid, r->page.payload);
	if (rc == 0 && !bricks_are_sane(r))
		rc = -EBADMSG;
	if (rc == 0) {
		r->bricks = calloc(r->page.child_count + 1, sizeof(struct brick_entry *));
		rc = r->bricks ? 0 : -ENOMEM;
	}
	if (rc < 0) {
		repository_finish(r);
		return rc;
	}
	r->point_count = grid_points(&r->grid) + r->grid.vantage_count;
	r->ready = true;
	return 0;
}

int repository_give_brick(struct repository *repository, uint32_t child, struct bytes object)
{
	if (!repository->ready || child >= repository->page.child_count)
		return -EBADMSG;
	if (repository->bricks[child])
		return 0;
	struct brick_entry *brick = calloc(1, sizeof(*brick));
	if (!brick)
		return -ENOMEM;
	struct page page;
	int rc = page_decode(&page, object);
	if (rc == 0) {
		rc = page.kind == PAGE_BRICK ? brick_page_decode(&brick->page, page.payload)
					     : -EBADMSG;
		if (rc == 0)
			rc = children_take(&brick->children, &page,
					   repository->page.children[child].hash);
		page_finish(&page);
	}
	if (rc < 0) {
		brick_destroy(brick);
		return rc;
	}
	repository->bricks[child] = brick;
	return 0;
}

static int face_add(struct repository *r, struct face_entry *face)
{
	int rc = ARRAY_RESERVE(r->faces, r->face_room, r->face_count + 1, UINT32_MAX);
	if (rc == 0)
		rc = map_set(&r->face_of, face->key, r->face_count);
	if (rc == 0)
		r->faces[r->face_count++] = face;
	return rc;
}

int repository_give_face(struct repository *repository, face_key key, struct bytes object)
{
	struct message_want place;
	if (repository_face(repository, key, &place, NULL) != REPOSITORY_PAGE)
		return 0; /* here already, or not expected */
	struct face_entry *face = calloc(1, sizeof(*face));
	if (!face)
		return -ENOMEM;
	face->key = key;
	struct page page;
	int rc = page_decode(&page, object);
	if (rc == 0) {
		rc = page.kind == PAGE_FACE ? face_page_decode(&face->page, page.payload)
					    : -EBADMSG;
		if (rc == 0)
			rc = children_take(&face->children, &page, place.hash);
		page_finish(&page);
	}
	if (rc == 0)
		rc = face_add(repository, face);
	if (rc < 0)
		face_destroy(face);
	return rc;
}

/* ---- questions */

void repository_point_m(const struct repository *repository, uint32_t point, float out[3])
{
	const struct samples_page *grid = &repository->grid;
	const uint32_t on_grid = grid_points(grid);
	if (point >= on_grid) {
		memcpy(out, grid->vantage_m[point - on_grid], sizeof(grid->vantage_m[0]));
		return;
	}
	uint32_t at[3] = { point % grid->count[0], point / grid->count[0] % grid->count[1],
			   point / grid->count[0] / grid->count[1] };
	for (int i = 0; i < 3; i++)
		out[i] = grid->origin_m[i] + grid->spacing_m[i] * (float)at[i];
}

/* Returns the brick's child index in the samples page, and the point's index in that brick. */
static uint32_t brick_of(const struct repository *r, uint32_t point, uint32_t *in_brick)
{
	const struct samples_page *grid = &r->grid;
	const uint32_t on_grid = grid_points(grid);
	if (point >= on_grid) {
		*in_brick = point - on_grid;
		return grid->brick_child[samples_page_bricks(grid) - 1];
	}
	uint32_t x = point % grid->count[0], y = point / grid->count[0] % grid->count[1];
	uint32_t z = point / grid->count[0] / grid->count[1];
	*in_brick = (z % BRICK_SIDE * BRICK_SIDE + y % BRICK_SIDE) * BRICK_SIDE + x % BRICK_SIDE;
	return grid->brick_child[(z / BRICK_SIDE * grid->bricks[1] + y / BRICK_SIDE) *
					 grid->bricks[0] +
				 x / BRICK_SIDE];
}

bool repository_brick(const struct repository *repository, uint32_t child,
		      struct message_want *want)
{
	if (!repository->ready || child >= repository->page.child_count ||
	    repository->bricks[child])
		return false;
	*want = (struct message_want){ .hash = repository->page.children[child].hash,
				       .page = repository->page_hash,
				       .offset = (uint32_t)page_child_offset(&repository->page,
									     child),
				       .size = repository->page.children[child].size };
	return true;
}

enum repository_state repository_face(const struct repository *repository, face_key face,
				      struct message_want *want, uint32_t *brick_child)
{
	uint32_t point = face / CUBE_FACES, in_brick;
	if (!repository->ready || point >= repository->point_count)
		return REPOSITORY_EMPTY;
	uint32_t child = brick_of(repository, point, &in_brick);
	if (child == SAMPLE_NONE)
		return REPOSITORY_EMPTY;
	const struct brick_entry *brick = repository->bricks[child];
	if (!brick) {
		if (brick_child)
			*brick_child = child;
		if (want && !repository_brick(repository, child, want))
			return REPOSITORY_EMPTY;
		return REPOSITORY_UNKNOWN;
	}
	uint32_t at = brick->page.face_child[in_brick][face % CUBE_FACES];
	if (at == SAMPLE_NONE || at >= brick->children.count)
		return REPOSITORY_EMPTY;
	if (map_get(&repository->face_of, face) != MAP_NONE)
		return REPOSITORY_READY;
	return children_want(&brick->children, at, want) ? REPOSITORY_PAGE : REPOSITORY_EMPTY;
}

bool repository_covers(const struct repository *repository, face_key face, uint16_t sixteenths)
{
	uint32_t in_brick, point = face / CUBE_FACES;
	uint32_t child = brick_of(repository, point, &in_brick);
	if (child == SAMPLE_NONE)
		return false;
	const struct brick_entry *brick = repository->bricks[child];
	return !brick || (brick->page.coverage[in_brick][face % CUBE_FACES] & sixteenths) != 0;
}

uint32_t repository_levels(const struct repository *repository)
{
	return repository->grid.level_count;
}

bool repository_tile(const struct repository *repository, struct tile_name name,
		     struct message_want *want)
{
	uint64_t index = map_get(&repository->face_of, name.face);
	if (index == MAP_NONE)
		return false;
	const struct face_entry *face = repository->faces[index];
	if (name.level >= face->page.level_count)
		return false;
	uint32_t child = face->page.tile_child[face_tile_index(name.level, name.row, name.column)];
	return child != SAMPLE_NONE && children_want(&face->children, child, want);
}
