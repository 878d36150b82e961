/* What is known about the temple's parts: the release's information database, and the words and
 * pictures over the model. Wants its objects through wants_add like the scene does. */
#ifndef GOPURA_APP_VISIT_INFORMATION_VIEW_H
#define GOPURA_APP_VISIT_INFORMATION_VIEW_H

#include "app/wants.h"
#include "format/root_page.h"
#include "render/scene/scene.h"
#include "storage/info.h"
#include "ui/overlay.h"

struct information_view;

struct information_view_options {
	int width_px, height_px; /* as the visitor sees it */
	float px_per_mm;         /* 0: guessed */
	const char *language;    /* copied; NULL: the release's first */
};

must_check int information_view_create(struct information_view **out,
				       const struct information_view_options *options);
void information_view_destroy(struct information_view *view);

/* Another release: its info page is child ROOT_CHILD_INFO of the root page. What is open closes
 * when the new database is there; until then the old one answers. */
void information_view_open(struct information_view *view, struct hash root,
			   const struct page *root_page);
/* true: the object was the story's. */
bool information_view_give(struct information_view *view, struct hash hash, struct bytes object);
void information_view_wants(struct information_view *view, struct wants *wants);

/* NULL until the database is there, and for a story that is NULL. Borrowed until the next
 * information_view_give. */
struct overlay *information_view_overlay(struct information_view *view);
const struct info *information_view_info(const struct information_view *view);
/* What the words come from arrived and cannot be read. */
bool information_view_broken(const struct information_view *view);
/* NULL: not chosen yet. Borrowed. */
const char *information_view_language(const struct information_view *view);
void information_view_set_language(struct information_view *view, const char *language);

/* Says to the overlay what its query finds. */
void information_view_search(struct information_view *view);

/* The part that a point of the surface belongs to: of those that contain it the smallest, or -1. */
int information_view_part_at(const struct information_view *view, const float point_m[3]);
/* The region of a part, for the bold border. false: it is only a point. */
bool information_view_region(const struct information_view *view, uint32_t part,
			     struct region *out);
/* Where to stand to see a part well: as the eye stands now, but nearer. A part that is smaller
 * than least_m, or a mere point, is looked at as if it were as large. */
void information_view_viewpoint(const struct information_view *view, uint32_t part, float least_m,
				const float eye_m[3], float eye_out_m[3], float target_m[3]);

/* Opens a part's page beside the model. false: it has none. */
bool information_view_open_page(struct information_view *view, uint32_t part);

#endif
