/* Looks a scene up in scenes.json for its axes and unit, and makes stops of its views. */
#include "pipeline/content/tour_scene.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"
#include "pipeline/content/tour_keys.h"
#include "pipeline/import/import_scenery.h"

#define STILL_STAY_S 6.0f  /* at a Viewpoint that stands still; as at other stops */
#define END_STAY_S   2.0f  /* where a way begins and ends, at least */
#define SAME_M       1e-4f /* the same view: the camera rests between two keys */

/* ---- the scene in scenes.json */

static const char *text_of(const cJSON *object, const char *key)
{
	return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, key));
}

/* Sets the axes and the unit of a scene, and *scene, owned by the caller, to the name of the file's
 * scene that is shown, or NULL. scenes_read reports what is wrong with them.
 * Returns -ENOENT if scenes.json does not name the file. */
static int find_scene(struct draft *draft, const char *file, struct import_options *options,
		      char **scene)
{
	struct json_text json;
	const cJSON *array, *item;
	int rc = draft_read_json(draft, "scenes.json", "scenes", &json, &array), found = -ENOENT;

	*options = (struct import_options){ .up = IMPORT_Y_UP };
	*scene = NULL;
	cJSON_ArrayForEach(item, array)
	{
		const char *name = text_of(item, "file"), *up = text_of(item, "up");
		const char *unit = text_of(item, "unit"), *shown = text_of(item, "scene");

		if (found == 0 || !name || strcmp(name, file) != 0)
			continue;
		found = 0;
		if (up)
			(void)import_axis_named(up, &options->up);
		if (unit)
			(void)import_unit_named(unit, &options->metres_per_unit);
		if (shown && !(*scene = strdup(shown)))
			rc = -ENOMEM;
	}
	json_text_finish(&json);
	return rc < 0 ? rc : found;
}

/* ---- stops */

static bool is_same(const struct import_view *a, const struct import_view *b)
{
	return vec_distance(a->eye_m, b->eye_m) < SAME_M &&
	       vec_distance(a->target_m, b->target_m) < SAME_M;
}

/* Adds a stop for a view, unless it is the last stop's: there the camera rests. */
static void add_view(struct draft_tour *tour, const struct import_views *views, uint32_t i)
{
	const struct import_view *view = &views->items[i];
	const struct import_view *before = i > 0 ? &views->items[i - 1] : NULL;
	const float since_s = before && views->is_way ? view->time_s - before->time_s : 0;
	struct draft_stop *stop;

	if (views->is_way && before && is_same(view, before)) {
		tour->stops[tour->stop_count - 1].view.stay_s += since_s;
		return;
	}
	stop = &tour->stops[tour->stop_count++];
	stop->line = tour->line;
	stop->has_eye = stop->has_target = true;
	memcpy(stop->view.eye_m, view->eye_m, sizeof(stop->view.eye_m));
	memcpy(stop->view.target_m, view->target_m, sizeof(stop->view.target_m));
	stop->view.part = -1;
	stop->view.stay_s = views->is_way ? 0 : STILL_STAY_S;
	stop->view.travel_s = since_s;
	stop->view.is_even = since_s > 0;
}

static int make_stops(struct draft *draft, struct draft_tour *tour,
		      const struct import_views *views, const char *file)
{
	tour->stops = calloc((size_t)views->count + 1, sizeof(*tour->stops));
	if (!tour->stops)
		return -ENOMEM;
	for (uint32_t i = 0; i < views->count; i++)
		add_view(tour, views, i);
	if (tour->stop_count >= 2 && tour->stop_count <= INFO_STOPS_MAX) {
		struct info_stop *ends[] = { &tour->stops[0].view,
					     &tour->stops[tour->stop_count - 1].view };

		for (int e = 0; e < 2; e++)
			if (ends[e]->stay_s < END_STAY_S)
				ends[e]->stay_s = END_STAY_S;
		return 0;
	}
	diagnostics_add(draft->diagnostics, -EINVAL, "tours.json", tour->line,
			views->is_way
				? "tour \"%.64s\": the camera in %.100s that moves has %u "
				  "views: a tour needs 2 to %d; give it as many keys"
				: "tour \"%.64s\": %.100s has %u Viewpoints or cameras: a tour "
				  "needs 2 to "
				  "%d, or one that moves",
			tour->id, file, tour->stop_count, INFO_STOPS_MAX);
	tour->stop_count = 0;
	return 0;
}

/* Where a way has more keys than a tour may have stops, leaves keys out. */
static int thin_out(struct draft *draft, const struct draft_tour *tour, struct import_views *views,
		    const char *file)
{
	const uint32_t count = views->count;
	float off_m = 0;
	int rc = 0;

	if (!views->is_way || count <= INFO_STOPS_MAX)
		return 0;
	rc = tour_keys_thin(views, INFO_STOPS_MAX, &off_m);
	if (rc == 0 && views->count < count)
		diagnostics_add(draft->diagnostics, 0, "tours.json", tour->line,
				"tour \"%.64s\": of the %u keys of the camera in %.100s, %u are "
				"flown, which keep its way within %.0f mm",
				tour->id, count, file, views->count, (double)off_m * 1000);
	return rc;
}

int tour_scene_stops(struct draft *draft, struct draft_tour *tour, const char *file,
		     const char *description)
{
	struct import_options options;
	struct import_views views = { 0 };
	char path[PATH_MAX];
	char *scene;
	int rc = find_scene(draft, file, &options, &scene);

	if (rc == -ENOENT) {
		diagnostics_add(draft->diagnostics, -EINVAL, "tours.json", tour->line,
				"tour \"%.64s\": scenes.json does not name \"%.100s\": add it "
				"there, or correct the tour's \"scene\"",
				tour->id, file);
		free(scene);
		return 0;
	}
	if (rc == 0 && !draft_path(draft, path, sizeof(path), file))
		rc = -ENAMETOOLONG;
	if (rc == 0)
		rc = import_scenery_views(&views, path, description, &options, scene,
					  draft->diagnostics);
	if (rc == 0)
		rc = thin_out(draft, tour, &views, file);
	if (rc == 0)
		rc = make_stops(draft, tour, &views, file);
	free(views.items);
	free(scene);
	return rc == -ENOMEM || rc == -ENAMETOOLONG ? rc : 0;
}
