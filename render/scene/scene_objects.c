/* Creates the scene, takes the objects that arrive and opens them by kind, and answers ray
 * queries. */
#include "render/scene/scene_objects.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/clock.h"
#include "base/log.h"
#include "geometry/vec.h"
#include "render/scene/scene_labels.h"
#include "render/scene/scene_scenery.h"
#include "render/scene/scene_stream.h"

enum {
	DEPTH_FACE_PX = 512,
	DEPTH_TEXEL_BYTES = 2, /* 4 where the driver cannot draw into RGB565 */
	FACES_MIN = 16,
	SIDE_FACES_MAX = 8, /* faces per side of a depth sheet; follows from GL_LIMIT_TEXTURE_PX */
};

static uint32_t limited(uint64_t value, uint64_t least, uint64_t most)
{
	value = value < least ? least : value;
	return (uint32_t)(value > most ? most : value);
}

/* Chooses the depth sheets: as large as a texture may be, and as few as possible. Where they must
 * repeat (depth.h) each has two rows: of the powers of two that fits most budgets. */
static struct depth_layout lay_out_depths(uint32_t faces)
{
	struct depth_layout out = { .face_px = DEPTH_FACE_PX };
	uint32_t side = limited((uint64_t)gl_texture_most_px() / DEPTH_FACE_PX, 1, SIDE_FACES_MAX);
	uint32_t rows = faces / side;
	out.across = (int)side;
	out.sheets = (int)((rows + side - 1) / side);
	out.rows = (int)rows / out.sheets;
	if (!gl_has_highp() && side > 1) {
		out.rows = 2;
		out.sheets = (int)rows / 2;
	}
	if (out.sheets > DEPTH_SHEETS_MAX)
		out.sheets = DEPTH_SHEETS_MAX;
	return out;
}

/* Three eighths of the texture budget are for depths: a face in use has about a dozen tiles in
 * use. */
static int make_atlases(struct scene *scene)
{
	const uint64_t face_bytes = (uint64_t)DEPTH_TEXEL_BYTES * DEPTH_FACE_PX * DEPTH_FACE_PX;
	const uint64_t budget = scene->options.texture_budget_bytes;
	const uint32_t faces = limited(budget * 3 / 8 / face_bytes, FACES_MIN, TILES_FACES_MAX);
	const struct depth_layout layout = lay_out_depths(faces);
	const int rows = layout.rows * layout.sheets;
	const uint64_t spent = face_bytes * (uint64_t)(rows * layout.across);
	int rc = tiles_init(&scene->tiles, budget > spent ? budget - spent : 0,
			    (uint32_t)layout.across, (uint32_t)rows);
	if (rc == 0)
		rc = depth_init(&scene->depth, &layout);
	return rc;
}

/* ---- life */

const struct scene_effort scene_effort_full = {
	.scale = 1, .faces = PLAN_ENTRIES, .triangles = UINT32_MAX, .budget = 1, .share = 1
};

int scene_create(struct scene **out, const struct scene_options *options)
{
	struct scene *scene = calloc(1, sizeof(*scene));
	*out = NULL;
	if (!scene)
		return -ENOMEM;
	scene->options = *options;
	scene->image_share = -1;
	scene->effort = scene->used = scene_effort_full;
	int rc = pool_create(&scene->pool, options->worker_count);
	if (rc == 0)
		rc = make_atlases(scene);
	if (rc == 0)
		rc = surface_init(&scene->surface, &scene->tiles);
	if (rc == 0)
		rc = mark_init(&scene->mark);
	if (rc == 0)
		rc = part_renderer_init(&scene->part);
	if (rc == 0)
		rc = outline_init(&scene->outline);
	if (rc == 0)
		rc = visibility_init(&scene->visibility);
	if (rc < 0) {
		scene_destroy(scene);
		return rc;
	}
	*out = scene;
	return 0;
}

