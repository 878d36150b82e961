/* Follows routes from each TimeSensor: back to the TouchSensors that start it, and on through
 * interpolators to what they set. What such a chain says becomes a motion; other routes have no
 * meaning without an event loop, and are named in warnings. */
#include "pipeline/scene/vrml_motions.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "geometry/turn.h"
#include "pipeline/scene/vrml_bends.h"
#include "pipeline/scene/vrml_drags.h"
#include "pipeline/scene/vrml_graph.h"
#include "pipeline/scene/vrml_keys.h"

enum { INSTANCES_MAX = 1 << 14, ROUTES_MAX = 4096 };

struct follow {
	struct scenery_maker *maker;
	const struct vrml_route **routes; /* owned; in the order of the files */
	bool *used;                       /* owned; by route */
	uint32_t count;
	const struct vrml_instances *instances;
	struct diagnostics *diagnostics, *warnings;
};

int vrml_instances_add(struct vrml_instances *instances, const struct vrml_instance *instance)
{
	int rc = ARRAY_RESERVE(instances->items, instances->room, (uint64_t)instances->count + 1,
			       INSTANCES_MAX);

	if (rc == 0)
		instances->items[instances->count++] = *instance;
	return rc;
}

void vrml_instances_finish(struct vrml_instances *instances)
{
	free(instances->items);
	*instances = (struct vrml_instances){ 0 };
}

/* Whether a route goes from an event of a node to one of a type. */
static bool leads(const struct vrml_route *route, const struct vrml_node *from, const char *out,
		  const char *type, const char *in)
{
	return *route->from == from && strcmp(route->out, out) == 0 && *route->to &&
	       vrml_is(*route->to, type) && vrml_event_sets(route->in, in);
}

/* ---- tracks */

/* What an interpolator may set. */
static const struct sink {
	const char *interpolator, *node, *field;
	enum scenery_target target;
	uint32_t width; /* of the interpolator's values */
} sinks[] = {
	{ "PositionInterpolator", "Transform", "translation", SCENERY_MOVE, 3 },
	{ "PositionInterpolator", "Transform", "scale", SCENERY_SCALE, 3 },
	{ "OrientationInterpolator", "Transform", "rotation", SCENERY_TURN, 4 },
	{ "ScalarInterpolator", "Material", "transparency", SCENERY_OPACITY, 1 },
	{ "ColorInterpolator", "Material", "diffuseColor", SCENERY_COLOUR, 3 },
	{ "ColorInterpolator", "Material", "emissiveColor", SCENERY_GLOW, 3 },
	{ "CoordinateInterpolator", "Coordinate", "point", SCENERY_SHAPE, 1 },
};

static void set_value(float *out, const struct sink *sink, const float *from)
{
	switch (sink->target) {
	case SCENERY_TURN:
		turn_about(out, from, from[3]);
		break;
	case SCENERY_OPACITY:
		out[0] = fminf(fmaxf(1 - from[0], 0), 1);
		break;
	default:
		memcpy(out, from, 3 * sizeof(*out));
		break;
	}
}

/* Adds the track of a number or a vector for each key. */
static int add_values(const struct follow *follow, const struct vrml_node *interpolator,
		      uint32_t node, const struct sink *sink)
{
	const struct vrml_value *keys, *values;
	const uint32_t wide = scenery_width(sink->target);
	float *out;
	int rc = vrml_keys(interpolator, sink->width, &keys, &values, follow->diagnostics);

	if (rc == 0)
		rc = scenery_add_track(follow->maker, node, sink->target, keys->floats, keys->count,
				       &out);
	for (uint32_t k = 0; rc == 0 && k < keys->count; k++)
		set_value(&out[k * wide], sink, &values->floats[k * sink->width]);
	return rc;
}

/* Adds what an interpolator sets of one instance. */
static int add_track(const struct follow *follow, const struct vrml_node *interpolator,
		     const struct vrml_instance *instance, const struct sink *sink)
{
	enum scenery_target target = sink->target;

	switch (target) {
	case SCENERY_SHAPE:
		return instance->bender == interpolator
			       ? vrml_bent_track(follow->maker, instance->node, interpolator,
						 follow->diagnostics)
			       : 0;
	case SCENERY_COLOUR:
	case SCENERY_GLOW:
		if (instance->is_lines)
			target = target == SCENERY_GLOW ? SCENERY_COLOUR : SCENERY_TARGETS;
		if (target == SCENERY_TARGETS ||
		    (target == SCENERY_COLOUR && instance->has_own_colours))
			return 0; /* it has no effect on this surface */
		return vrml_colour_track(follow->maker, instance->node, target, interpolator,
					 follow->diagnostics);
	default:
		return add_values(follow, interpolator, instance->node, sink);
	}
}

