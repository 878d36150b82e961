/* Most scans have binary vertices without lists and faces that are all triangles. Then each thread
 * can read a range of the file. That a face is a triangle is only seen when it is read; the first
 * one that is not ends the run, and what was delivered of later ranges is replaced by what the
 * caller reads there. */
#include "pipeline/import/ply_runs.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "base/bytes.h"
#include "base/parallel.h"
#include "pipeline/import/ply_decode.h"

enum {
	RANGE_ITEMS = 1 << 16,
	TRIANGLE_UVS = 6, /* numbers in the list of texture coordinates */
	LISTS_MAX = 2,    /* corners and texture coordinates */
};

/* A list that must have the same length in every face. */
struct list {
	uint32_t count_at, at; /* bytes from the start of the item: of the count, of the numbers */
	enum ply_type count_type, type;
	uint32_t count;
};

struct run {
	const struct ply *ply;
	const struct ply_element *element;
	const struct ply_visitor *visitor;
	uint64_t from;       /* file offset of the first item */
	uint32_t item_bytes; /* 0: the items may differ in size */
	/* of faces; corners first */
	struct list lists[LISTS_MAX];
	bool has_uvs;
	uint32_t texture_at;
	enum ply_type texture_type; /* PLY_TYPE_NONE: no property texnumber */
	enum ply_type types[PLY_SLOT_NONE];
	uint8_t **buffers; /* of each worker, of PLY_BUFFER_BYTES; owned */
	atomic_uint end;   /* the first item known not to belong to the run */
};

/* ---- faces */

static bool add_list(struct run *run, const struct ply_property *property, bool *has_corners)
{
	const bool is_uvs = property->slot == PLY_SLOT_CORNER_UVS;
	struct list *list = &run->lists[is_uvs];

	if ((property->slot != PLY_SLOT_CORNERS && !is_uvs) || list->count > 0)
		return false;
	*list = (struct list){
		.count_at = run->item_bytes,
		.at = run->item_bytes + (uint32_t)ply_type_bytes(property->count_type),
		.count_type = property->count_type,
		.type = property->type,
		.count = is_uvs ? TRIANGLE_UVS : 3,
	};
	run->has_uvs |= is_uvs;
	*has_corners |= !is_uvs;
	run->item_bytes = list->at + list->count * (uint32_t)ply_type_bytes(property->type);
	return true;
}

/* Computes where the numbers of a triangle lie. Returns false if that may differ from one to the
 * next. */
static bool lay_out_triangle(struct run *run)
{
	bool has_corners = false;

	run->texture_type = PLY_TYPE_NONE;
	for (uint32_t i = 0; i < run->element->property_count; i++) {
		const struct ply_property *property = &run->element->properties[i];

		if (property->count_type != PLY_TYPE_NONE) {
			if (!add_list(run, property, &has_corners))
				return false;
			continue;
		}
		if (property->slot == PLY_SLOT_TEXTURE) {
			run->texture_at = run->item_bytes;
			run->texture_type = property->type;
		}
		run->item_bytes += (uint32_t)ply_type_bytes(property->type);
	}
	return has_corners;
}

/* Returns 1 if the item is no triangle, or one with a fault. */
static int deliver_triangle(const struct run *run, uint32_t index, const uint8_t *bytes)
{
	const bool big = run->ply->encoding == PLY_BIG;
	const double vertices = (double)run->ply->summary.vertex_count;
	const struct list *corners = &run->lists[0], *uvs = &run->lists[1];
	struct ply_triangle triangle = { .face = index };

	for (int i = 0; i <= run->has_uvs; i++)
		if (ply_number(bytes + run->lists[i].count_at, run->lists[i].count_type, big) !=
		    run->lists[i].count)
			return 1;
	for (uint32_t k = 0; k < 3; k++) {
		double corner = ply_number(bytes + corners->at + k * ply_type_bytes(corners->type),
					   corners->type, big);

		if (!(corner >= 0 && corner < vertices))
			return 1;
		triangle.corner[k] = (uint32_t)corner;
	}
	for (uint32_t k = 0; run->has_uvs && k < TRIANGLE_UVS; k++)
		triangle.uv[k / 2][k % 2] = (float)ply_number(
			bytes + uvs->at + k * ply_type_bytes(uvs->type), uvs->type, big);
	if (run->texture_type != PLY_TYPE_NONE)
		triangle.texture = ply_texture_from(
			ply_number(bytes + run->texture_at, run->texture_type, big));
	return run->visitor->triangle(run->visitor->data, index, &triangle);
}

