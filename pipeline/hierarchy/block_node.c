/* Encodes and decodes the result of a node. The file stays on this machine and is removed when the
 * master is complete. */
#include "pipeline/hierarchy/block_node.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

void block_result_init(struct block_result *result)
{
	*result = (struct block_result){ 0 };
	buffer_init(&result->objects, SIZE_MAX);
}

void block_result_finish(struct block_result *result)
{
	if (!result)
		return;
	free(result->others);
	hierarchy_finish(&result->made);
	free(result->losses_m4);
	free(result->sizes);
	buffer_finish(&result->objects);
	live_patches_finish(&result->left);
	free(result->vertices);
	free(result->borders);
	block_result_init(result);
}

static int result_path(char out[PATH_MAX], const char *folder, uint32_t node)
{
	return snprintf(out, PATH_MAX, "%s/node-%u", folder, node) < PATH_MAX ? 0 : -ENAMETOOLONG;
}

bool block_result_exists(const char *folder, uint32_t node)
{
	char path[PATH_MAX];

	return result_path(path, folder, node) == 0 && access(path, F_OK) == 0;
}

/* ---- rows */

static void put_group(struct buffer *out, const struct hierarchy_group *group)
{
	buffer_put_u32(out, group->patch_count);
	buffer_put_f32(out, group->error_m);
	for (int i = 0; i < 3; i++)
		buffer_put_f32(out, group->centre_m[i]);
	buffer_put_f32(out, group->radius_m);
}

static void get_group(struct hierarchy_group *out, struct reader *reader)
{
	out->patch_count = reader_u32(reader);
	out->error_m = reader_f32(reader);
	for (int i = 0; i < 3; i++)
		out->centre_m[i] = reader_f32(reader);
	out->radius_m = reader_f32(reader);
}

static void put_row(struct buffer *out, const struct hierarchy_patch *patch)
{
	buffer_put_u32(out, patch->finer);
	buffer_put_u16(out, patch->triangle_count);
	buffer_put_u16(out, patch->vertex_count);
	for (int i = 0; i < 3; i++)
		buffer_put_f32(out, patch->centre_m[i]);
	buffer_put_f32(out, patch->radius_m);
	for (int i = 0; i < 3; i++)
		buffer_put_f32(out, patch->cone_axis[i]);
	buffer_put_f32(out, patch->cone_cos);
}

static void get_row(struct hierarchy_patch *out, struct reader *reader)
{
	out->finer = reader_u32(reader);
	out->triangle_count = reader_u16(reader);
	out->vertex_count = reader_u16(reader);
	for (int i = 0; i < 3; i++)
		out->centre_m[i] = reader_f32(reader);
	out->radius_m = reader_f32(reader);
	for (int i = 0; i < 3; i++)
		out->cone_axis[i] = reader_f32(reader);
	out->cone_cos = reader_f32(reader);
}

static void put_rows(struct buffer *out, const struct block_result *result)
{
	buffer_put_u32(out, result->other_count);
	buffer_put_u32(out, result->made.group_count);
	buffer_put_u32(out, result->made.patch_count);
	for (uint32_t i = 0; i < result->other_count; i++) {
		buffer_put_u32(out, result->others[i].node);
		buffer_put_u32(out, result->others[i].number);
	}
	for (uint32_t g = 0; g < result->made.group_count; g++) {
		put_group(out, &result->made.groups[g]);
		buffer_put_f32(out, result->losses_m4[g]);
		buffer_put_u32(out, result->sizes[g]);
	}
	for (uint32_t p = 0; p < result->made.patch_count; p++)
		put_row(out, &result->made.patches[p]);
}

/* Counts come from the file: no more is allocated than it can hold. */
static void *room_for(struct reader *reader, uint32_t count, size_t size, int *rc)
{
	void *room = NULL;

	if (reader->failed || count > reader_left(reader))
		*rc = -EBADMSG;
	if (*rc == 0) {
		room = calloc(count + (size_t)1, size);
		*rc = room ? 0 : -ENOMEM;
	}
	return room;
}

