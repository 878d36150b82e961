#include "app/visit/information_view.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "storage/info_view.h"

enum { PICTURES_MOST = 512, DECODED_MOST = 48, LANGUAGE_BYTES = 16, FOUND_MOST = 100 };

/* A picture that was asked for. */
struct story_picture {
	bool wanted;
	bool broken;            /* came, and cannot be decoded: not asked for again */
	struct picture decoded; /* rgba NULL: not here */
	uint32_t used;          /* turn of its last use, for letting the oldest go */
};

struct story {
	struct story_options options;
	char language[LANGUAGE_BYTES];
	struct overlay *overlay;
	struct info *info;

	struct hash root;          /* zero: no release */
	struct page_child page_at; /* the info page in the root page */
	uint32_t page_offset;
	bool page_here, database_here; /* or found damaged: either way wanted no more */
	struct page page;              /* the info page; children zero until it is here */
	struct buffer page_bytes;      /* what page.payload borrows from */

	struct story_picture pictures[PICTURES_MOST]; /* as info_picture numbers them */
	uint32_t turn;
};

int story_create(struct story **out, const struct story_options *options)
{
	struct story *story = calloc(1, sizeof(*story));

	*out = NULL;
	if (!story)
		return -ENOMEM;
	story->options = *options;
	if (options->language)
		snprintf(story->language, sizeof(story->language), "%s", options->language);
	story->options.language = NULL;
	buffer_init(&story->page_bytes, PAGE_BYTES_MOST);
	*out = story;
	return 0;
}

static void forget_pictures(struct story *story)
{
	for (size_t i = 0; i < PICTURES_MOST; i++)
		picture_finish(&story->pictures[i].decoded);
	memset(story->pictures, 0, sizeof(story->pictures));
}

void story_destroy(struct story *story)
{
	if (!story)
		return;
	overlay_destroy(story->overlay);
	info_close(story->info);
	forget_pictures(story);
	page_finish(&story->page);
	buffer_finish(&story->page_bytes);
	free(story);
}

void story_open(struct story *story, struct hash root, const struct page *root_page)
{
	page_finish(&story->page);
	story->page_here = story->database_here = false;
	story->root = root;
	story->page_at = root_page->children[ROOT_CHILD_INFO];
	story->page_offset = (uint32_t)page_child_offset(root_page, ROOT_CHILD_INFO);
}

struct overlay *story_overlay(struct story *story)
{
	return story ? story->overlay : NULL;
}

const struct info *story_info(const struct story *story)
{
	return story ? story->info : NULL;
}

/* ---- pictures */

static uint32_t picture_index(const struct story *story, const struct info_picture *picture)
{
	return (uint32_t)(picture - info_picture(story->info, 0));
}

static bool on_picture(void *data, const char *name, struct overlay_picture *out)
{
	struct story *story = data;
	const struct info_picture *picture =
		story->info ? info_find_picture(story->info, name) : NULL;
	struct story_picture *own;

	if (!picture || picture_index(story, picture) >= PICTURES_MOST)
		return false;
	own = &story->pictures[picture_index(story, picture)];
	own->used = ++story->turn;
	own->wanted = !own->decoded.rgba && !own->broken;
	*out = (struct overlay_picture){
		.picture = own->decoded.rgba ? &own->decoded : NULL,
		.width_px = picture->width_px,
		.height_px = picture->height_px,
	};
	return true;
}

/* Keeps at most DECODED_MOST pictures in memory; asking for one that went brings it again. */
static void let_oldest_picture_go(struct story *story)
{
	struct story_picture *oldest = NULL;
	uint32_t count = 0;

	for (size_t i = 0; i < PICTURES_MOST; i++) {
		struct story_picture *own = &story->pictures[i];

		if (!own->decoded.rgba)
			continue;
		count++;
		if (!oldest || own->used < oldest->used)
			oldest = own;
	}
	if (count > DECODED_MOST)
		picture_finish(&oldest->decoded);
}

static void decode_picture(struct story_picture *own, const char *name, struct bytes object)
{
	const int rc = picture_decode_for_page(&own->decoded, object);

	own->broken = rc < 0;
	if (rc == -EFBIG)
		log_error("app", "content bug: picture %s is larger than %d px a side", name,
			  PICTURE_PAGE_SIDE_MOST_PX);
	else if (rc < 0)
		log_error("app", "content bug: picture %s cannot be shown", name);
}

