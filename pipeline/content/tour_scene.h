/* Makes the stops of a tour from the Viewpoints of a scene. Private to pipeline/content. */
#ifndef GOPURA_PIPELINE_CONTENT_TOUR_SCENE_H
#define GOPURA_PIPELINE_CONTENT_TOUR_SCENE_H

#include "pipeline/content/draft.h"

/* Fills the tour's stops from a file that scenes.json names: a way's keys, of which the camera
 * passes those where it does not rest, or Viewpoints that stand still, where it stays. description:
 * as import_scenery_views. Every fault is added to the draft's diagnostics, and the tour then has
 * no stops. -ENOMEM. */
must_check int tour_scene_stops(struct draft *draft, struct draft_tour *tour, const char *file,
				const char *description);

#endif
