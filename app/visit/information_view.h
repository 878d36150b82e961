/* What is known about the temple's parts: the release's information database, and the words and
 * pictures over the model. Wants its objects through wants_add like the scene does. */
#ifndef GOPURA_APP_VISIT_INFORMATION_VIEW_H
#define GOPURA_APP_VISIT_INFORMATION_VIEW_H

#include "app/wants.h"
#include "format/root_page.h"
#include "render/scene/scene.h"
#include "storage/info.h"
#include "ui/overlay.h"

struct story;

struct story_options {
	int width_px, height_px; /* as the visitor sees it */
	float px_per_mm;         /* 0: guessed */
	const char *language;    /* copied; NULL: the release's first */
};

must_check int story_create(struct story **out, const struct story_options *options);
void story_destroy(struct story *story);

/* Another release: its info page is child ROOT_CHILD_INFO of the root page. What is open closes
 * when the new database is there; until then the old one answers. */
void story_open(struct story *story, struct hash root, const struct page *root_page);
/* true: the object was the story's. */
bool story_give(struct story *story, struct hash hash, struct bytes object);
void story_wants(struct story *story, struct wants *wants);

/* NULL until the database is there, and for a story that is NULL. Borrowed until the next
 * story_give. */
struct overlay *story_overlay(struct story *story);
const struct info *story_info(const struct story *story);
/* What the words come from arrived and cannot be read. */
bool story_broken(const struct story *story);
/* NULL: not chosen yet. Borrowed. */
const char *story_language(const struct story *story);
void story_set_language(struct story *story, const char *language);

/* Says to the overlay what its query finds. */
void story_search(struct story *story);

/* The part that a point of the surface belongs to: of those that contain it the smallest, or -1. */
int story_part_at(const struct story *story, const float point_m[3]);
/* The region of a part, for the bold border. false: it is only a point. */
bool story_region(const struct story *story, uint32_t part, struct region *out);
/* Where to stand to see a part well: as the eye stands now, but nearer. A part that is smaller
 * than least_m, or a mere point, is looked at as if it were as large. */
void story_viewpoint(const struct story *story, uint32_t part, float least_m, const float eye_m[3],
		     float eye_out_m[3], float target_m[3]);

/* Opens a part's page beside the model. false: it has none. */
bool story_open_page(struct story *story, uint32_t part);

#endif
