/* Keeps the streaming mesh in two buffers and draws it in its own colours. */
#include "render/scene/scene_stream.h"

#include <stddef.h>

#include "base/log.h"

void scene_drop_stream(struct scene *scene)
{
	struct scene_stream *stream = &scene->stream;
	stream_growth_finish(&stream->growth);
	if (stream->vertices)
		glDeleteBuffers(1, &stream->vertices);
	if (stream->indices)
		glDeleteBuffers(1, &stream->indices);
	stream->vertices = stream->indices = 0;
}

uint32_t scene_first_cut(const struct scene *scene)
{
	const uint32_t count = scene->stream.growth.start.group_count;
	return count < scene->hierarchy.group_count ? count : scene->hierarchy.group_count;
}

bool scene_first_cut_is_here(const struct scene *scene)
{
	if (!scene->has_hierarchy)
		return false;
	for (uint32_t g = 0; g < scene_first_cut(scene); g++)
		if (!scene->geometry.loaded[g])
			return false;
	return true;
}

/* Uploads what changed. */
static void upload(struct scene_stream *stream, const struct stream_change *change)
{
	const struct stream_growth *growth = &stream->growth;
	if (change->vertices == 0)
		return;
	if (!stream->vertices) {
		glGenBuffers(1, &stream->vertices);
		glGenBuffers(1, &stream->indices);
	}
	glBindBuffer(GL_ARRAY_BUFFER, stream->vertices);
	if (!change->triangles) {
		glBufferSubData(GL_ARRAY_BUFFER,
				(GLintptr)(change->first_vertex * sizeof(*growth->shown)),
				(GLsizeiptr)(change->vertices * sizeof(*growth->shown)),
				growth->shown + change->first_vertex);
		return;
	}
	glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(growth->vertex_count * sizeof(*growth->shown)),
		     growth->shown, GL_DYNAMIC_DRAW);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, stream->indices);
	glBufferData(GL_ELEMENT_ARRAY_BUFFER,
		     (GLsizeiptr)(3 * growth->triangle_count * sizeof(*growth->indices)),
		     growth->indices, GL_STATIC_DRAW);
}

void scene_step_stream(struct scene *scene, float passed_ms)
{
	struct scene_stream *stream = &scene->stream;
	struct stream_change change;
	if (scene->has_hierarchy && scene->dissolve.share[0] >= 1 && !stream->over) {
		if (stream->growth.decoder)
			log_debug("render", "patches have taken the place of the streaming mesh");
		scene_drop_stream(scene);
		stream->over = true;
	}
	stream_growth_step(&stream->growth, passed_ms, &change);
	upload(stream, &change);
	if (!scene->has_hierarchy)
		return;
	scene->dissolve.root = ROOT_AT_ONCE;
	if (stream->growth.vertex_count > 0)
		scene->dissolve.root = scene_first_cut_is_here(scene) ? ROOT_APPEARS : ROOT_HELD;
}

void scene_draw_stream(struct scene *scene, const struct surface_frame *frame)
{
	static const struct blend none[PLAN_ENTRIES];
	const struct scene_stream *stream = &scene->stream;
	const struct dissolve_range range = { .low = scene->has_hierarchy ? scene->dissolve.share[0]
									  : 0,
					      .high = 1 };
	const int program = surface_choose(frame, none, range);
	const GLsizei stride = sizeof(struct stream_vertex);
	if (stream->growth.triangle_count == 0 || program < 0)
		return;
	surface_begin(&scene->surface, frame, program);
	glBindBuffer(GL_ARRAY_BUFFER, stream->vertices);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, stream->indices);
	glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride,
			      (void *)offsetof(struct stream_vertex, place));
	glVertexAttribPointer(1, 2, GL_BYTE, GL_FALSE, stride,
			      (void *)offsetof(struct stream_vertex, normal));
	glVertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride,
			      (void *)offsetof(struct stream_vertex, colour));
	glVertexAttrib3f(3, 0, 0, 0);
	surface_dissolve(&scene->surface, range);
	geometry_draw(&scene->geometry, 0, stream->growth.triangle_count);
}
