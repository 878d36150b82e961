/* Walks the nodes of a glTF scene (glTF 2.0, 3.5 to 3.9). */
#include "pipeline/scene/gltf_scenery.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/srgb.h"
#include "geometry/vec.h"
#include "pipeline/scene/gltf_morph.h"
#include "pipeline/scene/gltf_motions.h"
#include "pipeline/scene/gltf_nodes.h"
#include "pipeline/scene/gltf_paint.h"
#include "pipeline/scene/scenery_look.h"
#include "pipeline/scene/vrml_graph.h"

enum { TRIANGLES = 4, STRIP = 5, FAN = 6 };

struct walk {
	struct scenery_maker *maker;
	const struct gltf *gltf;
	struct diagnostics *warnings;
	bool *moves, *was_seen; /* by node of the file */
	bool *has_mesh;         /* itself, or a node below */
	uint32_t *nodes;        /* of the scenery */
	uint32_t root;          /* of the scenery, that stands for the file */
	uint32_t depth;
	bool has_other_shapes;
	struct gltf_pictures pictures;
};

static int fail(const struct walk *walk, int rc, const cJSON *object)
{
	if (rc == -EFBIG)
		gltf_say(walk->gltf, rc, object,
			 "more than scenery may have; simplify the scene, or use it as a scan");
	else if (rc == -ENOMEM)
		gltf_say(walk->gltf, rc, object, "too large for this machine's memory");
	return rc;
}

/* ---- meshes */

static float to_srgb(float linear)
{
	return srgb_of_light(fminf(fmaxf(linear, 0), 1));
}

struct look {
	float factor[4]; /* baseColorFactor, linear */
	struct scenery_material material;
	bool has_mean; /* of a substance, in place of the factor */
	uint8_t mean[3];
	struct gltf_paint paint;
};

static uint8_t to_byte(float linear)
{
	return (uint8_t)(to_srgb(linear) * 255 + 0.5f);
}

/* Returns a number from 0 to 1; 1 if it is left out. */
static float get_factor(const cJSON *pbr, const char *key)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(pbr, key);

	return cJSON_IsNumber(item) ? fminf(fmaxf((float)item->valuedouble, 0), 1) : 1;
}

/* A smooth surface has a highlight, and a smooth metal mirrors. What glTF leaves out is rough
 * metal, which has neither. */
static void get_gloss(const struct walk *walk, struct look *out, const cJSON *pbr,
		      const cJSON *material)
{
	static const float least_smooth = 0.3f;
	const float rough = get_factor(pbr, "roughnessFactor");
	const float metal = get_factor(pbr, "metallicFactor"), smooth = 1 - rough;
	float strength;

	if (smooth >= least_smooth && !cJSON_HasObjectItem(pbr, "metallicRoughnessTexture")) {
		for (int k = 0; k < 3; k++) {
			strength = 0.25f + metal * (out->factor[k] - 0.25f);
			out->material.specular[k] = to_byte(strength * smooth);
		}
		/* as wide as the lobe of that roughness (Walter et al. 2007: alpha is its square)
		 */
		out->material.shininess = fminf(fmaxf(2 / powf(fmaxf(rough, 0.2f), 4) - 2, 1), 128);
		out->material.mirror = 0.6f * metal * smooth;
		out->material.by_pixel = true;
	}
	scenery_look_add(walk->maker, gltf_name(material), &out->material);
	if (out->material.substance && !cJSON_HasObjectItem(pbr, "baseColorFactor")) {
		scenery_look_mean(out->mean, &out->material);
		out->has_mean = true;
	}
}

