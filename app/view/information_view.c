/* Loads a release's information page, database and pictures as they arrive, and fills the overlay
 * with their texts. */
#include "app/view/information_view.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "geometry/viewpoint.h"
#include "storage/info_ask.h"
#include "storage/info_tools.h"
#include "storage/info_tour.h"

enum {
	DECODED_MAX = 48,
	DECODED_BYTES_MAX = 128 << 20, /* a picture of 4096 pixels a side takes 64 MiB */
	WANTED_MAX = 128, /* pictures; the model is wanted too, and the list is not endless */
	LANGUAGE_BYTES = 16,
	FOUND_MAX = 100,
};

/* Of what a visitor has asked for, and of the database. */
enum { ASKED_PRIORITY = MESSAGE_PRIORITY_INDEX / 2, DATABASE_PRIORITY = 350000 };

/* One picture of the release. */
struct information_view_picture {
	bool wanted;
	bool broken;            /* arrived but cannot be decoded; it is not requested again */
	struct picture decoded; /* rgba NULL: not loaded */
	uint64_t used;          /* value of turn at its last use, to evict the oldest */
	uint32_t child;         /* of the info page; set where it is wanted */
};

struct information_view {
	struct information_view_options options;
	char language[LANGUAGE_BYTES];
	struct overlay *overlay;
	struct info *info;

	struct hash root;          /* zero: no release */
	struct page_child page_at; /* the info page in the root page */
	uint32_t page_offset;
	bool page_here, database_here; /* arrived, intact or damaged: no longer wanted */
	struct page page;              /* the info page; no children until it has arrived */
	struct buffer page_bytes;      /* the bytes that page.payload points into */

	struct information_view_picture *pictures; /* owned; indexed like info_picture */
	uint32_t picture_count;
	uint64_t turn;             /* counts the uses of pictures */
	uint32_t uses[WANTED_MAX]; /* which picture was used in turn n, at n % WANTED_MAX */
	struct hash spoken_hash;   /* of the spoken text that was asked for last; zero: none */
	struct buffer spoken;      /* its bytes; empty: they have not arrived */
};

int information_view_create(struct information_view **out,
			    const struct information_view_options *options)
{
	struct information_view *view = calloc(1, sizeof(*view));

	*out = NULL;
	if (!view)
		return -ENOMEM;
	view->options = *options;
	if (options->language)
		snprintf(view->language, sizeof(view->language), "%s", options->language);
	view->options.language = NULL;
	buffer_init(&view->page_bytes, PAGE_BYTES_MAX);
	buffer_init(&view->spoken, INFO_SPOKEN_BYTES_MAX);
	*out = view;
	return 0;
}

static void forget_pictures(struct information_view *view)
{
	for (uint32_t i = 0; i < view->picture_count; i++)
		picture_finish(&view->pictures[i].decoded);
	free(view->pictures);
	view->pictures = NULL;
	view->picture_count = 0;
	view->turn = 0;
}

void information_view_destroy(struct information_view *view)
{
	if (!view)
		return;
	overlay_destroy(view->overlay);
	info_close(view->info);
	forget_pictures(view);
	page_finish(&view->page);
	buffer_finish(&view->page_bytes);
	buffer_finish(&view->spoken);
	free(view);
}

void information_view_open(struct information_view *view, struct hash root,
			   const struct page *root_page)
{
	page_finish(&view->page);
	view->page_here = view->database_here = false;
	view->root = root;
	view->page_at = root_page->children[ROOT_CHILD_INFO];
	view->page_offset = (uint32_t)page_child_offset(root_page, ROOT_CHILD_INFO);
}

struct overlay *information_view_overlay(struct information_view *view)
{
	return view ? view->overlay : NULL;
}

const struct info *information_view_info(const struct information_view *view)
{
	return view ? view->info : NULL;
}

/* ---- pictures */

static uint32_t picture_index(const struct information_view *view,
			      const struct info_picture *picture)
{
	return (uint32_t)(picture - info_picture(view->info, 0));
}

