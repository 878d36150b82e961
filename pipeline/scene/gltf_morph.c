/* Computes where vertices are at each key of the weights. */
#include "pipeline/scene/gltf_morph.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/scene/gltf_nodes.h"

const cJSON *gltf_morph_channel(const struct gltf *gltf, uint32_t node, const cJSON **animation)
{
	for (uint32_t i = 0; i < gltf->lists[GLTF_ANIMATIONS].count; i++) {
		const cJSON *channel, *channels = cJSON_GetObjectItemCaseSensitive(
					      gltf->lists[GLTF_ANIMATIONS].items[i], "channels");

		*animation = gltf->lists[GLTF_ANIMATIONS].items[i];
		cJSON_ArrayForEach(channel, channels)
		{
			const cJSON *target = cJSON_GetObjectItemCaseSensitive(channel, "target");
			const char *path = cJSON_GetStringValue(
				cJSON_GetObjectItemCaseSensitive(target, "path"));
			uint32_t number;

			if (path && strcmp(path, "weights") == 0 &&
			    gltf_item(gltf, GLTF_NODES, target, "node", &number) && number == node)
				return channel;
		}
	}
	return NULL;
}

static uint32_t count_of(const cJSON *primitive)
{
	return (uint32_t)cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(primitive, "targets"));
}

uint32_t gltf_morph_count(const struct gltf *gltf, const cJSON *node)
{
	const cJSON *mesh = gltf_item(gltf, GLTF_MESHES, node, "mesh", NULL);

	return count_of(
		cJSON_GetArrayItem(cJSON_GetObjectItemCaseSensitive(mesh, "primitives"), 0));
}

/* The weights of a node, or else of its mesh, or else none. */
static void get_weights(struct gltf_morph *out, const cJSON *node, const cJSON *mesh)
{
	const cJSON *own = cJSON_GetObjectItemCaseSensitive(node, "weights");
	const cJSON *list = own ? own : cJSON_GetObjectItemCaseSensitive(mesh, "weights"), *item;
	uint32_t at = 0;

	cJSON_ArrayForEach(item, list)
	{
		if (at < out->count && cJSON_IsNumber(item))
			out->weights[at] = (float)item->valuedouble;
		at++;
	}
}

int gltf_morph_read(struct gltf_morph *out, const struct gltf *gltf, const cJSON *node,
		    const cJSON *mesh, const cJSON *primitive, uint32_t vertex_count)
{
	const cJSON *target, *targets = cJSON_GetObjectItemCaseSensitive(primitive, "targets");
	uint32_t count = count_of(primitive);
	int rc = 0;

	memset(out, 0, sizeof(*out));
	if (count > GLTF_WEIGHTS_MAX)
		return gltf_say(gltf, -EFBIG, primitive,
				"mesh \"%.60s\" has over %d morph targets; leave some out",
				gltf_name(mesh), GLTF_WEIGHTS_MAX);
	cJSON_ArrayForEach(target, targets)
	{
		struct gltf_numbers *numbers = &out->targets[out->count];

		/* One without places moves none. */
		if (rc == 0 && cJSON_HasObjectItem(target, "POSITION"))
			rc = gltf_numbers_of(numbers, gltf, target, "POSITION", 3);
		else if (rc == 0)
			*numbers = (struct gltf_numbers){ .count = vertex_count, .width = 3 };
		if (rc == 0 && numbers->count != vertex_count)
			rc = gltf_say(gltf, -EBADMSG, primitive,
				      "a morph target of mesh \"%.60s\" has another number of "
				      "vertices; export it anew",
				      gltf_name(mesh));
		out->count += rc == 0;
	}
	get_weights(out, node, mesh);
	return rc;
}

void gltf_morph_place(float position[3], const struct gltf_morph *morph, const float *weights,
		      uint32_t vertex)
{
	for (uint32_t i = 0; i < morph->count; i++)
		for (uint32_t k = 0; k < 3 && weights[i] != 0; k++)
			position[k] += weights[i] * gltf_number(&morph->targets[i], vertex, k);
}

int gltf_morph_add(struct scenery_maker *maker, uint32_t node,
		   const struct scenery_material *material, const struct soup *soup,
		   float crease_rad, const struct scenery_paint *paint,
		   const struct gltf_morph *morph, const struct gltf_numbers *positions,
		   const struct gltf_sampler *sampler)
{
	struct scenery_bend bend = { .point_count = positions->count,
				     .shape_count = gltf_sampler_key_count(sampler) };
	const uint64_t places = (uint64_t)bend.point_count * bend.shape_count;
	float weights[GLTF_WEIGHTS_MAX] = { 0 }, (*all)[3];
	int rc;

	if (places > 8ull * SCENERY_SHAPE_VERTICES_MAX)
		return -EFBIG;
	all = malloc((size_t)places * sizeof(*all) + 1);
	if (!all)
		return -ENOMEM;
	for (uint32_t shape = 0; shape < bend.shape_count; shape++) {
		gltf_sampler_key(weights, sampler, shape);
		for (uint32_t v = 0; v < bend.point_count; v++) {
			float at[3];

			for (uint32_t k = 0; k < 3; k++)
				at[k] = gltf_number(positions, v, k);
			gltf_morph_place(at, morph, weights, v);
			soup_place(all[(size_t)shape * bend.point_count + v], soup, at);
		}
	}
	bend.places = (const float(*)[3])all;
	rc = scenery_add_bent(maker, node, material, soup, crease_rad, paint, &bend);
	free(all);
	return rc;
}