static bool give_picture(struct story *story, struct hash hash, struct bytes object)
{
	bool ours = false;

	if (!story->info || !story->overlay)
		return false;
	for (uint32_t i = 0; i < info_picture_count(story->info) && i < PICTURES_MOST; i++) {
		const struct info_picture *picture = info_picture(story->info, i);
		struct story_picture *own = &story->pictures[i];

		if (!hash_equal(picture->hash, hash))
			continue;
		ours = true;
		own->wanted = false;
		if (!own->decoded.rgba)
			decode_picture(own, picture->name, object);
		let_oldest_picture_go(story);
		overlay_picture_arrived(story->overlay, picture->name);
	}
	return ours;
}

/* ---- the database */

static int tell_parts(struct story *story)
{
	const uint32_t count = info_part_count(story->info);
	struct overlay_part *parts = calloc(count ? count : 1, sizeof(*parts));
	int rc;

	if (!parts)
		return -ENOMEM;
	for (uint32_t i = 0; i < count; i++) {
		const struct info_text text = info_text(story->info, i, story->language);

		parts[i] = (struct overlay_part){
			.title = text.title,
			.caption = text.caption,
			.thumbnail = text.thumbnail,
			.has_page = info_part(story->info, i)->has_page,
		};
	}
	rc = overlay_parts(story->overlay, parts, count);
	free(parts);
	return rc;
}

static int tell_tours(struct story *story)
{
	struct overlay_tour tours[INFO_TOURS_MOST];
	const uint32_t count = info_tour_count(story->info);

	for (uint32_t i = 0; i < count; i++) {
		const struct info_text text = info_tour_text(story->info, i, story->language);

		tours[i] = (struct overlay_tour){ text.title, text.caption, text.thumbnail };
	}
	return overlay_tours(story->overlay, tours, count) < 0 ? -ENOMEM : 0;
}

static int create_overlay(struct story *story)
{
	const char *languages[OVERLAY_LANGUAGES_MOST];
	struct overlay_options options = {
		.width_px = story->options.width_px,
		.height_px = story->options.height_px,
		.px_per_mm = story->options.px_per_mm,
		.languages = languages,
		.language_count = info_language_count(story->info),
		.picture = on_picture,
		.data = story,
	};

	if (options.language_count > OVERLAY_LANGUAGES_MOST)
		options.language_count = OVERLAY_LANGUAGES_MOST;
	for (uint32_t i = 0; i < options.language_count; i++)
		languages[i] = info_language(story->info, i);
	overlay_destroy(story->overlay);
	return overlay_create(&story->overlay, &options);
}

_Static_assert((int)INFO_TOOL_LIGHT == (int)OVERLAY_TOOL_LIGHT &&
		       (int)INFO_TOOL_SECTION == (int)OVERLAY_TOOL_SECTION,
	       "one set of tools");

static void give_database(struct story *story, struct bytes object)
{
	struct info *info;
	int rc = info_open(&info, object);

	if (rc < 0) {
		log_error("app", "content bug: the release's information database is damaged");
		return;
	}
	info_close(story->info);
	story->info = info;
	forget_pictures(story);
	snprintf(story->language, sizeof(story->language), "%s",
		 info_nearest_language(info, story->language));
	rc = create_overlay(story);
	if (rc == 0) {
		overlay_language(story->overlay, story->language);
		overlay_offer_tools(story->overlay, info_tools(info));
		rc = tell_parts(story);
		if (rc == 0)
			rc = tell_tours(story);
	}
	if (rc < 0)
		log_error("app", "the words over the model cannot be shown: %s", strerror(-rc));
}

bool story_give(struct story *story, struct hash hash, struct bytes object)
{
	if (hash_equal(hash, story->page_at.hash) && !story->page_here) {
		story->page_here = true;
		buffer_clear(&story->page_bytes);
		buffer_put(&story->page_bytes, object.data, object.size);
		if (story->page_bytes.error ||
		    page_decode(&story->page, buffer_bytes(&story->page_bytes)) < 0 ||
		    story->page.kind != PAGE_INFO || story->page.child_count == 0) {
			log_error("app", "content bug: the release's info page is damaged");
			page_finish(&story->page); /* one of another kind names nothing of ours */
		}
		return true;
	}
	if (!story->database_here && story->page.child_count > 0 &&
	    hash_equal(hash, story->page.children[0].hash)) {
		story->database_here = true;
		give_database(story, object);
		return true;
	}
	return give_picture(story, hash, object);
}

static void want_child(struct story *story, struct wants *wants, uint32_t child, uint32_t priority)
{
	const struct message_want want = {
		.hash = story->page.children[child].hash,
		.page = story->page_at.hash,
		.offset = (uint32_t)page_child_offset(&story->page, child),
		.size = story->page.children[child].size,
		.priority = priority,
	};

	wants_add(wants, &want);
}

