/* Finds cameras, the animation that moves each or a node above it, and where it is at the keys of
 * the channels that do so. */
#include "pipeline/scene/gltf_views.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "geometry/turn.h"
#include "pipeline/scene/gltf_nodes.h"
#include "pipeline/scene/gltf_sampler.h"
#include "pipeline/scene/vrml_graph.h"

/* Between two keys a camera goes on an arc if a node above it turns. */
enum { ARC_PIECES = 8, ARC_KEYS_MAX = 1024, CHANNELS_MAX = 64, MOMENTS_MAX = 1 << 16 };

static const float at_rest[3];

/* What a channel that moves a camera sets. */
enum part { MOVE, TURN, SCALE, PARTS };
static const char *const part_names[PARTS] = { "translation", "rotation", "scale" };
static const uint32_t part_widths[PARTS] = { 3, 4, 3 };

struct channel {
	uint32_t node;
	enum part part;
	struct gltf_sampler sampler;
};

struct search {
	const struct gltf *gltf;
	uint32_t *parents; /* of each node of the file; SCENERY_NONE: it is a root */
	bool *was_seen;
	uint32_t *cameras; /* numbers of nodes, in their order */
	uint32_t count, room, depth;
	struct channel channels[CHANNELS_MAX]; /* of the camera that was chosen */
	uint32_t channel_count;
};

/* ---- cameras */

static const cJSON *node_of(const struct search *search, uint32_t number)
{
	return search->gltf->lists[GLTF_NODES].items[number];
}

static const cJSON *camera_of(const struct search *search, const cJSON *node)
{
	return gltf_item(search->gltf, GLTF_CAMERAS, node, "camera", NULL);
}

static int add_camera(struct search *search, uint32_t number)
{
	int rc = ARRAY_RESERVE(search->cameras, search->room, (uint64_t)search->count + 1,
			       SCENE_CAMERAS_MAX);

	if (rc == -EFBIG)
		return gltf_say(search->gltf, rc, node_of(search, number),
				"over %d cameras; leave some out", SCENE_CAMERAS_MAX);
	if (rc == 0)
		search->cameras[search->count++] = number;
	return rc;
}

static int visit(struct search *search, const cJSON *list, uint32_t parent, const cJSON *of)
{
	const cJSON *item;
	int rc = 0;

	if (search->depth == GLTF_DEPTH_MAX)
		return gltf_say(search->gltf, -EBADMSG, of,
				"node \"%.60s\" is over %d deep; export it anew", gltf_name(of),
				GLTF_DEPTH_MAX);
	search->depth++;
	cJSON_ArrayForEach(item, list)
	{
		uint32_t number = 0;
		const cJSON *node = rc == 0 ? gltf_child(search->gltf, item, &number) : NULL;

		if (rc == 0 && (!node || search->was_seen[number]))
			rc = gltf_say(search->gltf, -EBADMSG, of,
				      "\"%.60s\" has a child that is none or another's; export it "
				      "anew",
				      gltf_name(of));
		if (rc < 0)
			break;
		search->was_seen[number] = true;
		search->parents[number] = parent;
		if (camera_of(search, node))
			rc = add_camera(search, number);
		if (rc == 0)
			rc = visit(search, cJSON_GetObjectItemCaseSensitive(node, "children"),
				   number, node);
	}
	search->depth--;
	return rc;
}

/* Whether a node is the camera's, or above it. */
static bool carries(const struct search *search, uint32_t node, uint32_t camera)
{
	while (camera != node && camera != SCENERY_NONE)
		camera = search->parents[camera];
	return camera != SCENERY_NONE;
}

/* ---- which one */

