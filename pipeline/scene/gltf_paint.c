/* Reads textureInfo objects, and bends the normals of a map by its scale. */
#include "pipeline/scene/gltf_paint.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "geometry/vec.h"
#include "pipeline/scene/gltf_nodes.h"

/* Gets where a textureInfo puts its picture. Returns false if it has numbers that are none. */
static bool get_lay(struct gltf_lay *out, const cJSON *info)
{
	static const float zero[2], one[2] = { 1, 1 };
	const cJSON *extensions = cJSON_GetObjectItemCaseSensitive(info, "extensions");
	const cJSON *moved = cJSON_GetObjectItemCaseSensitive(extensions, "KHR_texture_transform");
	const cJSON *set = cJSON_GetObjectItemCaseSensitive(moved, "texCoord");
	const cJSON *turn = cJSON_GetObjectItemCaseSensitive(moved, "rotation");

	if (!set)
		set = cJSON_GetObjectItemCaseSensitive(info, "texCoord");
	memset(out, 0, sizeof(*out));
	snprintf(out->coordinates, sizeof(out->coordinates), "TEXCOORD_%d",
		 cJSON_IsNumber(set) ? set->valueint : 0);
	if (cJSON_IsNumber(turn))
		out->turn_rad = (float)turn->valuedouble;
	return gltf_floats(out->offset, moved, "offset", 2, zero) &&
	       gltf_floats(out->scale, moved, "scale", 2, one) && isfinite(out->turn_rad);
}

static bool are_equal(const struct gltf_lay *a, const struct gltf_lay *b)
{
	return strcmp(a->coordinates, b->coordinates) == 0 && a->turn_rad == b->turn_rad &&
	       memcmp(a->offset, b->offset, sizeof(a->offset)) == 0 &&
	       memcmp(a->scale, b->scale, sizeof(a->scale)) == 0;
}

int gltf_paint_get(struct gltf_paint *out, const struct gltf *gltf, const cJSON *material,
		   struct diagnostics *warnings)
{
	const cJSON *pbr = cJSON_GetObjectItemCaseSensitive(material, "pbrMetallicRoughness");
	const cJSON *picture = cJSON_GetObjectItemCaseSensitive(pbr, "baseColorTexture");
	const cJSON *normals = cJSON_GetObjectItemCaseSensitive(material, "normalTexture");
	const cJSON *depth = cJSON_GetObjectItemCaseSensitive(normals, "scale");
	struct gltf_lay other;

	*out = (struct gltf_paint){ .depth =
					    cJSON_IsNumber(depth) ? (float)depth->valuedouble : 1 };
	out->picture = gltf_item(gltf, GLTF_TEXTURES, picture, "index", NULL);
	out->normals = gltf_item(gltf, GLTF_TEXTURES, normals, "index", NULL);
	if (!get_lay(&out->lay, picture) || !get_lay(&other, normals) || !isfinite(out->depth))
		return gltf_say(gltf, -EBADMSG, material,
				"material \"%.60s\" has an offset, rotation or scale of a "
				"picture that is no number; export it anew",
				gltf_name(material));
	if (!out->picture)
		out->lay = other;
	if (out->picture && out->normals && !are_equal(&out->lay, &other)) {
		diagnostics_add(warnings, 0, gltf->path, json_text_line(&gltf->json, normals),
				"the normal map of material \"%.60s\" lies otherwise than its "
				"picture, so it is left out; give both the same coordinates",
				gltf_name(material));
		out->normals = NULL;
	}
	return 0;
}

void gltf_paint_place(float uv[2], const struct gltf_lay *lay)
{
	const float u = uv[0] * lay->scale[0], v = uv[1] * lay->scale[1];
	const float c = cosf(lay->turn_rad), s = sinf(lay->turn_rad);

	/* Counter-clockwise as the picture is seen, whose v grows downwards. */
	uv[0] = lay->offset[0] + c * u + s * v;
	uv[1] = lay->offset[1] - s * u + c * v;
}

/* Makes a normal map deeper or flatter. */
static void deepen(struct picture *map, float depth)
{
	const size_t count = (size_t)map->width * map->height;

	for (size_t i = 0; i < count; i++) {
		uint8_t *pixel = &map->rgba[4 * i];
		float normal[3];

		for (int k = 0; k < 3; k++)
			normal[k] = ((float)pixel[k] / 255 * 2 - 1) * (k < 2 ? depth : 1);
		vec_normalise(normal);
		for (int k = 0; k < 3; k++)
			pixel[k] = (uint8_t)lrintf((normal[k] + 1) / 2 * 255);
	}
}

/* Reads a texture, or keeps the one that was read last. depth: of a normal map; else 1. */
static int get(struct gltf_picture *kept, const struct picture **out, const struct gltf *gltf,
	       const cJSON *texture, float depth, struct diagnostics *warnings)
{
	int rc;

	*out = NULL;
	if (!texture)
		return 0;
	if (kept->of != texture || kept->depth != depth) {
		picture_finish(&kept->picture);
		kept->of = texture;
		kept->depth = depth;
		rc = gltf_picture(&kept->picture, gltf, texture, warnings);
		if (rc < 0)
			return rc;
		if (rc > 0 && depth != 1)
			deepen(&kept->picture, depth);
	}
	if (kept->picture.rgba)
		*out = &kept->picture;
	return 0;
}

int gltf_pictures_get(struct gltf_pictures *pictures, struct scenery_paint *out,
		      const struct gltf *gltf, const struct gltf_paint *paint,
		      struct diagnostics *warnings)
{
	int rc = get(&pictures->colours, &out->picture, gltf, paint->picture, 1, warnings);

	if (rc == 0)
		rc = get(&pictures->normals, &out->normals, gltf, paint->normals, paint->depth,
			 warnings);
	return rc;
}

void gltf_pictures_finish(struct gltf_pictures *pictures)
{
	picture_finish(&pictures->colours.picture);
	picture_finish(&pictures->normals.picture);
	*pictures = (struct gltf_pictures){ 0 };
}