static void note_use(struct information_view *view, uint32_t picture)
{
	view->pictures[picture].used = ++view->turn;
	view->uses[view->turn % WANTED_MAX] = picture;
}

/* Returns the child of the info page with that name; 0, which is the database: there is none. */
static uint32_t find_child(const struct information_view *view, struct hash hash)
{
	for (uint32_t c = 1; c < view->page.child_count; c++)
		if (hash_equal(view->page.children[c].hash, hash))
			return c;
	return 0;
}

static bool on_picture(void *data, const char *name, struct found_picture *out)
{
	struct information_view *view = data;
	const struct info_picture *picture =
		view->info ? info_find_picture(view->info, name) : NULL;
	struct information_view_picture *own;
	bool wanted;

	if (!picture)
		return false;
	own = &view->pictures[picture_index(view, picture)];
	note_use(view, picture_index(view, picture));
	wanted = !own->decoded.rgba && !own->broken;
	if (wanted && !own->wanted)
		own->child = find_child(view, picture->hash);
	own->wanted = wanted;
	*out = (struct found_picture){
		.picture = own->decoded.rgba ? &own->decoded : NULL,
		.width_px = picture->width_px,
		.height_px = picture->height_px,
	};
	return true;
}

static size_t decoded_bytes(const struct information_view_picture *own)
{
	return (size_t)4 * own->decoded.width * own->decoded.height;
}

/* Returns the picture used longest ago if more are decoded than may be, else NULL. */
static struct information_view_picture *find_one_too_many(const struct information_view *view)
{
	struct information_view_picture *oldest = NULL;
	uint32_t count = 0;
	size_t bytes = 0;

	for (uint32_t i = 0; i < view->picture_count; i++) {
		struct information_view_picture *own = &view->pictures[i];

		if (!own->decoded.rgba)
			continue;
		count++;
		bytes += decoded_bytes(own);
		if (!oldest || own->used < oldest->used)
			oldest = own;
	}
	return count > DECODED_MAX || (count > 1 && bytes > DECODED_BYTES_MAX) ? oldest : NULL;
}

/* They are requested again when they are needed. */
static void let_oldest_pictures_go(struct information_view *view)
{
	struct information_view_picture *own;

	while ((own = find_one_too_many(view)))
		picture_finish(&own->decoded);
}

static void decode_picture(struct information_view_picture *own, const char *name,
			   struct bytes object)
{
	const int rc = picture_decode_for_page(&own->decoded, object);

	own->broken = rc < 0 && rc != -ENOMEM; /* without memory it is wanted again */
	if (rc == -ENOMEM)
		log_warn("app", "out of memory for picture %s", name);
	else if (rc == -EFBIG)
		log_error("app", "content bug: picture %s is larger than %d px a side", name,
			  PICTURE_PAGE_SIDE_MOST_PX);
	else if (rc < 0)
		log_error("app", "content bug: picture %s cannot be shown", name);
}

static bool give_picture(struct information_view *view, struct hash hash, struct bytes object)
{
	bool ours = false;

	if (!view->info || !view->overlay)
		return false;
	for (uint32_t i = 0; i < view->picture_count; i++) {
		const struct info_picture *picture = info_picture(view->info, i);
		struct information_view_picture *own = &view->pictures[i];

		if (!hash_equal(picture->hash, hash))
			continue;
		ours = true;
		own->wanted = false;
		note_use(view, i); /* the new one is not the one to go */
		if (!own->decoded.rgba)
			decode_picture(own, picture->name, object);
		let_oldest_pictures_go(view);
		overlay_picture_arrived(view->overlay, picture->name);
	}
	return ours;
}

/* ---- spoken texts */

static bool give_spoken(struct information_view *view, struct hash hash, struct bytes object)
{
	if (hash_is_zero(view->spoken_hash) || !hash_equal(view->spoken_hash, hash))
		return false;
	if (view->spoken.size == 0)
		buffer_put(&view->spoken, object.data, object.size);
	return true;
}

