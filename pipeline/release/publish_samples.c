/* Publishes the sample pages: turns the faces of the sample store into face, brick and samples
 * pages. */
#include "pipeline/release/publish_samples.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/log.h"
#include "pipeline/samples/sample_store.h"

struct children {
	struct page_child *items; /* owned */
	uint32_t count, room;
};

/* Faces arrive brick by brick, so only one brick is open at a time. */
struct samples_writer {
	struct object_store *objects;
	struct samples_page page;
	struct children bricks;
	uint32_t brick_index; /* the open brick, or SAMPLE_NONE */
	struct brick_page brick;
	struct children faces; /* children of the open brick */
};

static int add_child(struct children *children, const struct page_child *child)
{
	int rc = ARRAY_RESERVE(children->items, children->room, children->count + 1, UINT32_MAX);

	if (rc == 0)
		children->items[children->count++] = *child;
	return rc;
}

static int add_page(struct object_store *objects, enum page_kind kind,
		    const struct children *children, const struct buffer *payload,
		    struct page_child *out)
{
	struct page page = { .kind = kind,
			     .child_count = children->count,
			     .children = children->items,
			     .payload = buffer_bytes(payload) };

	return payload->error ? payload->error : object_store_add_page(objects, &page, out);
}

static void open_brick(struct samples_writer *writer, uint32_t index)
{
	writer->brick_index = index;
	writer->faces.count = 0;
	memset(&writer->brick, 0, sizeof(writer->brick));
	memset(writer->brick.face_child, 0xff, sizeof(writer->brick.face_child));
}

static int close_brick(struct samples_writer *writer)
{
	struct page_child child;
	struct buffer payload;
	int rc;

	if (writer->brick_index == SAMPLE_NONE)
		return 0;
	buffer_init(&payload, PAGE_BYTES_MAX);
	brick_page_encode(&payload, &writer->brick);
	rc = add_page(writer->objects, PAGE_BRICK, &writer->faces, &payload, &child);
	if (rc == 0) {
		writer->page.brick_child[writer->brick_index] = writer->bricks.count;
		rc = add_child(&writer->bricks, &child);
	}
	writer->brick_index = SAMPLE_NONE;
	buffer_finish(&payload);
	return rc;
}

static int write_face_page(struct object_store *objects, const struct sample_face *face,
			   struct page_child *out)
{
	struct face_page page = { .level_count = (uint8_t)face->level_count };
	struct children tiles = { 0 };
	struct buffer payload;
	int rc = 0;

	memset(page.tile_child, 0xff, sizeof(page.tile_child));
	buffer_init(&payload, PAGE_BYTES_MAX);
	for (uint32_t i = 0; rc == 0 && i < face->tile_count; i++) {
		struct page_child tile = { .hash = face->hashes[i], .size = face->sizes[i] };

		page.tile_child[face->tiles[i]] = i;
		rc = object_store_add_stretch(objects, face->path, face->offsets[i], &tile);
		if (rc == 0)
			rc = add_child(&tiles, &tile);
	}
	if (rc == 0) {
		face_page_encode(&payload, &page);
		rc = add_page(objects, PAGE_FACE, &tiles, &payload, out);
	}
	buffer_finish(&payload);
	free(tiles.items);
	return rc;
}

static int write_face(struct samples_writer *writer, const struct sample_face *face)
{
	uint32_t brick[3], within[3], index, point;
	struct page_child child;
	int rc = 0;

	for (int axis = 0; axis < 3; axis++) {
		brick[axis] = face->point[axis] / BRICK_SIDE;
		within[axis] = face->point[axis] % BRICK_SIDE;
	}
	index = (brick[2] * writer->page.bricks[1] + brick[1]) * writer->page.bricks[0] + brick[0];
	if (index != writer->brick_index) {
		rc = close_brick(writer);
		open_brick(writer, index);
	}
	if (rc == 0)
		rc = write_face_page(writer->objects, face, &child);
	if (rc < 0)
		return rc;
	point = (within[2] * BRICK_SIDE + within[1]) * BRICK_SIDE + within[0];
	writer->brick.face_child[point][face->face] = writer->faces.count;
	writer->brick.coverage[point][face->face] = face->coverage;
	writer->brick.near_m[point][face->face] = face->near_m;
	writer->brick.far_m[point][face->face] = face->far_m;
	return add_child(&writer->faces, &child);
}

static int start(struct samples_writer *writer, const struct samples_store *store)
{
	const struct sample_grid *grid = samples_store_grid(store);
	struct samples_page *page = &writer->page;
	uint32_t total = 1;

	for (int axis = 0; axis < 3; axis++) {
		page->origin_m[axis] = grid->origin_m[axis];
		page->spacing_m[axis] = grid->spacing_m[axis];
		page->count[axis] = (uint8_t)grid->count[axis];
		page->bricks[axis] = (grid->count[axis] + BRICK_SIDE - 1) / BRICK_SIDE;
		total *= page->bricks[axis];
	}
	page->level_count = (uint8_t)grid->level_count;
	page->brick_child = malloc((total + 1) * sizeof(*page->brick_child));
	if (!page->brick_child)
		return -ENOMEM;
	memset(page->brick_child, 0xff, (total + 1) * sizeof(*page->brick_child));
	page->vantage_count = grid->vantage_count;
	memcpy(page->vantage_m, grid->vantage_m, sizeof(page->vantage_m));
	writer->brick_index = SAMPLE_NONE;
	return 0;
}

/* Vantage points that see nothing are left out. */
static void leave_out_blind(struct samples_page *page)
{
	if (page->vantage_count > 0 &&
	    page->brick_child[samples_page_bricks(page) - 1] == SAMPLE_NONE)
		page->vantage_count = 0;
}

int publish_samples(struct object_store *objects, struct samples_store *store,
		    struct page_child *out)
{
	struct samples_writer *writer = calloc(1, sizeof(*writer));
	struct sample_face face;
	struct buffer payload;
	int rc = writer ? 0 : -ENOMEM;

	samples_store_rewind(store);
	buffer_init(&payload, PAGE_BYTES_MAX);
	if (rc == 0) {
		writer->objects = objects;
		rc = start(writer, store);
	}
	while (rc == 0 && (rc = samples_store_next(store, &face)) == 1)
		rc = write_face(writer, &face);
	if (rc == 0)
		rc = close_brick(writer);
	if (rc == 0) {
		leave_out_blind(&writer->page);
		samples_page_encode(&payload, &writer->page);
		rc = add_page(objects, PAGE_SAMPLES, &writer->bricks, &payload, out);
	}
	buffer_finish(&payload);
	if (writer) {
		samples_page_finish(&writer->page);
		free(writer->bricks.items);
		free(writer->faces.items);
	}
	free(writer);
	return rc;
}