static void drop_hierarchy(struct scene *scene)
{
	scene_drop_labels(scene);
	dissolve_finish(&scene->dissolve);
	cut_finish(&scene->cut);
	cut_finish(&scene->around);
	geometry_finish(&scene->geometry);
	hierarchy_finish(&scene->hierarchy);
	free(scene->groups);
	free(scene->group_offset);
	free(scene->seen_px);
	free(scene->group_priority);
	scene->groups = NULL;
	scene->group_offset = NULL;
	scene->seen_px = NULL;
	scene->group_priority = NULL;
}

/* Drops everything of a release. */
static void forget(struct scene *scene)
{
	pool_forget(scene->pool);
	scene->object_count = 0;
	map_clear(&scene->object_of);
	map_clear(&scene->decoding);
	if (scene->has_hierarchy)
		drop_hierarchy(scene);
	scene_drop_stream(scene);
	scene_drop_scenery(scene);
	solid_finish(&scene->solid);
	repository_finish(&scene->repository);
	scene->backdrop.share = 0;
	scene->backdrop.look_count = 0;
	scene->has_root = scene->has_hierarchy = false;
	scene->visible_count = scene->leaving_count = 0;
	scene->counted_count = scene->want_count = 0;
	scene->counting = scene->depth_task.is_begun = false;
	scene->references.has_shown = scene->references.is_begun = false;
}

void scene_destroy(struct scene *scene)
{
	if (!scene)
		return;
	if (scene->pool)
		forget(scene);
	pool_destroy(scene->pool);
	mark_finish(&scene->mark);
	part_renderer_finish(&scene->part);
	outline_finish(&scene->outline);
	accumulation_finish(&scene->accumulation);
	enlargement_finish(&scene->enlargement);
	for (int i = 0; i < 2; i++)
		image_warp_let_go(&scene->references.of[i]);
	image_warp_finish(&scene->references.warp);
	visibility_finish(&scene->visibility);
	surface_finish(&scene->surface);
	backdrop_finish(&scene->backdrop.picture);
	scenery_picture_finish(&scene->scenery.picture);
	depth_finish(&scene->depth);
	tiles_finish(&scene->tiles);
	map_finish(&scene->object_of);
	map_finish(&scene->decoding);
	free(scene->objects);
	free(scene->visible);
	free(scene->counted);
	free(scene->wants);
	free(scene);
}

int scene_open(struct scene *scene, struct hash root, uint32_t root_bytes)
{
	forget(scene);
	tiles_clear(&scene->tiles);
	depth_clear(&scene->depth, 1);
	accumulation_break(&scene->accumulation);
	scene->still.is_begun = scene->still.sum_is_seen = false;
	scene->opened_ms = clock_now_ms();
	scene->visibility_us = 0;
	scene->root_hash = root;
	scene->root_bytes = root_bytes;
	scene->want_count = 0;
	scene->wants_are_stale = true;
	scene->stream.over = false;
	return 0;
}

const struct root_page *scene_root(const struct scene *scene)
{
	return scene->has_root ? &scene->root : NULL;
}

/* ---- objects in */

struct object *scene_object(struct scene *scene, struct hash hash)
{
	uint64_t at = map_get(&scene->object_of, hash_key(hash));
	return at == MAP_NONE ? NULL : &scene->objects[at];
}

struct object *scene_expect(struct scene *scene, struct hash hash, enum object_kind kind,
			    uint64_t id)
{
	struct object *known = scene_object(scene, hash);
	if (known) {
		/* The same bytes may serve two purposes, one after the other. */
		if (known->state == OBJECT_WANTED) {
			known->kind = kind;
			known->id = id;
		}
		return known;
	}
	if (ARRAY_RESERVE(scene->objects, scene->object_room, scene->object_count + 1, UINT32_MAX) <
		    0 ||
	    map_set(&scene->object_of, hash_key(hash), scene->object_count) < 0)
		return NULL;
	struct object *object = &scene->objects[scene->object_count++];
	*object = (struct object){ .hash = hash, .kind = kind, .id = id };
	return object;
}

