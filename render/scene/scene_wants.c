/* Lists what the scene wants, pages, geometry, labels and tiles, each with a priority by gain per
 * byte. */
#include "render/scene/scene_wants.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/clock.h"
#include "geometry/vec.h"
#include "render/plan/plan_quality.h"
#include "render/scene/scene_backdrop.h"
#include "render/scene/scene_labels.h"
#include "render/scene/scene_objects.h"
#include "render/scene/scene_stream.h"
#include "render/scene/scene_visibility.h"

/* A coarse tile, two levels up, stands in for 16 fine ones: it comes first where no image is shown
 * yet. */
enum { COARSER_FIRST = 2 };

static void want(struct scene *scene, enum object_kind kind, uint64_t id,
		 const struct message_want *place, uint32_t priority)
{
	const struct object *object = scene_expect(scene, place->hash, kind, id);
	if (object && object->state != OBJECT_WANTED)
		return;
	if (!object ||
	    ARRAY_RESERVE(scene->wants, scene->want_room, scene->want_count + 1, UINT32_MAX) < 0) {
		scene->lacked_memory = true;
		return;
	}
	struct message_want *out = &scene->wants[scene->want_count++];
	*out = *place;
	out->priority = priority;
}

static void want_child_of_root(struct scene *scene, enum object_kind kind, uint32_t child,
			       uint32_t priority)
{
	struct message_want place = { .hash = scene->root_child[child].hash,
				      .page = scene->root_hash,
				      .size = scene->root_child[child].size };
	for (uint32_t i = 0; i < child; i++)
		place.offset += scene->root_child[i].size;
	want(scene, kind, 0, &place, priority);
}

/* Geometry stays useful for every later view, an image only for views from near its sampling
 * point. */
static const float lasting = 4;

/* Returns the lowest priority that is fetched. A model that fills a third of the picture is not
 * worth less than one that fills it: there is nothing else to see. */
static uint32_t least_priority(const struct scene *scene, float lasts)
{
	float filled = scene->visibility_us ? scene->filled : 1;
	return plan_priority(scene->options.price_px_per_kb * filled / lasts, 1000);
}

/* ---- the streaming mesh, and the first cut of patches */

/* Both come before the texts: a visitor looks first. */
enum { FIRST_PRIORITY = MESSAGE_PRIORITY_INDEX };

/* Returns what a surface with this error in pixels costs the picture, on the scale of plan_worth.
 * An image adds octaves of detail even to a rough surface; a finer surface puts them in the right
 * place. */
static float misplaced(float error_px)
{
	return 0.1f * (isfinite(error_px) ? error_px / (error_px + 8) : 1);
}

/* Returns what the stream costs the picture after so many blocks, in pixels. */
static float stream_costs(const struct scene *scene, uint32_t blocks)
{
	const float *low = scene->root.box_min_m, *high = scene->root.box_max_m;
	float centre[3], radius = vec_distance(low, high) / 2, away, pixels;
	for (int i = 0; i < 3; i++)
		centre[i] = (low[i] + high[i]) / 2;
	away = vec_most(vec_distance(scene->view.eye_m, centre), radius);
	pixels = vec_least(view_sphere_px(&scene->view, centre, radius), scene->view.picture_px);
	return pixels * misplaced(stream_growth_error_m(&scene->stream.growth, blocks) *
				  scene->view.focal_px / away);
}

/* Wants the base before all else, then block by block, by what each adds. */
static void want_stream(struct scene *scene)
{
	const struct stream_growth *growth = &scene->stream.growth;
	uint32_t last = root_page_plain(&scene->root, scene->root_child_count);
	uint32_t most = 2 * MESSAGE_PRIORITY_INDEX - 1;
	if (!growth->decoder) {
		want_child_of_root(scene, OBJECT_STREAM, last, 2 * MESSAGE_PRIORITY_INDEX + 1);
		return;
	}
	struct message_want place = { .page = scene->root_child[last].hash };
	if (!scene->has_view || growth->damaged || scene_first_cut_is_here(scene))
		return;
	for (uint32_t i = 0; i < growth->page.child_count; i++) {
		const struct page_child *block = &growth->page.children[i];
		uint32_t priority =
			FIRST_PRIORITY +
			plan_priority(stream_costs(scene, i) - stream_costs(scene, i + 1),
				      block->size);
		place.hash = block->hash;
		place.size = block->size;
		/* No block is of use before the one before it. */
		most = priority < most ? priority : most - 1;
		if (!growth->has[i])
			want(scene, OBJECT_BLOCK, i, &place, most);
		place.offset += block->size;
	}
}