static int add_tracks(const struct follow *follow, const struct vrml_node *interpolator,
		      const struct vrml_node *target, const struct sink *sink)
{
	int rc = 0;

	for (uint32_t i = 0; i < follow->instances->count && rc == 0; i++)
		if (follow->instances->items[i].of == target)
			rc = add_track(follow, interpolator, &follow->instances->items[i], sink);
	return rc;
}

/* Whether a route goes to points that bend, and not by this interpolator; or that do not. */
static bool bends_nothing(const struct follow *follow, const struct vrml_node *interpolator,
			  const struct vrml_node *target)
{
	for (uint32_t i = 0; i < follow->instances->count; i++)
		if (follow->instances->items[i].of == target &&
		    follow->instances->items[i].bender == interpolator)
			return false;
	return true;
}

/* Whether a route moves a Viewpoint: that is the way of a tour (vrml_views.h), and no motion. */
static bool moves_viewpoint(const struct vrml_route *route, const struct vrml_node *interpolator)
{
	return leads(route, interpolator, "value_changed", "Viewpoint", "position") ||
	       leads(route, interpolator, "value_changed", "Viewpoint", "orientation");
}

/* Adds what one interpolator sets. Sets *moves_view if that is a Viewpoint. */
static int follow_interpolator(const struct follow *follow, const struct vrml_node *interpolator,
			       bool *moves_view)
{
	int rc = 0;

	for (uint32_t r = 0; r < follow->count && rc == 0; r++) {
		if (moves_viewpoint(follow->routes[r], interpolator)) {
			follow->used[r] = true;
			*moves_view = true;
		}
		for (size_t s = 0; s < ARRAY_COUNT(sinks) && rc == 0; s++) {
			const struct sink *sink = &sinks[s];

			if (!vrml_is(interpolator, sink->interpolator) ||
			    !leads(follow->routes[r], interpolator, "value_changed", sink->node,
				   sink->field) ||
			    (sink->target == SCENERY_SHAPE &&
			     bends_nothing(follow, interpolator, *follow->routes[r]->to)))
				continue;
			follow->used[r] = true;
			rc = add_tracks(follow, interpolator, *follow->routes[r]->to, sink);
		}
	}
	return rc;
}

/* ---- timers */

static bool is_interpolator(const struct vrml_node *node)
{
	for (size_t s = 0; s < ARRAY_COUNT(sinks); s++)
		if (vrml_is(node, sinks[s].interpolator))
			return true;
	return false;
}

static int add_touches(const struct follow *follow, const struct vrml_node *timer, uint32_t motion,
		       uint32_t *touches)
{
	int rc = 0;

	for (uint32_t r = 0; r < follow->count; r++) {
		const struct vrml_route *route = follow->routes[r];

		if (*route->to != timer || !*route->from || !vrml_is(*route->from, "TouchSensor") ||
		    strcmp(route->out, "touchTime") != 0 ||
		    !vrml_event_sets(route->in, "startTime"))
			continue;
		follow->used[r] = true;
		for (uint32_t i = 0; i < follow->instances->count && rc == 0; i++)
			if (follow->instances->items[i].of == *route->from) {
				rc = scenery_add_touch(follow->maker,
						       follow->instances->items[i].node, motion);
				++*touches;
			}
	}
	return rc;
}

/* A motion without a beginning or an effect is taken back, with its touches and tracks. why NULL:
 * without a warning. */
static void take_back(const struct follow *follow, const struct vrml_node *timer, uint32_t touches,
		      const char *why)
{
	struct scenery *out = &follow->maker->out;
	const struct scenery_motion *motion = &out->motions[--out->motion_count];

	if (motion->track_count > 0)
		out->number_count = out->tracks[motion->first_track].first;
	out->track_count = motion->first_track;
	out->touch_count -= touches;
	if (why)
		diagnostics_add(follow->warnings, 0, timer->file, timer->line,
				"this TimeSensor %s; it was left out", why);
}

