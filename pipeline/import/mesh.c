/* Frees, measures and joins meshes, and reads texture pixels. */
#include "pipeline/import/mesh.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

void mesh_finish(struct mesh *mesh)
{
	if (!mesh)
		return;
	free(mesh->positions);
	free(mesh->colours);
	free(mesh->uvs);
	free(mesh->triangles);
	free(mesh->materials);
	free(mesh->faces);
	for (uint32_t i = 0; mesh->textures && i < mesh->texture_count; i++)
		free(mesh->textures[i].rgb);
	free(mesh->textures);
	*mesh = (struct mesh){ 0 };
}

void mesh_box(const struct mesh *mesh, float low[3], float high[3])
{
	for (int k = 0; k < 3; k++)
		low[k] = high[k] = mesh->vertex_count ? mesh->positions[0][k] : 0;
	for (uint32_t i = 1; i < mesh->vertex_count; i++)
		for (int k = 0; k < 3; k++) {
			low[k] = fminf(low[k], mesh->positions[i][k]);
			high[k] = fmaxf(high[k], mesh->positions[i][k]);
		}
}

/* ---- appending */

/* Returns a new array with the first and then the second. If one is NULL, its part is set to fill
 * bytes. */
static void *join(const void *first, size_t first_count, const void *second, size_t second_count,
		  size_t item_bytes, int fill)
{
	uint8_t *joined = malloc((first_count + second_count) * item_bytes + 1);

	if (!joined)
		return NULL;
	memset(joined, fill, (first_count + second_count) * item_bytes);
	if (first)
		memcpy(joined, first, first_count * item_bytes);
	if (second)
		memcpy(joined + first_count * item_bytes, second, second_count * item_bytes);
	return joined;
}

static int copy_texture(struct mesh_texture *to, const struct mesh_texture *from)
{
	size_t bytes = (size_t)from->width * from->height * 3;

	*to = *from;
	to->rgb = malloc(bytes + 1);
	if (!to->rgb)
		return -ENOMEM;
	memcpy(to->rgb, from->rgb, bytes);
	return 0;
}

/* The colour of a mesh without textures: that of its first vertex, or white. */
static void plain_colour(const struct mesh *mesh, uint8_t rgb[3])
{
	memset(rgb, 255, 3);
	if (mesh->colours && mesh->vertex_count > 0)
		memcpy(rgb, mesh->colours[0], 3);
}

/* Copies the textures of both meshes. A mesh without textures gets a plain one, because its
 * triangles need a material. *base is the index of the second mesh's first texture. */
static int join_textures(struct mesh *joined, const struct mesh *a, const struct mesh *b,
			 uint32_t *base)
{
	uint8_t a_colour[3], b_colour[3];
	const struct mesh_texture a_plain = { 1, 1, a_colour }, b_plain = { 1, 1, b_colour };
	uint32_t a_count = a->textures ? a->texture_count : 1;
	uint32_t b_count = b->textures ? b->texture_count : 1;
	int rc = 0;

	*base = a_count;
	plain_colour(a, a_colour);
	plain_colour(b, b_colour);
	joined->textures = calloc((size_t)a_count + b_count, sizeof(*joined->textures));
	if (!joined->textures)
		return -ENOMEM;
	joined->texture_count = a_count + b_count;
	for (uint32_t i = 0; i < a_count && rc == 0; i++)
		rc = copy_texture(&joined->textures[i], a->textures ? &a->textures[i] : &a_plain);
	for (uint32_t i = 0; i < b_count && rc == 0; i++)
		rc = copy_texture(&joined->textures[a_count + i],
				  b->textures ? &b->textures[i] : &b_plain);
	return rc;
}