static void forget_spoken(struct information_view *view)
{
	view->spoken_hash = (struct hash){ 0 };
	buffer_finish(&view->spoken);
	buffer_init(&view->spoken, INFO_SPOKEN_BYTES_MAX);
}

int information_view_spoken(struct information_view *view, struct info_spoken *spoken,
			    struct bytes *bytes)
{
	const int part = view->overlay ? overlay_page(view->overlay) : -1;
	int rc = view->info && part >= 0
			 ? info_spoken(view->info, (uint32_t)part, view->language, spoken)
			 : -ENOENT;

	*bytes = (struct bytes){ 0 };
	if (rc < 0)
		return rc;
	if (!hash_equal(view->spoken_hash, spoken->hash)) {
		forget_spoken(view);
		view->spoken_hash = spoken->hash;
	}
	*bytes = buffer_bytes(&view->spoken);
	return view->spoken.error;
}

/* ---- the database */

static int tell_parts(struct information_view *view)
{
	const uint32_t count = info_part_count(view->info);
	struct overlay_part *parts = calloc(count ? count : 1, sizeof(*parts));
	int rc;

	if (!parts)
		return -ENOMEM;
	for (uint32_t i = 0; i < count; i++) {
		const struct info_text text = info_text(view->info, i, view->language);

		parts[i] = (struct overlay_part){
			.title = text.title,
			.caption = text.caption,
			.thumbnail = text.thumbnail,
			.has_page = info_part(view->info, i)->has_page,
		};
	}
	rc = overlay_parts(view->overlay, parts, count);
	free(parts);
	return rc;
}

static int tell_tours(struct information_view *view)
{
	struct overlay_tour tours[INFO_TOURS_MAX];
	const uint32_t count = info_tour_count(view->info);

	for (uint32_t i = 0; i < count; i++) {
		const struct info_text text = info_tour_text(view->info, i, view->language);

		tours[i] = (struct overlay_tour){ text.title, text.caption, text.thumbnail };
	}
	return overlay_tours(view->overlay, tours, count) < 0 ? -ENOMEM : 0;
}

static int create_overlay(struct information_view *view)
{
	const char *languages[OVERLAY_LANGUAGES_MAX];
	struct overlay_options options = {
		.width_px = view->options.width_px,
		.height_px = view->options.height_px,
		.px_per_mm = view->options.px_per_mm,
		.languages = languages,
		.language_count = info_language_count(view->info),
		.picture = on_picture,
		.data = view,
	};

	if (options.language_count > OVERLAY_LANGUAGES_MAX)
		options.language_count = OVERLAY_LANGUAGES_MAX;
	for (uint32_t i = 0; i < options.language_count; i++)
		languages[i] = info_language(view->info, i);
	overlay_destroy(view->overlay);
	return overlay_create(&view->overlay, &options);
}

_Static_assert((int)INFO_TOOL_LIGHT == (int)OVERLAY_TOOL_LIGHT &&
		       (int)INFO_TOOL_SECTION == (int)OVERLAY_TOOL_SECTION &&
		       (int)INFO_TOOL_MEASURE == (int)OVERLAY_TOOL_MEASURE &&
		       (int)INFO_TOOL_WALK == (int)OVERLAY_TOOL_WALK,
	       "one set of tools");

static void forget_database(struct information_view *view)
{
	overlay_destroy(view->overlay);
	view->overlay = NULL;
	forget_pictures(view);
	info_close(view->info);
	view->info = NULL;
}

static int make_pictures(struct information_view *view)
{
	const uint32_t count = info_picture_count(view->info);

	view->pictures = calloc((size_t)count + 1, sizeof(*view->pictures));
	view->picture_count = view->pictures ? count : 0;
	return view->pictures ? 0 : -ENOMEM;
}

