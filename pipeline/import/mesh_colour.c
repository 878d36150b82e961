/* Averages texture pixels over the faces around each vertex to get vertex colours. */
#include "pipeline/import/mesh_colour.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/spill.h"
#include "pipeline/import/mesh_places.h"

enum { CELLS_MIN = 2, CELLS_MAX = 8 };

/* Weighted sum of colours at one place. */
struct sum {
	float rgb[3], weight;
};

/* Number of cells along an edge of the face: about one for every two pixels. */
static int cells_of(const struct mesh *mesh, const uint32_t t[3],
		    const struct mesh_texture *texture)
{
	const float *a = mesh->uvs[t[0]], *b = mesh->uvs[t[1]], *c = mesh->uvs[t[2]];
	float area = fabsf((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
	float side_px = sqrtf(area * (float)texture->width * (float)texture->height);

	if (!(side_px > 2 * CELLS_MIN))
		return CELLS_MIN;
	return side_px < 2 * CELLS_MAX ? (int)(side_px / 2) : CELLS_MAX;
}

static void add_sample(const struct mesh *mesh, const uint32_t t[3],
		       const struct mesh_texture *texture, const float weights[3],
		       const uint32_t places[3], float share, struct sum *sums)
{
	float uv[2] = { 0, 0 };
	uint8_t rgb[3];

	for (int k = 0; k < 3; k++)
		for (int axis = 0; axis < 2; axis++)
			uv[axis] += weights[k] * mesh->uvs[t[k]][axis];
	mesh_texel(texture, uv, rgb);
	for (int k = 0; k < 3; k++) {
		struct sum *sum = &sums[places[k]];
		float weight = weights[k] * weights[k] * share;

		for (int channel = 0; channel < 3; channel++)
			sum->rgb[channel] += weight * (float)rgb[channel];
		sum->weight += weight;
	}
}

/* Adds samples at the centres of the cells of a regular subdivision of the face, both the upward
 * and the downward cells. */
static void add_face(const struct mesh *mesh, uint32_t face, const uint32_t *place,
		     struct sum *sums)
{
	const uint32_t *t = mesh->triangles[face];
	const struct mesh_texture *texture = &mesh->textures[mesh->materials[face]];
	const uint32_t places[3] = { place ? place[t[0]] : t[0], place ? place[t[1]] : t[1],
				     place ? place[t[2]] : t[2] };
	int cells = cells_of(mesh, t, texture);
	float share = 1 / (float)(cells * cells); /* every face has the same weight */

	for (int i = 0; i < cells; i++)
		for (int j = 0; i + j < cells; j++)
			for (int down = 0; down < (i + j + 1 < cells ? 2 : 1); down++) {
				float centre = down ? 2.0f / 3 : 1.0f / 3;
				float u = ((float)i + centre) / (float)cells;
				float v = ((float)j + centre) / (float)cells;

				add_sample(mesh, t, texture, (float[3]){ 1 - u - v, u, v }, places,
					   share, sums);
			}
}

static int give_colours(struct mesh *mesh)
{
	if (mesh->colours)
		return 0;
	mesh->colours = spill_alloc((size_t)mesh->vertex_count * 4);
	if (!mesh->colours)
		return -errno;
	memset(mesh->colours, 255, (size_t)mesh->vertex_count * 4);
	return 0;
}

int mesh_colours_from_textures(struct mesh *mesh, uint32_t jobs)
{
	uint32_t *place;
	struct sum *sums = NULL;
	int rc;

	if (!mesh->textures || !mesh->uvs || !mesh->materials)
		return 0;
	rc = mesh_places(&place, mesh, jobs);
	if (rc == 0) {
		sums = spill_alloc(((size_t)mesh->vertex_count + 1) * sizeof(*sums));
		rc = sums ? give_colours(mesh) : -errno;
	}
	for (uint32_t i = 0; i < mesh->triangle_count && rc == 0; i++) {
		add_face(mesh, i, place, sums);
		spill_pass(i);
	}
	for (uint32_t i = 0; i < mesh->vertex_count && rc == 0; i++) {
		const struct sum *sum = &sums[place ? place[i] : i];

		for (int k = 0; k < 3 && sum->weight > 0; k++)
			mesh->colours[i][k] = (uint8_t)(sum->rgb[k] / sum->weight + 0.5f);
		spill_pass(i);
	}
	spill_free(place);
	spill_free(sums);
	return rc;
}