/* ---- vertices */

static int deliver_vertex(const struct run *run, uint32_t index, const uint8_t *bytes)
{
	const struct ply_element *element = run->element;
	double values[PLY_SLOT_NONE] = { 0 };
	struct ply_vertex vertex;

	for (uint32_t i = 0; i < element->property_count; i++) {
		const struct ply_property *property = &element->properties[i];

		if (property->slot != PLY_SLOT_NONE)
			values[property->slot] =
				ply_number(bytes + property->offset, property->type,
					   run->ply->encoding == PLY_BIG);
	}
	ply_vertex_from(&vertex, &run->ply->summary, values, run->types);
	return run->visitor->vertex(run->visitor->data, index, &vertex);
}

/* ---- ranges */

static void end_run(struct run *run, uint32_t at)
{
	uint32_t end = atomic_load(&run->end);

	while (at < end && !atomic_compare_exchange_weak(&run->end, &end, at))
		;
}

static int deliver(struct run *run, uint32_t first, uint32_t count, const uint8_t *bytes)
{
	const bool is_vertex = run->element->kind == PLY_KIND_VERTEX;

	for (uint32_t i = 0; i < count; i++, bytes += run->item_bytes) {
		int rc = is_vertex ? deliver_vertex(run, first + i, bytes)
				   : deliver_triangle(run, first + i, bytes);

		if (rc < 0)
			return rc;
		if (rc > 0) {
			end_run(run, first + i);
			break;
		}
	}
	return 0;
}

static int read_range(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	struct run *run = user;
	const uint32_t most = PLY_BUFFER_BYTES / run->item_bytes;
	int rc = 0;

	if (!run->buffers[worker])
		run->buffers[worker] = malloc(PLY_BUFFER_BYTES);
	if (!run->buffers[worker])
		return -ENOMEM;
	for (uint32_t at = first, count; rc == 0 && at < after; at += count) {
		size_t bytes;

		count = after - at < most ? after - at : most;
		bytes = (size_t)count * run->item_bytes;
		if (at >= atomic_load(&run->end))
			break;
		if (bytes_read_at(run->ply->input.fd, run->buffers[worker], bytes,
				  run->from + (uint64_t)at * run->item_bytes) < 0) {
			end_run(run, at);
			break;
		}
		rc = deliver(run, at, count, run->buffers[worker]);
		if (run->visitor->advance)
			run->visitor->advance(run->visitor->data, bytes);
	}
	return rc;
}

static int read_ranges(struct run *run, uint32_t count)
{
	const uint32_t jobs = run->visitor->jobs ? run->visitor->jobs : 1;
	int rc = -ENOMEM;

	atomic_store(&run->end, count);
	run->buffers = calloc(jobs, sizeof(*run->buffers));
	if (run->buffers)
		rc = parallel_ranges(jobs, count, RANGE_ITEMS, read_range, run);
	for (uint32_t i = 0; run->buffers && i < jobs; i++)
		free(run->buffers[i]);
	free(run->buffers);
	return rc;
}

int ply_runs_read(uint64_t *count, struct ply *ply, const struct ply_element *element,
		  const struct ply_visitor *visitor)
{
	struct run run = {
		.ply = ply,
		.element = element,
		.visitor = visitor,
		.from = ply_input_offset(&ply->input),
		.item_bytes = element->stride,
	};
	int rc;

	*count = 0;
	if (ply->encoding == PLY_ASCII || element->count >= UINT32_MAX)
		return 0;
	if (element->kind == PLY_KIND_FACE) {
		run.item_bytes = 0;
		if (!lay_out_triangle(&run))
			return 0;
	} else if (element->kind != PLY_KIND_VERTEX || run.item_bytes == 0) {
		return 0;
	}
	ply_types_of(run.types, element);
	rc = read_ranges(&run, (uint32_t)element->count);
	*count = atomic_load(&run.end);
	if (rc == 0)
		rc = ply_input_seek(&ply->input, run.from + *count * run.item_bytes);
	return rc;
}