/* -ENOMEM: as if it had not arrived. */
static int give_database(struct information_view *view, struct bytes object)
{
	struct info *info;
	int rc = info_open(&info, object);

	if (rc < 0) {
		if (rc != -ENOMEM)
			log_error("app",
				  "content bug: the release's information database is damaged");
		return rc;
	}
	forget_pictures(view);
	forget_spoken(view);
	info_close(view->info);
	view->info = info;
	if (make_pictures(view) < 0) {
		forget_database(view);
		return -ENOMEM;
	}
	snprintf(view->language, sizeof(view->language), "%s",
		 info_nearest_language(info, view->language));
	rc = create_overlay(view);
	if (rc == 0) {
		overlay_language(view->overlay, view->language);
		overlay_offer_tools(view->overlay, info_tools(info));
		rc = tell_parts(view);
		if (rc == 0)
			rc = tell_tours(view);
	}
	if (rc == -ENOMEM)
		forget_database(view);
	else if (rc < 0)
		log_error("app", "the texts over the model cannot be shown: %s", strerror(-rc));
	return rc;
}

static int give_page(struct information_view *view, struct bytes object)
{
	int rc;

	buffer_clear(&view->page_bytes);
	buffer_put(&view->page_bytes, object.data, object.size);
	rc = view->page_bytes.error;
	if (rc == 0)
		rc = page_decode(&view->page, buffer_bytes(&view->page_bytes));
	if (rc == 0 && (view->page.kind != PAGE_INFO || view->page.child_count == 0)) {
		page_finish(&view->page); /* another kind of page has no children for us */
		rc = -EBADMSG;
	}
	if (rc < 0 && rc != -ENOMEM)
		log_error("app", "content bug: the release's info page is damaged");
	return rc;
}

/* Returns whether it is here, damaged or not: without memory it is wanted again. */
static bool is_here(int rc)
{
	if (rc == -ENOMEM)
		log_warn("app", "out of memory for the texts; they are requested again");
	return rc != -ENOMEM;
}

bool information_view_give(struct information_view *view, struct hash hash, struct bytes object)
{
	if (hash_equal(hash, view->page_at.hash) && !view->page_here) {
		view->page_here = is_here(give_page(view, object));
		return true;
	}
	if (!view->database_here && view->page.child_count > 0 &&
	    hash_equal(hash, view->page.children[0].hash)) {
		view->database_here = is_here(give_database(view, object));
		return true;
	}
	return give_spoken(view, hash, object) || give_picture(view, hash, object);
}

static struct message_want child_want(const struct information_view *view, uint32_t child)
{
	return (struct message_want){
		.hash = view->page.children[child].hash,
		.page = view->page_at.hash,
		.offset = (uint32_t)page_child_offset(&view->page, child),
		.size = view->page.children[child].size,
		.priority = ASKED_PRIORITY,
	};
}

/* A visitor looks first: the database comes when nothing improves the picture by 5 pixels a
 * kilobyte any more, which is at about 30 dB. */
static struct message_want database_want(const struct information_view *view)
{
	struct message_want want = child_want(view, 0);

	want.priority = DATABASE_PRIORITY;
	return want;
}

/* child 0: there is none. */
static void add_want(const struct information_view *view, uint32_t child, struct message_want *out,
		     uint32_t *count, uint32_t most)
{
	if (child > 0 && *count < most)
		out[(*count)++] = child_want(view, child);
}

uint32_t information_view_wants(const struct information_view *view, struct message_want *out,
				uint32_t most)
{
	uint32_t count = 0;

	if (hash_is_zero(view->root) || most == 0)
		return 0;
	if (!view->page_here) {
		out[0] = (struct message_want){
			.hash = view->page_at.hash,
			.page = view->root,
			.offset = view->page_offset,
			.size = view->page_at.size,
			.priority = MESSAGE_PRIORITY_INDEX,
		};
		return 1;
	}
	if (view->page.child_count > 0 && !view->database_here)
		out[count++] = database_want(view);
	if (!hash_is_zero(view->spoken_hash) && view->spoken.size == 0)
		add_want(view, find_child(view, view->spoken_hash), out, &count, most);
	/* What was asked for long ago, such as a row that scrolled by, is wanted when it is asked
	 * for again. */
	for (uint64_t turn = view->turn; turn > 0 && view->turn - turn < WANTED_MAX; turn--) {
		const struct information_view_picture *own =
			&view->pictures[view->uses[turn % WANTED_MAX]];

		if (own->wanted && own->used == turn)
			add_want(view, own->child, out, &count, most);
	}
	return count;
}

