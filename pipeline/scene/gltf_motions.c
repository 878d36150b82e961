/* Makes motions of animations, and tracks of their channels. */
#include "pipeline/scene/gltf_motions.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/compiler.h"
#include "pipeline/scene/gltf_morph.h"
#include "pipeline/scene/gltf_nodes.h"
#include "pipeline/scene/gltf_sampler.h"

enum { CHANNELS_MAX = SCENERY_TRACKS_MAX };

/* What a channel may set. */
static const struct path {
	const char *name;
	enum scenery_target target;
} paths[] = {
	{ "translation", SCENERY_MOVE },
	{ "rotation", SCENERY_TURN },
	{ "scale", SCENERY_SCALE },
	{ "weights", SCENERY_SHAPE },
};

static const char *text_of(const cJSON *object, const char *field)
{
	return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, field));
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

/* ---- tracks */

static int add_track(struct scenery_maker *maker, const struct gltf *gltf,
		     const struct gltf_sampler *sampler, uint32_t node, enum scenery_target target,
		     float duration_s, const cJSON *animation)
{
	const uint32_t count = gltf_sampler_key_count(sampler);
	float *times = malloc(count * sizeof(*times)), *values, ignored[GLTF_WEIGHTS_MAX];
	int rc = times ? 0 : -ENOMEM;

	for (uint32_t i = 0; rc == 0 && i < count; i++)
		times[i] = fminf(gltf_sampler_key(ignored, sampler, i) / duration_s, 1);
	if (rc == 0)
		rc = scenery_add_track(maker, node, target, times, count, &values);
	for (uint32_t i = 0; rc == 0 && i < count; i++) {
		float *value = &values[i * scenery_width(target)];

		if (target == SCENERY_SHAPE) { /* gltf_morph.c made one for each key */
			*value = (float)i;
			continue;
		}
		gltf_sampler_key(value, sampler, i);
		for (uint32_t k = 0; k < sampler->width; k++)
			if (!isfinite(value[k]))
				rc = -EBADMSG;
		if (target == SCENERY_TURN && !gltf_make_turn(value))
			rc = -EBADMSG;
	}
	free(times);
	return rc == -EBADMSG ? gltf_say(gltf, rc, animation,
					 "animation \"%.60s\" has values that are none; export it "
					 "anew",
					 gltf_name(animation))
			      : rc;
}

struct channel {
	struct gltf_sampler sampler;
	uint32_t node; /* of the scenery */
	enum scenery_target target;
};

/* Reads the sampler of a channel. -ENOENT: it moves nothing: there are no morph targets, or another
 * animation has given the mesh its shapes. */
static int read_channel(struct gltf_sampler *out, const struct gltf *gltf, const cJSON *animation,
			const cJSON *channel, enum scenery_target target, uint32_t node)
{
	const cJSON *of = gltf->lists[GLTF_NODES].items[node], *first;
	const uint32_t weights = gltf_morph_count(gltf, of);

	if (target != SCENERY_SHAPE)
		return gltf_sampler_read(out, gltf, animation, channel, scenery_width(target));
	if (weights < 1 || weights > GLTF_WEIGHTS_MAX ||
	    gltf_morph_channel(gltf, node, &first) != channel)
		return -ENOENT;
	return gltf_sampler_read_weights(out, gltf, animation, channel, weights);
}

/* Finds the channels of an animation that move something of the scene. */
static int find_channels(struct channel *out, uint32_t *count, const struct gltf *gltf,
			 const cJSON *animation, const uint32_t *nodes)
{
	const cJSON *channel, *channels = cJSON_GetObjectItemCaseSensitive(animation, "channels");

	*count = 0;
	cJSON_ArrayForEach(channel, channels)
	{
		const cJSON *target = cJSON_GetObjectItemCaseSensitive(channel, "target");
		const struct path *path = path_of(target);
		uint32_t node;
		int rc;

		if (!path || !gltf_item(gltf, GLTF_NODES, target, "node", &node) ||
		    nodes[node] == SCENERY_NONE)
			continue;
		if (*count == CHANNELS_MAX)
			return -EFBIG;
		rc = read_channel(&out[*count].sampler, gltf, animation, channel, path->target,
				  node);
		if (rc == -ENOENT)
			continue;
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

/* Whether an animation moves a node with a camera. */
static bool moves_camera(const struct gltf *gltf, const cJSON *animation)
{
	const cJSON *channel, *channels = cJSON_GetObjectItemCaseSensitive(animation, "channels");

	cJSON_ArrayForEach(channel, channels)
	{
		const cJSON *target = cJSON_GetObjectItemCaseSensitive(channel, "target");

		if (gltf_item(gltf, GLTF_CAMERAS, gltf_item(gltf, GLTF_NODES, target, "node", NULL),
			      "camera", NULL))
			return true;
	}
	return false;
}

static int add_animation(struct scenery_maker *maker, const struct gltf *gltf,
			 const cJSON *animation, struct channel *channels, const uint32_t *nodes,
			 bool plays_always, struct diagnostics *warnings)
{
	struct scenery_motion motion = { .loops = plays_always };
	uint32_t count, number;
	int rc = find_channels(channels, &count, gltf, animation, nodes);

	for (uint32_t i = 0; i < count && rc == 0; i++)
		motion.duration_s =
			fmaxf(motion.duration_s, gltf_sampler_end_s(&channels[i].sampler));
	if (rc == 0 && !(motion.duration_s > 0)) {
		if (!moves_camera(gltf, animation))
			diagnostics_add(
				warnings, 0, gltf->path, json_text_line(&gltf->json, animation),
				"animation \"%.60s\" moves nothing of the scene; it was left out",
				gltf_name(animation));
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