static int open_root(struct scene *scene, struct bytes bytes)
{
	struct page page;
	int rc = page_decode(&page, bytes);
	if (rc < 0)
		return rc;
	rc = page.kind == PAGE_ROOT ? root_page_decode(&scene->root, page.payload) : -EBADMSG;
	if (rc == 0 && root_page_plain(&scene->root, page.child_count) < ROOT_CHILD_COUNT)
		rc = -EBADMSG;
	if (rc == 0) {
		scene->root_child_count =
			page.child_count < ROOT_CHILDREN_MAX ? page.child_count : ROOT_CHILDREN_MAX;
		scene->stream.over = !scene->root.has_stream;
		memcpy(scene->root_child, page.children,
		       scene->root_child_count * sizeof(*scene->root_child));
		pool_set_lattice(scene->pool, &scene->root.lattice);
		/* A sampling point may lie outside the model's box by half the box's size on every
		 * side. */
		float far_m = 2.2f * vec_distance(scene->root.box_min_m, scene->root.box_max_m);
		depth_clear(&scene->depth, far_m);
		scene->has_root = true;
	}
	page_finish(&page);
	return rc;
}

static int keep_groups(struct scene *scene, struct page *page)
{
	scene->groups = page->children;
	page->children = NULL;
	uint32_t count = page->child_count;
	page->child_count = 0;
	scene->group_offset = calloc(count + 1, sizeof(*scene->group_offset));
	if (!scene->group_offset)
		return -ENOMEM;
	for (uint32_t i = 0; i < count; i++)
		scene->group_offset[i + 1] = scene->group_offset[i] + scene->groups[i].size;
	return 0;
}

static int open_hierarchy(struct scene *scene, struct hash hash, struct bytes bytes)
{
	struct page page;
	int rc = page_decode(&page, bytes);
	if (rc < 0)
		return rc;
	rc = page.kind == PAGE_HIERARCHY ? hierarchy_decode(&scene->hierarchy, page.payload)
					 : -EBADMSG;
	if (rc == 0 && page.child_count < scene->hierarchy.group_count)
		rc = -EBADMSG;
	if (rc == 0)
		rc = keep_groups(scene, &page);
	if (rc == 0)
		rc = geometry_init(&scene->geometry, &scene->hierarchy);
	if (rc == 0) {
		scene->seen_px = calloc(scene->hierarchy.patch_count + 1, sizeof(float));
		scene->group_priority = calloc(scene->hierarchy.group_count + 1, sizeof(uint32_t));
		rc = scene->seen_px && scene->group_priority ? 0 : -ENOMEM;
	}
	if (rc == 0)
		rc = cut_init(&scene->cut, &scene->hierarchy);
	if (rc == 0)
		rc = cut_init(&scene->around, &scene->hierarchy);
	if (rc == 0)
		rc = dissolve_init(&scene->dissolve, &scene->cut);
	page_finish(&page);
	if (rc < 0) {
		drop_hierarchy(scene);
		return rc;
	}
	scene->hierarchy_hash = hash;
	scene->has_hierarchy = true;
	return 0;
}

static int decode_elsewhere(struct scene *scene, struct object *object, enum pool_kind kind,
			    struct bytes bytes)
{
	uint64_t id = (uint64_t)hash_key(object->hash);
	int rc = map_set(&scene->decoding, id, (uint64_t)(object - scene->objects));
	if (rc == 0)
		rc = pool_give(scene->pool, kind, id, bytes);
	if (rc == 0)
		object->state = OBJECT_DECODING;
	return rc;
}

