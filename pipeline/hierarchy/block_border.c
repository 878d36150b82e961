/* Settles the vertices that blocks share, a file for each block, and reads them all. */
#include "pipeline/hierarchy/block_border.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/array.h"
#include "base/bytes.h"
#include "base/map.h"
#include "pipeline/material/material.h"

enum { BORDER_BYTES = LATTICE_VERTEX_BYTES + 8, BORDER_FILE_BYTES_MAX = 1 << 30 };

void block_look_apply(const struct block_look *look, const struct lattice *lattice,
		      struct lattice_vertex *vertices, uint32_t count)
{
	for (uint32_t v = 0; v < count; v++) {
		struct lattice_vertex *vertex = &vertices[v];
		float at[3], rgb[3];
		uint16_t coarse[3];
		double at_m[3];

		lattice_coarse(coarse, lattice, vertex->position);
		vertex->seen = exposure_of(look->exposure, coarse, vertex->normal);
		if (!look->is_stone)
			continue;
		lattice_metres(at_m, lattice, vertex->position);
		for (int i = 0; i < 3; i++)
			at[i] = (float)at_m[i];
		if (look->substance == SUBSTANCE_NONE)
			material_colour(rgb, at, vertex->normal, look->footprint_m);
		else
			substance_colour(rgb, look->substance, at, look->footprint_m);
		for (int i = 0; i < 3; i++)
			vertex->colour[i] = (uint8_t)(255.0f * (rgb[i] < 0.0f   ? 0.0f
								: rgb[i] > 1.0f ? 1.0f
										: rgb[i]) +
						      0.5f);
	}
}

/* ---- settling */

static bool holds(const struct map *places, const int32_t place[3])
{
	return map_get(places, lattice_key(place)) != MAP_NONE;
}

static uint32_t block_at(const struct block_cells *cells, const struct lattice *lattice,
			 const int32_t place[3])
{
	uint16_t coarse[3];

	lattice_coarse(coarse, lattice, place);
	return cells->block_of_cell[block_cell(coarse)];
}

/* Finds the places of vertices in the block's cells that have a triangle of another block. */
static int find_places(struct map *places, const struct block_scan *scan,
		       const struct block_cells *cells, const struct block_triangles *triangles,
		       uint32_t block)
{
	int rc = 0;

	for (uint32_t t = triangles->own_count; rc == 0 && t < triangles->count; t++) {
		int32_t corners[3][3];

		block_corners(corners, scan, triangles->items[t]);
		for (int c = 0; rc == 0 && c < 3; c++)
			if (block_at(cells, &scan->lattice, corners[c]) == block)
				rc = map_set(places, lattice_key(corners[c]), 0);
	}
	return rc;
}

/* Moves the triangles that have a corner among the places to the front. */
static uint32_t keep_touching(struct block_triangles *triangles, const struct map *places,
			      const struct block_scan *scan)
{
	uint32_t kept = 0;

	for (uint32_t t = 0; t < triangles->count; t++) {
		int32_t corners[3][3];

		block_corners(corners, scan, triangles->items[t]);
		if (holds(places, corners[0]) || holds(places, corners[1]) ||
		    holds(places, corners[2]))
			memmove(triangles->items[kept++], triangles->items[t],
				sizeof(*triangles->items));
	}
	return kept;
}

/* For each vertex, the first and the last block that own a triangle of it. */
static int find_users(uint32_t *lows, uint32_t *highs, const struct lattice_mesh *mesh,
		      const struct block_cells *cells)
{
	if (!lows || !highs)
		return -ENOMEM;
	memset(lows, 0xff, mesh->vertex_count * sizeof(*lows));
	memset(highs, 0, mesh->vertex_count * sizeof(*highs));
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		uint16_t corners[3][3];
		uint32_t block;

		for (int c = 0; c < 3; c++)
			lattice_coarse(corners[c], &mesh->lattice,
				       mesh->vertices[mesh->triangles[t][c]].position);
		block = cells->block_of_cell[block_cell_of_triangle((const uint16_t(*)[3])corners)];
		for (int c = 0; c < 3; c++) {
			uint32_t v = mesh->triangles[t][c];

			lows[v] = block < lows[v] ? block : lows[v];
			highs[v] = block > highs[v] ? block : highs[v];
		}
	}
	return 0;
}

static void put_vertex(struct buffer *out, const struct border_vertex *border)
{
	lattice_vertex_put(out, &border->vertex);
	buffer_put_u32(out, border->low);
	buffer_put_u32(out, border->high);
}

static int compare_borders(const void *left, const void *right)
{
	map_key a = lattice_key(((const struct border_vertex *)left)->vertex.position);
	map_key b = lattice_key(((const struct border_vertex *)right)->vertex.position);

	return a < b ? -1 : a > b;
}

static int put_border(struct buffer *out, const struct lattice_mesh *mesh, const struct map *places,
		      const struct block_cells *cells)
{
	uint32_t *lows = malloc((mesh->vertex_count + (size_t)1) * sizeof(*lows));
	uint32_t *highs = malloc((mesh->vertex_count + (size_t)1) * sizeof(*highs));
	struct border_vertex *kept = malloc((mesh->vertex_count + (size_t)1) * sizeof(*kept));
	uint32_t count = 0;
	int rc = kept ? find_users(lows, highs, mesh, cells) : -ENOMEM;

	for (uint32_t v = 0; rc == 0 && v < mesh->vertex_count; v++)
		if (holds(places, mesh->vertices[v].position))
			kept[count++] =
				(struct border_vertex){ mesh->vertices[v], lows[v], highs[v] };
	if (rc == 0)
		qsort(kept, count, sizeof(*kept), compare_borders);
	for (uint32_t i = 0; rc == 0 && i < count; i++)
		put_vertex(out, &kept[i]);
	free(lows);
	free(highs);
	free(kept);
	return rc < 0 ? rc : out->error;
}

