/* Walks the graph of a scene and adds its shapes where the transforms above them put them. */
#include "pipeline/scene/vrml_surface.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "geometry/vec.h"
#include "pipeline/scene/vrml_graph.h"
#include "pipeline/scene/vrml_shapes.h"

struct walk {
	struct vrml_surface *out;
	struct diagnostics *diagnostics;
	uint32_t visits, depth;
};

/* ---- shapes */

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

static int add_shape(struct walk *walk, const struct vrml_node *shape, const float place[16])
{
	struct vrml_surface *out = walk->out;
	const struct vrml_node *look = vrml_node_of(shape, "appearance", "Appearance");
	const struct vrml_node *material = vrml_node_of(look, "material", "Material");
	const struct vrml_node *texture = vrml_node_of(look, "texture", "ImageTexture");
	const struct vrml_node *uvs = vrml_node_of(look, "textureTransform", "TextureTransform");
	const struct vrml_node *geometry = vrml_get_node(shape, "geometry");
	uint8_t rgb[3] = { 255, 255, 255 };
	uint32_t before = out->soup.count;
	int rc = 0;

	if (!geometry)
		return 0;
	if (material)
		vrml_material_colour(rgb, material);
	memcpy(out->soup.place, place, sizeof(out->soup.place));
	out->soup.texture = SOUP_NO_TEXTURE;
	if (texture && vrml_get(texture, "url"))
		rc = texture_number(out, texture);
	if (rc < 0)
		return diagnostics_add(walk->diagnostics, rc, shape->file, shape->line,
				       "over %d pictures; join some", VRML_TEXTURES_MAX);
	rc = vrml_shape_add(&out->soup, geometry, rgb, vrml_mirrors(place), walk->diagnostics);
	for (uint32_t i = before; uvs && i < out->soup.count; i++)
		for (int k = 0; k < 3; k++)
			vrml_transform_uv(out->soup.triangles[i].corners[k].uv, uvs);
	out->left_out += rc == 0;
	out->has_colours |= material || (vrml_field_named(geometry->type, "color", 5) >= 0 &&
					 vrml_get_node(geometry, "color"));
	return rc < 0 ? rc : 0;
}

/* ---- groups */

static int visit(struct walk *walk, const struct vrml_node *node, const float parent[16])
{
	struct vrml_node *const *children;
	float place[16];
	uint32_t count;
	int rc = 0;

	if (++walk->visits > VRML_VISITS_MAX)
		return diagnostics_add(walk->diagnostics, -EFBIG, node->file, node->line,
				       "USE repeats nodes over %d times; split the scene",
				       VRML_VISITS_MAX);
	if (strcmp(node->type->name, "Shape") == 0)
		return add_shape(walk, node, parent);
	if (++walk->depth > VRML_DEPTH_MAX)
		return diagnostics_add(walk->diagnostics, -EFBIG, node->file, node->line,
				       "USE nests nodes over %d deep; flatten the scene",
				       VRML_DEPTH_MAX);
	if (strcmp(node->type->name, "Transform") == 0)
		vrml_transform(place, parent, node);
	else
		memcpy(place, parent, sizeof(place));
	children = vrml_children(node, &count);
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
		rc = visit(&walk, scene->roots[i], vrml_identity);
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
