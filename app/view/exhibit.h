/* One release as it can be shown: its scene, its information, and what the last frame showed of
 * it. Others borrow the exhibit that is shown; its scene and view change with the release. */
#ifndef GOPURA_APP_VIEW_EXHIBIT_H
#define GOPURA_APP_VIEW_EXHIBIT_H

#include "app/view/information_view.h"
#include "format/hash.h"
#include "render/scene/scene.h"

struct exhibit {
	struct scene *scene;           /* owned; NULL: there is no release */
	struct information_view *view; /* owned; NULL like scene */
	struct hash root;
	uint32_t root_bytes;
	struct scene_frame frame; /* result of the last draw */
};

/* The event that another release is shown. */
struct exhibit_change {
	const struct exhibit *shown;  /* the new one; its scene is NULL if it cannot be opened */
	const struct exhibit *before; /* the one before it, about to be closed; its scene is NULL
					 if there was none */
};

/* Opens scene and view of a release. Returns 0 or a negative errno; *exhibit is zeroed then. */
must_check int exhibit_open(struct exhibit *exhibit, struct hash root, uint32_t root_bytes,
			    const struct scene_options *scene,
			    const struct information_view_options *view);
/* Frees scene and view, and zeroes the exhibit; a zeroed one is fine. */
void exhibit_close(struct exhibit *exhibit);
/* Returns whether an object of the release could not be decoded. */
bool exhibit_is_broken(const struct exhibit *exhibit);

/* Return the overlay and the database; NULL if there is no release or its database has not
 * arrived. Borrowed until an object is given to the view, or the release changes. */
struct overlay *exhibit_overlay(const struct exhibit *exhibit);
const struct info *exhibit_info(const struct exhibit *exhibit); /* likewise */

#endif
