/* Compiles the content with the tours as they are in the editor, and samples the path of one. */
#include "curator/pages/tour_flight.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_tree.h"
#include "curator/pages/content_save.h"
#include "geometry/tour_path.h"
#include "geometry/vec.h"
#include "pipeline/content/part_faces.h"
#include "pipeline/content/tour_check.h"
#include "storage/info_tour.h"

enum { STEP_MS = 100, POSES_MAX = 6000 };

static int build(struct site *site, struct bytes tours, struct info_built *out,
		 struct diagnostics *found)
{
	const char *languages[CONTENT_LANGUAGES_MAX];
	const struct info_text_instead instead = { "tours.json", tours };
	struct part_faces_all faces;
	const struct info_build_options options = { .folder = site->content.folder,
						    .languages = languages,
						    .language_count = site->content.language_count,
						    .tools = site->content.tools,
						    .instead = &instead,
						    .instead_count = 1,
						    .skims_pictures = true,
						    .judge_faces = part_faces_judge,
						    .place_faces = part_faces_place,
						    .faces_data = &faces,
						    .diagnostics = found };
	int rc;

	for (uint32_t n = 0; n < options.language_count; n++)
		languages[n] = site->content.languages[n];
	part_faces_init(&faces, site->scans);
	rc = info_build(out, &options);
	part_faces_finish(&faces);
	return rc;
}

/* To a millimetre. */
static void add_numbers(cJSON *list, const float numbers[3])
{
	for (int i = 0; i < 3; i++)
		json_append(list, cJSON_CreateNumber(round((double)numbers[i] * 1e3) / 1e3));
}

static void add_stops(cJSON *list, const struct info_tour *tour)
{
	for (uint32_t n = 0; n < tour->stop_count; n++) {
		cJSON *stop = cJSON_CreateObject();

		add_numbers(cJSON_AddArrayToObject(stop, "eye"), tour->stops[n].eye_m);
		add_numbers(cJSON_AddArrayToObject(stop, "target"), tour->stops[n].target_m);
		json_append(list, stop);
	}
}

static void add_path(cJSON *json, const struct site *site, const struct info_tour *tour)
{
	struct tour_view views[TOUR_STOPS_MAX];
	cJSON *poses = cJSON_AddArrayToObject(json, "poses"),
	      *at = cJSON_AddArrayToObject(json, "at");
	float low_m[3], high_m[3];
	struct tour_path path;
	int64_t step_ms;

	for (uint32_t n = 0; n < tour->stop_count; n++) {
		const struct info_stop *stop = &tour->stops[n];

		views[n] = (struct tour_view){ .stay_s = stop->stay_s,
					       .travel_s = stop->travel_s,
					       .is_even = stop->is_even };
		memcpy(views[n].eye_m, stop->eye_m, sizeof(views[n].eye_m));
		memcpy(views[n].target_m, stop->target_m, sizeof(views[n].target_m));
	}
	mesh_box(site->mesh, low_m, high_m);
	tour_path_init(&path, views, tour->stop_count, tour->attract, vec_distance(low_m, high_m));
	step_ms = path.duration_ms / POSES_MAX > STEP_MS ? path.duration_ms / POSES_MAX : STEP_MS;
	for (int64_t ms = 0; ms < path.duration_ms + step_ms; ms += step_ms) {
		struct tour_pose pose;

		tour_path_pose(&path, ms < path.duration_ms ? ms : path.duration_ms, &pose);
		add_numbers(poses, pose.eye_m);
		add_numbers(poses, pose.target_m);
		json_append(at, cJSON_CreateNumber(pose.stop));
	}
	cJSON_AddNumberToObject(json, "step_ms", (double)step_ms);
	cJSON_AddNumberToObject(json, "duration_ms", (double)path.duration_ms);
}

static int add_flight(cJSON *json, struct site *site, const char *id,
		      const struct info_built *built, struct diagnostics *found)
{
	const struct tour_check_options check = { .mesh = site->mesh, .diagnostics = found };
	const struct info_tour *tour = NULL;
	struct info *info;
	int rc = info_open(&info, buffer_bytes(&built->database));

	if (rc < 0)
		return rc;
	for (uint32_t n = 0; n < info_tour_count(info); n++)
		if (strcmp(info_tour(info, n)->id, id) == 0)
			tour = info_tour(info, n);
	if (tour) {
		add_stops(cJSON_AddArrayToObject(json, "stops"), tour);
		add_path(json, site, tour);
		rc = tour_check(built, &check);
		rc = rc == -EINVAL ? 0 : rc; /* its faults are in the list */
	} else {
		rc = -ENOENT;
	}
	info_close(info);
	return rc;
}

int tour_flight(struct cJSON **out, struct site *site, const char *id, struct bytes tours,
		struct diagnostics *diagnostics)
{
	struct diagnostics found = { .max = CONTENT_PROBLEMS_MAX };
	cJSON *json = cJSON_CreateObject();
	struct info_built built = { 0 };
	int rc;

	documents_lock(site->documents);
	rc = build(site, tours, &built, &found);
	documents_unlock(site->documents);
	if (rc == 0)
		rc = add_flight(json, site, id, &built, &found);
	else if (rc == -EINVAL && found.error_count > 0)
		rc = 0; /* without a path: the faults are the answer */
	if (rc == 0)
		json_add(json, "problems", content_problems(&found, ""));
	else
		diagnostics_add(diagnostics, rc, NULL, 0, "%s",
				rc == -ENOENT ? "there is no such tour"
					      : diagnostics_cause(&found, rc));
	info_built_finish(&built);
	diagnostics_finish(&found);
	if (rc < 0)
		cJSON_Delete(json);
	*out = rc < 0 ? NULL : json;
	return rc;
}