static int get_look(struct walk *walk, struct look *out, const cJSON *primitive)
{
	static const float white[4] = { 1, 1, 1, 1 }, black[3];
	const cJSON *material = gltf_item(walk->gltf, GLTF_MATERIALS, primitive, "material", NULL);
	const cJSON *pbr = cJSON_GetObjectItemCaseSensitive(material, "pbrMetallicRoughness");
	const char *alpha =
		cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(material, "alphaMode"));
	float emissive[3];

	*out = (struct look){ .material = scenery_plain };
	out->material.has_two_sides =
		cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(material, "doubleSided"));
	if (!gltf_floats(out->factor, pbr, "baseColorFactor", 4, white) ||
	    !gltf_floats(emissive, material, "emissiveFactor", 3, black))
		return gltf_say(walk->gltf, -EBADMSG, material,
				"material \"%.60s\" has a colour that is none; export it anew",
				gltf_name(material));
	for (int k = 0; k < 3; k++)
		out->material.emissive[k] = to_byte(emissive[k]);
	if (alpha && strcmp(alpha, "BLEND") == 0)
		out->material.opacity = fminf(fmaxf(out->factor[3], 0), 1);
	get_gloss(walk, out, pbr, material);
	return gltf_paint_get(&out->paint, walk->gltf, material, walk->warnings);
}

struct shape {
	struct gltf_numbers positions, colours, indices, uvs, normals;
	bool has_uvs, has_colours, has_indices, has_normals;
	struct look look;
	struct gltf_morph morph;
	const cJSON *bender;         /* the channel that animates its weights; NULL: none */
	struct gltf_sampler sampler; /* of the bender */
	int mode;
	uint32_t count; /* of corners in order */
};

static int read_shape(struct walk *walk, struct shape *out, const cJSON *primitive)
{
	const struct gltf *gltf = walk->gltf;
	const cJSON *attributes = cJSON_GetObjectItemCaseSensitive(primitive, "attributes");
	const cJSON *mode = cJSON_GetObjectItemCaseSensitive(primitive, "mode");
	const cJSON *colours, *type;
	int rc;

	*out = (struct shape){ .mode = mode ? mode->valueint : TRIANGLES };
	rc = gltf_numbers_of(&out->positions, gltf, attributes, "POSITION", 3);
	if (rc < 0)
		return rc;
	colours = gltf_item(gltf, GLTF_ACCESSORS, attributes, "COLOR_0", NULL);
	type = cJSON_GetObjectItemCaseSensitive(colours, "type");
	out->has_colours = colours;
	if (colours)
		rc = gltf_numbers_of(
			&out->colours, gltf, attributes, "COLOR_0",
			type && type->valuestring && strcmp(type->valuestring, "VEC3") == 0 ? 3
											    : 4);
	out->has_indices = cJSON_HasObjectItem(primitive, "indices");
	if (rc == 0 && out->has_indices)
		rc = gltf_numbers_of(&out->indices, gltf, primitive, "indices", 1);
	if (rc < 0)
		return rc;
	out->has_normals = cJSON_HasObjectItem(attributes, "NORMAL");
	if (out->has_normals)
		rc = gltf_numbers_of(&out->normals, gltf, attributes, "NORMAL", 3);
	if (rc < 0)
		return rc;
	out->count = out->has_indices ? out->indices.count : out->positions.count;
	rc = get_look(walk, &out->look, primitive);
	out->has_uvs = rc == 0 && (out->look.paint.picture || out->look.paint.normals) &&
		       cJSON_HasObjectItem(attributes, out->look.paint.lay.coordinates);
	if (out->has_uvs)
		rc = gltf_numbers_of(&out->uvs, gltf, attributes, out->look.paint.lay.coordinates,
				     2);
	return rc;
}

/* Where the mesh of a node of the file goes. */
struct place_of {
	const cJSON *of;
	uint32_t number;    /* of it in the file */
	uint32_t node;      /* of the scenery */
	const float *place; /* in that; column-major */
	bool is_mirrored;
};

static uint32_t vertex_at(const struct shape *shape, uint32_t at)
{
	return shape->has_indices ? gltf_index(&shape->indices, at) : at;
}