static void want_group(struct scene *scene, uint32_t group, uint32_t priority)
{
	struct message_want place = { .hash = scene->groups[group].hash,
				      .page = scene->hierarchy_hash,
				      .offset = scene->group_offset[group],
				      .size = scene->groups[group].size };
	want(scene, OBJECT_GROUP, group, &place, priority);
	scene->groups_are_wanted = true;
}

/* Wants the groups that take the stream's place, all as one: what they add is what the stream still
 * lacks. */
static void want_first_cut(struct scene *scene)
{
	const struct stream_growth *growth = &scene->stream.growth;
	const uint32_t count = scene_first_cut(scene);
	uint32_t bytes = 0, priority;
	for (uint32_t g = 0; g < count; g++)
		bytes += scene->geometry.loaded[g] ? 0 : scene->groups[g].size;
	priority = FIRST_PRIORITY + plan_priority(stream_costs(scene, growth->block_count), bytes);
	for (uint32_t g = 0; g < count; g++)
		if (!scene->geometry.loaded[g])
			want_group(scene, g, priority + (count - g < 1000 ? count - g : 1000));
}

/* Wants groups by their own worth, and by the worth of the groups that depend on them. */
static void want_groups(struct scene *scene)
{
	const struct cut *cut = &scene->cut;
	if (scene_awaits_backdrop(scene))
		return;
	if (scene->stream.growth.decoder)
		want_first_cut(scene);
	else if (!scene->geometry.loaded[0])
		want_group(scene, 0, MESSAGE_PRIORITY_INDEX - 1);
	if (!scene->geometry.loaded[0])
		return;
	uint32_t least = least_priority(scene, lasting), *priority = scene->group_priority;
	memset(priority, 0, scene->hierarchy.group_count * sizeof(*priority));
	for (uint32_t i = cut->want_count; i-- > 0;) {
		const struct cut_want *w = &cut->wants[i];
		uint32_t own = plan_priority(w->seen_px * misplaced(w->error_px),
					     scene->groups[w->group].size);
		if (priority[w->group] < own)
			priority[w->group] = own;
		uint32_t count;
		const uint32_t *replaced = cut_replaced(cut, w->group, &count);
		for (uint32_t k = 0; k < count; k++) {
			uint32_t on = scene->hierarchy.patches[replaced[k]].group;
			if (priority[on] <= priority[w->group])
				priority[on] = priority[w->group] + 1;
		}
		if (priority[w->group] >= least)
			want_group(scene, w->group, priority[w->group]);
	}
}

/* ---- labels */

/* Labels come after everything visible: until they arrive, regions answer a touch. */
enum { LABELS_PRIORITY = 1 };

static void want_labels_of(struct scene *scene, uint32_t group)
{
	const uint32_t child = scene->labels_of[group];
	struct message_want place = { .page = scene->root_child[ROOT_CHILD_LABELS].hash };
	if (child == LABEL_NONE || scene->geometry.labels[group].patch_count > 0)
		return;
	place.hash = scene->labels[child].hash;
	place.size = scene->labels[child].size;
	place.offset = scene->labels_offset[child];
	want(scene, OBJECT_LABELS, group, &place, LABELS_PRIORITY);
}

/* Wants the labels of visible groups. */
static void want_labels(struct scene *scene)
{
	uint8_t *asked = scene->labels ? calloc(scene->hierarchy.group_count, 1) : NULL;
	if (!scene->labels)
		want_child_of_root(scene, OBJECT_LABELS_PAGE, ROOT_CHILD_LABELS, LABELS_PRIORITY);
	else if (!asked)
		scene->lacked_memory = true;
	for (uint32_t i = 0; asked && i < scene->visible_count; i++) {
		const struct visible_piece *v = &scene->visible[i];
		const struct piece_state *state =
			&scene->geometry.patches[v->patch].pieces[v->piece];
		uint32_t group = scene->hierarchy.patches[v->patch].group;
		if (asked[group] || (state->counted && state->seen_px <= 0))
			continue;
		asked[group] = 1;
		want_labels_of(scene, group);
	}
	free(asked);
}

