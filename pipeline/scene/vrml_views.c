/* Finds Viewpoints, follows the routes that move one back to its TimeSensor, and evaluates it at
 * the keys of its interpolators. */
#include "pipeline/scene/vrml_views.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/map.h"
#include "geometry/turn.h"
#include "geometry/vec.h"
#include "pipeline/scene/scenery_maker.h"
#include "pipeline/scene/vrml_graph.h"
#include "pipeline/scene/vrml_keys.h"

/* The keys of both interpolators, and the two ends. */
enum { WAY_VIEWS_MAX = 2 * SCENE_KEYS_MAX + 2 };

/* A Viewpoint, where the Transforms above it put it, and what moves it; NULL: nothing does. */
struct camera {
	const struct vrml_node *node, *position, *orientation;
	float place[16];
	bool is_carried; /* by a Transform that moves */
};

struct search {
	const struct vrml *scene;
	struct diagnostics *diagnostics;
	struct map carriers; /* Transforms that routes move */
	struct camera *cameras;
	uint32_t count, room, visits, depth;
};

static map_key key_of(const struct vrml_node *node)
{
	return (map_key)(uintptr_t)node;
}

/* ---- Viewpoints */

/* Returns the interpolator that sets a field of the node; NULL: none. */
static const struct vrml_node *mover_of(const struct vrml *scene, const struct vrml_node *node,
					const char *field, const char *type)
{
	for (const struct vrml_route *route = scene->routes; route; route = route->before)
		if (*route->to == node && *route->from && vrml_is(*route->from, type) &&
		    strcmp(route->out, "value_changed") == 0 && vrml_event_sets(route->in, field))
			return *route->from;
	return NULL;
}

static int add_camera(struct search *search, const struct vrml_node *node, const float place[16],
		      bool is_carried)
{
	struct camera *camera;
	int rc = ARRAY_RESERVE(search->cameras, search->room, (uint64_t)search->count + 1,
			       SCENE_CAMERAS_MAX);

	if (rc < 0)
		return diagnostics_add(search->diagnostics, rc, node->file, node->line,
				       "over %d Viewpoints; leave some out", SCENE_CAMERAS_MAX);
	camera = &search->cameras[search->count++];
	*camera = (struct camera){ .node = node, .is_carried = is_carried };
	memcpy(camera->place, place, sizeof(camera->place));
	camera->position = mover_of(search->scene, node, "position", "PositionInterpolator");
	camera->orientation =
		mover_of(search->scene, node, "orientation", "OrientationInterpolator");
	return 0;
}

static int visit(struct search *search, const struct vrml_node *of, const float parent[16],
		 bool is_carried)
{
	struct vrml_node *const *children;
	float place[16];
	uint32_t count;
	int rc = 0;

	if (++search->visits > VRML_VISITS_MAX || search->depth == VRML_DEPTH_MAX)
		return diagnostics_add(search->diagnostics, -EFBIG, of->file, of->line,
				       "USE repeats nodes over %d times, or nests them over %d "
				       "deep; split the scene",
				       VRML_VISITS_MAX, VRML_DEPTH_MAX);
	if (vrml_is(of, "Viewpoint"))
		return add_camera(search, of, parent, is_carried);
	memcpy(place, parent, sizeof(place));
	if (vrml_is(of, "Transform")) {
		vrml_transform(place, parent, of);
		is_carried |= map_get(&search->carriers, key_of(of)) != MAP_NONE;
	}
	children = vrml_children(of, &count);
	search->depth++;
	for (uint32_t i = 0; i < count && rc == 0; i++)
		rc = visit(search, children[i], place, is_carried);
	search->depth--;
	return rc;
}

static int find_cameras(struct search *search)
{
	int rc = 0;

	for (const struct vrml_route *route = search->scene->routes; route && rc == 0;
	     route = route->before)
		if (*route->to && vrml_is(*route->to, "Transform"))
			rc = map_set(&search->carriers, key_of(*route->to), 1);
	for (uint32_t i = 0; i < search->scene->root_count && rc == 0; i++)
		rc = visit(search, search->scene->roots[i], vrml_identity, false);
	return rc;
}

static bool moves(const struct camera *camera)
{
	return camera->position || camera->orientation || camera->is_carried;
}

static const char *name_of(const struct camera *camera)
{
	const struct vrml_value *value = vrml_get(camera->node, "description");

	return value && value->count > 0 ? value->strings[0] : "";
}

