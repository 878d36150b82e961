/* Walks the graph of a scene and adds its shapes where the transforms above them put them. */
#include "pipeline/scene/vrml_surface.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "geometry/vec.h"
#include "pipeline/scene/vrml_faces.h"
#include "pipeline/scene/vrml_shapes.h"

/* USE can nest nodes deeper than the text does. */
enum { VISITS_MAX = 1 << 20, DEPTH_MAX = 1000 };

struct walk {
	struct vrml_surface *out;
	struct diagnostics *diagnostics;
	uint32_t visits, depth;
};

static const float identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };

/* ---- places */

static void shift(float m[16], const float by[3], float sign)
{
	float step[16], result[16];

	memcpy(step, identity, sizeof(step));
	for (int k = 0; k < 3; k++)
		step[12 + k] = sign * by[k];
	matrix_multiply(result, m, step);
	memcpy(m, result, sizeof(result));
}

/* Turns by an axis and an angle; sign -1: the other way. */
static void turn(float m[16], const float rotation[4], float sign)
{
	float axis[3] = { rotation[0], rotation[1], rotation[2] };
	float s = sinf(sign * rotation[3]), c = cosf(rotation[3]);
	float step[16], result[16];

	if (!(vec_normalise(axis) > 0))
		return;
	memcpy(step, identity, sizeof(step));
	for (int column = 0; column < 3; column++)
		for (int row = 0; row < 3; row++)
			step[4 * column + row] =
				axis[row] * axis[column] * (1 - c) + (row == column ? c : 0);
	step[1] += axis[2] * s;
	step[2] -= axis[1] * s;
	step[4] -= axis[2] * s;
	step[6] += axis[0] * s;
	step[8] += axis[1] * s;
	step[9] -= axis[0] * s;
	matrix_multiply(result, m, step);
	memcpy(m, result, sizeof(result));
}

/* T C R SR S -SR -C, as 6.52 has it. */
static void transform(float out[16], const float parent[16], const struct vrml_node *node)
{
	static const float zero[4] = { 0, 0, 1, 0 }, one[3] = { 1, 1, 1 };
	float move[3], center[3], rotation[4], size[3], stretch[4];

	vrml_get_floats(move, node, "translation", 3, (const float[3]){ 0 });
	vrml_get_floats(center, node, "center", 3, (const float[3]){ 0 });
	vrml_get_floats(rotation, node, "rotation", 4, zero);
	vrml_get_floats(stretch, node, "scaleOrientation", 4, zero);
	vrml_get_floats(size, node, "scale", 3, one);
	memcpy(out, parent, 16 * sizeof(*out));
	shift(out, move, 1);
	shift(out, center, 1);
	turn(out, rotation, 1);
	turn(out, stretch, 1);
	for (int i = 0; i < 12; i++)
		out[i] *= size[i / 4];
	turn(out, stretch, -1);
	shift(out, center, -1);
}

static bool mirrors(const float m[16])
{
	float cross[3];

	vec_cross(cross, m, m + 4);
	return vec_dot(cross, m + 8) < 0;
}

/* ---- shapes */

/* -C S R C T, as 6.49 has it. */
static void transform_uv(float uv[2], const struct vrml_node *node)
{
	float move[2], center[2], size[2], x, y;
	float angle = vrml_get_float(node, "rotation", 0);

	vrml_get_floats(move, node, "translation", 2, (const float[2]){ 0 });
	vrml_get_floats(center, node, "center", 2, (const float[2]){ 0 });
	vrml_get_floats(size, node, "scale", 2, (const float[2]){ 1, 1 });
	x = uv[0] + move[0] + center[0];
	y = uv[1] + move[1] + center[1];
	uv[0] = size[0] * (cosf(angle) * x - sinf(angle) * y) - center[0];
	uv[1] = size[1] * (sinf(angle) * x + cosf(angle) * y) - center[1];
}

/* Finds or adds a picture. */
static int texture_number(struct vrml_surface *out, const struct vrml_node *texture)
{
	int rc;

	for (uint32_t i = 0; i < out->texture_count; i++)
		if (out->textures[i] == texture) {
			out->soup.texture = i;
			return 0;
		}
	rc = ARRAY_RESERVE(out->textures, out->texture_room, (uint64_t)out->texture_count + 1,
			   VRML_TEXTURES_MAX);
	if (rc == 0) {
		out->soup.texture = out->texture_count;
		out->textures[out->texture_count++] = texture;
	}
	return rc;
}

static const struct vrml_node *node_of(const struct vrml_node *node, const char *field,
				       const char *type)
{
	const struct vrml_node *found = node ? vrml_get_node(node, field) : NULL;

	return found && strcmp(found->type->name, type) == 0 ? found : NULL;
}

