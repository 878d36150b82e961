/* Writes OBJ files. Each triangle names its material only where that changes. */
#include "pipeline/deform/mesh_obj.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/chunk_file.h"
#include "base/spill.h"
#include "format/picture.h"

enum { PNG_BYTES_MAX = 1 << 30 };

/* Returns the length of a path without its ".obj"; -EINVAL. */
static int stem_of(const char *path)
{
	const size_t length = strlen(path);

	if (length <= 4 || strcmp(path + length - 4, ".obj") != 0)
		return -EINVAL;
	return length + 16 < BYTES_PATH_MAX ? (int)length - 4 : -ENAMETOOLONG;
}

/* The name of a file in its folder. */
static const char *name_in(const char *path)
{
	const char *slash = strrchr(path, '/');

	return slash ? slash + 1 : path;
}

/* ---- pictures and materials */

static int write_picture(const struct mesh_texture *texture, const char *path)
{
	const size_t pixels = (size_t)texture->width * texture->height;
	struct picture picture = { texture->width, texture->height, malloc(4 * pixels + 1) };
	struct buffer png;
	int rc;

	if (!picture.rgba)
		return -ENOMEM;
	for (size_t i = 0; i < pixels; i++) {
		memcpy(&picture.rgba[4 * i], &texture->rgb[3 * i], 3);
		picture.rgba[4 * i + 3] = 255;
	}
	buffer_init(&png, PNG_BYTES_MAX);
	rc = picture_encode_png(&png, &picture);
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&png), path);
	buffer_finish(&png);
	picture_finish(&picture);
	return rc;
}

static int write_materials(const struct mesh *mesh, const char *path, int stem)
{
	char name[BYTES_PATH_MAX];
	struct buffer text;
	int rc = 0;

	buffer_init(&text, 64u << 20);
	for (uint32_t i = 0; i < mesh->texture_count && rc == 0; i++) {
		const struct mesh_texture *texture = &mesh->textures[i];

		buffer_print(&text, "newmtl m%u\n", i);
		if (mesh_texture_is_colour(texture)) {
			buffer_print(&text, "Kd %.5f %.5f %.5f\n", texture->rgb[0] / 255.0,
				     texture->rgb[1] / 255.0, texture->rgb[2] / 255.0);
			continue;
		}
		snprintf(name, sizeof(name), "%.*s-%u.png", stem, path, i);
		buffer_print(&text, "Kd 1 1 1\nmap_Kd %s\n", name_in(name));
		rc = write_picture(texture, name);
	}
	snprintf(name, sizeof(name), "%.*s.mtl", stem, path);
	if (rc == 0)
		rc = text.error;
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&text), name);
	buffer_finish(&text);
	return rc;
}

/* ---- the mesh */

/* Colours of vertices are no part of the format, but what most programs write and read. Beside
 * textures they are only means of these, and left out. */
static void put_vertices(struct chunk_file *file, const struct mesh *mesh)
{
	const bool has_colours = mesh->colours && mesh->texture_count == 0;

	for (uint32_t i = 0; i < mesh->vertex_count && chunk_file_pass(file); i++) {
		const float *at = mesh->positions[i];

		buffer_print(&file->chunk, "v %.9g %.9g %.9g", (double)at[0], (double)at[1],
			     (double)at[2]);
		for (int k = 0; k < 3 && has_colours; k++)
			buffer_print(&file->chunk, " %.5f", mesh->colours[i][k] / 255.0);
		buffer_put_text(&file->chunk, "\n");
		spill_pass(i);
	}
	for (uint32_t i = 0; mesh->uvs && i < mesh->vertex_count && chunk_file_pass(file); i++) {
		buffer_print(&file->chunk, "vt %.9g %.9g\n", (double)mesh->uvs[i][0],
			     (double)mesh->uvs[i][1]);
		spill_pass(i);
	}
}

static void put_triangles(struct chunk_file *file, const struct mesh *mesh)
{
	int material = -1;

	for (uint32_t i = 0; i < mesh->triangle_count && chunk_file_pass(file); i++) {
		const uint32_t *corners = mesh->triangles[i];

		if (mesh->materials && mesh->materials[i] != material) {
			material = mesh->materials[i];
			buffer_print(&file->chunk, "usemtl m%d\n", material);
		}
		buffer_put_text(&file->chunk, "f");
		for (int k = 0; k < 3; k++)
			if (mesh->uvs)
				buffer_print(&file->chunk, " %u/%u", corners[k] + 1,
					     corners[k] + 1);
			else
				buffer_print(&file->chunk, " %u", corners[k] + 1);
		buffer_put_text(&file->chunk, "\n");
		spill_pass(i);
	}
}

static int write_obj(const struct mesh *mesh, const char *path, int stem)
{
	const char *name = name_in(path);
	struct chunk_file file;

	chunk_file_begin(&file, path);
	if (mesh->texture_count > 0)
		buffer_print(&file.chunk, "mtllib %.*s.mtl\n", stem - (int)(name - path), name);
	put_vertices(&file, mesh);
	put_triangles(&file, mesh);
	return chunk_file_end(&file);
}

int mesh_obj_write(const struct mesh *mesh, const char *path)
{
	const int stem = stem_of(path);
	int rc = stem < 0 ? stem : 0;

	if (rc == 0 && mesh->texture_count > 0)
		rc = write_materials(mesh, path, stem);
	return rc == 0 ? write_obj(mesh, path, stem) : rc;
}