/* Sets *found to the moving Viewpoint that is meant; NULL: none moves, and none was named. */
static int choose(const struct search *search, const char *description, const struct camera **found)
{
	const char *file = search->scene->root_count > 0 ? search->scene->roots[0]->file : "scene";

	*found = NULL;
	for (uint32_t i = 0; i < search->count; i++) {
		const struct camera *camera = &search->cameras[i];

		if (!moves(camera) || (description && strcmp(name_of(camera), description) != 0))
			continue;
		if (*found && (*found)->node != camera->node)
			return diagnostics_add(
				search->diagnostics, -EINVAL, camera->node->file,
				camera->node->line,
				"a second Viewpoint that moves, \"%.60s\": give each its own "
				"description, and name one as the tour's \"viewpoint\"",
				name_of(camera));
		*found = camera;
	}
	if (description && !*found)
		return diagnostics_add(search->diagnostics, -EINVAL, file, 0,
				       "has no moving Viewpoint whose description is \"%.60s\"; "
				       "correct the tour's \"viewpoint\"",
				       description);
	if (search->count == 0)
		return diagnostics_add(search->diagnostics, -EINVAL, file, 0,
				       "has no Viewpoint that a tour could show; add one");
	return 0;
}

/* ---- one view */

static void own_position(float out[3], const struct vrml_node *node)
{
	vrml_get_floats(out, node, "position", 3, (const float[3]){ 0, 0, 10 });
}

static void own_turn(float out[4], const struct vrml_node *node)
{
	float rotation[4];

	vrml_get_floats(rotation, node, "orientation", 4, (const float[4]){ 0, 0, 1, 0 });
	turn_about(out, rotation, rotation[3]);
}

static int add_still(struct scene_views *out, const struct search *search)
{
	int rc = 0;

	for (uint32_t i = 0; i < search->count && rc == 0; i++) {
		float position[3], turn[4];

		own_position(position, search->cameras[i].node);
		own_turn(turn, search->cameras[i].node);
		rc = scene_views_add(out, 0, search->cameras[i].place, position, turn);
	}
	return rc;
}

/* ---- a moving one */

struct keys {
	const struct vrml_value *times, *values; /* NULL: it stays */
};

/* Returns the key before a moment, and how far between it and the next the moment is. */
static uint32_t find_key(const struct vrml_value *times, struct scene_moment moment, float *share)
{
	const float time = moment.time;
	uint32_t at = 0, end = times->count; /* the first key after the moment is one of these */

	while (at < end) {
		const uint32_t middle = (at + end) / 2;

		if (scene_moment_reaches(moment, times->floats[middle]))
			at = middle + 1;
		else
			end = middle;
	}
	at -= at > 0;
	*share = 0;
	if (at + 1 < times->count && time > times->floats[at])
		*share = (time - times->floats[at]) / (times->floats[at + 1] - times->floats[at]);
	return at;
}

static void position_at(float out[3], const struct keys *keys, struct scene_moment moment)
{
	float share;
	const uint32_t at = find_key(keys->times, moment, &share);
	const float *from = &keys->values->floats[3 * at], *to = share > 0 ? from + 3 : from;

	for (int k = 0; k < 3; k++)
		out[k] = from[k] + share * (to[k] - from[k]);
}

/* The shorter way round, at an even speed. */
static void turn_at(float out[4], const struct keys *keys, struct scene_moment moment)
{
	float share, a[4], b[4];
	const uint32_t at = find_key(keys->times, moment, &share);
	const float *from = &keys->values->floats[4 * at], *to = share > 0 ? from + 4 : from;

	turn_about(a, from, from[3]);
	turn_about(b, to, to[3]);
	turn_between(out, a, b, share);
}

/* Writes the moments of all keys, each once, and both ends; returns how many. */
static uint32_t gather_moments(struct scene_moment out[WAY_VIEWS_MAX], const struct keys *position,
			       const struct keys *turn)
{
	const struct vrml_value *lists[] = { position->times, turn->times };
	uint32_t count = 0;

	out[count++] = (struct scene_moment){ .time = 0 };
	out[count++] = (struct scene_moment){ .time = 1 };
	for (size_t l = 0; l < ARRAY_COUNT(lists); l++)
		for (uint32_t i = 0; lists[l] && i < lists[l]->count; i++) {
			const float *key = &lists[l]->floats[i];
			const bool jumps = i + 1 < lists[l]->count && key[1] == key[0];

			out[count++] = (struct scene_moment){ .time = *key, .is_before = jumps };
		}
	return scene_moments_sort(out, count);
}