static int join_materials(struct mesh *joined, const struct mesh *a, const struct mesh *b)
{
	uint32_t base;
	int rc;

	if (!a->textures && !b->textures)
		return 0;
	if ((uint64_t)a->texture_count + b->texture_count + 2 > MESH_TEXTURES_MAX)
		return -EFBIG;
	rc = join_textures(joined, a, b, &base);
	if (rc < 0)
		return rc;
	joined->uvs = join(a->uvs, a->vertex_count, b->uvs, b->vertex_count, sizeof(*a->uvs), 0);
	joined->materials = join(a->materials, a->triangle_count, b->materials, b->triangle_count,
				 sizeof(*a->materials), 0);
	if (!joined->uvs || !joined->materials)
		return -ENOMEM;
	for (uint32_t i = 0; i < b->triangle_count; i++)
		joined->materials[a->triangle_count + i] += (uint16_t)base;
	return 0;
}

static int join_meshes(struct mesh *joined, const struct mesh *a, const struct mesh *b)
{
	joined->vertex_count = a->vertex_count + b->vertex_count;
	joined->triangle_count = a->triangle_count + b->triangle_count;
	joined->positions = join(a->positions, a->vertex_count, b->positions, b->vertex_count,
				 sizeof(*a->positions), 0);
	joined->triangles = join(a->triangles, a->triangle_count, b->triangles, b->triangle_count,
				 sizeof(*a->triangles), 0);
	if (!joined->positions || !joined->triangles)
		return -ENOMEM;
	for (uint32_t i = a->triangle_count; i < joined->triangle_count; i++)
		for (int k = 0; k < 3; k++)
			joined->triangles[i][k] += a->vertex_count;
	if (a->colours || b->colours) {
		joined->colours = join(a->colours, a->vertex_count, b->colours, b->vertex_count,
				       sizeof(*a->colours), 255);
		if (!joined->colours)
			return -ENOMEM;
	}
	return join_materials(joined, a, b);
}

static int join_scans(struct mesh *joined, const struct mesh *a, const struct mesh *b)
{
	if (a->scan_count + b->scan_count > MESH_SCANS_MAX)
		return -EFBIG;
	memcpy(joined->scans, a->scans, a->scan_count * sizeof(*a->scans));
	memcpy(joined->scans + a->scan_count, b->scans, b->scan_count * sizeof(*b->scans));
	joined->scan_count = a->scan_count + b->scan_count;
	if (!a->faces && !b->faces)
		return 0;
	joined->faces = join(a->faces, a->triangle_count, b->faces, b->triangle_count,
			     sizeof(*a->faces), 0xff); /* MESH_NO_FACE */
	return joined->faces ? 0 : -ENOMEM;
}

int mesh_append(struct mesh *mesh, const struct mesh *other)
{
	struct mesh joined = { 0 };
	int rc;

	if ((uint64_t)mesh->vertex_count + other->vertex_count >= UINT32_MAX ||
	    (uint64_t)mesh->triangle_count + other->triangle_count >= UINT32_MAX)
		return -EFBIG;
	rc = join_meshes(&joined, mesh, other);
	if (rc == 0)
		rc = join_scans(&joined, mesh, other);
	if (rc < 0) {
		mesh_finish(&joined);
		return rc;
	}
	mesh_finish(mesh);
	*mesh = joined;
	return 0;
}

/* ---- textures */

/* Maps a repeating texture coordinate to a pixel in 0 .. size - 1. */
static uint32_t wrap(float at, uint32_t size)
{
	float within = at - floorf(at);
	uint32_t pixel = (uint32_t)(within * (float)size);

	return pixel < size ? pixel : size - 1;
}

void mesh_texel(const struct mesh_texture *texture, const float uv[2], uint8_t rgb[3])
{
	bool finite = isfinite(uv[0]) && isfinite(uv[1]);
	uint32_t x = finite ? wrap(uv[0], texture->width) : 0;
	uint32_t y = finite ? texture->height - 1 - wrap(uv[1], texture->height) : 0;

	memcpy(rgb, texture->rgb + ((size_t)y * texture->width + x) * 3, 3);
}