/* Returns whether a channel moves a camera, and which part of which node it sets. */
static bool moves(const struct search *search, const cJSON *channel, uint32_t camera,
		  uint32_t *node, enum part *part)
{
	const cJSON *target = cJSON_GetObjectItemCaseSensitive(channel, "target");
	const char *path = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(target, "path"));

	if (!path || !gltf_item(search->gltf, GLTF_NODES, target, "node", node) ||
	    !carries(search, *node, camera))
		return false;
	for (*part = MOVE; *part < PARTS; ++*part)
		if (strcmp(path, part_names[*part]) == 0)
			return true;
	return false;
}

static bool animation_moves(const struct search *search, const cJSON *animation, uint32_t camera)
{
	const cJSON *channel, *channels = cJSON_GetObjectItemCaseSensitive(animation, "channels");
	enum part part;
	uint32_t node;

	cJSON_ArrayForEach(channel, channels)
	{
		if (moves(search, channel, camera, &node, &part))
			return true;
	}
	return false;
}

/* Sets *out to the animation that moves a camera; NULL: none. */
static int find_animation(const cJSON **out, const struct search *search, uint32_t camera)
{
	const struct gltf *gltf = search->gltf;

	*out = NULL;
	for (uint32_t i = 0; i < gltf->lists[GLTF_ANIMATIONS].count; i++) {
		const cJSON *animation = gltf->lists[GLTF_ANIMATIONS].items[i];

		if (!animation_moves(search, animation, camera))
			continue;
		if (*out)
			return gltf_say(gltf, -EINVAL, animation,
					"a second animation, \"%.60s\", moves the camera of node "
					"\"%.60s\"; export the file with one of them",
					gltf_name(animation), gltf_name(node_of(search, camera)));
		*out = animation;
	}
	return 0;
}

static bool is_named(const struct search *search, uint32_t camera, const char *name)
{
	const cJSON *node = node_of(search, camera);

	return strcmp(gltf_name(node), name) == 0 ||
	       strcmp(gltf_name(camera_of(search, node)), name) == 0;
}

/* Sets *animation to the one that moves the camera that is meant; NULL: none moves, and none was
 * named. */
static int choose(const struct search *search, const char *name, uint32_t *camera,
		  const cJSON **animation)
{
	int rc = 0;

	*animation = NULL;
	for (uint32_t i = 0; i < search->count && rc == 0; i++) {
		const cJSON *mover = NULL;

		if (name && !is_named(search, search->cameras[i], name))
			continue;
		rc = find_animation(&mover, search, search->cameras[i]);
		if (rc == 0 && mover && *animation)
			rc = gltf_say(search->gltf, -EINVAL, node_of(search, search->cameras[i]),
				      "a second camera that moves, of node \"%.60s\": give each "
				      "its own name, and name one as the tour's \"viewpoint\"",
				      gltf_name(node_of(search, search->cameras[i])));
		if (mover) {
			*camera = search->cameras[i];
			*animation = mover;
		}
	}
	if (rc == 0 && name && !*animation)
		rc = gltf_say(search->gltf, -EINVAL, NULL,
			      "has no moving camera of the name \"%.60s\"; correct the tour's "
			      "\"viewpoint\"",
			      name);
	if (rc == 0 && search->count == 0)
		rc = gltf_say(search->gltf, -EINVAL, NULL,
			      "has no camera that a tour could show; add one");
	return rc;
}

/* A visitor's eye sees in perspective. */
static int check_kind(const struct search *search, uint32_t camera)
{
	const cJSON *node = node_of(search, camera), *of = camera_of(search, node);
	const char *type = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(of, "type"));

	if (type && strcmp(type, "perspective") == 0)
		return 0;
	return gltf_say(search->gltf, -ENOTSUP, of,
			"the camera of node \"%.60s\" is %.20s, and a visitor looks in "
			"perspective; make it a perspective camera",
			gltf_name(node), type ? type : "of no type");
}

/* ---- where it is */

