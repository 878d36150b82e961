/* The anchors of the parts: where they are on the panel, and whether the model hides them. A few
 * are tested in each frame with a ray, because what hides an anchor changes slowly. */
#ifndef GOPURA_APP_VIEW_ANCHORS_H
#define GOPURA_APP_VIEW_ANCHORS_H

#include "app/view/eye.h"

struct anchors {
	bool hidden[OVERLAY_PARTS_MAX]; /* whether each was hidden when last tested */
	uint32_t next;                  /* the one tested last */
	uint32_t to_test;               /* still to test before the picture is final */
	uint32_t tested_triangles;      /* triangles drawn when they were last tested */
};

/* Places the anchors of the release that is shown in its overlay; call it after the scene was
 * drawn. An anchor that the section cuts away is not visible. */
void anchors_place(struct anchors *anchors, const struct eye *eye, const struct viewport *viewport,
		   const struct section *section);
/* Has all anchors tested again: something else may hide them. */
void anchors_test_again(struct anchors *anchors);
/* Another release is shown. data is the anchors. */
void anchors_on_release(void *data, const struct exhibit_change *change);

#endif