/* Finds the TimeSensor of an interpolator; NULL: none drives it. */
static const struct vrml_node *timer_of(const struct vrml *scene,
					const struct vrml_node *interpolator)
{
	for (const struct vrml_route *route = scene->routes; route; route = route->before)
		if (*route->to == interpolator && *route->from &&
		    vrml_is(*route->from, "TimeSensor") &&
		    strcmp(route->out, "fraction_changed") == 0 &&
		    vrml_event_sets(route->in, "fraction"))
			return *route->from;
	return NULL;
}

static int fault(const struct search *search, const struct vrml_node *node, const char *text)
{
	return diagnostics_add(search->diagnostics, -EBADMSG, node->file, node->line, "%s", text);
}

static int get_keys(const struct search *search, const struct vrml_node *interpolator,
		    uint32_t width, struct keys *out)
{
	int rc;

	*out = (struct keys){ 0 };
	if (!interpolator)
		return 0;
	rc = vrml_keys(interpolator, width, &out->times, &out->values, search->diagnostics);
	if (rc == 0 && out->times->count > SCENE_KEYS_MAX)
		rc = diagnostics_add(search->diagnostics, -EFBIG, interpolator->file,
				     interpolator->line, "over %d keys; leave some out",
				     SCENE_KEYS_MAX);
	return rc;
}

/* Finds the only timer of a camera, and its seconds. */
static int get_duration(const struct search *search, const struct camera *camera, float *seconds)
{
	const struct vrml_node *timers[2], *timer;

	timers[0] = camera->position ? timer_of(search->scene, camera->position) : NULL;
	timers[1] = camera->orientation ? timer_of(search->scene, camera->orientation) : NULL;
	timer = timers[0] ? timers[0] : timers[1];
	if ((camera->position && !timers[0]) || (camera->orientation && !timers[1]))
		return fault(search,
			     timers[0]          ? camera->orientation
			     : camera->position ? camera->position
						: camera->orientation,
			     "no TimeSensor drives this interpolator of a Viewpoint; add a ROUTE "
			     "from its fraction_changed");
	if (timers[1] && timers[1] != timer)
		return fault(search, camera->node,
			     "two TimeSensors move this Viewpoint; drive both interpolators by "
			     "one");
	*seconds = vrml_get_float(timer, "cycleInterval", 1);
	if (!(*seconds > 0 && *seconds <= 3600))
		return fault(search, timer,
			     "cycleInterval must be above 0 and at most 3600 seconds");
	return 0;
}

static int add_way(struct scene_views *out, const struct search *search,
		   const struct camera *camera)
{
	struct scene_moment *moments;
	float seconds = 0;
	struct keys position, turn;
	uint32_t count;
	int rc;

	if (camera->is_carried)
		return fault(search, camera->node,
			     "this Viewpoint stands in a Transform that moves; route its "
			     "interpolators to the Viewpoint itself");
	rc = get_keys(search, camera->position, 3, &position);
	if (rc == 0)
		rc = get_keys(search, camera->orientation, 4, &turn);
	if (rc == 0)
		rc = get_duration(search, camera, &seconds);
	moments = rc == 0 ? malloc(WAY_VIEWS_MAX * sizeof(*moments)) : NULL;
	if (!moments)
		return rc < 0 ? rc : -ENOMEM;
	out->moves = true;
	count = gather_moments(moments, &position, &turn);
	for (uint32_t i = 0; i < count && rc == 0; i++) {
		float at[3], quaternion[4];

		own_position(at, camera->node);
		own_turn(quaternion, camera->node);
		if (position.times)
			position_at(at, &position, moments[i]);
		if (turn.times)
			turn_at(quaternion, &turn, moments[i]);
		rc = scene_views_add(out, moments[i].time * seconds, camera->place, at, quaternion);
	}
	free(moments);
	return rc;
}

int vrml_views_read(struct scene_views *out, const struct vrml *scene, const char *description,
		    struct diagnostics *diagnostics)
{
	struct search search = { .scene = scene, .diagnostics = diagnostics };
	const struct camera *camera = NULL;
	int rc = find_cameras(&search);

	*out = (struct scene_views){ 0 };
	if (rc == 0)
		rc = choose(&search, description, &camera);
	if (rc == 0)
		rc = camera ? add_way(out, &search, camera) : add_still(out, &search);
	if (rc == -ENOMEM)
		diagnostics_add(diagnostics, rc, scene->roots[0]->file, 0,
				"too large for this machine's memory");
	free(search.cameras);
	map_finish(&search.carriers);
	return rc;
}
