/* Passes over the scan: box, counts, and sorting into blocks; each by processes that take a piece
 * at a time. */
#include "pipeline/hierarchy/block_split.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/bytes.h"
#include "base/shared_memory.h"
#include "pipeline/hierarchy/lattice_mesh.h"

#define NO_BLOCK UINT32_MAX

enum { PIECE = 1 << 20 /* vertices or triangles that one process takes */ };

static uint32_t pieces_of(uint32_t count)
{
	return count / PIECE + (count % PIECE != 0);
}

static uint32_t piece_end(uint32_t count, uint32_t piece)
{
	return count - piece * PIECE < PIECE ? count : (piece + 1) * PIECE;
}

/* ---- the box */

struct box {
	float low[3], high[3];
};

struct box_pass {
	const struct mesh *mesh;
	struct box *boxes; /* shared; for each piece */
};

static int find_box(void *user, uint32_t piece)
{
	const struct box_pass *pass = user;
	struct box box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };

	for (uint32_t v = piece * PIECE; v < piece_end(pass->mesh->vertex_count, piece); v++)
		for (int i = 0; i < 3; i++) {
			float at = pass->mesh->positions[v][i];

			if (!isfinite(at))
				return -EINVAL;
			box.low[i] = fminf(box.low[i], at);
			box.high[i] = fmaxf(box.high[i], at);
		}
	pass->boxes[piece] = box;
	return 0;
}

int block_scan_init(struct block_scan *scan, const struct mesh *mesh, double step_max_m,
		    uint32_t jobs)
{
	uint32_t pieces = pieces_of(mesh->vertex_count);
	size_t size = (pieces + (size_t)1) * sizeof(struct box);
	struct box_pass pass = { mesh, shared_memory_create(size) };
	const struct processes processes = {
		.worker_count = jobs,
		.piece_count = pieces,
		.work = find_box,
		.user = &pass,
	};
	int rc = pass.boxes ? processes_run(&processes) : -ENOMEM;

	*scan = (struct block_scan){ .mesh = mesh, .jobs = jobs };
	for (uint32_t p = 0; rc == 0 && p < pieces; p++)
		for (int i = 0; i < 3; i++) {
			float *low = &scan->box_min_m[i], *high = &scan->box_max_m[i];

			*low = p == 0 ? pass.boxes[p].low[i] : fminf(*low, pass.boxes[p].low[i]);
			*high = p == 0 ? pass.boxes[p].high[i]
				       : fmaxf(*high, pass.boxes[p].high[i]);
		}
	shared_memory_destroy(pass.boxes, size);
	return rc < 0 ? rc
		      : lattice_of_box(&scan->lattice, scan->box_min_m, scan->box_max_m,
				       step_max_m);
}

/* ---- counting */

void block_corners(int32_t out[3][3], const struct block_scan *scan, const uint32_t triangle[3])
{
	for (int c = 0; c < 3; c++)
		lattice_place(out[c], &scan->lattice, scan->mesh->positions[triangle[c]]);
}

struct count_pass {
	const struct block_scan *scan;
	struct block_counts *counts;
	struct exposure *exposure;
	uint64_t *lengths; /* shared; for each piece */
};

static int count_piece(void *user, uint32_t piece)
{
	const struct count_pass *pass = user;
	const struct mesh *mesh = pass->scan->mesh;
	uint64_t length = 0;

	for (uint32_t t = piece * PIECE; t < piece_end(mesh->triangle_count, piece); t++) {
		const uint32_t *triangle = mesh->triangles[t];
		int32_t corners[3][3];
		uint16_t coarse[3][3];
		const uint16_t(*at)[3] = (const uint16_t(*)[3])coarse;

		for (int c = 0; c < 3; c++)
			if (triangle[c] >= mesh->vertex_count)
				return -EINVAL;
		block_corners(corners, pass->scan, triangle);
		for (int c = 0; c < 3; c++)
			lattice_coarse(coarse[c], &pass->scan->lattice, corners[c]);
		block_counts_add(pass->counts, at);
		exposure_add(pass->exposure, at);
		for (int i = 0; i < 3; i++)
			length += (uint64_t)abs(corners[0][i] - corners[1][i]);
	}
	pass->lengths[piece] = length;
	return 0;
}