static int settle(struct buffer *out, const struct block_scan *scan,
		  const struct block_cells *cells, const struct block_look *look,
		  const char *folder, uint32_t block)
{
	struct block_triangles triangles;
	struct map places = { 0 };
	struct lattice_mesh lattice_mesh = { 0 };
	struct lattice_counts counts;
	struct mesh mesh = { 0 };
	int rc = block_triangles_read(&triangles, scan, cells, folder, block);

	if (rc < 0)
		return rc;
	rc = find_places(&places, scan, cells, &triangles, block);
	if (rc == 0 && places.count > 0) {
		uint32_t kept = keep_touching(&triangles, &places, scan);

		rc = block_mesh(&mesh, scan, triangles.items, kept);
		if (rc == 0)
			rc = lattice_mesh_create(&lattice_mesh, &counts, &mesh, &scan->lattice,
						 look->plain_colour);
		/* If none has an area there is nothing to share. */
		if (rc == -EINVAL)
			rc = 0;
		if (rc == 0)
			rc = lattice_mesh_find_borders(&lattice_mesh, &counts, NULL);
		block_look_apply(look, &scan->lattice, lattice_mesh.vertices,
				 lattice_mesh.vertex_count);
		if (rc == 0)
			rc = put_border(out, &lattice_mesh, &places, cells);
	}
	lattice_mesh_finish(&lattice_mesh);
	mesh_finish(&mesh);
	map_finish(&places);
	block_triangles_finish(&triangles);
	return rc;
}

static int border_path(char out[PATH_MAX], const char *folder, uint32_t block)
{
	return snprintf(out, PATH_MAX, "%s/border-%u", folder, block) < PATH_MAX ? 0
										 : -ENAMETOOLONG;
}

int block_border_write(const struct block_scan *scan, const struct block_cells *cells,
		       const struct block_look *look, const char *folder, uint32_t block)
{
	char path[PATH_MAX];
	struct buffer file;
	int rc = border_path(path, folder, block);

	if (rc < 0 || access(path, F_OK) == 0)
		return rc;
	buffer_init(&file, BORDER_FILE_BYTES_MAX);
	rc = settle(&file, scan, cells, look, folder, block);
	if (rc == 0 && access(path, F_OK) < 0)
		rc = bytes_write_file(buffer_bytes(&file), path);
	buffer_finish(&file);
	return rc;
}

/* ---- reading */

static void get_vertex(struct border_vertex *out, struct reader *reader)
{
	lattice_vertex_get(&out->vertex, reader);
	out->low = reader_u32(reader);
	out->high = reader_u32(reader);
}

static int read_block(struct block_border *border, const char *folder, uint32_t block)
{
	char path[PATH_MAX];
	struct buffer file;
	struct reader reader;
	uint32_t count = 0;
	int rc = border_path(path, folder, block);

	buffer_init(&file, BORDER_FILE_BYTES_MAX);
	if (rc == 0)
		rc = buffer_read_file(&file, path);
	if (rc == 0 && file.size % BORDER_BYTES != 0)
		rc = -EBADMSG;
	if (rc == 0) {
		count = (uint32_t)(file.size / BORDER_BYTES);
		rc = ARRAY_RESERVE(border->vertices, border->vertex_room,
				   (uint64_t)border->first[block] + count, UINT32_MAX);
	}
	reader_init(&reader, buffer_bytes(&file));
	for (uint32_t i = 0; rc == 0 && i < count; i++)
		get_vertex(&border->vertices[border->first[block] + i], &reader);
	border->first[block + 1] = border->first[block] + count;
	buffer_finish(&file);
	return rc;
}

int block_border_read(struct block_border *out, const struct block_cells *cells, const char *folder)
{
	int rc;

	*out = (struct block_border){
		.first = calloc(cells->block_count + (size_t)1, sizeof(*out->first)),
		.block_count = cells->block_count,
	};
	rc = out->first ? 0 : -ENOMEM;
	for (uint32_t block = 0; rc == 0 && block < cells->block_count; block++)
		rc = read_block(out, folder, block);
	if (rc < 0)
		block_border_finish(out);
	return rc;
}

void block_border_finish(struct block_border *border)
{
	if (!border)
		return;
	free(border->vertices);
	free(border->first);
	*border = (struct block_border){ 0 };
}

uint32_t block_border_find(const struct block_border *border, const struct block_cells *cells,
			   const struct lattice *lattice, const int32_t position[3])
{
	uint32_t block = block_at(cells, lattice, position);
	uint32_t low = border->first[block], end = border->first[block + 1], high = end;
	map_key place = lattice_key(position);

	while (low < high) {
		uint32_t middle = low + (high - low) / 2;

		if (lattice_key(border->vertices[middle].vertex.position) < place)
			low = middle + 1;
		else
			high = middle;
	}
	return low < end && lattice_key(border->vertices[low].vertex.position) == place
		       ? low
		       : BORDER_NONE;
}