static bool set_corner(struct soup_corner *out, const struct shape *shape, uint32_t at)
{
	const uint32_t vertex = vertex_at(shape, at);
	float morphed[3];

	*out = (struct soup_corner){ 0 };
	if (vertex >= shape->positions.count ||
	    (shape->has_colours && vertex >= shape->colours.count) ||
	    (shape->has_uvs && vertex >= shape->uvs.count))
		return false;
	/* Those of what bends are computed for each shape. */
	if (shape->has_normals && shape->morph.count == 0 && vertex < shape->normals.count)
		for (uint32_t k = 0; k < 3; k++)
			out->normal[k] = gltf_number(&shape->normals, vertex, k);
	if (shape->has_uvs) {
		out->uv[0] = gltf_number(&shape->uvs, vertex, 0);
		out->uv[1] = gltf_number(&shape->uvs, vertex, 1);
		gltf_paint_place(out->uv, &shape->look.paint.lay);
		out->uv[1] = 1 - out->uv[1]; /* from the bottom */
	}
	for (uint32_t k = 0; k < 3; k++)
		morphed[k] = gltf_number(&shape->positions, vertex, k);
	gltf_morph_place(morphed, &shape->morph, shape->morph.weights, vertex);
	for (int k = 0; k < 3; k++) {
		const float colour =
			shape->has_colours ? gltf_number(&shape->colours, vertex, (uint32_t)k) : 1;

		out->position[k] = morphed[k];
		out->rgb[k] = shape->look.has_mean ? shape->look.mean[k]
						   : to_byte(colour * shape->look.factor[k]);
		if (!isfinite(out->position[k]))
			return false;
	}
	return true;
}

/* Adds the triangles of a shape to the soup. -EBADMSG: an index or a place is none. */
static int add_triangles(struct soup *soup, const struct shape *shape)
{
	const uint32_t step = shape->mode == TRIANGLES ? 3 : 1;
	int rc = 0;

	for (uint32_t i = 0; i + 3 <= shape->count && rc == 0; i += step) {
		const bool is_odd = shape->mode == STRIP && i % 2;
		const uint32_t at[3] = { shape->mode == FAN ? 0 : i, is_odd ? i + 2 : i + 1,
					 is_odd ? i + 1 : i + 2 };
		struct soup_corner corners[3];
		uint32_t vertices[3];

		for (int k = 0; k < 3; k++) {
			vertices[k] = vertex_at(shape, at[k]);
			if (!set_corner(&corners[k], shape, at[k]))
				return -EBADMSG;
		}
		soup->from = vertices;
		rc = soup_add(soup, corners, 3);
	}
	soup->from = NULL;
	return rc;
}

/* Reads the morph targets of a shape, and the animation of their weights. */
static int read_morph(const struct walk *walk, struct shape *shape, const struct place_of *of,
		      const cJSON *mesh, const cJSON *primitive)
{
	const struct gltf *gltf = walk->gltf;
	const cJSON *animation = NULL;
	int rc = gltf_morph_read(&shape->morph, gltf, of->of, mesh, primitive,
				 shape->positions.count);

	if (rc < 0 || shape->morph.count == 0)
		return rc;
	shape->bender = gltf_morph_channel(gltf, of->number, &animation);
	if (shape->bender && shape->morph.count != gltf_morph_count(gltf, of->of))
		return gltf_say(gltf, -EBADMSG, primitive,
				"the primitives of mesh \"%.60s\" have different numbers of morph "
				"targets; export it anew",
				gltf_name(mesh));
	return shape->bender ? gltf_sampler_read_weights(&shape->sampler, gltf, animation,
							 shape->bender, shape->morph.count)
			     : 0;
}