int block_scan_count(const struct block_scan *scan, struct block_counts *counts,
		     struct exposure *exposure, uint64_t *edge_steps)
{
	uint32_t pieces = pieces_of(scan->mesh->triangle_count);
	size_t size = (pieces + (size_t)1) * sizeof(uint64_t);
	struct count_pass pass = { scan, counts, exposure, shared_memory_create(size) };
	const struct processes processes = {
		.worker_count = scan->jobs,
		.piece_count = pieces,
		.work = count_piece,
		.user = &pass,
	};
	int rc = pass.lengths ? processes_run(&processes) : -ENOMEM;

	*edge_steps = 0;
	for (uint32_t p = 0; rc == 0 && p < pieces; p++)
		*edge_steps += pass.lengths[p];
	shared_memory_destroy(pass.lengths, size);
	return rc;
}

/* ---- sorting into blocks
 *
 * A file: for each block u32 own triangles and u32 triangles of others, then the triangles of block
 * after block, its own first; all in this machine's byte order. */

struct split_pass {
	const struct block_scan *scan;
	const struct block_cells *cells;
	const char *folder;
};

static int split_path(char out[PATH_MAX], const char *folder, uint32_t piece)
{
	return snprintf(out, PATH_MAX, "%s/split-%u", folder, piece) < PATH_MAX ? 0 : -ENAMETOOLONG;
}

/* The blocks that get a triangle: the owner, then others that have one of its corners. */
static uint32_t blocks_of(uint32_t blocks[4], const struct block_scan *scan,
			  const struct block_cells *cells, const uint32_t triangle[3])
{
	int32_t corners[3][3];
	uint16_t coarse[3][3];
	const uint16_t(*at)[3] = (const uint16_t(*)[3])coarse;
	uint32_t count = 1;

	block_corners(corners, scan, triangle);
	for (int c = 0; c < 3; c++)
		lattice_coarse(coarse[c], &scan->lattice, corners[c]);
	blocks[0] = cells->block_of_cell[block_cell_of_triangle(at)];
	for (int c = 0; c < 3; c++) {
		uint32_t block = cells->block_of_cell[block_cell(at[c])], i = 0;

		while (i < count && blocks[i] != block)
			i++;
		if (i == count)
			blocks[count++] = block;
	}
	return count;
}

/* Counts into heads, two for each block, and sets only[] of each triangle to the block that alone
 * gets it, or to NO_BLOCK. Then, where rows is given, puts the triangles there and moves the
 * heads on. */
static void sort_piece(uint32_t *heads, uint32_t *only, uint32_t (*rows)[3],
		       const struct split_pass *pass, uint32_t piece)
{
	const struct mesh *mesh = pass->scan->mesh;

	for (uint32_t t = piece * PIECE; t < piece_end(mesh->triangle_count, piece); t++) {
		uint32_t *alone = &only[t - piece * PIECE], blocks[4] = { *alone }, count = 1;

		if (!rows || *alone == NO_BLOCK)
			count = blocks_of(blocks, pass->scan, pass->cells, mesh->triangles[t]);
		*alone = count == 1 ? blocks[0] : NO_BLOCK;
		for (uint32_t i = 0; i < count; i++) {
			uint32_t *head = &heads[2 * blocks[i] + (i > 0)];

			if (rows)
				memcpy(rows[*head], mesh->triangles[t], sizeof(*rows));
			++*head;
		}
	}
}

