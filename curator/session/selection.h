/* The tools of a session: strokes on the sharp view become changes of the region. One thread. */
#ifndef GOPURA_CURATOR_SESSION_SELECTION_H
#define GOPURA_CURATOR_SESSION_SELECTION_H

#include "curator/region/region_set.h"
#include "curator/select/superpixels.h"
#include "curator/session/request.h"
#include "curator/session/site.h"

struct selection {
	struct site *site;               /* borrowed, as all but what is owned */
	struct region_set *set;          /* changed by strokes */
	const struct view_image *image;  /* NULL: no view */
	struct camera camera;            /* of the image */
	struct superpixels superpixels;  /* of the image, once has_superpixels; owned */
	bool has_superpixels, has_marks; /* whether any stroke of mark or unmark is kept */
	uint8_t *marks, *in_part;        /* for each pixel; owned */
};

/* site and set are borrowed. There is no view yet. */
void selection_init(struct selection *selection, struct site *site, struct region_set *set);

/* Works on another view; strokes that are kept are dropped. The image is borrowed until the next
 * call or selection_leave, which frees what belongs to the view. -ENOMEM; then there is no view. */
must_check int selection_look(struct selection *selection, const struct view_image *image,
			      const struct camera *camera);
void selection_leave(struct selection *selection); /* works on no view; zeroed is fine */
/* Prepares for the first stroke, if that is not done. -ENOMEM. */
must_check int selection_prepare(struct selection *selection);

/* Carries out a stroke: a lasso or a heavy lasso changes the region, the others are kept.
 * -ESTALE: there is no view. -EINVAL: it marks nothing. -ENOMEM. */
must_check int selection_stroke(struct selection *selection, const struct request *stroke);
/* Finds the part from the strokes kept, and changes the region. Errors likewise. */
must_check int selection_apply(struct selection *selection, bool take, bool through);
void selection_clear(struct selection *selection);

/* Finds where the surface is at a pixel. Returns false if there is none. */
bool selection_pick(const struct selection *selection, const float at_px[2], float point_m[3]);

#endif
