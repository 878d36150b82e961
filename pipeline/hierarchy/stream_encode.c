/* Collapses a mesh, then replays the collapses backwards to find the records of its stream. */
#include "pipeline/hierarchy/stream_encode.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct replay {
	const struct patch_vertex *vertices; /* of the input */
	uint32_t vertex_count, triangle_count;
	uint32_t (*triangles)[3]; /* owned; those left after the collapses */
	uint32_t (*base)[3];      /* owned */
	struct stream_collapses collapses;
	struct stream_mesh mesh;
	struct stream_record *records; /* owned */
	uint32_t record_count;
	uint32_t *numbers; /* owned; of each vertex of the input, its number in the stream */
	uint32_t *inputs;  /* owned; of each triangle of the stream, its number in the input */
	uint8_t *is_moved; /* owned; for each triangle of the input, during one record */
};

static void give_number(struct replay *replay, uint32_t vertex)
{
	struct stream_mesh *mesh = &replay->mesh;

	replay->numbers[vertex] = mesh->vertex_count;
	mesh->vertices[mesh->vertex_count] = replay->vertices[vertex];
	memset(mesh->vertices[mesh->vertex_count].zero, 0, sizeof(mesh->vertices->zero));
}

/* Base vertices are numbered as its triangles first name them, then those that none names. */
static void make_base(struct replay *replay)
{
	struct stream_mesh *mesh = &replay->mesh;

	memset(replay->numbers, 0xff, replay->vertex_count * sizeof(*replay->numbers));
	for (uint32_t t = 0; t < replay->triangle_count; t++) {
		uint32_t corners[3];

		if (replay->triangles[t][0] == STREAM_NONE)
			continue;
		for (int c = 0; c < 3; c++) {
			uint32_t v = replay->triangles[t][c];

			if (replay->numbers[v] == STREAM_NONE) {
				give_number(replay, v);
				stream_mesh_add_vertex(mesh);
			}
			corners[c] = replay->numbers[v];
		}
		replay->inputs[mesh->triangle_count] = t;
		memcpy(replay->base[mesh->triangle_count], corners, sizeof(corners));
		stream_mesh_add_triangle(mesh, corners);
	}
}

/* Vertices that no triangle used from the beginning. */
static void keep_unused(struct replay *replay, const uint32_t (*triangles)[3])
{
	uint8_t *used = replay->is_moved; /* has room for vertices too */

	for (uint32_t t = 0; t < replay->triangle_count; t++)
		for (int c = 0; c < 3; c++)
			used[triangles[t][c]] = 1;
	for (uint32_t v = 0; v < replay->vertex_count; v++)
		if (!used[v]) {
			give_number(replay, v);
			stream_mesh_add_vertex(&replay->mesh);
		}
	memset(used, 0, replay->vertex_count);
}

/* Finds the vanished triangle that runs from a to b to x. */
static uint32_t find_vanished(const struct replay *replay, const struct stream_collapse *item,
			      uint32_t a, uint32_t b, uint32_t x)
{
	const uint32_t *entry = replay->collapses.lists + item->first + item->moved_count;

	for (uint32_t i = 0; i < item->vanished_count; i++, entry += 4)
		for (uint32_t c = 0; c < 3; c++)
			if (replay->numbers[entry[1 + c]] == a &&
			    replay->numbers[entry[1 + (c + 1) % 3]] == b &&
			    replay->numbers[entry[1 + (c + 2) % 3]] == x)
				return entry[0];
	return STREAM_NONE;
}

/* In the order in which format/stream_code.c asks for new triangles. */
static uint32_t make_faces(struct replay *replay, const struct stream_collapse *item,
			   struct stream_record *record)
{
	const struct stream_mesh *mesh = &replay->mesh;
	uint32_t old = record->target, new = mesh->vertex_count, count = 0, i = 0;

