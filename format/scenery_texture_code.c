/* Encodes and decodes the pictures of scenery. */
#include "format/scenery_texture_code.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "format/picture.h"

enum {
	TEXTURE_BYTES = 2 + 2 + 1 + 4 + 1, /* at least */
	UV_BYTES = 4,
};

static void put_uvs(struct buffer *out, const struct scenery_mesh *mesh)
{
	for (int k = 0; k < 2; k++) {
		buffer_put_f32(out, mesh->uv_origin[k]);
		buffer_put_f32(out, mesh->uv_step[k]);
		for (uint32_t v = 0; v < mesh->vertex_count; v++)
			buffer_put_u16(out, mesh->uvs[v][k]);
	}
}

static int get_uvs(struct reader *in, struct scenery_mesh *mesh)
{
	if ((uint64_t)mesh->vertex_count * UV_BYTES > reader_left(in))
		return -EBADMSG;
	mesh->uvs = calloc((size_t)mesh->vertex_count + 1, sizeof(*mesh->uvs));
	if (!mesh->uvs)
		return -ENOMEM;
	for (int k = 0; k < 2; k++) {
		mesh->uv_origin[k] = reader_f32(in);
		mesh->uv_step[k] = reader_f32(in);
		for (uint32_t v = 0; v < mesh->vertex_count; v++)
			mesh->uvs[v][k] = reader_u16(in);
	}
	return 0;
}

static void put_texture(struct buffer *out, const struct scenery_texture *texture)
{
	buffer_put_u16(out, texture->width);
	buffer_put_u16(out, texture->height);
	buffer_put_u8(out, texture->repeats);
	buffer_put_u32(out, texture->jpeg_bytes);
	buffer_put(out, texture->jpeg, texture->jpeg_bytes);
}

static int get_texture(struct reader *in, struct scenery_texture *texture)
{
	struct bytes jpeg;
	uint8_t repeats;

	texture->width = reader_u16(in);
	texture->height = reader_u16(in);
	repeats = reader_u8(in);
	texture->repeats = repeats;
	texture->jpeg_bytes = reader_u32(in);
	if (in->failed || repeats > 1 || texture->jpeg_bytes == 0 ||
	    texture->jpeg_bytes > reader_left(in))
		return -EBADMSG;
	jpeg = reader_bytes(in, texture->jpeg_bytes);
	texture->jpeg = malloc(jpeg.size + 1);
	if (!texture->jpeg)
		return -ENOMEM;
	memcpy(texture->jpeg, jpeg.data, jpeg.size);
	return 0;
}

void scenery_put_textures(struct buffer *out, const struct scenery *scenery, bool has_normals)
{
	buffer_put_u32(out, scenery->texture_count);
	for (uint32_t i = 0; i < scenery->texture_count; i++)
		put_texture(out, &scenery->textures[i]);
	for (uint32_t i = 0; i < scenery->material_count; i++)
		buffer_put_u16(out, scenery->materials[i].texture);
	for (uint32_t i = 0; i < scenery->material_count && has_normals; i++)
		buffer_put_u16(out, scenery->materials[i].normals);
	for (uint32_t i = 0; i < scenery->mesh_count; i++)
		if (scenery_is_painted(&scenery->materials[scenery->meshes[i].material]))
			put_uvs(out, &scenery->meshes[i]);
}

int scenery_get_textures(struct reader *in, struct scenery *scenery, bool has_normals)
{
	const uint32_t count = reader_u32(in);
	int rc = 0;

	if (in->failed || count > SCENERY_TEXTURES_MAX || count > reader_left(in) / TEXTURE_BYTES)
		return -EBADMSG;
	scenery->textures = calloc(count + 1, sizeof(*scenery->textures));
	if (!scenery->textures)
		return -ENOMEM;
	scenery->texture_count = count;
	for (uint32_t i = 0; i < count && rc == 0; i++)
		rc = get_texture(in, &scenery->textures[i]);
	for (uint32_t i = 0; i < scenery->material_count; i++)
		scenery->materials[i].texture = reader_u16(in);
	for (uint32_t i = 0; i < scenery->material_count && has_normals; i++)
		scenery->materials[i].normals = reader_u16(in);
	for (uint32_t i = 0; i < scenery->mesh_count && rc == 0; i++) {
		struct scenery_mesh *mesh = &scenery->meshes[i];

		if (mesh->material >= scenery->material_count)
			rc = -EBADMSG;
		else if (scenery_is_painted(&scenery->materials[mesh->material]))
			rc = get_uvs(in, mesh);
	}
	return rc;
}

int scenery_decode_textures(struct scenery *scenery)
{
	for (uint32_t i = 0; i < scenery->texture_count; i++) {
		struct scenery_texture *texture = &scenery->textures[i];
		struct picture picture;
		int rc = picture_decode_for_page(
			&picture, (struct bytes){ texture->jpeg, texture->jpeg_bytes });

		if (rc == 0 &&
		    (picture.width != texture->width || picture.height != texture->height)) {
			picture_finish(&picture);
			rc = -EBADMSG;
		}
		if (rc < 0)
			return rc == -ENOMEM ? rc : -EBADMSG;
		free(texture->rgba);
		texture->rgba = picture.rgba; /* taken */
	}
	return 0;
}
