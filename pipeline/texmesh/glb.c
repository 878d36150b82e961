/* The description is JSON, the rest one buffer: indices, places, normals, texture coordinates,
 * colours, pictures. */
#include "pipeline/texmesh/glb.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/srgb.h"
#include "geometry/vec.h"

/* Types of components, targets of buffers, and modes of textures, by GL's numbers. */
enum {
	UNSIGNED_SHORT = 5123,
	UNSIGNED_INT = 5125,
	FLOAT = 5126,
	ARRAY_BUFFER = 34962,
	ELEMENT_ARRAY_BUFFER = 34963,
	CLAMP_TO_EDGE = 33071,
	REPEAT = 10497,
};

enum { GLB_MAGIC = 0x46546c67, GLB_VERSION = 2, CHUNK_JSON = 0x4e4f534a, CHUNK_BIN = 0x004e4942 };

/* What the functions that write a file share. */
struct writer {
	const struct reduced_mesh *mesh;
	const struct glb_options *options;
	bool uvs_fit; /* all texture coordinates are in 0..1 */
	struct buffer json, views, accessors;
	uint64_t at; /* bytes of the buffer so far */
	uint32_t view_count, accessor_count;
};

static bool has_small_indices(const struct reduced_mesh *mesh)
{
	/* 65535 would restart a strip */
	return mesh->vertex_count < UINT16_MAX;
}

static bool do_uvs_fit(const struct reduced_mesh *mesh)
{
	for (uint32_t i = 0; mesh->uvs && i < mesh->vertex_count; i++)
		for (int k = 0; k < 2; k++)
			if (!(mesh->uvs[i][k] >= 0 && mesh->uvs[i][k] <= 1))
				return false;
	return true;
}

static uint64_t padded(uint64_t bytes)
{
	return (bytes + 3) & ~(uint64_t)3;
}

static uint64_t index_bytes(const struct reduced_mesh *mesh, uint32_t material)
{
	const uint64_t triangles = mesh->firsts[material + 1] - mesh->firsts[material];

	return 3 * triangles * (has_small_indices(mesh) ? 2 : 4);
}

uint64_t glb_mesh_bytes(const struct reduced_mesh *mesh, bool lit)
{
	const uint64_t a_vertex =
		12 + (lit ? 12 : 0) + (mesh->uvs ? 8 : 0) + (mesh->colours ? 8 : 0);
	uint64_t indices = 0;

	for (uint32_t m = 0; m < mesh->material_count; m++)
		indices += padded(index_bytes(mesh, m));
	return a_vertex * mesh->vertex_count + indices;
}

/* ---- the description */

/* Adds a part of the buffer; target 0: a picture. */
static void add_view(struct writer *w, uint64_t bytes, int target)
{
	buffer_print(&w->views, "%s{\"buffer\":0,\"byteOffset\":%llu,\"byteLength\":%llu",
		     w->view_count ? "," : "", (unsigned long long)w->at,
		     (unsigned long long)bytes);
	if (target)
		buffer_print(&w->views, ",\"target\":%d", target);
	buffer_put_text(&w->views, "}");
	w->at += padded(bytes);
	w->view_count++;
}

/* Adds a view of its own and an array in it; more: further members, each after a comma. Returns its
 * number. */
static uint32_t add_array(struct writer *w, uint64_t bytes, int component, uint32_t count,
			  const char *type, const char *more)
{
	add_view(w, bytes, strcmp(type, "SCALAR") == 0 ? ELEMENT_ARRAY_BUFFER : ARRAY_BUFFER);
	buffer_print(&w->accessors,
		     "%s{\"bufferView\":%u,\"componentType\":%d,\"count\":%u,\"type\":\"%s\"%s}",
		     w->accessor_count ? "," : "", w->view_count - 1, component, count, type, more);
	return w->accessor_count++;
}