	for (uint32_t at = mesh->first[old]; at != STREAM_NONE; at = mesh->next[at], i++)
		for (uint32_t slot = 0; slot < 2; slot++) {
			uint32_t x = mesh->triangles[at / 3][(at % 3 + 1 + slot) % 3];

			for (uint32_t back = 0; back < 2; back++) {
				uint32_t t = find_vanished(replay, item, back ? new : old,
							   back ? old : new, x);
				uint32_t known = 0;

				while (known < count &&
				       replay->inputs[mesh->triangle_count + known] != t)
					known++;
				if (t == STREAM_NONE || known < count || count == STREAM_FACES_MAX)
					continue;
				replay->inputs[mesh->triangle_count + count] = t;
				record->faces[count++] = (uint8_t)(STREAM_FACE | i |
								   (slot ? STREAM_FACE_BEFORE : 0) |
								   (back ? STREAM_FACE_BACK : 0));
			}
		}
	return count;
}

static int make_split(struct replay *replay, const struct stream_collapse *item,
		      struct stream_record *record)
{
	const uint32_t *moved = replay->collapses.lists + item->first;
	const struct stream_mesh *mesh = &replay->mesh;
	uint32_t i = 0;

	give_number(replay, item->gone);
	record->target = replay->numbers[item->target];
	for (uint32_t m = 0; m < item->moved_count; m++)
		replay->is_moved[moved[m]] = 1;
	for (uint32_t at = mesh->first[record->target]; at != STREAM_NONE && i < STREAM_RING_MAX;
	     at = mesh->next[at], i++)
		record->moved |= (uint32_t)replay->is_moved[replay->inputs[at / 3]] << i;
	for (uint32_t m = 0; m < item->moved_count; m++)
		replay->is_moved[moved[m]] = 0;
	return make_faces(replay, item, record) == item->vanished_count ? 0 : -EINVAL;
}

/* The triangles of a piece must each be another of the eight; else it is none. */
static int make_piece(struct replay *replay, const struct stream_collapse *item,
		      struct stream_record *record)
{
	struct stream_mesh *mesh = &replay->mesh;
	uint32_t base = mesh->vertex_count, corners[3], found = 0;

	record->target = STREAM_NONE;
	for (record->moved = 0;
	     record->moved < STREAM_PIECE_VERTICES && item->piece[record->moved] != STREAM_NONE;
	     record->moved++) {
		give_number(replay, item->piece[record->moved]);
		mesh->vertex_count++;
	}
	mesh->vertex_count = base;
	for (uint32_t face = 0; face < 2 * STREAM_PIECE_FACES; face++) {
		uint32_t t;

		if (record->moved == 3 && face % 4 != 3)
			continue;
		stream_piece_face(corners, face);
		t = find_vanished(replay, item, base + corners[0], base + corners[1],
				  base + corners[2]);
		if (t == STREAM_NONE)
			continue;
		replay->inputs[mesh->triangle_count + found++] = t;
		record->faces[0] |= (uint8_t)(1u << face);
	}
	return found == item->vanished_count ? 0 : -EINVAL;
}

static const struct replay *sorted_replay; /* of the sort in progress */

static int compare_items(const void *a, const void *b)
{
	const struct stream_collapse *x = a, *y = b;
	uint32_t p, q;

	if (x->target == STREAM_NONE || y->target == STREAM_NONE) {
		p = x->target == STREAM_NONE ? x->gone : 0;
		q = y->target == STREAM_NONE ? y->gone : 0;
	} else {
		p = sorted_replay->numbers[x->target];
		q = sorted_replay->numbers[y->target];
	}
	return p < q ? -1 : p > q;
}

static int replay_rounds(struct replay *replay, struct stream_stats *stats)
{
	struct stream_collapses *all = &replay->collapses;
	uint32_t end = all->count;
	int rc = 0;

	while (rc == 0 && end > 0) {
		uint32_t begin = end - 1;

		while (begin > 0 && all->items[begin - 1].round == all->items[end - 1].round)
			begin--;
		sorted_replay = replay;
		qsort(all->items + begin, end - begin, sizeof(*all->items), compare_items);
		for (uint32_t i = begin; rc == 0 && i < end; i++) {
			struct stream_record *record = &replay->records[replay->record_count++];
			bool piece = all->items[i].target == STREAM_NONE;

			*record = (struct stream_record){ 0 };
			rc = piece ? make_piece(replay, &all->items[i], record)
				   : make_split(replay, &all->items[i], record);
			if (rc == 0 && !stream_record_fits(&replay->mesh, record))
				rc = -EINVAL;
			if (rc == 0)
				stream_mesh_apply(&replay->mesh, record);
			stats->piece_count += piece;
			stats->errors[(replay->record_count - 1) / STREAM_BLOCK_RECORDS] +=
				all->items[i].cost;
		}
		end = begin;
	}
	return rc;
}

