/* Frees, measures and joins meshes, and reads texture pixels. */
#include "pipeline/import/mesh.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "base/spill.h"

enum {
	PUT_BYTES = 16 << 20,
	BOX_VERTICES = 1 << 18, /* measured by one thread at a time */
};

void mesh_finish(struct mesh *mesh)
{
	if (!mesh)
		return;
	spill_free(mesh->positions);
	spill_free(mesh->colours);
	spill_free(mesh->uvs);
	spill_free(mesh->triangles);
	spill_free(mesh->materials);
	spill_free(mesh->faces);
	for (uint32_t i = 0; mesh->textures && i < mesh->texture_count; i++)
		spill_free(mesh->textures[i].rgb);
	free(mesh->textures);
	*mesh = (struct mesh){ 0 };
}

struct box {
	const struct mesh *mesh;
	pthread_mutex_t lock; /* guards the fields below */
	float *low, *high;
};

static int add_to_box(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	struct box *box = user;
	float low[3] = { INFINITY, INFINITY, INFINITY };
	float high[3] = { -INFINITY, -INFINITY, -INFINITY };

	(void)worker;
	spill_breathe();
	for (uint32_t i = first; i < after; i++)
		for (int k = 0; k < 3; k++) {
			const float at = box->mesh->positions[i][k];

			low[k] = at < low[k] ? at : low[k];
			high[k] = at > high[k] ? at : high[k];
		}
	pthread_mutex_lock(&box->lock);
	for (int k = 0; k < 3; k++) {
		box->low[k] = low[k] < box->low[k] ? low[k] : box->low[k];
		box->high[k] = high[k] > box->high[k] ? high[k] : box->high[k];
	}
	pthread_mutex_unlock(&box->lock);
	return 0;
}

void mesh_box(const struct mesh *mesh, float low[3], float high[3])
{
	struct box box = { .mesh = mesh, .low = low, .high = high };
	int rc;

	for (int k = 0; k < 3; k++) {
		low[k] = mesh->vertex_count ? INFINITY : 0;
		high[k] = mesh->vertex_count ? -INFINITY : 0;
	}
	pthread_mutex_init(&box.lock, NULL);
	rc = parallel_ranges(parallel_cores(), mesh->vertex_count, BOX_VERTICES, add_to_box, &box);
	assert(rc == 0); /* no range fails */
	(void)rc;
	pthread_mutex_destroy(&box.lock);
}

/* ---- appending */

/* Copies bytes, or sets them to fill if from is NULL, without keeping all of them resident. */
static void put(uint8_t *to, const uint8_t *from, int fill, size_t bytes)
{
	for (size_t at = 0, size; at < bytes; at += size) {
		size = bytes - at < PUT_BYTES ? bytes - at : PUT_BYTES;
		if (from)
			memcpy(to + at, from + at, size);
		else
			memset(to + at, fill, size);
		spill_breathe();
	}
}

/* Makes room in *array for another second_count items behind the first_count, and copies them from
 * second. What one of the two lacks is set to fill bytes. */
