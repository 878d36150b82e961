/* Encodes and decodes the files of a node. They stay on this machine and are removed when the
 * master is complete. */
#include "pipeline/hierarchy/block_node.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { USE_BYTES = 12, TOUCH_BYTES = 12 /* in a digest */ };

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
	block_result_init(result);
}

void block_left_finish(struct block_left *left)
{
	if (!left)
		return;
	live_patches_finish(&left->patches);
	free(left->vertices);
	free(left->keys);
	*left = (struct block_left){ 0 };
}

void block_digest_finish(struct block_digest *digest)
{
	if (!digest)
		return;
	free(digest->patches);
	free(digest->uses);
	free(digest->touches);
	*digest = (struct block_digest){ 0 };
}

static int node_path(char out[PATH_MAX], const char *folder, const char *kind, uint32_t node)
{
	return snprintf(out, PATH_MAX, "%s/%s-%u", folder, kind, node) < PATH_MAX ? 0
										  : -ENAMETOOLONG;
}

bool block_node_exists(const char *folder, uint32_t node)
{
	static const char *const kinds[] = { "digest", "left", "node" };
	char path[PATH_MAX];

	for (size_t i = 0; i < ARRAY_COUNT(kinds); i++)
		if (node_path(path, folder, kinds[i], node) < 0 || access(path, F_OK) < 0)
			return false;
	return true;
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
		hierarchy_patch_put(out, &result->made.patches[p]);
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
		hierarchy_patch_get(&out->made.patches[p], reader);
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

static void put_left(struct buffer *out, const struct block_left *left)
{
	buffer_put_u32(out, left->vertex_count);
	for (uint32_t v = 0; v < left->vertex_count; v++) {
		lattice_vertex_put(out, &left->vertices[v]);
		buffer_put_u64(out, left->keys[v]);
	}
	buffer_put_u32(out, left->patches.count);
	for (uint32_t p = 0; p < left->patches.count; p++) {
		const struct live_patch *patch = &left->patches.items[p];

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

static int get_patch(struct block_left *out, struct reader *reader)
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
		return live_patches_add(&out->patches, patch);
	live_patch_finish(&patch);
	return rc;
}

static int get_left(void *to, struct reader *reader)
{
	struct block_left *out = to;
	uint32_t count;
	int rc = 0;

	out->vertex_count = reader_u32(reader);
	out->vertices = room_for(reader, out->vertex_count, sizeof(*out->vertices), &rc);
	out->keys = room_for(reader, out->vertex_count, sizeof(*out->keys), &rc);
	for (uint32_t v = 0; rc == 0 && v < out->vertex_count; v++) {
		lattice_vertex_get(&out->vertices[v], reader);
		out->keys[v] = reader_u64(reader);
	}
	count = reader_u32(reader);
	for (uint32_t p = 0; rc == 0 && p < count && !reader->failed; p++)
		rc = get_patch(out, reader);
	return rc;
}

/* ---- its digest */

/* Passes each vertex on from patch to patch: notes the passes, and the vertices with a key. */
static int put_uses(struct buffer *uses, struct buffer *passes, const struct block_left *left)
{
	uint32_t *last = malloc((left->vertex_count + (size_t)1) * sizeof(*last));

	if (!last)
		return -ENOMEM;
	memset(last, 0xff, left->vertex_count * sizeof(*last));
	for (uint32_t p = 0; p < left->patches.count; p++) {
		const struct live_patch *patch = &left->patches.items[p];

		for (uint32_t c = 0; c < 3 * patch->triangle_count; c++) {
			uint32_t vertex = patch->triangles[c / 3][c % 3];
			uint64_t pass = (uint64_t)last[vertex] << 32 | p;

			if (last[vertex] == p)
				continue;
			if (last[vertex] != NO_GROUP)
				buffer_put(passes, &pass, sizeof(pass));
			last[vertex] = p;
			if (left->keys[vertex] == BLOCK_NO_KEY)
				continue;
			buffer_put_u32(uses, p);
			buffer_put_u64(uses, left->keys[vertex]);
		}
	}
	free(last);
	return uses->error ? uses->error : passes->error;
}

static int compare_passes(const void *left, const void *right)
{
	uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;

	return a < b ? -1 : a > b;
}

static void put_touches(struct buffer *out, struct buffer *passes)
{
	uint64_t *items = (uint64_t *)(void *)passes->data;
	size_t count = passes->size / sizeof(*items);

	if (count > 0)
		qsort(items, count, sizeof(*items), compare_passes);
	for (size_t i = 0, end; i < count; i = end) {
		for (end = i + 1; end < count && items[end] == items[i]; end++)
			;
		buffer_put_u32(out, (uint32_t)(items[i] >> 32));
		buffer_put_u32(out, (uint32_t)items[i]);
		buffer_put_u32(out, (uint32_t)(end - i));
	}
}

static int put_digest(struct buffer *out, const struct block_left *left)
{
	struct buffer uses, passes;
	int rc;

	buffer_put_u32(out, left->patches.count);
	for (uint32_t p = 0; p < left->patches.count; p++) {
		buffer_put_u32(out, left->patches.items[p].triangle_count);
		for (int i = 0; i < 3; i++)
			buffer_put_f32(out, left->patches.items[p].centre[i]);
	}
	buffer_init(&uses, SIZE_MAX);
	buffer_init(&passes, SIZE_MAX);
	rc = put_uses(&uses, &passes, left);
	buffer_put_u32(out, (uint32_t)(uses.size / USE_BYTES));
	buffer_put(out, uses.data, uses.size);
	put_touches(out, &passes);
	buffer_finish(&uses);
	buffer_finish(&passes);
	return rc;
}

static int get_digest(void *to, struct reader *reader)
{
	struct block_digest *out = to;
	uint32_t patches = reader_u32(reader);
	int rc = 0;

	out->patches = room_for(reader, patches, sizeof(*out->patches), &rc);
	for (uint32_t p = 0; rc == 0 && p < patches; p++) {
		out->patches[p].triangle_count = reader_u32(reader);
		for (int i = 0; i < 3; i++)
			out->patches[p].centre[i] = reader_f32(reader);
	}
	out->patch_count = rc == 0 ? patches : 0;
	out->use_count = reader_u32(reader);
	if (rc == 0)
		out->uses = room_for(reader, out->use_count, sizeof(*out->uses), &rc);
	for (uint32_t u = 0; rc == 0 && u < out->use_count; u++) {
		out->uses[u].patch = reader_u32(reader);
		out->uses[u].key = reader_u64(reader);
		if (out->uses[u].patch >= patches)
			rc = -EBADMSG;
	}
	out->touch_count = (uint32_t)(reader_left(reader) / TOUCH_BYTES);
	if (rc == 0)
		out->touches = room_for(reader, out->touch_count, sizeof(*out->touches), &rc);
	for (uint32_t t = 0; rc == 0 && t < out->touch_count; t++) {
		out->touches[t].a = reader_u32(reader);
		out->touches[t].b = reader_u32(reader);
		out->touches[t].count = reader_u32(reader);
		if (out->touches[t].a >= patches || out->touches[t].b >= patches)
			rc = -EBADMSG;
	}
	return rc;
}

/* ---- the files */

/* Writes a file if rc is 0. One that is there stays: it holds the same, and another machine may be
 * reading it. */
static int write_file(struct buffer *file, const char *folder, const char *kind, uint32_t node,
		      int rc)
{
	char path[PATH_MAX];

	if (rc == 0)
		rc = node_path(path, folder, kind, node);
	if (rc == 0)
		rc = file->error;
	if (rc == 0)
		rc = access(path, F_OK) == 0 ? 0 : bytes_write_file(buffer_bytes(file), path);
	buffer_clear(file);
	return rc;
}

int block_node_write(const struct block_result *result, const struct block_left *left,
		     const char *folder, uint32_t node)
{
	struct buffer file;
	int rc;

	buffer_init(&file, SIZE_MAX);
	rc = write_file(&file, folder, "digest", node, put_digest(&file, left));
	put_left(&file, left);
	rc = write_file(&file, folder, "left", node, rc);
	put_rows(&file, result);
	put_report(&file, result);
	buffer_put_u64(&file, result->objects.size);
	buffer_put(&file, result->objects.data, result->objects.size);
	rc = write_file(&file, folder, "node", node, rc);
	buffer_finish(&file);
	return rc;
}

static int read_file(void *out, const char *folder, const char *kind, uint32_t node,
		     int (*get)(void *out, struct reader *reader))
{
	char path[PATH_MAX];
	struct buffer file;
	struct reader reader;
	int rc = node_path(path, folder, kind, node);

	buffer_init(&file, SIZE_MAX);
	if (rc == 0)
		rc = buffer_read_file(&file, path);
	reader_init(&reader, buffer_bytes(&file));
	if (rc == 0)
		rc = get(out, &reader);
	if (rc == 0 && (reader.failed || reader_left(&reader) > 0))
		rc = -EBADMSG;
	buffer_finish(&file);
	return rc;
}

static int get_result(void *to, struct reader *reader)
{
	struct block_result *out = to;
	struct bytes objects;
	int rc = get_rows(out, reader);

	if (rc == 0)
		rc = get_report(out, reader);
	if (rc < 0)
		return rc;
	objects.size = (size_t)reader_u64(reader);
	objects = reader_bytes(reader, objects.size);
	buffer_put(&out->objects, objects.data, objects.size);
	return out->objects.error;
}

int block_result_read(struct block_result *out, const char *folder, uint32_t node)
{
	block_result_init(out);
	return read_file(out, folder, "node", node, get_result);
}

int block_left_read(struct block_left *out, const char *folder, uint32_t node)
{
	*out = (struct block_left){ 0 };
	return read_file(out, folder, "left", node, get_left);
}

int block_digest_read(struct block_digest *out, const char *folder, uint32_t node)
{
	*out = (struct block_digest){ 0 };
	return read_file(out, folder, "digest", node, get_digest);
}