/* errors holds the cost of each block's records; what is missing of the mesh after some blocks is
 * the sum of all later ones. */
static void sum_errors(struct stream_stats *stats, double area)
{
	double sum = 0.0;

	for (uint32_t i = stream_block_count(stats->record_count); i-- > 0;) {
		sum += stats->errors[i];
		stats->errors[i] = area > 0.0 ? sqrt(sum / area) : 0.0;
	}
}

static void replay_finish(struct replay *replay)
{
	stream_collapses_finish(&replay->collapses);
	stream_mesh_finish(&replay->mesh);
	free(replay->triangles);
	free(replay->base);
	free(replay->records);
	free(replay->numbers);
	free(replay->inputs);
	free(replay->is_moved);
}

static int replay_init(struct replay *replay, const uint32_t (*triangles)[3])
{
	size_t vertices = (size_t)replay->vertex_count + 1,
	       count = replay->triangle_count + (size_t)1;
	int rc = stream_mesh_init(&replay->mesh, replay->vertex_count, replay->triangle_count);

	if (rc < 0)
		return rc;
	for (uint32_t t = 0; t < replay->triangle_count; t++)
		for (int c = 0; c < 3; c++)
			if (triangles[t][c] >= replay->vertex_count ||
			    triangles[t][c] == triangles[t][(c + 1) % 3])
				return -EINVAL;
	replay->triangles = malloc(count * sizeof(*replay->triangles));
	replay->base = malloc(count * sizeof(*replay->base));
	replay->records = malloc(vertices * sizeof(*replay->records));
	replay->numbers = malloc(vertices * sizeof(*replay->numbers));
	replay->inputs = malloc((count + STREAM_FACES_MAX + 8) * sizeof(*replay->inputs));
	replay->is_moved = calloc(count + vertices, 1);
	if (!replay->triangles || !replay->base || !replay->records || !replay->numbers ||
	    !replay->inputs || !replay->is_moved)
		return -ENOMEM;
	memcpy(replay->triangles, triangles, (count - 1) * sizeof(*triangles));
	return 0;
}

int stream_make(struct buffer *out, struct stream_stats *stats, const struct patch_vertex *vertices,
		uint32_t vertex_count, const uint32_t (*triangles)[3], uint32_t triangle_count,
		const struct stream_options *options)
{
	struct replay replay = { .vertices = vertices,
				 .vertex_count = vertex_count,
				 .triangle_count = triangle_count };
	int rc = replay_init(&replay, triangles);

	*stats = (struct stream_stats){ 0 };
	if (rc == 0)
		rc = stream_collapse(&replay.collapses, vertices, vertex_count, replay.triangles,
				     triangle_count, options);
	if (rc == 0) {
		make_base(&replay);
		keep_unused(&replay, triangles);
		stats->base_vertices = replay.mesh.vertex_count;
		stats->base_triangles = replay.mesh.triangle_count;
		rc = replay_rounds(&replay, stats);
	}
	if (rc == 0) {
		const struct stream_source source = {
			.vertices = replay.mesh.vertices,
			.vertex_count = vertex_count,
			.triangle_count = triangle_count,
			.base = (const uint32_t(*)[3])replay.base,
			.base_vertices = stats->base_vertices,
			.base_triangles = stats->base_triangles,
			.records = replay.records,
			.record_count = replay.record_count,
		};

		stats->record_count = replay.record_count;
		sum_errors(stats, replay.collapses.area);
		rc = stream_encode(out, &source);
	}
	replay_finish(&replay);
	return rc;
}