/* Sets value to that of a channel at a moment. */
static int value_at(float *value, const struct search *search, const struct channel *channel,
		    struct scene_moment moment)
{
	const struct gltf_sampler *sampler = &channel->sampler;
	const uint32_t count = gltf_sampler_key_count(sampler);
	float from[4], to[4], from_s, to_s, share;
	uint32_t after = 0, end = count; /* the first key after the moment is one of these */

	while (after < end) {
		const uint32_t middle = (after + end) / 2;

		if (scene_moment_reaches(moment, gltf_sampler_key(to, sampler, middle)))
			after = middle + 1;
		else
			end = middle;
	}
	from_s = gltf_sampler_key(from, sampler, after > 0 ? after - 1 : 0);
	to_s = gltf_sampler_key(to, sampler, after < count ? after : count - 1);
	share = to_s > from_s && moment.time > from_s ? (moment.time - from_s) / (to_s - from_s)
						      : 0;
	if (channel->part == TURN) {
		if (!gltf_make_turn(from) || !gltf_make_turn(to))
			return gltf_say(search->gltf, -EBADMSG, node_of(search, channel->node),
					"a key turns node \"%.60s\" by numbers that are no turn; "
					"export it anew",
					gltf_name(node_of(search, channel->node)));
		turn_between(value, from, to, share);
		return 0;
	}
	for (uint32_t k = 0; k < sampler->width; k++)
		value[k] = from[k] + share * (to[k] - from[k]);
	return 0;
}

/* Sets out to the place of a node at a moment. */
static int node_at(float out[16], const struct search *search, uint32_t node,
		   struct scene_moment moment)
{
	const uint32_t above = search->parents[node];
	struct scenery_place place;
	float parent[16];
	int rc = gltf_place(&place, search->gltf, node_of(search, node));

	memcpy(parent, vrml_identity, sizeof(parent));
	if (rc == 0 && above != SCENERY_NONE)
		rc = node_at(parent, search, above, moment);
	for (uint32_t i = 0; i < search->channel_count && rc == 0; i++) {
		const struct channel *channel = &search->channels[i];
		float *const parts[PARTS] = { place.move_m, place.turn, place.scale };

		if (channel->node == node)
			rc = value_at(parts[channel->part], search, channel, moment);
	}
	gltf_place_below(out, parent, &place);
	return rc;
}

static int add_view(struct scene_views *out, const struct search *search, uint32_t camera,
		    struct scene_moment moment)
{
	static const float none[4] = { 0, 0, 0, 1 };
	float place[16];
	int rc = node_at(place, search, camera, moment);

	return rc == 0 ? scene_views_add(out, moment.time, place, at_rest, none) : rc;
}

static int add_still(struct scene_views *out, const struct search *search)
{
	int rc = 0;

	for (uint32_t i = 0; i < search->count && rc == 0; i++) {
		rc = check_kind(search, search->cameras[i]);
		if (rc == 0)
			rc = add_view(out, search, search->cameras[i], (struct scene_moment){ 0 });
	}
	return rc;
}

/* ---- a way */

static int find_channels(struct search *search, const cJSON *animation, uint32_t camera)
{
	const cJSON *item, *channels = cJSON_GetObjectItemCaseSensitive(animation, "channels");
	int rc = 0;

	cJSON_ArrayForEach(item, channels)
	{
		struct channel *channel = &search->channels[search->channel_count];
		struct channel found = { 0 };

		if (rc < 0 || !moves(search, item, camera, &found.node, &found.part))
			continue;
		if (search->channel_count == CHANNELS_MAX)
			return gltf_say(search->gltf, -EFBIG, item,
					"over %d channels move one camera; bake its movement "
					"into its own node",
					CHANNELS_MAX);
		rc = gltf_sampler_read(&found.sampler, search->gltf, animation, item,
				       part_widths[found.part]);
		if (rc == 0 && found.sampler.times.count > SCENE_KEYS_MAX)
			rc = gltf_say(search->gltf, -EFBIG, item, "over %d keys; leave some out",
				      SCENE_KEYS_MAX);
		*channel = found;
		search->channel_count += rc == 0;
	}
	return rc;
}

