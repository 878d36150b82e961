/* Places, children and looks of nodes. */
#include "pipeline/scene/vrml_graph.h"

#include <math.h>
#include <string.h>

#include "base/compiler.h"
#include "geometry/vec.h"
#include "pipeline/scene/vrml_faces.h"

const float vrml_identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };

/* ---- places */

static void shift(float m[16], const float by[3], float sign)
{
	float step[16], result[16];

	memcpy(step, vrml_identity, sizeof(step));
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
	memcpy(step, vrml_identity, sizeof(step));
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
void vrml_transform(float out[16], const float parent[16], const struct vrml_node *node)
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

/* -C S R C T, as 6.49 has it. */
void vrml_transform_uv(float uv[2], const struct vrml_node *node)
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

bool vrml_mirrors(const float m[16])
{
	float cross[3];

	vec_cross(cross, m, m + 4);
	return vec_dot(cross, m + 8) < 0;
}

/* ---- groups and looks */

bool vrml_is(const struct vrml_node *node, const char *type)
{
	return strcmp(node->type->name, type) == 0;
}

bool vrml_event_sets(const char *event, const char *field)
{
	return strcmp(strncmp(event, "set_", 4) == 0 ? event + 4 : event, field) == 0;
}

struct vrml_node *const *vrml_levels(const struct vrml_node *node, uint32_t *count)
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
	if (vrml_is(node, "Switch")) {
		choice = vrml_get_integer(node, "whichChoice", -1);
		*count = choice >= 0 && (uint32_t)choice < value->count;
		return value->nodes + (*count ? choice : 0);
	}
	return value->nodes;
}

struct vrml_node *const *vrml_children(const struct vrml_node *node, uint32_t *count)
{
	struct vrml_node *const *children = vrml_levels(node, count);

	if (vrml_is(node, "LOD") && *count > 1)
		*count = 1;
	return children;
}

const struct vrml_node *vrml_node_of(const struct vrml_node *node, const char *field,
				     const char *type)
{
	const struct vrml_node *found = node ? vrml_get_node(node, field) : NULL;

	return found && vrml_is(found, type) ? found : NULL;
}

void vrml_material_colour(uint8_t rgb[3], const struct vrml_node *material)
{
	static const float grey[3] = { 0.8f, 0.8f, 0.8f }, black[3];
	float diffuse[3], emissive[3];

	vrml_get_floats(diffuse, material, "diffuseColor", 3, grey);
	vrml_get_floats(emissive, material, "emissiveColor", 3, black);
	vrml_colour(rgb, vec_length(diffuse) > 0 ? diffuse : emissive);
}