/* ---- images */

/* A tile or page that pieces want, with the sum of their gains. */
struct gain {
	uint64_t id;
	float pixels;
	enum object_kind kind;
};

struct gains {
	struct gain *list; /* owned */
	uint32_t count, room;
	struct map of; /* id and kind -> index */
	bool lacked_memory;
};

static void gain_add(struct gains *gains, enum object_kind kind, uint64_t id, float pixels)
{
	uint64_t key = id << 3 | kind;
	uint64_t at = map_get(&gains->of, key);
	if (at != MAP_NONE) {
		gains->list[at].pixels += pixels;
		return;
	}
	if (ARRAY_RESERVE(gains->list, gains->room, gains->count + 1, UINT32_MAX) == 0 &&
	    map_set(&gains->of, key, gains->count) == 0)
		gains->list[gains->count++] = (struct gain){ id, pixels, kind };
	else
		gains->lacked_memory = true;
}

static int place_of(float at, int count)
{
	int place = (int)((at + 1) / 2 * (float)count);
	return place < 0 ? 0 : place >= count ? count - 1 : place;
}

static void add_level(const struct scene *scene, struct gains *gains, const struct plan_want *w,
		      uint32_t level, float pixels)
{
	int count = 1 << level;
	int x0 = place_of(w->area.u0, count), x1 = place_of(w->area.u1, count);
	int y0 = place_of(-w->area.v1, count), y1 = place_of(-w->area.v0, count);
	float each = pixels / (float)((x1 - x0 + 1) * (y1 - y0 + 1));
	for (int y = y0; y <= y1; y++) {
		for (int x = x0; x <= x1; x++) {
			struct tile_name name = { .face = w->face,
						  .level = (uint8_t)level,
						  .row = (uint8_t)y,
						  .column = (uint8_t)x };
			if (!tiles_has(&scene->tiles, name) &&
			    !tiles_is_declined(&scene->tiles, name))
				gain_add(gains, OBJECT_TILE, tile_name_pack(name), each);
		}
	}
}

static void add_want(const struct scene *scene, struct gains *gains, const struct plan_want *w,
		     float pixels, bool bare)
{
	uint32_t brick = 0;
	switch (repository_face(&scene->repository, w->face, NULL, &brick)) {
	case REPOSITORY_EMPTY:
		return;
	case REPOSITORY_UNKNOWN:
		gain_add(gains, OBJECT_BRICK, brick, pixels);
		return;
	case REPOSITORY_PAGE:
		gain_add(gains, OBJECT_FACE, w->face, pixels);
		return;
	case REPOSITORY_READY:
		break;
	}
	if (bare && w->level >= COARSER_FIRST) {
		add_level(scene, gains, w, w->level - COARSER_FIRST, 0.6f * pixels);
		pixels *= 0.4f;
	}
	add_level(scene, gains, w, w->level, pixels);
}

static bool place_gain(const struct scene *scene, const struct gain *gain,
		       struct message_want *place)
{
	switch (gain->kind) {
	case OBJECT_BRICK:
		return repository_brick(&scene->repository, (uint32_t)gain->id, place);
	case OBJECT_FACE:
		return repository_face(&scene->repository, (face_key)gain->id, place, NULL) ==
		       REPOSITORY_PAGE;
	default:
		return repository_tile(&scene->repository, tile_name_unpack(gain->id), place);
	}
}

/* What a page leads to, beside its own bytes: nothing is gained before some tiles are here too.
 * More of it makes pages wait for tiles that are known, less brings pages of many faces before the
 * first tile of one. */
enum { BYTES_BEHIND_PAGE = 16000 };

/* Returns the priority of a gain; 0: not worth fetching. */
static uint32_t gain_priority(const struct scene *scene, const struct gain *gain, uint32_t bytes)
{
	uint32_t priority = plan_priority(gain->pixels, bytes);
	if (priority < least_priority(scene, 1))
		return 0;
	return gain->kind == OBJECT_TILE ? priority
					 : plan_priority(gain->pixels, bytes + BYTES_BEHIND_PAGE);
}

