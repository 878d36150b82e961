/* Gives a surface a shape for each key of its interpolator, and colours pieces between keys. */
#include "pipeline/scene/vrml_bends.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/scene/vrml_faces.h"
#include "pipeline/scene/vrml_graph.h"
#include "pipeline/scene/vrml_keys.h"

enum { PIECES = 8, KEYS_MAX = SCENERY_NUMBERS_MAX / (4 * PIECES) };

const struct vrml_node *vrml_bender_of(const struct vrml *scene, const struct vrml_node *geometry)
{
	const struct vrml_node *points = vrml_node_of(geometry, "coord", "Coordinate");
	const struct vrml_node *found = NULL;

	if (!points || !vrml_is(geometry, "IndexedFaceSet"))
		return NULL;
	for (const struct vrml_route *route = scene->routes; route; route = route->before)
		if (*route->to == points && *route->from &&
		    vrml_is(*route->from, "CoordinateInterpolator") &&
		    strcmp(route->out, "value_changed") == 0 && vrml_event_sets(route->in, "point"))
			found = *route->from; /* routes are listed backwards */
	return found;
}

static uint32_t point_count(const struct vrml_node *geometry)
{
	const struct vrml_value *points =
		vrml_member(vrml_get_node(geometry, "coord"), "Coordinate", "point");

	return points ? points->count / 3 : 0;
}

int vrml_bent_add(struct scenery_maker *maker, uint32_t node,
		  const struct scenery_material *material, const struct soup *soup,
		  float crease_rad, const struct scenery_paint *paint,
		  const struct vrml_node *geometry, const struct vrml_node *interpolator,
		  struct diagnostics *diagnostics)
{
	struct scenery_bend bend = { .point_count = point_count(geometry) };
	const struct vrml_value *keys, *values;
	float(*places)[3];
	int rc = vrml_keys(interpolator, 3 * bend.point_count, &keys, &values, diagnostics);

	if (rc < 0)
		return rc;
	bend.shape_count = keys->count;
	if ((uint64_t)keys->count * bend.point_count > 8ull * SCENERY_SHAPE_VERTICES_MAX)
		return -EFBIG;
	places = malloc((size_t)keys->count * bend.point_count * sizeof(*places) + 1);
	if (!places)
		return -ENOMEM;
	for (size_t i = 0; i < (size_t)keys->count * bend.point_count; i++)
		soup_place(places[i], soup, &values->floats[3 * i]);
	bend.places = (const float(*)[3])places;
	rc = scenery_add_bent(maker, node, material, soup, crease_rad, paint, &bend);
	free(places);
	return rc == -EBADMSG
		       ? diagnostics_add(diagnostics, rc, interpolator->file, interpolator->line,
					 "the points of this CoordinateInterpolator have no size, "
					 "or are no numbers; correct them")
		       : rc;
}

int vrml_bent_track(struct scenery_maker *maker, uint32_t node,
		    const struct vrml_node *interpolator, struct diagnostics *diagnostics)
{
	const struct vrml_value *keys = vrml_get(interpolator, "key");
	float *values;
	int rc;

	if (!keys || keys->count == 0)
		return diagnostics_add(diagnostics, -EBADMSG, interpolator->file,
				       interpolator->line, "this %s has no keys; correct it",
				       interpolator->type->name);
	rc = scenery_add_track(maker, node, SCENERY_SHAPE, keys->floats, keys->count, &values);
	for (uint32_t k = 0; k < keys->count && rc == 0; k++)
		values[k] = (float)k;
	return rc;
}

/* ---- colours */

/* Hue 0 to 6, saturation and value 0 to 1. A grey has the hue 0. */
static void to_hsv(float out[3], const float rgb[3])
{
	const float most = fmaxf(fmaxf(rgb[0], rgb[1]), rgb[2]);
	const float span = most - fminf(fminf(rgb[0], rgb[1]), rgb[2]);

	out[0] = 0;
	out[1] = most > 0 ? span / most : 0;
	out[2] = most;
	if (span <= 0)
		return;
	if (most == rgb[0])
		out[0] = (rgb[1] - rgb[2]) / span;
	else if (most == rgb[1])
		out[0] = 2 + (rgb[2] - rgb[0]) / span;
	else
		out[0] = 4 + (rgb[0] - rgb[1]) / span;
}

static void to_rgb(float out[3], const float hsv[3])
{
	static const float hues[3] = { 0, 2, 4 };

	for (int k = 0; k < 3; k++) {
		/* How far the hue is from red, green or blue. */
		const float apart = fabsf(remainderf(hsv[0] - hues[k], 6));

		out[k] = hsv[2] * (1 - hsv[1] * fminf(fmaxf(apart - 1, 0), 1));
	}
}

static void between_colours(float out[3], const float from[3], const float to[3], float share)
{
	float a[3], b[3], mixed[3];

	to_hsv(a, from);
	to_hsv(b, to);
	/* Black has any saturation, and a grey any hue. */
	if (a[2] <= 0)
		a[1] = b[1];
	if (b[2] <= 0)
		b[1] = a[1];
	if (a[1] <= 0 || a[2] <= 0)
		a[0] = b[0];
	if (b[1] <= 0 || b[2] <= 0)
		b[0] = a[0];
	mixed[0] = a[0] + share * remainderf(b[0] - a[0], 6);
	for (int k = 1; k < 3; k++)
		mixed[k] = a[k] + share * (b[k] - a[k]);
	to_rgb(out, mixed);
}

static void get_colour(float out[3], const struct vrml_value *values, uint32_t key)
{
	for (int k = 0; k < 3; k++)
		out[k] = fminf(fmaxf(values->floats[3 * key + (uint32_t)k], 0), 1);
}

int vrml_colour_track(struct scenery_maker *maker, uint32_t node, enum scenery_target target,
		      const struct vrml_node *interpolator, struct diagnostics *diagnostics)
{
	const struct vrml_value *keys, *colours;
	float *times = NULL, *values;
	uint32_t count;
	int rc = vrml_keys(interpolator, 3, &keys, &colours, diagnostics);

	if (rc < 0)
		return rc;
	if (keys->count > KEYS_MAX)
		return -EFBIG;
	count = (keys->count - 1) * PIECES + 1;
	times = malloc(count * sizeof(*times));
	if (!times)
		return -ENOMEM;
	for (uint32_t i = 0; i < count; i++) {
		const float *key = &keys->floats[i / PIECES];
		const float part = (float)(i % PIECES) / PIECES;

		times[i] = part > 0 ? key[0] + part * (key[1] - key[0]) : key[0];
	}
	rc = scenery_add_track(maker, node, target, times, count, &values);
	for (uint32_t i = 0; i < count && rc == 0; i++) {
		const uint32_t next = i % PIECES ? i / PIECES + 1 : i / PIECES;
		float from[3], to[3];

		get_colour(from, colours, i / PIECES);
		get_colour(to, colours, next);
		between_colours(&values[3 * i], from, to, (float)(i % PIECES) / PIECES);
	}
	free(times);
	return rc;
}