static void add_attributes(struct writer *w, struct buffer *out)
{
	const struct reduced_mesh *mesh = w->mesh;
	const uint32_t count = mesh->vertex_count;
	float low[3], high[3];
	char limits[240];

	vec_copy(low, mesh->positions[0]);
	vec_copy(high, mesh->positions[0]);
	for (uint32_t i = 1; i < count; i++)
		for (int k = 0; k < 3; k++) {
			low[k] = vec_least(low[k], mesh->positions[i][k]);
			high[k] = vec_most(high[k], mesh->positions[i][k]);
		}
	snprintf(limits, sizeof(limits), ",\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]",
		 (double)low[0], (double)low[1], (double)low[2], (double)high[0], (double)high[1],
		 (double)high[2]);
	buffer_print(out, "\"POSITION\":%u",
		     add_array(w, 12ull * count, FLOAT, count, "VEC3", limits));
	if (w->options->lit)
		buffer_print(out, ",\"NORMAL\":%u",
			     add_array(w, 12ull * count, FLOAT, count, "VEC3", ""));
	if (mesh->uvs)
		buffer_print(out, ",\"TEXCOORD_0\":%u",
			     add_array(w, 8ull * count, FLOAT, count, "VEC2", ""));
	if (mesh->colours)
		buffer_print(out, ",\"COLOR_0\":%u",
			     add_array(w, 8ull * count, UNSIGNED_SHORT, count, "VEC4",
				       ",\"normalized\":true"));
}

static void add_primitives(struct writer *w)
{
	const struct reduced_mesh *mesh = w->mesh;
	const int component = has_small_indices(mesh) ? UNSIGNED_SHORT : UNSIGNED_INT;
	struct buffer attributes;
	bool is_first = true;

	buffer_init(&attributes, 1 << 16);
	add_attributes(w, &attributes);
	for (uint32_t m = 0; m < mesh->material_count; m++) {
		const uint32_t corners = 3 * (mesh->firsts[m + 1] - mesh->firsts[m]);

		if (corners == 0)
			continue;
		buffer_print(&w->json, "%s{\"attributes\":{%.*s},\"material\":%u,\"indices\":%u}",
			     is_first ? "" : ",", (int)attributes.size,
			     (const char *)attributes.data, m,
			     add_array(w, index_bytes(mesh, m), component, corners, "SCALAR", ""));
		is_first = false;
	}
	w->json.error = w->json.error ? w->json.error : attributes.error;
	buffer_finish(&attributes);
}

static float linear(uint8_t srgb)
{
	return srgb_to_light((float)srgb / 255);
}

static void add_materials(struct writer *w)
{
	struct buffer *json = &w->json;
	uint32_t pictures = 0;

	buffer_put_text(json, "],\"materials\":[");
	for (uint32_t m = 0; m < w->mesh->material_count; m++) {
		const struct glb_material *material = &w->options->materials[m];
		const uint8_t *rgb = material->rgb;

		buffer_print(json,
			     "%s{\"doubleSided\":true,\"pbrMetallicRoughness\":{"
			     "\"metallicFactor\":0,\"roughnessFactor\":1,",
			     m ? "," : "");
		if (material->jpeg.size > 0)
			buffer_print(json, "\"baseColorTexture\":{\"index\":%u}}", pictures++);
		else
			buffer_print(json, "\"baseColorFactor\":[%.4g,%.4g,%.4g,1]}",
				     linear(rgb[0]), linear(rgb[1]), linear(rgb[2]));
		buffer_put_text(json, w->options->lit
					      ? "}"
					      : ",\"extensions\":{\"KHR_materials_unlit\":{}}}");
	}
	buffer_put_text(json, "]");
}

static void add_pictures(struct writer *w)
{
	const int wrap = w->uvs_fit ? CLAMP_TO_EDGE : REPEAT;
	struct buffer textures;
	uint32_t count = 0;

	buffer_init(&textures, 16 << 20);
	for (uint32_t m = 0; m < w->mesh->material_count; m++) {
		const struct bytes jpeg = w->options->materials[m].jpeg;

		if (jpeg.size == 0)
			continue;
		add_view(w, jpeg.size, 0);
		buffer_print(&w->json, "%s{\"mimeType\":\"image/jpeg\",\"bufferView\":%u}",
			     count ? "," : ",\"images\":[", w->view_count - 1);
		buffer_print(&textures, "%s{\"sampler\":0,\"source\":%u}", count ? "," : "", count);
		count++;
	}
	if (count > 0)
		buffer_print(&w->json,
			     "],\"samplers\":[{\"wrapS\":%d,\"wrapT\":%d}],\"textures\":[%.*s]",
			     wrap, wrap, (int)textures.size, (const char *)textures.data);
	w->json.error = w->json.error ? w->json.error : textures.error;
	buffer_finish(&textures);
}