/* What shines by itself alone is as bright as it shines. */
static void material_colour(uint8_t rgb[3], const struct vrml_node *material)
{
	static const float grey[3] = { 0.8f, 0.8f, 0.8f }, black[3];
	float diffuse[3], emissive[3];

	vrml_get_floats(diffuse, material, "diffuseColor", 3, grey);
	vrml_get_floats(emissive, material, "emissiveColor", 3, black);
	vrml_colour(rgb, vec_length(diffuse) > 0 ? diffuse : emissive);
}

static int add_shape(struct walk *walk, const struct vrml_node *shape, const float place[16])
{
	struct vrml_surface *out = walk->out;
	const struct vrml_node *look = node_of(shape, "appearance", "Appearance");
	const struct vrml_node *material = node_of(look, "material", "Material");
	const struct vrml_node *texture = node_of(look, "texture", "ImageTexture");
	const struct vrml_node *uvs = node_of(look, "textureTransform", "TextureTransform");
	const struct vrml_node *geometry = vrml_get_node(shape, "geometry");
	uint8_t rgb[3] = { 255, 255, 255 };
	uint32_t before = out->soup.count;
	int rc = 0;

	if (!geometry)
		return 0;
	if (material)
		material_colour(rgb, material);
	memcpy(out->soup.place, place, sizeof(out->soup.place));
	out->soup.texture = SOUP_NO_TEXTURE;
	if (texture && vrml_get(texture, "url"))
		rc = texture_number(out, texture);
	if (rc < 0)
		return diagnostics_add(walk->diagnostics, rc, shape->file, shape->line,
				       "over %d pictures; join some", VRML_TEXTURES_MAX);
	rc = vrml_shape_add(&out->soup, geometry, rgb, mirrors(place), walk->diagnostics);
	for (uint32_t i = before; uvs && i < out->soup.count; i++)
		for (int k = 0; k < 3; k++)
			transform_uv(out->soup.triangles[i].corners[k].uv, uvs);
	out->left_out += rc == 0;
	out->has_colours |= material || (vrml_field_named(geometry->type, "color", 5) >= 0 &&
					 vrml_get_node(geometry, "color"));
	return rc < 0 ? rc : 0;
}

/* ---- groups */

/* The nodes below a node that are seen; *count is 0 where there are none. */
static struct vrml_node *const *children_of(const struct vrml_node *node, uint32_t *count)
{
	static const char *const fields[] = { "children", "choice", "level" };
	const struct vrml_value *value = NULL;
	int32_t choice;

	*count = node->child_count;
	if (node->children)
		return node->children;
	for (size_t i = 0; i < ARRAY_COUNT(fields) && !value; i++)
		if (vrml_field_named(node->type, fields[i], strlen(fields[i])) >= 0)
			value = vrml_get(node, fields[i]);
	if (!value)
		return NULL;
	*count = value->count;
	if (strcmp(node->type->name, "Switch") == 0) {
		choice = vrml_get_integer(node, "whichChoice", -1);
		*count = choice >= 0 && (uint32_t)choice < value->count;
		return value->nodes + (*count ? choice : 0);
	}
	if (strcmp(node->type->name, "LOD") == 0)
		*count = value->count > 0;
	return value->nodes;
}

static int visit(struct walk *walk, const struct vrml_node *node, const float parent[16])
{
	struct vrml_node *const *children;
	float place[16];
	uint32_t count;
	int rc = 0;

	if (++walk->visits > VISITS_MAX)
		return diagnostics_add(walk->diagnostics, -EFBIG, node->file, node->line,
				       "USE repeats nodes over %d times; split the scene",
				       VISITS_MAX);
	if (strcmp(node->type->name, "Shape") == 0)
		return add_shape(walk, node, parent);
	if (++walk->depth > DEPTH_MAX)
		return diagnostics_add(walk->diagnostics, -EFBIG, node->file, node->line,
				       "USE nests nodes over %d deep; flatten the scene",
				       DEPTH_MAX);
	if (strcmp(node->type->name, "Transform") == 0)
		transform(place, parent, node);
	else
		memcpy(place, parent, sizeof(place));
	children = children_of(node, &count);
	for (uint32_t i = 0; i < count && rc == 0; i++)
		rc = visit(walk, children[i], place);
	walk->depth--;
	return rc;
}

int vrml_surface_make(struct vrml_surface *out, const struct vrml *scene,
		      struct diagnostics *diagnostics)
{
	struct walk walk = { .out = out, .diagnostics = diagnostics };
	int rc = 0;

	*out = (struct vrml_surface){ 0 };
	for (uint32_t i = 0; i < scene->root_count && rc == 0; i++)
		rc = visit(&walk, scene->roots[i], identity);
	if (rc < 0)
		vrml_surface_finish(out);
	return rc;
}

void vrml_surface_finish(struct vrml_surface *surface)
{
	if (!surface)
		return;
	soup_finish(&surface->soup);
	free(surface->textures);
	*surface = (struct vrml_surface){ 0 };
}