static int take_object(struct scene *scene, struct object *object, struct bytes bytes)
{
	switch (object->kind) {
	case OBJECT_ROOT:
		return scene->has_root ? 0 : open_root(scene, bytes);
	case OBJECT_HIERARCHY:
		return scene->has_hierarchy ? 0 : open_hierarchy(scene, object->hash, bytes);
	case OBJECT_SAMPLES:
		return scene->repository.ready
			       ? 0
			       : repository_open(&scene->repository, object->hash, bytes);
	case OBJECT_GROUP:
		return decode_elsewhere(scene, object, POOL_GROUP, bytes);
	case OBJECT_BRICK:
		return repository_give_brick(&scene->repository, (uint32_t)object->id, bytes);
	case OBJECT_FACE:
		return repository_give_face(&scene->repository, (face_key)object->id, bytes);
	case OBJECT_TILE:
		return decode_elsewhere(scene, object, POOL_TILE, bytes);
	case OBJECT_LABELS_PAGE:
		return scene->labels ? 0 : scene_open_labels(scene, bytes);
	case OBJECT_LABELS:
		return decode_elsewhere(scene, object, POOL_LABELS, bytes);
	case OBJECT_STREAM:
		return scene->stream.over || scene->stream.growth.decoder
			       ? 0
			       : stream_growth_open(&scene->stream.growth, bytes);
	case OBJECT_BLOCK:
		return stream_growth_give(&scene->stream.growth, (uint32_t)object->id, bytes);
	case OBJECT_SCENERY:
		return decode_elsewhere(scene, object, POOL_SCENERY, bytes);
	case OBJECT_SOLID:
		return decode_elsewhere(scene, object, POOL_SOLID, bytes);
	}
	return -EBADMSG;
}

void scene_refuse(struct scene *scene, struct object *object, int error)
{
	static const char *const names[] = { "root page",
					     "hierarchy page",
					     "samples page",
					     "patch group",
					     "brick page",
					     "face page",
					     "tile",
					     "labels page",
					     "labels",
					     "stream page",
					     "block of the streaming mesh",
					     "scenery",
					     "octree of where an eye may be" };
	char hex[HASH_HEX_BYTES];
	hash_to_hex(object->hash, hex);
	log_error("render", "content bug: %s %s cannot be used: %s", names[object->kind], hex,
		  strerror(-error));
	object->state = OBJECT_BAD;
	scene->refused++;
}

void scene_give(struct scene *scene, struct hash hash, struct bytes object)
{
	struct object *known = scene_object(scene, hash);
	if (!known || known->state != OBJECT_WANTED)
		return;
	scene->wants_are_stale = true;
	int rc = take_object(scene, known, object);
	if (rc == -ENOMEM)
		log_warn("render", "out of memory for an object; it is requested again later");
	else if (rc < 0)
		scene_refuse(scene, known, rc);
	else if (known->kind == OBJECT_BRICK)
		scene->epoch++; /* the page tells which faces are empty */
}

uint32_t scene_refused(const struct scene *scene)
{
	return scene->refused;
}

int scene_fd(const struct scene *scene)
{
	return pool_fd(scene->pool);
}

int scene_dispatch(struct scene *scene)
{
	/* The next frame takes the answers, within its time budget. */
	pool_quiet(scene->pool);
	scene->uploads_wait = true;
	return 0;
}

void scene_memory(const struct scene *scene, struct scene_memory *out)
{
	const uint64_t tile_bytes = 4ull * SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX;
	const uint64_t face_bytes = (uint64_t)DEPTH_TEXEL_BYTES * DEPTH_FACE_PX * DEPTH_FACE_PX;

	out->texture_bytes =
		scene->tiles.slot_of.count * tile_bytes + scene->tiles.key_count * face_bytes;
	out->geometry_bytes = scene->geometry.bytes + scene_scenery_bytes(scene);
}

void scene_unmix(const struct scene *scene, uint8_t *rgba, size_t pixel_count)
{
	for (uint8_t *pixel = rgba; pixel < rgba + 4 * pixel_count; pixel += 4) {
		for (int k = 0; k < 3; k++) {
			int alpha = pixel[3], sky = scene->root.background[k];
			int value = 255 * pixel[k] - (255 - alpha) * sky;
			value = alpha > 0 ? (value + alpha / 2) / alpha : 0;
			pixel[k] = (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
		}
	}
}

void scene_use(struct scene *scene, const struct scene_tools *tools)
{
	const struct rake *was = &scene->tools.rake, *rake = &tools->rake;
	/* A change of the section is detected as a change of the view. */
	scene->tools_moved |= was->on != rake->on ||
			      (rake->on && memcmp(was->at, rake->at, sizeof(was->at)) != 0);
	scene->tools = *tools;
}