/* Writes the moments of all keys, and more between those that turn what is above the camera.
 * Returns how many; 0: over MOMENTS_MAX. */
static uint32_t gather(struct scene_moment *out, const struct search *search, uint32_t camera)
{
	uint32_t count = 0, pieces = 1;

	for (uint32_t c = 0; c < search->channel_count; c++)
		if (search->channels[c].node != camera && search->channels[c].part == TURN &&
		    gltf_sampler_key_count(&search->channels[c].sampler) <= ARC_KEYS_MAX)
			pieces = ARC_PIECES;
	out[count++] = (struct scene_moment){ .time = 0 };
	for (uint32_t c = 0; c < search->channel_count; c++) {
		const struct gltf_sampler *sampler = &search->channels[c].sampler;
		const uint32_t keys = gltf_sampler_key_count(sampler);

		for (uint32_t i = 0; i < keys; i++) {
			float ignored[4], now = gltf_sampler_key(ignored, sampler, i);
			float next = i + 1 < keys ? gltf_sampler_key(ignored, sampler, i + 1) : now;

			if (count + pieces > MOMENTS_MAX)
				return 0;
			out[count++] =
				(struct scene_moment){ .time = now,
						       .is_before = i + 1 < keys && next == now };
			for (uint32_t p = 1; p < pieces && next > now; p++)
				out[count++] = (struct scene_moment){
					.time = now + (next - now) * (float)p / (float)pieces
				};
		}
	}
	return scene_moments_sort(out, count);
}

static int add_way(struct scene_views *out, struct search *search, const cJSON *animation,
		   uint32_t camera)
{
	struct scene_moment *moments = malloc(MOMENTS_MAX * sizeof(*moments));
	uint32_t count = 0;
	int rc = moments ? check_kind(search, camera) : -ENOMEM;

	if (rc == 0)
		rc = find_channels(search, animation, camera);
	if (rc == 0) {
		out->moves = true;
		count = gather(moments, search, camera);
		if (count == 0)
			rc = gltf_say(search->gltf, -EFBIG, animation,
				      "animation \"%.60s\" moves a camera at too many times; "
				      "leave keys out",
				      gltf_name(animation));
	}
	for (uint32_t i = 0; i < count && rc == 0; i++)
		rc = add_view(out, search, camera, moments[i]);
	free(moments);
	return rc;
}

int gltf_views_read(struct scene_views *out, const struct gltf *gltf, const char *scene,
		    const char *name)
{
	const size_t nodes = gltf->lists[GLTF_NODES].count;
	const cJSON *chosen = gltf_scene(gltf, scene), *animation = NULL;
	struct search *search = calloc(1, sizeof(*search));
	uint32_t camera = 0;
	int rc = search ? 0 : -ENOMEM;

	*out = (struct scene_views){ 0 };
	if (rc == 0 && !chosen)
		rc = -EINVAL;
	if (rc == 0) {
		search->gltf = gltf;
		search->parents = calloc(nodes + 1, sizeof(*search->parents));
		search->was_seen = calloc(nodes + 1, sizeof(*search->was_seen));
		rc = search->parents && search->was_seen ? 0 : -ENOMEM;
	}
	if (rc == 0)
		rc = visit(search, cJSON_GetObjectItemCaseSensitive(chosen, "nodes"), SCENERY_NONE,
			   chosen);
	if (rc == 0)
		rc = choose(search, name, &camera, &animation);
	if (rc == 0)
		rc = animation ? add_way(out, search, animation, camera) : add_still(out, search);
	if (rc == -ENOMEM)
		gltf_say(gltf, rc, NULL, "too large for this machine's memory");
	if (search) {
		free(search->parents);
		free(search->was_seen);
		free(search->cameras);
	}
	free(search);
	return rc;
}
