/* Uploads the area of a part on a patch as triangles, and draws them white. */
#include "render/patches/part_buffers.h"

#include <string.h>

/* Triangles that are cut at the border have the depth of the whole one except for rounding, and a
 * patch that dissolves has that of another level, so all are drawn nearer by this distance. */
static const float nearer_px = 1.5f;

static const char part_vertex[] =
	"attribute vec3 a_position, a_base;\n"
	"uniform mat4 u_clip;\n"
	"uniform vec4 u_lattice;\n"
	"uniform vec4 u_cut;\n"
	"uniform float u_nearer;\n"
	"varying float v_cut;\n" /* metres in front of the section plane */
	"void main() {\n"
	"	vec3 p = u_lattice.xyz + u_lattice.w * (a_base + a_position);\n"
	"	v_cut = dot(u_cut.xyz, p) - u_cut.w;\n"
	"	gl_Position = u_clip * vec4(p * u_nearer, 1.0);\n"
	"}\n";

static const char part_fragment[] = "varying float v_cut;\n"
				    "void main() {\n"
				    "	if (v_cut > 0.0) discard;\n"
				    "	gl_FragColor = vec4(1.0);\n"
				    "}\n";

int part_renderer_init(struct part_renderer *renderer)
{
	memset(renderer, 0, sizeof(*renderer));
	const struct gl_program_source source = {
		.name = "part",
		.vertex = (const char *const[]){ part_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, part_fragment, NULL },
		.attributes = (const char *const[]){ "a_position", "a_normal", "a_colour", "a_base",
						     NULL },
	};
	int rc = gl_program_build(&renderer->program, &source);
	renderer->clip = glGetUniformLocation(renderer->program, "u_clip");
	renderer->lattice = glGetUniformLocation(renderer->program, "u_lattice");
	renderer->cut = glGetUniformLocation(renderer->program, "u_cut");
	renderer->nearer = glGetUniformLocation(renderer->program, "u_nearer");
	return rc;
}

void part_renderer_finish(struct part_renderer *renderer)
{
	if (renderer->program)
		glDeleteProgram(renderer->program);
	memset(renderer, 0, sizeof(*renderer));
}

/* ---- the area on one patch */

static void put(GLuint *out, GLenum target, const void *data, size_t bytes)
{
	if (bytes == 0)
		return;
	glGenBuffers(1, out);
	glBindBuffer(target, *out);
	glBufferData(target, (GLsizeiptr)bytes, data, GL_STATIC_DRAW);
}

int part_buffers_make(struct part_buffers *out, const struct part_area *area, uint32_t serial)
{
	part_buffers_finish(out);
	put(&out->whole, GL_ELEMENT_ARRAY_BUFFER, area->whole,
	    area->whole_count * sizeof(*area->whole));
	put(&out->within, GL_ARRAY_BUFFER, area->within,
	    area->within_count * sizeof(*area->within));
	out->whole_count = area->whole_count;
	out->within_count = area->within_count;
	out->serial = serial;
	return gl_check("uploading the area of a part");
}

void part_buffers_finish(struct part_buffers *buffers)
{
	if (buffers->whole)
		glDeleteBuffers(1, &buffers->whole);
	if (buffers->within)
		glDeleteBuffers(1, &buffers->within);
	memset(buffers, 0, sizeof(*buffers));
}

bool part_buffers_are_empty(const struct part_buffers *buffers)
{
	return buffers->whole_count + buffers->within_count == 0;
}

/* ---- drawing */

void part_renderer_begin(const struct part_renderer *renderer, const struct view *view,
			 const struct root_page *root)
{
	const struct lattice *lattice = &root->lattice;
	const float *eye = view->eye_m;
	glUseProgram(renderer->program);
	glUniformMatrix4fv(renderer->clip, 1, GL_FALSE, view->clip);
	glUniform4f(renderer->lattice, (float)(lattice->origin_m[0] - eye[0]),
		    (float)(lattice->origin_m[1] - eye[1]), (float)(lattice->origin_m[2] - eye[2]),
		    (float)lattice->step_m);
	glUniform4fv(renderer->cut, 1, view->cut);
	glUniform1f(renderer->nearer, 1 - nearer_px / view->focal_px);
	glEnableVertexAttribArray(0);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
}

void part_buffers_draw(const struct part_buffers *buffers)
{
	if (buffers->whole_count > 0) {
		glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers->whole);
		glDrawElements(GL_TRIANGLES, (GLsizei)buffers->whole_count, GL_UNSIGNED_SHORT,
			       NULL);
	}
	if (buffers->within_count > 0) {
		glBindBuffer(GL_ARRAY_BUFFER, buffers->within);
		glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, NULL);
		glDrawArrays(GL_TRIANGLES, 0, (GLsizei)buffers->within_count);
	}
}
