/* A picture a frame, because a driver copies and shrinks it when it is uploaded. */
#include "render/scenery/scenery_textures.h"

#include <errno.h>
#include <stdlib.h>

int scenery_textures_load(struct scenery_textures *textures, const struct scenery *scenery)
{
	size_t end = 0;

	scenery_textures_finish(textures);
	if (scenery->texture_count == 0)
		return 0;
	textures->names = calloc(scenery->texture_count, sizeof(*textures->names));
	textures->offset = calloc((size_t)scenery->mesh_count + 1, sizeof(*textures->offset));
	if (!textures->names || !textures->offset)
		return -ENOMEM;
	for (uint32_t i = 0; i < scenery->mesh_count; i++) {
		textures->offset[i] = end;
		if (scenery->meshes[i].uvs)
			end += scenery->meshes[i].vertex_count * sizeof(*scenery->meshes[i].uvs);
	}
	glGenBuffers(1, &textures->uvs);
	glBindBuffer(GL_ARRAY_BUFFER, textures->uvs);
	glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)end, NULL, GL_STATIC_DRAW);
	for (uint32_t i = 0; i < scenery->mesh_count; i++)
		if (scenery->meshes[i].uvs)
			glBufferSubData(GL_ARRAY_BUFFER, (GLintptr)textures->offset[i],
					(GLsizeiptr)(scenery->meshes[i].vertex_count *
						     sizeof(*scenery->meshes[i].uvs)),
					scenery->meshes[i].uvs);
	return gl_check("uploading where pictures lie");
}

bool scenery_textures_next(struct scenery_textures *textures, struct scenery *scenery)
{
	struct scenery_texture *texture;
	struct gl_texture_options options = { .format = GL_RGBA,
					      .filter = GL_LINEAR,
					      .mipmaps = true };

	if (textures->count == scenery->texture_count)
		return true;
	texture = &scenery->textures[textures->count];
	options.width_px = texture->width;
	options.height_px = texture->height;
	options.repeat = texture->repeats;
	options.pixels = texture->rgba;
	glActiveTexture(GL_TEXTURE1);
	if (!texture->rgba || gl_texture_create(&textures->names[textures->count], &options) < 0)
		textures->names[textures->count] = 0;
	textures->count++;
	free(texture->rgba);
	texture->rgba = NULL;
	return false;
}

uint64_t scenery_textures_bytes(const struct scenery *scenery)
{
	return (uint64_t)scenery_texels(scenery) * 4 * 4 / 3; /* with the smaller ones */
}

void scenery_textures_bind(const struct scenery_textures *textures, const struct scenery *scenery,
			   uint32_t mesh)
{
	const struct scenery_material *material =
		&scenery->materials[scenery->meshes[mesh].material];

	if (material->texture > 0)
		gl_bind_texture(1, textures->names[material->texture - 1]);
	if (material->normals > 0)
		gl_bind_texture(2, textures->names[material->normals - 1]);
	glBindBuffer(GL_ARRAY_BUFFER, textures->uvs);
	glEnableVertexAttribArray(3);
	glVertexAttribPointer(3, 2, GL_UNSIGNED_SHORT, GL_FALSE, 0, (void *)textures->offset[mesh]);
}

void scenery_textures_finish(struct scenery_textures *textures)
{
	if (textures->names)
		glDeleteTextures((GLsizei)textures->count, textures->names);
	if (textures->uvs)
		glDeleteBuffers(1, &textures->uvs);
	free(textures->names);
	free(textures->offset);
	*textures = (struct scenery_textures){ 0 };
}