/* Returns whether the page of each face that the backdrop shows is here. */
static bool knows_looks(const struct scene *scene)
{
	const struct scene_backdrop *backdrop = &scene->backdrop;
	for (uint32_t i = 0; i < backdrop->look_count; i++) {
		const enum repository_state state =
			repository_face(&scene->repository, backdrop->looks[i].face, NULL, NULL);
		if (state != REPOSITORY_READY && state != REPOSITORY_EMPTY)
			return false;
	}
	return true;
}

/* Adds the tiles, from two levels up to the finest that is of use, of a part of the picture;
 * without finer ones only the first of these levels. */
static void add_look(const struct scene *scene, struct gains *gains,
		     const struct backdrop_look *look, float pixels, bool finer)
{
	const struct plan_want w = { .face = look->face,
				     .level = look->level,
				     .area = { look->u, look->v, look->u, look->v } };
	int before = tiles_level_at(&scene->tiles, look->face, look->u, look->v);
	int level = look->level > COARSER_FIRST ? look->level - COARSER_FIRST : 0;
	if (repository_face(&scene->repository, look->face, NULL, NULL) != REPOSITORY_READY) {
		add_want(scene, gains, &w, pixels * scene_backdrop_worth(scene, look->level, -1),
			 false);
		return;
	}
	const int finest = finer ? look->level : level;
	for (level = level > before ? level : before + 1; level <= finest; level++) {
		add_level(scene, gains, &w, (uint32_t)level,
			  pixels * scene_backdrop_worth(scene, level, before));
		before = level;
	}
}

static void add_backdrop(const struct scene *scene, struct gains *gains)
{
	const struct scene_backdrop *backdrop = &scene->backdrop;
	/* or fine tiles of one face fill the line before the coarse ones of the next */
	const bool finer = knows_looks(scene);
	for (uint32_t i = 0; i < backdrop->look_count; i++)
		add_look(scene, gains, &backdrop->looks[i],
			 scene->view.picture_px / (float)backdrop->look_count, finer);
}

static void add_pieces(const struct scene *scene, struct gains *gains)
{
	for (uint32_t i = 0; i < scene->visible_count; i++) {
		const struct visible_piece *v = &scene->visible[i];
		const struct piece_state *state =
			&scene->geometry.patches[v->patch].pieces[v->piece];
		const struct plan_choice *choice = &state->choice;
		float pixels = scene_seen_px(state, v);
		for (uint32_t k = 0; k < choice->want_count && pixels > 0; k++)
			add_want(scene, gains, &choice->want[k], choice->want[k].gain * pixels,
				 choice->entry_count == 0);
	}
}

/* Returns whether anything is wanted. base is added to each priority. */
static bool want_gains(struct scene *scene, struct gains *gains, uint32_t base)
{
	bool any = false;
	scene->lacked_memory = scene->lacked_memory || gains->lacked_memory;
	for (uint32_t i = 0; i < gains->count; i++) {
		struct message_want place;
		if (!place_gain(scene, &gains->list[i], &place))
			continue;
		uint32_t priority = gain_priority(scene, &gains->list[i], place.size);
		if (priority == 0)
			continue;
		want(scene, gains->list[i].kind, gains->list[i].id, &place, base + priority);
		any = true;
	}
	free(gains->list);
	map_finish(&gains->of);
	*gains = (struct gains){ 0 };
	return any;
}

/* The backdrop alone at first: which other images the mesh needs is known better when there is
 * one. */
static void want_images(struct scene *scene)
{
	struct gains gains = { 0 };
	add_backdrop(scene, &gains);
	if (want_gains(scene, &gains, FIRST_PRIORITY))
		return;
	add_pieces(scene, &gains);
	(void)want_gains(scene, &gains, 0);
}

/* ---- the list */

/* Where the eye may go is felt, not seen: after what gains the picture two pixels a kilobyte. */
enum { SOLID_PRIORITY = 328000 };

/* Where no image comes in this time, none may ever come. */
enum { AWAIT_MS = 30000 };