static int extend(void **array, size_t first_count, const void *second, size_t second_count,
		  size_t item_bytes, int fill)
{
	const size_t first_bytes = first_count * item_bytes;
	const bool filled = *array == NULL;
	int rc = spill_resize(array, filled ? 0 : first_count, first_count + second_count,
			      item_bytes);

	if (rc < 0)
		return rc;
	if (filled)
		put(*array, NULL, fill, first_bytes);
	put((uint8_t *)*array + first_bytes, second, fill, second_count * item_bytes);
	return 0;
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

/* Adds a texture of one pixel in the colour of the mesh's first vertex, or white. */
static int add_plain(struct mesh *to, const struct mesh *of)
{
	uint8_t rgb[3] = { 255, 255, 255 };
	const struct mesh_texture plain = { 1, 1, rgb };

	if (of->colours && of->vertex_count > 0)
		memcpy(rgb, of->colours[0], 3);
	return copy_texture(&to->textures[to->texture_count++], &plain);
}

/* A mesh without textures gets a plain one, because its triangles need a material. *base is the
 * index of the second mesh's first texture. The array gets its exact size: a mesh keeps no room. */
static int extend_textures(struct mesh *mesh, const struct mesh *other, uint32_t *base)
{
	size_t room = (size_t)mesh->texture_count + other->texture_count + 2;
	struct mesh_texture *grown = realloc(mesh->textures, room * sizeof(*grown));
	bool had = mesh->textures != NULL;
	int rc = 0;

	if (!grown)
		return -ENOMEM;
	mesh->textures = grown;
	if (!had)
		rc = add_plain(mesh, mesh);
	*base = mesh->texture_count;
	if (rc == 0 && !other->textures)
		rc = add_plain(mesh, other);
	for (uint32_t i = 0; i < other->texture_count && rc == 0; i++)
		rc = copy_texture(&mesh->textures[mesh->texture_count++], &other->textures[i]);
	return rc;
}

static int extend_materials(struct mesh *mesh, const struct mesh *other)
{
	uint32_t base = 0;
	int rc;

	if (!mesh->textures && !other->textures)
		return 0;
	if ((uint64_t)mesh->texture_count + other->texture_count + 2 > MESH_TEXTURES_MAX)
		return -EFBIG;
	rc = extend_textures(mesh, other, &base);
	if (rc == 0)
		rc = extend((void **)&mesh->uvs, mesh->vertex_count, other->uvs,
			    other->vertex_count, sizeof(*mesh->uvs), 0);
	if (rc == 0)
		rc = extend((void **)&mesh->materials, mesh->triangle_count, other->materials,
			    other->triangle_count, sizeof(*mesh->materials), 0);
	for (uint32_t i = 0; i < other->triangle_count && rc == 0; i++)
		mesh->materials[mesh->triangle_count + i] += (uint16_t)base;
	return rc;
}

static int extend_vertices(struct mesh *mesh, const struct mesh *other)
{
	int rc = 0;

	if (mesh->colours || other->colours)
		rc = extend((void **)&mesh->colours, mesh->vertex_count, other->colours,
			    other->vertex_count, sizeof(*mesh->colours), 255);
	if (rc == 0)
		rc = extend((void **)&mesh->positions, mesh->vertex_count, other->positions,
			    other->vertex_count, sizeof(*mesh->positions), 0);
	return rc;
}

static int extend_triangles(struct mesh *mesh, const struct mesh *other)
{
	int rc = extend((void **)&mesh->triangles, mesh->triangle_count, other->triangles,
			other->triangle_count, sizeof(*mesh->triangles), 0);

	for (uint32_t i = 0; i < other->triangle_count && rc == 0; i++) {
		for (int k = 0; k < 3; k++)
			mesh->triangles[mesh->triangle_count + i][k] += mesh->vertex_count;
		spill_pass(i);
	}
	if (rc == 0 && (mesh->faces || other->faces))
		rc = extend((void **)&mesh->faces, mesh->triangle_count, other->faces,
			    other->triangle_count, sizeof(*mesh->faces), 0xff); /* MESH_NO_FACE */
	return rc;
}

int mesh_append(struct mesh *mesh, const struct mesh *other)
{
	int rc;

	if ((uint64_t)mesh->vertex_count + other->vertex_count >= UINT32_MAX ||
	    (uint64_t)mesh->triangle_count + other->triangle_count >= UINT32_MAX ||
	    mesh->scan_count + other->scan_count > MESH_SCANS_MAX)
		return -EFBIG;
	rc = extend_materials(mesh, other);
	if (rc == 0)
		rc = extend_vertices(mesh, other);
	if (rc == 0)
		rc = extend_triangles(mesh, other);
	if (rc < 0)
		return rc;
	memcpy(mesh->scans + mesh->scan_count, other->scans,
	       other->scan_count * sizeof(*other->scans));
	mesh->scan_count += other->scan_count;
	mesh->vertex_count += other->vertex_count;
	mesh->triangle_count += other->triangle_count;
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