static int add_primitive(struct walk *walk, const cJSON *primitive, const cJSON *mesh,
			 const struct place_of *of)
{
	const float round = 1;
	struct soup soup = { .texture = SOUP_NO_TEXTURE, .is_inside_out = of->is_mirrored };
	struct scenery_paint paint = { 0 };
	struct shape shape;
	int rc = read_shape(walk, &shape, primitive);

	if (rc == 0)
		rc = read_morph(walk, &shape, of, mesh, primitive);
	if (rc < 0)
		return rc;
	soup.keeps_sources = shape.bender != NULL;
	if (shape.mode != TRIANGLES && shape.mode != STRIP && shape.mode != FAN) {
		walk->has_other_shapes = true;
		return 0;
	}
	if (shape.look.material.opacity < 1.0f / 255)
		return 0; /* it is not seen */
	memcpy(soup.place, of->place, sizeof(soup.place));
	if (shape.has_uvs)
		rc = gltf_pictures_get(&walk->pictures, &paint, walk->gltf, &shape.look.paint,
				       walk->warnings);
	if (rc == 0)
		rc = add_triangles(&soup, &shape);
	scenery_look_grain(&shape.look.material, &soup, &walk->maker->out.nodes[walk->root].place);
	if (rc == 0 && shape.bender)
		rc = gltf_morph_add(walk->maker, of->node, &shape.look.material, &soup,
				    shape.has_normals ? round : 0, &paint, &shape.morph,
				    &shape.positions, &shape.sampler);
	if (rc == -EBADMSG)
		gltf_say(walk->gltf, rc, primitive,
			 "mesh \"%.60s\" has indices or places that are none; export it anew",
			 gltf_name(mesh));
	if (rc == 0 && !shape.bender)
		rc = scenery_add_surface(walk->maker, of->node, &shape.look.material,
					 soup.triangles, soup.count, shape.has_normals ? round : 0,
					 &paint);
	soup_finish(&soup);
	return fail(walk, rc, mesh);
}

static int add_mesh(struct walk *walk, const struct place_of *of)
{
	const cJSON *node = of->of;
	const cJSON *mesh = gltf_item(walk->gltf, GLTF_MESHES, node, "mesh", NULL);
	const cJSON *primitives = cJSON_GetObjectItemCaseSensitive(mesh, "primitives"), *primitive;
	int rc = 0;

	if (mesh && cJSON_HasObjectItem(node, "skin"))
		return gltf_say(walk->gltf, -ENOTSUP, node,
				"node \"%.60s\" is bent by a skin, which scenery does not have; "
				"export it as stiff parts on nodes that move",
				gltf_name(node));
	cJSON_ArrayForEach(primitive, primitives) if (rc == 0) rc =
		add_primitive(walk, primitive, mesh, of);
	return rc;
}

/* ---- nodes */

/* Marks the nodes above what moves, and that each node is below one other at most. */
static int mark(struct walk *walk, const cJSON *node, uint32_t number)
{
	const cJSON *children = cJSON_GetObjectItemCaseSensitive(node, "children"), *item;
	int rc = 0;

	if (walk->was_seen[number] || walk->depth == GLTF_DEPTH_MAX)
		return gltf_say(walk->gltf, -EBADMSG, node,
				"node \"%.60s\" is below two nodes, or over %d deep; export it "
				"anew",
				gltf_name(node), GLTF_DEPTH_MAX);
	walk->was_seen[number] = true;
	walk->has_mesh[number] = cJSON_HasObjectItem(node, "mesh");
	walk->depth++;
	cJSON_ArrayForEach(item, children)
	{
		uint32_t child = 0;
		const cJSON *of = gltf_child(walk->gltf, item, &child);

		if (rc == 0 && !of)
			rc = gltf_say(walk->gltf, -EBADMSG, node,
				      "node \"%.60s\" has a child that is none; export it anew",
				      gltf_name(node));
		if (rc == 0)
			rc = mark(walk, of, child);
		if (rc == 0) {
			walk->moves[number] = walk->moves[number] || walk->moves[child];
			walk->has_mesh[number] = walk->has_mesh[number] || walk->has_mesh[child];
		}
	}
	/* What shows nothing, such as a camera, is not moved: a tour may fly its way. */
	walk->moves[number] = walk->moves[number] && walk->has_mesh[number];
	walk->depth--;
	return rc;
}

