/* The information about the model's parts: loads the release's information database and its
 * pictures, and shows them in the overlay. */
#ifndef GOPURA_APP_VIEW_INFORMATION_VIEW_H
#define GOPURA_APP_VIEW_INFORMATION_VIEW_H

#include "format/message.h"
#include "format/root_page.h"
#include "render/scene/scene.h"
#include "storage/info_spoken.h"
#include "ui/overlay.h"

struct information_view;

struct information_view_options {
	int width_px, height_px; /* of the picture as the visitor sees it */
	float px_per_mm;         /* 0: estimated */
	const char *language;    /* copied; NULL: the first language of the release */
	bool sound;              /* spoken texts are offered */
};

/* Creates a view without a release. *out is owned by the caller; it is NULL on failure. Returns 0
 * or -ENOMEM. */
must_check int information_view_create(struct information_view **out,
				       const struct information_view_options *options);
/* Frees it; NULL is fine. */
void information_view_destroy(struct information_view *view);

/* Begins to load a release; its info page is child ROOT_CHILD_INFO of the root page, which is
 * borrowed for the call. An open page or card closes when the new database arrives; until then the
 * old database is used. */
void information_view_open(struct information_view *view, struct hash root,
			   const struct page *root_page);
/* Gives an object that arrived to the view; borrowed for the call. Returns true if it belongs to
 * the view. */
bool information_view_give(struct information_view *view, struct hash hash, struct bytes object);
/* Writes the objects that are still needed, at most `most`, most important first. Returns how many
 * were written. */
uint32_t information_view_wants(const struct information_view *view, struct message_want *out,
				uint32_t most);

/* Return the overlay and the database; NULL until the database has arrived, and if view is NULL.
 * Borrowed until the next information_view_give. */
struct overlay *information_view_overlay(struct information_view *view);
const struct info *information_view_info(const struct information_view *view); /* likewise */
/* Returns whether the info page or the database arrived but could not be read. */
bool information_view_broken(const struct information_view *view);
/* Returns the language in use; NULL if none is chosen yet, or if view is NULL. Borrowed. */
const char *information_view_language(const struct information_view *view);
/* Changes to the language of the release that is nearest to the given one, and writes the overlay's
 * texts again. language is copied. */
void information_view_set_language(struct information_view *view, const char *language);

/* Searches for the overlay's query, and gives it the parts found. */
void information_view_search(struct information_view *view);

/* Returns the smallest part that contains a point of the surface, or -1. */
int information_view_part_at(const struct information_view *view, const float point_m[3]);
/* Writes the region of a part, for its outline. Returns false if it is only a point. */
bool information_view_region(const struct information_view *view, uint32_t part,
			     struct region *out);
/* Writes a pose from which the part is seen well: in about the direction from which the eye sees it
 * now, but closer. A part smaller than least_m, or a point, is treated as if it had that size. */
void information_view_viewpoint(const struct information_view *view, uint32_t part, float least_m,
				const float eye_m[3], float eye_out_m[3], float target_m[3]);

/* Opens a part's page beside the model. Returns false if there is none, or it cannot be shown
 * (logged). */
bool information_view_open_page(struct information_view *view, uint32_t part);

/* Finds the spoken text of the open page, as info_spoken, and asks for its object. Returns its
 * bytes; empty: they have not arrived. *spoken is borrowed until the next call, and so are the
 * bytes. -ENOENT: there is none, or no page is open. Other errors as of info_spoken. */
must_check int information_view_spoken(struct information_view *view, struct info_spoken *spoken,
				       struct bytes *bytes);

#endif