bool information_view_broken(const struct information_view *view)
{
	return view->page_here && (view->page.child_count == 0 || view->database_here) &&
	       !view->info;
}

const char *information_view_language(const struct information_view *view)
{
	return view && view->language[0] ? view->language : NULL;
}

/* Opens the page in another language, where it was read, with what lies over it: its picture, or a
 * card that one of its links opened. */
static void open_page_again(struct information_view *view)
{
	struct overlay *overlay = view->overlay;
	const int card = overlay_card(overlay), picture = overlay_picture(overlay);
	const float read = overlay_read(overlay);

	if (!information_view_open_page(view, (uint32_t)overlay_page(overlay)))
		return;
	overlay_read_from(overlay, read);
	overlay_show_card(overlay, card);
	overlay_show_picture(overlay, picture);
}

void information_view_set_language(struct information_view *view, const char *language)
{
	if (view->info)
		language = info_nearest_language(view->info, language);
	if (strcmp(view->language, language) == 0)
		return;
	log_debug("app", "words in %s", language);
	snprintf(view->language, sizeof(view->language), "%s", language);
	if (!view->overlay)
		return;
	overlay_language(view->overlay, view->language);
	if (tell_parts(view) < 0 || tell_tours(view) < 0)
		log_error("app", "out of memory for the texts of parts and tours");
	if (overlay_page(view->overlay) >= 0)
		open_page_again(view);
	if (overlay_searching(view->overlay))
		information_view_search(view); /* results in the chosen language come first */
}

bool information_view_open_page(struct information_view *view, uint32_t part)
{
	struct info_spoken spoken;
	struct bytes article;
	int rc = info_page(view->info, part, view->language, &article, NULL);

	if (rc == 0)
		rc = overlay_show_page(view->overlay, (int)part, article,
				       info_credits(view->info, part, view->language));
	if (rc < 0 && rc != -ENOENT)
		log_error("app", "content bug: page of %s: %s", info_part(view->info, part)->id,
			  strerror(-rc));
	if (rc == 0 && view->options.sound)
		overlay_offer_spoken(view->overlay,
				     info_spoken(view->info, part, view->language, &spoken) == 0);
	return rc == 0;
}

void information_view_search(struct information_view *view)
{
	static uint32_t parts[FOUND_MAX];
	const char *query = overlay_query(view->overlay);

	if (*query)
		overlay_found(view->overlay, parts,
			      info_search(view->info, query, view->language, parts, FOUND_MAX));
}

/* ---- regions */

bool information_view_region(const struct information_view *view, uint32_t part, struct region *out)
{
	*out = info_part(view->info, part)->region;
	return out->kind != REGION_POINT;
}

int information_view_part_at(const struct information_view *view, const float point_m[3])
{
	float best_size = INFINITY;
	int best = -1;

	for (uint32_t i = 0; view->info && i < info_part_count(view->info); i++) {
		const float size = region_size_m(&info_part(view->info, i)->region);
		struct region region;

		if (size < best_size && information_view_region(view, i, &region) &&
		    region_contains(&region, point_m)) {
			best = (int)i;
			best_size = size;
		}
	}
	return best;
}

void information_view_viewpoint(const struct information_view *view, uint32_t part, float least_m,
				const float eye_m[3], float eye_out_m[3], float target_m[3])
{
	const struct info_part *info = info_part(view->info, part);

	viewpoint_of_region(&info->region, info->anchor_m, least_m, eye_m, eye_out_m, target_m);
}