static int split_piece(void *user, uint32_t piece)
{
	const struct split_pass *pass = user;
	uint32_t head_count = 2 * pass->cells->block_count, total = 0;
	uint32_t *heads = calloc(head_count, sizeof(*heads));
	uint32_t *only = calloc(PIECE, sizeof(*only));
	struct buffer file;
	char path[PATH_MAX];
	uint8_t *rows;
	int rc = split_path(path, pass->folder, piece);

	if (!heads || !only)
		rc = -ENOMEM;
	if (rc < 0 || access(path, F_OK) == 0) {
		free(heads);
		free(only);
		return rc;
	}
	sort_piece(heads, only, NULL, pass, piece);
	buffer_init(&file, SIZE_MAX);
	buffer_put(&file, heads, head_count * sizeof(*heads));
	for (uint32_t h = 0; h < head_count; h++) {
		uint32_t count = heads[h];

		heads[h] = total;
		total += count;
	}
	rows = buffer_extend(&file, total * sizeof(uint32_t[3]));
	rc = rows ? 0 : file.error;
	if (rc == 0) {
		sort_piece(heads, only, (uint32_t(*)[3])(void *)rows, pass, piece);
		if (access(path, F_OK) < 0)
			rc = bytes_write_file(buffer_bytes(&file), path);
	}
	buffer_finish(&file);
	free(heads);
	free(only);
	return rc;
}

int block_split(const struct block_scan *scan, const struct block_cells *cells, const char *folder)
{
	struct split_pass pass = { scan, cells, folder };
	const struct processes processes = {
		.worker_count = scan->jobs,
		.piece_count = pieces_of(scan->mesh->triangle_count),
		.shard = scan->shard,
		.work = split_piece,
		.user = &pass,
	};

	return processes_run(&processes);
}

/* ---- reading a block */

static int split_open(const char *folder, uint32_t piece)
{
	char path[PATH_MAX];
	int rc = split_path(path, folder, piece);
	int fd = rc < 0 ? rc : open(path, O_RDONLY | O_CLOEXEC);

	return rc == 0 && fd < 0 ? -errno : fd;
}

/* Where the triangles of a block lie in a file: their number, own and others', and the place of the
 * first. */
static int find_block(uint32_t counts[2], uint64_t *place, int fd, uint32_t *heads,
		      const struct block_cells *cells, uint32_t block)
{
	int rc = bytes_read_at(fd, heads, 2 * (size_t)cells->block_count * sizeof(*heads), 0);
	uint64_t before = 0;

	for (uint32_t h = 0; rc == 0 && h < 2 * block; h++)
		before += heads[h];
	if (rc == 0) {
		counts[0] = heads[2 * block];
		counts[1] = heads[2 * block + 1];
		*place = 2 * (uint64_t)cells->block_count * sizeof(*heads) +
			 before * sizeof(uint32_t[3]);
	}
	return rc;
}

/* Visits the files twice: to count, then to read; own triangles go before those of others. */
static int visit_pieces(struct block_triangles *out, uint32_t *heads, uint32_t pieces,
			const struct block_cells *cells, const char *folder, uint32_t block)
{
	uint32_t at[2] = { 0, out->own_count };
	int rc = 0;

	for (uint32_t piece = 0; rc == 0 && piece < pieces; piece++) {
		int fd = split_open(folder, piece);
		uint32_t counts[2] = { 0, 0 };
		uint64_t place = 0;

		if (fd < 0)
			return fd;
		rc = find_block(counts, &place, fd, heads, cells, block);
		for (int kind = 0; rc == 0 && kind < 2; kind++) {
			size_t size = counts[kind] * sizeof(*out->items);

			if (out->items)
				rc = bytes_read_at(fd, out->items[at[kind]], size, place);
			at[kind] += counts[kind];
			place += size;
		}
		close(fd);
	}
	out->own_count = at[0];
	out->count = at[1];
	return rc;
}

int block_triangles_read(struct block_triangles *out, const struct block_scan *scan,
			 const struct block_cells *cells, const char *folder, uint32_t block)
{
	uint32_t pieces = pieces_of(scan->mesh->triangle_count);
	uint32_t *heads = malloc(2 * (size_t)cells->block_count * sizeof(*heads));
	int rc;

	*out = (struct block_triangles){ 0 };
	rc = heads ? visit_pieces(out, heads, pieces, cells, folder, block) : -ENOMEM;
	if (rc == 0) {
		out->count += out->own_count;
		out->items = malloc((out->count + (size_t)1) * sizeof(*out->items));
		rc = out->items ? visit_pieces(out, heads, pieces, cells, folder, block) : -ENOMEM;
	}
	free(heads);
	if (rc < 0)
		block_triangles_finish(out);
	return rc;
}