/* The node turns z up into y up. */
static int describe(struct writer *w)
{
	struct buffer *json = &w->json;

	buffer_print(json,
		     "{\"asset\":{\"version\":\"2.0\",\"generator\":\"gopura-content\"},%s"
		     "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,"
		     "\"rotation\":[-0.70710678,0,0,0.70710678]}],"
		     "\"meshes\":[{\"primitives\":[",
		     w->options->lit ? "" : "\"extensionsUsed\":[\"KHR_materials_unlit\"],");
	add_primitives(w);
	buffer_put_text(json, "]}");
	add_materials(w);
	add_pictures(w);
	buffer_print(json, ",\"accessors\":[%.*s],\"bufferViews\":[%.*s]", (int)w->accessors.size,
		     (const char *)w->accessors.data, (int)w->views.size,
		     (const char *)w->views.data);
	buffer_print(json, ",\"buffers\":[{\"byteLength\":%llu}]}", (unsigned long long)w->at);
	while (json->error == 0 && json->size % 4 != 0)
		buffer_put_u8(json, ' ');
	if (json->error || w->views.error || w->accessors.error)
		return json->error ? json->error : -ENOMEM;
	return 0;
}

/* ---- the buffer, in the order of the views */

static void pad(struct buffer *out, size_t begin)
{
	while (out->error == 0 && (out->size - begin) % 4 != 0)
		buffer_put_u8(out, 0);
}

static uint16_t share_16(float value)
{
	return (uint16_t)lroundf(value * UINT16_MAX);
}

static void put_attributes(struct buffer *out, const struct writer *w)
{
	const struct reduced_mesh *mesh = w->mesh;
	const uint32_t count = mesh->vertex_count;

	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++)
			buffer_put_f32(out, mesh->positions[i][k]);
	for (uint32_t i = 0; w->options->lit && i < count; i++)
		for (int k = 0; k < 3; k++)
			buffer_put_f32(out, mesh->normals[i][k]);
	for (uint32_t i = 0; mesh->uvs && i < count; i++) {
		buffer_put_f32(out, mesh->uvs[i][0]);
		buffer_put_f32(out, 1 - mesh->uvs[i][1]);
	}
	for (uint32_t i = 0; mesh->colours && i < count; i++) {
		for (int k = 0; k < 3; k++)
			buffer_put_u16(out, share_16(linear(mesh->colours[i][k])));
		buffer_put_u16(out, UINT16_MAX);
	}
}

static void put_indices(struct buffer *out, const struct reduced_mesh *mesh, uint32_t material)
{
	for (uint32_t i = mesh->firsts[material]; i < mesh->firsts[material + 1]; i++)
		for (int k = 0; k < 3; k++)
			if (has_small_indices(mesh))
				buffer_put_u16(out, (uint16_t)mesh->triangles[i][k]);
			else
				buffer_put_u32(out, mesh->triangles[i][k]);
}

static void put_buffer(struct buffer *out, const struct writer *w)
{
	const size_t begin = out->size;

	put_attributes(out, w);
	for (uint32_t m = 0; m < w->mesh->material_count; m++) {
		put_indices(out, w->mesh, m);
		pad(out, begin);
	}
	for (uint32_t m = 0; m < w->mesh->material_count; m++) {
		const struct bytes jpeg = w->options->materials[m].jpeg;

		buffer_put(out, jpeg.data, jpeg.size);
		pad(out, begin);
	}
}

int glb_write(struct buffer *out, const struct reduced_mesh *mesh,
	      const struct glb_options *options)
{
	struct writer w = { .mesh = mesh, .options = options, .uvs_fit = do_uvs_fit(mesh) };
	int rc;

	buffer_init(&w.json, 64 << 20);
	buffer_init(&w.views, 16 << 20);
	buffer_init(&w.accessors, 16 << 20);
	rc = describe(&w);
	if (rc == 0 && 28 + w.json.size + w.at > UINT32_MAX)
		rc = -EFBIG;
	if (rc == 0) {
		buffer_put_u32(out, GLB_MAGIC);
		buffer_put_u32(out, GLB_VERSION);
		buffer_put_u32(out, (uint32_t)(28 + w.json.size + w.at));
		buffer_put_u32(out, (uint32_t)w.json.size);
		buffer_put_u32(out, CHUNK_JSON);
		buffer_put(out, w.json.data, w.json.size);
		buffer_put_u32(out, (uint32_t)w.at);
		buffer_put_u32(out, CHUNK_BIN);
		put_buffer(out, &w);
		rc = out->error;
	}
	buffer_finish(&w.json);
	buffer_finish(&w.views);
	buffer_finish(&w.accessors);
	return rc;
}