static int visit(struct walk *walk, const cJSON *of, uint32_t number, uint32_t node,
		 const float parent[16], bool is_mirrored)
{
	const cJSON *children = cJSON_GetObjectItemCaseSensitive(of, "children"), *item;
	struct scenery_node own = { .parent = node, .layer = SCENERY_NONE };
	float place[16];
	int rc = gltf_place(&own.place, walk->gltf, of);

	if (rc < 0)
		return rc;
	is_mirrored ^= own.place.scale[0] * own.place.scale[1] * own.place.scale[2] < 0;
	if (walk->moves[number]) {
		memcpy(place, vrml_identity, sizeof(place));
		rc = scenery_add_node(walk->maker, &own, &node);
		walk->nodes[number] = node;
	} else {
		gltf_place_below(place, parent, &own.place);
	}
	if (rc < 0)
		return fail(walk, rc, of);
	rc = add_mesh(walk, &(struct place_of){ of, number, node, place, is_mirrored });
	cJSON_ArrayForEach(item, children)
	{
		uint32_t child = 0;
		const cJSON *below = gltf_child(walk->gltf, item, &child);

		if (rc == 0)
			rc = visit(walk, below, child, node, place, is_mirrored);
	}
	return rc;
}

/* ---- scenes */

static int add_scene(struct walk *walk, const cJSON *scene, uint32_t node,
		     const struct gltf_choice *choice)
{
	const cJSON *roots = cJSON_GetObjectItemCaseSensitive(scene, "nodes"), *item;
	uint32_t number = 0;
	int rc = 0;

	gltf_mark_animated(walk->gltf, walk->moves);
	cJSON_ArrayForEach(item, roots)
	{
		const cJSON *root = gltf_child(walk->gltf, item, &number);

		if (rc == 0 && !root)
			rc = gltf_say(walk->gltf, -EBADMSG, scene,
				      "the scene has a node that is none; export it anew");
		if (rc == 0)
			rc = mark(walk, root, number);
	}
	cJSON_ArrayForEach(item, roots)
	{
		const cJSON *root = rc == 0 ? gltf_child(walk->gltf, item, &number) : NULL;

		if (root)
			rc = visit(walk, root, number, node, vrml_identity, false);
	}
	if (rc == 0)
		rc = fail(walk,
			  gltf_motions_add(walk->maker, walk->gltf, walk->nodes,
					   choice->plays_always, walk->warnings),
			  scene);
	return rc;
}

static void warn(const struct walk *walk)
{
	const char *path = walk->gltf->path;

	if (walk->has_other_shapes)
		diagnostics_add(walk->warnings, 0, path, 0,
				"points and lines have no surface; they were left out");
}

int gltf_scenery_add(struct scenery_maker *maker, const struct gltf *gltf, uint32_t node,
		     const struct gltf_choice *choice, struct diagnostics *warnings)
{
	const uint32_t count = gltf->lists[GLTF_NODES].count;
	struct walk walk = { .maker = maker, .gltf = gltf, .warnings = warnings, .root = node };
	const cJSON *scene = gltf_scene(gltf, choice->scene);
	int rc = scene ? 0 : -EINVAL;

	if (rc < 0)
		return rc;
	walk.moves = calloc((size_t)count + 1, sizeof(*walk.moves));
	walk.was_seen = calloc((size_t)count + 1, sizeof(*walk.was_seen));
	walk.has_mesh = calloc((size_t)count + 1, sizeof(*walk.has_mesh));
	walk.nodes = malloc(((size_t)count + 1) * sizeof(*walk.nodes));
	for (uint32_t i = 0; walk.nodes && i < count; i++)
		walk.nodes[i] = SCENERY_NONE;
	if (!walk.moves || !walk.was_seen || !walk.has_mesh || !walk.nodes)
		rc = fail(&walk, -ENOMEM, NULL);
	if (rc == 0)
		rc = add_scene(&walk, scene, node, choice);
	if (rc == 0)
		warn(&walk);
	gltf_pictures_finish(&walk.pictures);
	free(walk.moves);
	free(walk.was_seen);
	free(walk.has_mesh);
	free(walk.nodes);
	return rc;
}