void story_wants(struct story *story, struct wants *wants)
{
	if (hash_is_zero(story->root))
		return;
	if (!story->page_here) {
		const struct message_want want = {
			.hash = story->page_at.hash,
			.page = story->root,
			.offset = story->page_offset,
			.size = story->page_at.size,
			.priority = MESSAGE_PRIORITY_INDEX,
		};

		wants_add(wants, &want);
		return;
	}
	if (story->page.child_count > 0 && !story->database_here)
		want_child(story, wants, 0, MESSAGE_PRIORITY_INDEX / 2);
	for (uint32_t i = 0; story->info && i < info_picture_count(story->info); i++) {
		const struct hash hash = info_picture(story->info, i)->hash;

		if (i >= PICTURES_MOST || !story->pictures[i].wanted)
			continue;
		for (uint32_t c = 1; c < story->page.child_count; c++)
			if (hash_equal(story->page.children[c].hash, hash))
				want_child(story, wants, c, MESSAGE_PRIORITY_INDEX / 2);
	}
}

bool story_broken(const struct story *story)
{
	return story->page_here && (story->page.child_count == 0 || story->database_here) &&
	       !story->info;
}

const char *story_language(const struct story *story)
{
	return story->language[0] ? story->language : NULL;
}

void story_set_language(struct story *story, const char *language)
{
	int page;

	if (story->info)
		language = info_nearest_language(story->info, language);
	if (strcmp(story->language, language) == 0)
		return;
	log_debug("app", "words in %s", language);
	snprintf(story->language, sizeof(story->language), "%s", language);
	if (!story->overlay)
		return;
	page = overlay_page(story->overlay);
	overlay_language(story->overlay, story->language);
	if (tell_parts(story) < 0 || tell_tours(story) < 0)
		log_error("app", "out of memory for the words of parts and tours");
	if (page >= 0)
		story_open_page(story, (uint32_t)page);
	if (overlay_searching(story->overlay))
		story_search(story); /* the language's own come first */
}

bool story_open_page(struct story *story, uint32_t part)
{
	struct bytes html;
	int rc = info_page(story->info, part, story->language, &html, NULL);

	if (rc == 0)
		rc = overlay_show_page(story->overlay, (int)part, html,
				       info_credits(story->info, part, story->language));
	if (rc < 0 && rc != -ENOENT)
		log_error("app", "content bug: page of %s: %s", info_part(story->info, part)->id,
			  strerror(-rc));
	return rc == 0;
}

void story_search(struct story *story)
{
	static uint32_t parts[FOUND_MOST];
	const char *query = overlay_query(story->overlay);

	if (*query)
		overlay_found(story->overlay, parts,
			      info_search(story->info, query, story->language, parts, FOUND_MOST));
}

/* ---- regions */

static void region_of(const struct info_region *from, struct region *out)
{
	static const enum region_kind kinds[] = {
		[INFO_REGION_POINT] = REGION_NONE,
		[INFO_REGION_SPHERE] = REGION_SPHERE,
		[INFO_REGION_BOX] = REGION_BOX,
		[INFO_REGION_PRISM] = REGION_PRISM,
	};

	_Static_assert((int)INFO_CORNERS_MOST == (int)REGION_CORNERS_MOST, "one limit");
	*out = (struct region){
		.kind = kinds[from->kind],
		.radius_m = from->radius_m,
		.turn_deg = from->turn_deg,
		.floor_m = from->floor_m,
		.roof_m = from->roof_m,
		.corner_count = from->corner_count,
	};
	memcpy(out->centre_m, from->centre_m, sizeof(out->centre_m));
	memcpy(out->half_m, from->half_m, sizeof(out->half_m));
	memcpy(out->corners_m, from->corners_m, sizeof(out->corners_m));
}

bool story_region(const struct story *story, uint32_t part, struct region *out)
{
	region_of(&info_part(story->info, part)->region, out);
	return out->kind != REGION_NONE;
}

int story_part_at(const struct story *story, const float point_m[3])
{
	float best_size = INFINITY;
	int best = -1;

	for (uint32_t i = 0; story->info && i < info_part_count(story->info); i++) {
		const float size = info_region_size_m(&info_part(story->info, i)->region);
		struct region region;

		if (size < best_size && story_region(story, i, &region) &&
		    region_contains(&region, point_m)) {
			best = (int)i;
			best_size = size;
		}
	}
	return best;
}

void story_viewpoint(const struct story *story, uint32_t part, float least_m, const float eye_m[3],
		     float eye_out_m[3], float target_m[3])
{
	const struct info_part *info = info_part(story->info, part);

	info_view(&info->region, info->anchor_m, least_m, eye_m, eye_out_m, target_m);
}