bool scene_awaits_image(const struct scene *scene)
{
	return scene->options.mode != SCENE_POLYGONS && scene->tiles.key_count == 0 &&
	       scene->want_count > 0 && clock_now_ms() - scene->opened_ms < AWAIT_MS;
}

/* What stands beside the scan may fill a sixteenth of the picture; nobody knows before it is here.
 */
static uint32_t scenery_priority(const struct scene *scene, uint32_t bytes)
{
	return plan_priority(scene->view.picture_px / 16 * misplaced(INFINITY), bytes);
}

static void want_surroundings(struct scene *scene)
{
	const uint32_t child = root_page_scenery(&scene->root, scene->root_child_count);

	if (scene->root.has_scenery && !scene->scenery.is_here)
		want_child_of_root(scene, OBJECT_SCENERY, child,
				   scenery_priority(scene, scene->root_child[child].size));
	if (scene->root.has_solid && !scene->solid.nodes)
		want_child_of_root(scene, OBJECT_SOLID, scene->root_child_count - 1,
				   SOLID_PRIORITY);
}

static int by_priority(const void *a, const void *b)
{
	const struct message_want *left = a, *right = b;
	if (left->priority != right->priority)
		return left->priority < right->priority ? 1 : -1;
	return hash_compare(left->hash, right->hash);
}

/* Keeps no more tiles than the atlas can take without dropping one in use. */
static void limit_to_room(struct scene *scene)
{
	uint32_t room = tiles_room(&scene->tiles), busy = pool_busy(scene->pool), kept = 0;
	room = room > busy ? room - busy : 0;
	for (uint32_t i = 0; i < scene->want_count; i++) {
		const struct object *object = scene_object(scene, scene->wants[i].hash);
		if (object && object->kind == OBJECT_TILE && room-- == 0) {
			room = 0;
			continue;
		}
		scene->wants[kept++] = scene->wants[i];
	}
	scene->want_count = kept;
}

void scene_list_wants(struct scene *scene)
{
	scene->wants_are_stale = false;
	scene->want_count = 0;
	scene->groups_are_wanted = false;
	if (!scene->has_root) {
		const struct message_want place = { .hash = scene->root_hash,
						    .size = scene->root_bytes };
		if (scene->root_bytes > 0)
			want(scene, OBJECT_ROOT, 0, &place, 2 * MESSAGE_PRIORITY_INDEX);
		return;
	}
	bool images = scene->options.mode != SCENE_POLYGONS;
	if (!scene->stream.over)
		want_stream(scene);
	if (!scene->has_hierarchy)
		want_child_of_root(scene, OBJECT_HIERARCHY, ROOT_CHILD_HIERARCHY,
				   2 * MESSAGE_PRIORITY_INDEX);
	if (!scene->repository.ready && images)
		want_child_of_root(scene, OBJECT_SAMPLES, ROOT_CHILD_SAMPLES,
				   2 * MESSAGE_PRIORITY_INDEX - 1);
	if (scene->has_hierarchy)
		want_groups(scene);
	if (scene->has_hierarchy && scene->geometry.loaded[0] && scene_has_labels(scene))
		want_labels(scene);
	if (scene->repository.ready && scene->has_hierarchy && images)
		want_images(scene);
	if (scene_first_cut_is_here(scene) && !scene_awaits_image(scene))
		want_surroundings(scene);
	if (scene->want_count > 0)
		qsort(scene->wants, scene->want_count, sizeof(*scene->wants), by_priority);
	limit_to_room(scene);
}

bool scene_lacked_memory(const struct scene *scene)
{
	return scene->lacked_memory;
}

size_t scene_wants(struct scene *scene, struct message_want *wants, size_t most)
{
	/* Before there is a root, nothing is drawn that would list them anew. */
	if (!scene->has_root && scene->lacked_memory) {
		scene->lacked_memory = false;
		scene->wants_are_stale = true;
	}
	if (scene->wants_are_stale)
		scene_list_wants(scene);
	size_t count = scene->want_count < most ? scene->want_count : most;
	if (count > 0)
		memcpy(wants, scene->wants, count * sizeof(*wants));
	return count;
}
