/* Reads animation samplers (glTF 2.0, 3.11) into tracks. A track changes evenly between its keys,
 * so a step becomes two keys at one time, and a cubic spline PIECES straight pieces a segment. */
#include "pipeline/scene/gltf_motions.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/compiler.h"

enum { PIECES = 8, CHANNELS_MAX = SCENERY_TRACKS_MAX };

/* What a channel may set. */
static const struct path {
	const char *name;
	enum scenery_target target;
} paths[] = {
	{ "translation", SCENERY_MOVE },
	{ "rotation", SCENERY_TURN },
	{ "scale", SCENERY_SCALE },
};

enum shape { LINEAR, STEP, CUBIC };

/* The keys of a channel. */
struct sampler {
	struct gltf_numbers times, values;
	enum shape shape;
	uint32_t width;
};

static const char *text_of(const cJSON *object, const char *field)
{
	return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, field));
}

static const char *name_of(const cJSON *object)
{
	const char *name = text_of(object, "name");

	return name ? name : "";
}

static const struct path *path_of(const cJSON *target)
{
	const char *name = text_of(target, "path");

	for (size_t i = 0; i < ARRAY_COUNT(paths); i++)
		if (name && strcmp(name, paths[i].name) == 0)
			return &paths[i];
	return NULL;
}

void gltf_mark_animated(const struct gltf *gltf, bool *moves)
{
	for (uint32_t i = 0; i < gltf->lists[GLTF_ANIMATIONS].count; i++) {
		const cJSON *channel, *channels = cJSON_GetObjectItemCaseSensitive(
					      gltf->lists[GLTF_ANIMATIONS].items[i], "channels");

		cJSON_ArrayForEach(channel, channels)
		{
			const cJSON *target = cJSON_GetObjectItemCaseSensitive(channel, "target");
			uint32_t node;

			if (path_of(target) && gltf_item(gltf, GLTF_NODES, target, "node", &node))
				moves[node] = true;
		}
	}
}

/* ---- samplers */

static int find_sampler(struct sampler *out, const struct gltf *gltf, const cJSON *animation,
			const cJSON *channel, uint32_t width)
{
	const cJSON *number = cJSON_GetObjectItemCaseSensitive(channel, "sampler");
	const cJSON *sampler =
		cJSON_GetArrayItem(cJSON_GetObjectItemCaseSensitive(animation, "samplers"),
				   cJSON_IsNumber(number) ? number->valueint : -1);
	const char *shape = text_of(sampler, "interpolation");
	float before = -1;
	int rc;

	*out = (struct sampler){ .width = width };
	if (!cJSON_IsObject(sampler))
		return gltf_say(gltf, -EBADMSG, channel,
				"a channel of animation \"%.60s\" has no sampler; export it anew",
				name_of(animation));
	out->shape = shape && strcmp(shape, "STEP") == 0          ? STEP
		     : shape && strcmp(shape, "CUBICSPLINE") == 0 ? CUBIC
								  : LINEAR;
	rc = gltf_numbers_of(&out->times, gltf, sampler, "input", 1);
	if (rc == 0)
		rc = gltf_numbers_of(&out->values, gltf, sampler, "output", width);
	if (rc < 0)
		return rc;
	if (out->times.count == 0 ||
	    out->values.count != out->times.count * (out->shape == CUBIC ? 3 : 1))
		return gltf_say(gltf, -EBADMSG, sampler,
				"animation \"%.60s\" has another number of times than of values; "
				"export it anew",
				name_of(animation));
	for (uint32_t i = 0; i < out->times.count; i++) {
		const float time = gltf_number(&out->times, i, 0);

		if (!(time > before && time <= 3600))
			return gltf_say(
				gltf, -EBADMSG, sampler,
				"animation \"%.60s\" has times that do not ascend from 0 to "
				"at most 3600 seconds; correct its keys",
				name_of(animation));
		before = time;
	}
	return 0;
}

static float end_s(const struct sampler *sampler)
{
	return gltf_number(&sampler->times, sampler->times.count - 1, 0);
}

static uint32_t key_count(const struct sampler *sampler)
{
	const uint32_t count = sampler->times.count;

	return sampler->shape == STEP    ? 2 * count - 1
	       : sampler->shape == CUBIC ? PIECES * (count - 1) + 1
					 : count;
}

/* The time and the value of a key of the track. */
static float key_at(float *value, const struct sampler *sampler, uint32_t key)
{
	const struct gltf_numbers *times = &sampler->times, *values = &sampler->values;
	uint32_t at = key;
	float from_s, span_s, t;

	if (sampler->shape != CUBIC) {
		at = sampler->shape == STEP ? key / 2 : key;
		for (uint32_t k = 0; k < sampler->width; k++)
			value[k] = gltf_number(values, at, k);
		return gltf_number(times, sampler->shape == STEP ? (key + 1) / 2 : key, 0);
	}
	/* Each key has its tangent before, its value and its tangent after (3.11, appendix C). */
	at = key / PIECES;
	t = (float)(key % PIECES) / PIECES;
	from_s = gltf_number(times, at, 0);
	span_s = at + 1 < times->count ? gltf_number(times, at + 1, 0) - from_s : 0;
	for (uint32_t k = 0; k < sampler->width; k++) {
		const float from = gltf_number(values, 3 * at + 1, k);

		value[k] = from;
		if (t > 0)
			value[k] =
				(2 * t * t * t - 3 * t * t + 1) * from +
				span_s * (t * t * t - 2 * t * t + t) *
					gltf_number(values, 3 * at + 2, k) +
				(3 * t * t - 2 * t * t * t) * gltf_number(values, 3 * at + 4, k) +
				span_s * (t * t * t - t * t) * gltf_number(values, 3 * at + 3, k);
	}
	return from_s + t * span_s;
}

