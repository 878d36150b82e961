/* Reads the nodes of a glTF document. */
#include "pipeline/scene/gltf_nodes.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <string.h>

#include "geometry/turn.h"
#include "geometry/vec.h"
#include "pipeline/scene/vrml_graph.h"

const char *gltf_name(const cJSON *object)
{
	const char *name = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, "name"));

	return name ? name : "";
}

bool gltf_floats(float *out, const cJSON *object, const char *field, int count,
		 const float *otherwise)
{
	const cJSON *array = cJSON_GetObjectItemCaseSensitive(object, field), *item;
	int at = 0;

	memcpy(out, otherwise, (size_t)count * sizeof(*out));
	if (!array)
		return true;
	if (!cJSON_IsArray(array) || cJSON_GetArraySize(array) != count)
		return false;
	cJSON_ArrayForEach(item, array)
	{
		out[at] = cJSON_IsNumber(item) ? (float)item->valuedouble : NAN;
		if (!isfinite(out[at++]))
			return false;
	}
	return true;
}

const cJSON *gltf_child(const struct gltf *gltf, const cJSON *item, uint32_t *number)
{
	const double at = cJSON_IsNumber(item) ? item->valuedouble : -1;

	if (!(at >= 0 && at < (double)gltf->lists[GLTF_NODES].count))
		return NULL;
	*number = (uint32_t)at;
	return gltf->lists[GLTF_NODES].items[*number];
}

const cJSON *gltf_scene(const struct gltf *gltf, const char *name)
{
	const cJSON *first = gltf_item(gltf, GLTF_SCENES, gltf->json.root, "scene", NULL);

	for (uint32_t i = 0; name && i < gltf->lists[GLTF_SCENES].count; i++)
		if (strcmp(gltf_name(gltf->lists[GLTF_SCENES].items[i]), name) == 0)
			return gltf->lists[GLTF_SCENES].items[i];
	if (name) {
		gltf_say(gltf, -EINVAL, NULL,
			 "has no scene \"%.60s\"; correct the name in scenes.json", name);
		return NULL;
	}
	if (!first && gltf->lists[GLTF_SCENES].count > 0)
		first = gltf->lists[GLTF_SCENES].items[0];
	if (!first)
		gltf_say(gltf, -EINVAL, NULL, "has no scene; export it with one");
	return first;
}

/* ---- places */

/* Sets a turn to that of a matrix whose columns are at right angles and of length 1. */
static void turn_of(float out[4], const float m[16])
{
	const float squares[4] = { 1 + m[0] - m[5] - m[10], 1 - m[0] + m[5] - m[10],
				   1 - m[0] - m[5] + m[10], 1 + m[0] + m[5] + m[10] };
	int most = 0;
	float half, scale;

	for (int k = 1; k < 4; k++)
		if (squares[k] > squares[most])
			most = k;
	half = sqrtf(fmaxf(squares[most], 0)) / 2;
	scale = half > 0 ? 0.25f / half : 0;
	out[most] = half;
	if (most == 3) {
		out[0] = (m[6] - m[9]) * scale;
		out[1] = (m[8] - m[2]) * scale;
		out[2] = (m[1] - m[4]) * scale;
	} else {
		const int next = (most + 1) % 3, last = (most + 2) % 3;

		out[next] = (m[4 * next + most] + m[4 * most + next]) * scale;
		out[last] = (m[4 * last + most] + m[4 * most + last]) * scale;
		out[3] = (m[4 * next + last] - m[4 * last + next]) * scale;
	}
}

/* Splits a matrix into the move, turn and scale that it must be made of. */
static void split_matrix(struct scenery_place *out, float m[16])
{
	memcpy(out->move_m, m + 12, sizeof(out->move_m));
	for (int column = 0; column < 3; column++) {
		out->scale[column] = vec_length(m + 4 * column);
		if (column == 0 && vrml_mirrors(m))
			out->scale[0] *= -1;
		for (int row = 0; row < 3 && out->scale[column] != 0; row++)
			m[4 * column + row] /= out->scale[column];
	}
	turn_of(out->turn, m);
}

int gltf_place(struct scenery_place *out, const struct gltf *gltf, const cJSON *node)
{
	static const float zero[3], one[3] = { 1, 1, 1 }, none[4] = { 0, 0, 0, 1 };
	float m[16], length = 0;
	bool is_good;

	*out = scenery_at_rest;
	is_good = gltf_floats(m, node, "matrix", 16, vrml_identity) &&
		  gltf_floats(out->move_m, node, "translation", 3, zero) &&
		  gltf_floats(out->turn, node, "rotation", 4, none) &&
		  gltf_floats(out->scale, node, "scale", 3, one);
	if (is_good && cJSON_HasObjectItem(node, "matrix"))
		split_matrix(out, m);
	for (int k = 0; k < 4; k++)
		length += out->turn[k] * out->turn[k];
	if (!is_good || !(length > 1e-6f && isfinite(length)))
		return gltf_say(gltf, -EBADMSG, node,
				"node \"%.60s\" has a place that is none; export it anew",
				gltf_name(node));
	for (int k = 0; k < 4; k++)
		out->turn[k] /= sqrtf(length);
	return 0;
}

void gltf_place_below(float out[16], const float parent[16], const struct scenery_place *place)
{
	float own[16] = { [15] = 1 };

	turn_matrix(own, place->turn);
	vec_copy(own + 12, place->move_m);
	for (int i = 0; i < 12; i++)
		own[i] *= place->scale[i / 4];
	matrix_multiply(out, parent, own);
}
