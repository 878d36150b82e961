/* Any bytes as a patch group: refused, or a group that encodes and decodes to itself. And any
 * triangles as patches: they encode, and decode to as many. */
#include "format/patch.h"

#include <stdlib.h>

#include "tests/fuzz/repack.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_round_trip(const struct patch_mesh *patches, uint32_t patch_count)
{
	struct patch_mesh back[GROUP_PATCHES_MAX];
	struct buffer object;
	uint32_t count;

	buffer_init(&object, 64 << 20);
	if (patch_group_encode(&object, patches, patch_count) < 0 ||
	    patch_group_decode(back, &count, buffer_bytes(&object)) < 0 || count != patch_count)
		abort();
	for (uint32_t p = 0; p < count; p++) {
		if (back[p].vertex_count != patches[p].vertex_count ||
		    back[p].triangle_count != patches[p].triangle_count)
			abort();
		patch_mesh_finish(&back[p]);
	}
	buffer_finish(&object);
}

static void decode(struct bytes object)
{
	struct patch_mesh patches[GROUP_PATCHES_MAX];
	uint32_t patch_count;

	if (patch_group_decode(patches, &patch_count, object) < 0)
		return;
	check_round_trip(patches, patch_count);
	for (uint32_t p = 0; p < patch_count; p++)
		patch_mesh_finish(&patches[p]);
}

/* Counts of vertices and triangles, then for each vertex its place and the rest from two bytes, so
 * that patches easily share some, then the corners of the triangles. shift is that of places. */
static struct patch_mesh read_mesh(struct reader *in, int shift)
{
	struct patch_mesh mesh = { .vertex_count = 1u + reader_u8(in),
				   .triangle_count = 1u + reader_u8(in) };

	mesh.vertices = calloc(mesh.vertex_count, sizeof(*mesh.vertices));
	mesh.indices = calloc(3 * mesh.triangle_count, sizeof(*mesh.indices));
	if (!mesh.vertices || !mesh.indices)
		abort();
	for (uint32_t v = 0; v < mesh.vertex_count; v++) {
		struct patch_vertex *vertex = &mesh.vertices[v];
		const uint8_t place = reader_u8(in), rest = reader_u8(in);

		for (int i = 0; i < 3; i++)
			vertex->position[i] = (place << 8 >> 3 * i) << shift;
		for (int i = 0; i < 4; i++)
			vertex->colour[i] = (uint8_t)(rest << i);
		vertex->normal[0] = (int8_t)rest;
		vertex->normal[1] = (int8_t)(place ^ rest);
	}
	for (uint32_t i = 0; i < 3 * mesh.triangle_count; i++)
		mesh.indices[i] = (uint16_t)(reader_u8(in) % mesh.vertex_count);
	return mesh;
}

/* 'R', the number of patches beside the shift of places, and what read_mesh reads for each. */
static void encode(struct bytes bytes)
{
	struct patch_mesh patches[4];
	struct reader in;
	uint32_t patch_count;
	uint8_t first;

	reader_init(&in, bytes);
	first = reader_u8(&in);
	patch_count = 1 + first % 4u;
	for (uint32_t p = 0; p < patch_count; p++)
		patches[p] = read_mesh(&in, first / 4 % 9);
	check_round_trip(patches, patch_count);
	for (uint32_t p = 0; p < patch_count; p++)
		patch_mesh_finish(&patches[p]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (repack_is_raw(data, size))
		encode((struct bytes){ data + 1, size - 1 });
	else
		decode((struct bytes){ data, size });
	return 0;
}