/* ---- tracks */

static bool make_turn(float *value)
{
	float length = 0;

	for (int k = 0; k < 4; k++)
		length += value[k] * value[k];
	length = sqrtf(length);
	for (int k = 0; k < 4; k++)
		value[k] /= length;
	return isfinite(length) && length > 1e-6f;
}

static int add_track(struct scenery_maker *maker, const struct gltf *gltf,
		     const struct sampler *sampler, uint32_t node, enum scenery_target target,
		     float duration_s, const cJSON *animation)
{
	const uint32_t count = key_count(sampler);
	float *times = malloc(count * sizeof(*times)), *values, ignored[4];
	int rc = times ? 0 : -ENOMEM;

	for (uint32_t i = 0; rc == 0 && i < count; i++)
		times[i] = fminf(key_at(ignored, sampler, i) / duration_s, 1);
	if (rc == 0)
		rc = scenery_add_track(maker, node, target, times, count, &values);
	for (uint32_t i = 0; rc == 0 && i < count; i++) {
		float *value = &values[i * sampler->width];

		key_at(value, sampler, i);
		for (uint32_t k = 0; k < sampler->width; k++)
			if (!isfinite(value[k]))
				rc = -EBADMSG;
		if (target == SCENERY_TURN && !make_turn(value))
			rc = -EBADMSG;
	}
	free(times);
	return rc == -EBADMSG ? gltf_say(gltf, rc, animation,
					 "animation \"%.60s\" has values that are none; export it "
					 "anew",
					 name_of(animation))
			      : rc;
}

struct channel {
	struct sampler sampler;
	uint32_t node; /* of the scenery */
	enum scenery_target target;
};

/* Finds the channels of an animation that move something of the scene. */
static int find_channels(struct channel *out, uint32_t *count, const struct gltf *gltf,
			 const cJSON *animation, const uint32_t *nodes)
{
	const cJSON *channel, *channels = cJSON_GetObjectItemCaseSensitive(animation, "channels");

	*count = 0;
	cJSON_ArrayForEach(channel, channels)
	{
		const cJSON *target = cJSON_GetObjectItemCaseSensitive(channel, "target");
		const char *name = text_of(target, "path");
		const struct path *path = path_of(target);
		uint32_t node;
		int rc;

		if (name && strcmp(name, "weights") == 0)
			return gltf_say(gltf, -ENOTSUP, channel,
					"animation \"%.60s\" moves morph targets, which scenery "
					"does not have; export it without, or move nodes instead",
					name_of(animation));
		if (!path || !gltf_item(gltf, GLTF_NODES, target, "node", &node) ||
		    nodes[node] == SCENERY_NONE)
			continue;
		if (*count == CHANNELS_MAX)
			return -EFBIG;
		rc = find_sampler(&out[*count].sampler, gltf, animation, channel,
				  scenery_width(path->target));
		if (rc < 0)
			return rc;
		out[*count].node = nodes[node];
		out[(*count)++].target = path->target;
	}
	return 0;
}

static int add_touches(struct scenery_maker *maker, uint32_t motion, const struct channel *channels,
		       uint32_t count)
{
	int rc = 0;

	for (uint32_t i = 0; i < count && rc == 0; i++) {
		bool is_there = false;

		for (uint32_t k = 0; k < i; k++)
			is_there = is_there || channels[k].node == channels[i].node;
		if (!is_there)
			rc = scenery_add_touch(maker, channels[i].node, motion);
	}
	return rc;
}

static int add_animation(struct scenery_maker *maker, const struct gltf *gltf,
			 const cJSON *animation, struct channel *channels, const uint32_t *nodes,
			 bool plays_always, struct diagnostics *warnings)
{
	struct scenery_motion motion = { .loops = plays_always };
	uint32_t count, number;
	int rc = find_channels(channels, &count, gltf, animation, nodes);

	for (uint32_t i = 0; i < count && rc == 0; i++)
		motion.duration_s = fmaxf(motion.duration_s, end_s(&channels[i].sampler));
	if (rc == 0 && !(motion.duration_s > 0)) {
		diagnostics_add(warnings, 0, gltf->path, json_text_line(&gltf->json, animation),
				"animation \"%.60s\" moves nothing of the scene; it was left out",
				name_of(animation));
		return 0;
	}
	if (rc == 0)
		rc = scenery_add_motion(maker, &motion, &number);
	for (uint32_t i = 0; i < count && rc == 0; i++)
		rc = add_track(maker, gltf, &channels[i].sampler, channels[i].node,
			       channels[i].target, motion.duration_s, animation);
	if (rc == 0 && !plays_always)
		rc = add_touches(maker, number, channels, count);
	return rc;
}

int gltf_motions_add(struct scenery_maker *maker, const struct gltf *gltf, const uint32_t *nodes,
		     bool plays_always, struct diagnostics *warnings)
{
	const uint32_t first = maker->out.motion_count;
	struct channel *channels = malloc(CHANNELS_MAX * sizeof(*channels));
	int rc = channels ? 0 : -ENOMEM;

	for (uint32_t i = 0; i < gltf->lists[GLTF_ANIMATIONS].count && rc == 0; i++)
		rc = add_animation(maker, gltf, gltf->lists[GLTF_ANIMATIONS].items[i], channels,
				   nodes, plays_always, warnings);
	if (rc == 0)
		scenery_find_returns(maker, first);
	free(channels);
	return rc;
}