static int get_rows(struct block_result *out, struct reader *reader)
{
	uint32_t groups, patches, first = 0;
	int rc = 0;

	out->other_count = reader_u32(reader);
	groups = reader_u32(reader);
	patches = reader_u32(reader);
	out->others = room_for(reader, out->other_count, sizeof(*out->others), &rc);
	out->made.groups = room_for(reader, groups, sizeof(*out->made.groups), &rc);
	out->losses_m4 = room_for(reader, groups, sizeof(*out->losses_m4), &rc);
	out->sizes = room_for(reader, groups, sizeof(*out->sizes), &rc);
	out->made.patches = room_for(reader, patches, sizeof(*out->made.patches), &rc);
	if (rc < 0)
		return rc;
	out->made.group_count = groups;
	out->made.patch_count = patches;
	for (uint32_t i = 0; i < out->other_count; i++) {
		out->others[i].node = reader_u32(reader);
		out->others[i].number = reader_u32(reader);
	}
	for (uint32_t g = 0; g < groups; g++) {
		get_group(&out->made.groups[g], reader);
		out->made.groups[g].first_patch = first;
		first += out->made.groups[g].patch_count;
		out->losses_m4[g] = reader_f32(reader);
		out->sizes[g] = reader_u32(reader);
	}
	for (uint32_t p = 0; p < patches; p++)
		get_row(&out->made.patches[p], reader);
	return first == patches ? 0 : -EBADMSG;
}

/* ---- what people are told */

static void put_report(struct buffer *out, const struct block_result *result)
{
	const struct lattice_counts *counts = &result->counts;

	buffer_put_u32(out, counts->merged_vertices);
	buffer_put_u32(out, counts->degenerate_triangles);
	buffer_put_u32(out, counts->duplicate_triangles);
	buffer_put_u32(out, counts->border_edges);
	buffer_put_u32(out, counts->crowded_edges);
	buffer_put_u64(out, result->stats.object_bytes);
	buffer_put_u64(out, result->stats.vertex_count);
	buffer_put_u32(out, result->stats.level_count);
	for (uint32_t l = 0; l < result->stats.level_count; l++) {
		buffer_put_u64(out, result->stats.levels[l].triangle_count);
		buffer_put_u32(out, result->stats.levels[l].patch_count);
		buffer_put_u32(out, result->stats.levels[l].group_count);
	}
}

static int get_report(struct block_result *out, struct reader *reader)
{
	struct lattice_counts *counts = &out->counts;

	counts->merged_vertices = reader_u32(reader);
	counts->degenerate_triangles = reader_u32(reader);
	counts->duplicate_triangles = reader_u32(reader);
	counts->border_edges = reader_u32(reader);
	counts->crowded_edges = reader_u32(reader);
	out->stats.object_bytes = reader_u64(reader);
	out->stats.vertex_count = reader_u64(reader);
	out->stats.level_count = reader_u32(reader);
	if (out->stats.level_count > MULTIRES_LEVELS_MAX)
		return -EBADMSG;
	for (uint32_t l = 0; l < out->stats.level_count; l++) {
		out->stats.levels[l].triangle_count = reader_u64(reader);
		out->stats.levels[l].patch_count = reader_u32(reader);
		out->stats.levels[l].group_count = reader_u32(reader);
	}
	return 0;
}

/* ---- what is left */

static void put_left(struct buffer *out, const struct block_result *result)
{
	buffer_put_u32(out, result->vertex_count);
	for (uint32_t v = 0; v < result->vertex_count; v++) {
		lattice_vertex_put(out, &result->vertices[v]);
		buffer_put_u32(out, result->borders[v]);
	}
	buffer_put_u32(out, result->left.count);
	for (uint32_t p = 0; p < result->left.count; p++) {
		const struct live_patch *patch = &result->left.items[p];

		buffer_put_u32(out, patch->triangle_count);
		buffer_put_u32(out, patch->finer);
		buffer_put_f64(out, patch->error_m);
		buffer_put_f64(out, patch->loss_m4);
		for (int i = 0; i < 3; i++)
			buffer_put_f64(out, patch->finer_sphere.centre[i]);
		buffer_put_f64(out, patch->finer_sphere.radius);
		for (int i = 0; i < 3; i++)
			buffer_put_f32(out, patch->centre[i]);
		for (uint32_t t = 0; t < patch->triangle_count; t++)
			for (int corner = 0; corner < 3; corner++)
				buffer_put_u32(out, patch->triangles[t][corner]);
	}
}

