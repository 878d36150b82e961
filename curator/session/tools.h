/* The tools of a session: strokes on the sharp view become changes of the region. One thread. */
#ifndef GOPURA_CURATOR_SESSION_TOOLS_H
#define GOPURA_CURATOR_SESSION_TOOLS_H

#include "curator/region/region_set.h"
#include "curator/select/superpixels.h"
#include "curator/session/message.h"
#include "curator/session/site.h"

struct tools {
	struct site *site;               /* borrowed, as all but what is owned */
	struct region_set *set;          /* changed by strokes */
	const struct view_image *image;  /* NULL: no view */
	struct camera camera;            /* of the image */
	struct superpixels superpixels;  /* of the image, once has_superpixels; owned */
	bool has_superpixels, has_marks; /* whether any stroke of mark or unmark is kept */
	uint8_t *marks, *in_part;        /* for each pixel; owned */
};

/* site and set are borrowed. */
void tools_init(struct tools *tools, struct site *site, struct region_set *set);
void tools_finish(struct tools *tools); /* zeroed is fine */

/* Works on another view, or NULL: on none; strokes that are kept are dropped. The image is borrowed
 * until the next call. -ENOMEM; then there is no view. */
must_check int tools_look(struct tools *tools, const struct view_image *image,
			  const struct camera *camera);
/* Prepares for the first stroke, if that is not done. -ENOMEM. */
must_check int tools_prepare(struct tools *tools);

/* Carries out a stroke: a lasso or a heavy lasso changes the region, the others are kept.
 * -ESTALE: there is no view. -EINVAL: it marks nothing. -ENOMEM. */
must_check int tools_stroke(struct tools *tools, const struct message *stroke);
/* Finds the part from the strokes kept, and changes the region. Errors likewise. */
must_check int tools_apply(struct tools *tools, bool take, bool through);
void tools_clear(struct tools *tools);

/* Finds where the surface is at a pixel. Returns false if there is none. */
bool tools_pick(const struct tools *tools, const float at_px[2], float point_m[3]);

#endif