static int follow_timer(const struct follow *follow, const struct vrml_node *timer)
{
	struct scenery_motion motion = { .duration_s = vrml_get_float(timer, "cycleInterval", 1),
					 .loops = vrml_get_integer(timer, "loop", 0) != 0 };
	uint32_t number = 0, touches = 0;
	bool moves_view = false;
	int rc;

	if (!(motion.duration_s > 0 && motion.duration_s <= 3600))
		return diagnostics_add(follow->diagnostics, -EBADMSG, timer->file, timer->line,
				       "cycleInterval must be above 0 and at most 3600 seconds");
	rc = scenery_add_motion(follow->maker, &motion, &number);
	if (rc == 0)
		rc = add_touches(follow, timer, number, &touches);
	for (uint32_t r = 0; r < follow->count && rc == 0; r++) {
		const struct vrml_route *route = follow->routes[r];

		if (*route->from != timer || strcmp(route->out, "fraction_changed") != 0 ||
		    !*route->to || !is_interpolator(*route->to) ||
		    !vrml_event_sets(route->in, "fraction"))
			continue;
		follow->used[r] = true;
		rc = follow_interpolator(follow, *route->to, &moves_view);
	}
	if (rc < 0)
		return rc;
	if (follow->maker->out.motions[number].track_count == 0)
		take_back(follow, timer, touches, moves_view ? NULL : "moves nothing that is seen");
	else if (!vrml_get_integer(timer, "enabled", 1))
		take_back(follow, timer, touches, "is not enabled");
	else if (touches == 0 && !motion.loops)
		take_back(follow, timer, touches,
			  "is started by no TouchSensor's touchTime and does not loop");
	return 0;
}

/* ---- all */

static bool was_followed(const struct follow *follow, uint32_t route)
{
	for (uint32_t r = 0; r < route; r++)
		if (*follow->routes[r]->from == *follow->routes[route]->from &&
		    strcmp(follow->routes[r]->out, "fraction_changed") == 0)
			return true;
	return false;
}

/* Normals of what bends are computed for each shape. */
static bool moves_normals(const struct vrml_route *route)
{
	return (*route->from && vrml_is(*route->from, "NormalInterpolator")) ||
	       (*route->to && vrml_is(*route->to, "NormalInterpolator"));
}

static int follow_all(const struct follow *follow)
{
	const uint32_t first = follow->maker->out.motion_count;
	int rc = 0;

	for (uint32_t r = 0; r < follow->count && rc == 0; r++) {
		const struct vrml_node *from = *follow->routes[r]->from;

		if (from && vrml_is(from, "TimeSensor") &&
		    strcmp(follow->routes[r]->out, "fraction_changed") == 0 &&
		    !was_followed(follow, r))
			rc = follow_timer(follow, from);
	}
	scenery_find_returns(follow->maker, first);
	for (uint32_t r = 0; r < follow->count && rc >= 0; r++) {
		rc = vrml_drags_add(follow->maker, follow->routes[r], follow->instances,
				    follow->diagnostics, follow->warnings);
		follow->used[r] |= rc == 1;
	}
	rc = rc > 0 ? 0 : rc;
	for (uint32_t r = 0; r < follow->count && rc == 0; r++)
		if (!follow->used[r] && !moves_normals(follow->routes[r]))
			diagnostics_add(follow->warnings, 0, follow->routes[r]->file,
					follow->routes[r]->line,
					"ROUTE from %.40s to %.40s is not kept; docs/scenery.md "
					"says which are",
					follow->routes[r]->out, follow->routes[r]->in);
	return rc;
}

int vrml_motions_add(struct scenery_maker *maker, const struct vrml *scene,
		     const struct vrml_instances *instances, struct diagnostics *diagnostics,
		     struct diagnostics *warnings)
{
	struct follow follow = { .maker = maker,
				 .count = scene->route_count,
				 .instances = instances,
				 .diagnostics = diagnostics,
				 .warnings = warnings };
	uint32_t at = scene->route_count;
	int rc = -ENOMEM;

	if (scene->route_count > ROUTES_MAX)
		return diagnostics_add(
			diagnostics, -EFBIG, scene->routes->file, scene->routes->line,
			"over %d ROUTE; split the scene into several files", ROUTES_MAX);
	follow.routes = calloc((size_t)scene->route_count + 1, sizeof(*follow.routes));
	follow.used = calloc((size_t)scene->route_count + 1, sizeof(*follow.used));
	for (const struct vrml_route *route = scene->routes; follow.routes && route;
	     route = route->before)
		follow.routes[--at] = route;
	if (follow.routes && follow.used)
		rc = follow_all(&follow);
	free(follow.routes);
	free(follow.used);
	return rc;
}
