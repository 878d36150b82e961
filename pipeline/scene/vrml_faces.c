/* IndexedFaceSet: faces with their colours and texture coordinates, by vertex or by face. */
#include "pipeline/scene/vrml_faces.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

enum { CORNERS_MAX = 1 << 20 };

struct faces {
	const struct vrml_node *node;
	const struct vrml_value *points, *indices;                            /* not NULL */
	const struct vrml_value *colours, *colour_indices, *uvs, *uv_indices; /* or NULL */
	const struct vrml_value *normals, *normal_indices;                    /* likewise */
	bool colour_per_vertex, normal_per_vertex;
	const uint8_t *rgb;
	float low[3], high[3]; /* for texture coordinates where none are given */
	int axes[2];
};

const struct vrml_value *vrml_member(const struct vrml_node *node, const char *type,
				     const char *field)
{
	return node && strcmp(node->type->name, type) == 0 ? vrml_get(node, field) : NULL;
}

void vrml_colour(uint8_t rgb[3], const float colour[3])
{
	for (int k = 0; k < 3; k++) {
		float value = colour[k] < 0 ? 0 : colour[k] > 1 ? 1 : colour[k];

		rgb[k] = (uint8_t)(255 * value + 0.5f);
	}
}

/* Texture coordinates where the file gives none: s along the longest side of the box, t along the
 * second longest. */
static void measure(struct faces *faces)
{
	float size[3];

	for (int k = 0; k < 3; k++) {
		faces->low[k] = faces->high[k] = faces->points->floats[k];
		for (uint32_t i = k; i < faces->points->count; i += 3) {
			float value = faces->points->floats[i];

			faces->low[k] = value < faces->low[k] ? value : faces->low[k];
			faces->high[k] = value > faces->high[k] ? value : faces->high[k];
		}
		size[k] = faces->high[k] - faces->low[k];
	}
	for (int k = 1; k < 3; k++)
		if (size[k] > size[faces->axes[0]])
			faces->axes[0] = k;
	faces->axes[1] = faces->axes[0] == 0;
	for (int k = 0; k < 3; k++)
		if (k != faces->axes[0] && size[k] > size[faces->axes[1]])
			faces->axes[1] = k;
}

static void default_uv(const struct faces *faces, struct soup_corner *corner)
{
	float size = faces->high[faces->axes[0]] - faces->low[faces->axes[0]];

	for (int i = 0; i < 2; i++) {
		int k = faces->axes[i];

		corner->uv[i] = size > 0 ? (corner->position[k] - faces->low[k]) / size : 0;
	}
}

/* Returns the item that an index of a list names, or NULL with its number in *wrong. */
static const float *item(const struct vrml_value *items, uint32_t width, int64_t index,
			 int64_t *wrong)
{
	if (index >= 0 && (uint64_t)index < items->count / width)
		return items->floats + width * index;
	*wrong = index;
	return NULL;
}

/* The index for corner `at` of the list: its own list's, or that of the position. */
static int64_t own_index(const struct vrml_value *indices, int64_t at, int64_t otherwise)
{
	if (!indices || indices->count == 0)
		return otherwise;
	return at < indices->count ? indices->integers[at] : -1;
}

/* Files have wrong normals as long as nobody looks at them: those are left out. */
static void read_normal(const struct faces *faces, uint32_t at, uint32_t face,
			struct soup_corner *out)
{
	const int64_t index =
		faces->normal_per_vertex
			? own_index(faces->normal_indices, at, faces->indices->integers[at])
			: own_index(faces->normal_indices, face, face);
	int64_t wrong;
	const float *found = faces->normals ? item(faces->normals, 3, index, &wrong) : NULL;

	memset(out->normal, 0, sizeof(out->normal));
	if (found)
		memcpy(out->normal, found, sizeof(out->normal));
}

/* Reads the corner `at` of face `face`. Returns what it lacks, or NULL. */
static const char *read_corner(const struct faces *faces, uint32_t at, uint32_t face,
			       struct soup_corner *out, int64_t *wrong)
{
	int64_t index = faces->indices->integers[at], colour_index;
	const float *found = item(faces->points, 3, index, wrong);

	if (!found)
		return "point";
	memcpy(out->position, found, sizeof(out->position));
	memcpy(out->rgb, faces->rgb, 3);
	read_normal(faces, at, face, out);
	if (faces->colours) {
		colour_index = faces->colour_per_vertex
				       ? own_index(faces->colour_indices, at, index)
				       : own_index(faces->colour_indices, face, face);
		found = item(faces->colours, 3, colour_index, wrong);
		if (!found)
			return "colour";
		vrml_colour(out->rgb, found);
	}
	if (!faces->uvs) {
		default_uv(faces, out);
		return NULL;
	}
	found = item(faces->uvs, 2, own_index(faces->uv_indices, at, index), wrong);
	if (!found)
		return "texture coordinate";
	memcpy(out->uv, found, sizeof(out->uv));
	return NULL;
}

static int add_faces(struct soup *soup, const struct faces *faces, struct diagnostics *diagnostics)
{
	struct soup_corner *corners = NULL;
	uint32_t *sources = NULL;
	uint32_t room = 0, source_room = 0, count = 0, face = 0;
	const char *lack = NULL;
	int64_t wrong = 0;
	int rc = 0;

	for (uint32_t at = 0; at <= faces->indices->count && rc == 0 && !lack; at++) {
		if (at == faces->indices->count || faces->indices->integers[at] == -1) {
			soup->from = sources;
			rc = soup_add(soup, corners, count);
			face += at < faces->indices->count;
			count = 0;
			continue;
		}
		rc = ARRAY_RESERVE(corners, room, (uint64_t)count + 1, CORNERS_MAX);
		if (rc == 0)
			rc = ARRAY_RESERVE(sources, source_room, (uint64_t)count + 1, CORNERS_MAX);
		if (rc == 0)
			sources[count] = (uint32_t)faces->indices->integers[at];
		if (rc == 0)
			lack = read_corner(faces, at, face, &corners[count++], &wrong);
	}
	free(corners);
	free(sources);
	soup->from = NULL;
	if (lack)
		return diagnostics_add(diagnostics, -EBADMSG, faces->node->file, faces->node->line,
				       "face %u of this IndexedFaceSet names %s %lld, which it "
				       "does not have; correct or remove the face",
				       face, lack, (long long)wrong);
	return rc;
}

int vrml_faces_add(struct soup *soup, const struct vrml_node *node, const uint8_t rgb[3],
		   struct diagnostics *diagnostics)
{
	struct faces faces = {
		.node = node,
		.rgb = rgb,
		.points = vrml_member(vrml_get_node(node, "coord"), "Coordinate", "point"),
		.indices = vrml_get(node, "coordIndex"),
		.colours = vrml_member(vrml_get_node(node, "color"), "Color", "color"),
		.colour_indices = vrml_get(node, "colorIndex"),
		.colour_per_vertex = vrml_get_integer(node, "colorPerVertex", 1) != 0,
		.normals = vrml_member(vrml_get_node(node, "normal"), "Normal", "vector"),
		.normal_indices = vrml_get(node, "normalIndex"),
		.normal_per_vertex = vrml_get_integer(node, "normalPerVertex", 1) != 0,
		.uvs = vrml_member(vrml_get_node(node, "texCoord"), "TextureCoordinate", "point"),
		.uv_indices = vrml_get(node, "texCoordIndex"),
	};
	int rc;

	if (!faces.points || faces.points->count < 3 || !faces.indices)
		return 0;
	measure(&faces);
	rc = add_faces(soup, &faces, diagnostics);
	return rc < 0 ? rc : 1;
}