static int get_patch(struct block_result *out, struct reader *reader)
{
	struct live_patch patch = { .triangles = NULL };
	int rc = 0;

	patch.triangle_count = reader_u32(reader);
	patch.finer = reader_u32(reader);
	patch.error_m = reader_f64(reader);
	patch.loss_m4 = reader_f64(reader);
	for (int i = 0; i < 3; i++)
		patch.finer_sphere.centre[i] = reader_f64(reader);
	patch.finer_sphere.radius = reader_f64(reader);
	for (int i = 0; i < 3; i++)
		patch.centre[i] = reader_f32(reader);
	patch.triangles = room_for(reader, patch.triangle_count, sizeof(*patch.triangles), &rc);
	for (uint32_t t = 0; rc == 0 && t < patch.triangle_count; t++)
		for (int corner = 0; corner < 3; corner++) {
			uint32_t vertex = reader_u32(reader);

			if (vertex >= out->vertex_count)
				rc = -EBADMSG;
			patch.triangles[t][corner] = vertex;
		}
	if (rc == 0)
		return live_patches_add(&out->left, patch);
	live_patch_finish(&patch);
	return rc;
}

static int get_left(struct block_result *out, struct reader *reader)
{
	uint32_t count;
	int rc = 0;

	out->vertex_count = reader_u32(reader);
	out->vertices = room_for(reader, out->vertex_count, sizeof(*out->vertices), &rc);
	out->borders = room_for(reader, out->vertex_count, sizeof(*out->borders), &rc);
	for (uint32_t v = 0; rc == 0 && v < out->vertex_count; v++) {
		lattice_vertex_get(&out->vertices[v], reader);
		out->borders[v] = reader_u32(reader);
	}
	count = reader_u32(reader);
	for (uint32_t p = 0; rc == 0 && p < count && !reader->failed; p++)
		rc = get_patch(out, reader);
	return rc;
}

/* ---- the file */

int block_result_write(const struct block_result *result, const char *folder, uint32_t node)
{
	char path[PATH_MAX];
	struct buffer file;
	int rc = result_path(path, folder, node);

	buffer_init(&file, SIZE_MAX);
	put_rows(&file, result);
	put_report(&file, result);
	put_left(&file, result);
	buffer_put_u64(&file, result->objects.size);
	buffer_put(&file, result->objects.data, result->objects.size);
	if (rc == 0)
		rc = file.error;
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&file), path);
	buffer_finish(&file);
	return rc;
}

int block_result_read(struct block_result *out, const char *folder, uint32_t node)
{
	char path[PATH_MAX];
	struct buffer file;
	struct reader reader;
	int rc = result_path(path, folder, node);

	block_result_init(out);
	buffer_init(&file, SIZE_MAX);
	if (rc == 0)
		rc = buffer_read_file(&file, path);
	reader_init(&reader, buffer_bytes(&file));
	if (rc == 0)
		rc = get_rows(out, &reader);
	if (rc == 0)
		rc = get_report(out, &reader);
	if (rc == 0)
		rc = get_left(out, &reader);
	if (rc == 0) {
		size_t size = (size_t)reader_u64(&reader);
		struct bytes objects = reader_bytes(&reader, size);

		buffer_put(&out->objects, objects.data, objects.size);
		rc = out->objects.error;
	}
	if (rc == 0 && (reader.failed || reader_left(&reader) > 0))
		rc = -EBADMSG;
	buffer_finish(&file);
	return rc;
}