void block_triangles_finish(struct block_triangles *triangles)
{
	if (!triangles)
		return;
	free(triangles->items);
	*triangles = (struct block_triangles){ 0 };
}

/* ---- a part of the scan as a mesh */

/* The scan's vertices that are used, as bits, with the number of those before each word. */
struct used {
	uint64_t *words;
	uint32_t *before;
	uint32_t first, word_count;
};

static uint32_t name_of(const struct used *used, uint32_t vertex)
{
	uint32_t bit = vertex - used->first;
	uint64_t below = used->words[bit / 64] & ((UINT64_C(1) << bit % 64) - 1);

	return used->before[bit / 64] + (uint32_t)__builtin_popcountll(below);
}

static int find_used(struct used *used, uint32_t *vertex_count, uint32_t (*triangles)[3],
		     uint32_t count)
{
	uint32_t low = UINT32_MAX, high = 0;

	for (uint32_t t = 0; t < count; t++)
		for (int c = 0; c < 3; c++) {
			low = triangles[t][c] < low ? triangles[t][c] : low;
			high = triangles[t][c] > high ? triangles[t][c] : high;
		}
	used->first = low;
	used->word_count = count > 0 ? (high - low) / 64 + 1 : 0;
	used->words = calloc(used->word_count + (size_t)1, sizeof(*used->words));
	used->before = calloc(used->word_count + (size_t)1, sizeof(*used->before));
	if (!used->words || !used->before)
		return -ENOMEM;
	for (uint32_t t = 0; t < count; t++)
		for (int c = 0; c < 3; c++) {
			uint32_t bit = triangles[t][c] - low;

			used->words[bit / 64] |= UINT64_C(1) << bit % 64;
		}
	*vertex_count = 0;
	for (uint32_t w = 0; w < used->word_count; w++) {
		used->before[w] = *vertex_count;
		*vertex_count += (uint32_t)__builtin_popcountll(used->words[w]);
	}
	return 0;
}

static void copy_vertices(struct mesh *out, const struct mesh *scan, const struct used *used)
{
	uint32_t name = 0;

	for (uint32_t w = 0; w < used->word_count; w++)
		for (uint64_t left = used->words[w]; left; left &= left - 1) {
			uint32_t vertex = used->first + 64 * w + (uint32_t)__builtin_ctzll(left);

			memcpy(out->positions[name], scan->positions[vertex],
			       sizeof(*out->positions));
			if (scan->colours)
				memcpy(out->colours[name], scan->colours[vertex],
				       sizeof(*out->colours));
			name++;
		}
}

int block_mesh(struct mesh *out, const struct block_scan *scan, uint32_t (*triangles)[3],
	       uint32_t count)
{
	struct used used = { 0 };
	uint32_t vertex_count = 0;
	int rc = find_used(&used, &vertex_count, triangles, count);

	*out = (struct mesh){ .vertex_count = vertex_count, .triangle_count = count };
	if (rc == 0) {
		out->positions = malloc((vertex_count + (size_t)1) * sizeof(*out->positions));
		out->triangles = malloc((count + (size_t)1) * sizeof(*out->triangles));
		if (scan->mesh->colours)
			out->colours = malloc((vertex_count + (size_t)1) * sizeof(*out->colours));
		if (!out->positions || !out->triangles || (scan->mesh->colours && !out->colours))
			rc = -ENOMEM;
	}
	if (rc == 0)
		copy_vertices(out, scan->mesh, &used);
	for (uint32_t t = 0; rc == 0 && t < count; t++)
		for (int c = 0; c < 3; c++)
			out->triangles[t][c] = name_of(&used, triangles[t][c]);
	free(used.words);
	free(used.before);
	if (rc < 0)
		mesh_finish(out);
	return rc;
}
