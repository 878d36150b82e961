/* Uploads outlines as quads and triangles, widens the lines in the vertex shader, and draws lines
 * and tints. */
#include "render/patches/outline_lines.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { QUADS = 4096 };

/* A corner of the quad around a line, in the layout of the vertex shader. */
struct vertex {
	float at[3], other[3]; /* this end and the other end, in lattice units */
	int8_t normal[3];
	int8_t side; /* 1 and -1: this is the first end; 2 and -2: the second */
};

/* The line is widened in pixels. The depth of each corner is that of the triangle's plane there, so
 * that the line does not sink into a surface seen at a grazing angle, and a little nearer, so that
 * it lies on top. */
static const char line_vertex[] =
	"attribute vec3 a_position, a_base;\n"
	"attribute vec3 a_other;\n"
	"attribute vec4 a_side;\n" /* normal; side as in struct vertex */
	"uniform mat4 u_clip;\n"
	"uniform vec4 u_lattice;\n"
	"uniform vec4 u_picture;\n" /* half its sides and the focal length, in pixels */
	"uniform vec4 u_cut;\n"
	"varying float v_cut;\n" /* metres in front of the section plane */
	"varying vec3 v_at;\n"   /* pixels along and across the line; its length */
	"void main() {\n"
	"	const float reach = 3.5;\n"
	"	vec3 p = u_lattice.xyz + u_lattice.w * (a_base + a_position);\n"
	"	v_cut = dot(u_cut.xyz, p) - u_cut.w;\n"
	"	vec4 here = u_clip * vec4(p, 1.0);\n"
	"	vec4 there = u_clip * vec4(u_lattice.xyz + u_lattice.w * (a_base + a_other), 1.0);\n"
	/* an end is nearer than the near plane */
	"	if (here.z < -here.w || there.z < -there.w) {\n"
	"		gl_Position = vec4(2.0, 2.0, 2.0, 1.0);\n"
	"		return;\n"
	"	}\n"
	"	bool second = abs(a_side.w) > 1.5;\n"
	"	vec2 at = here.xy / here.w * u_picture.xy;\n"
	"	vec2 along = there.xy / there.w * u_picture.xy - at;\n"
	"	float size = length(along);\n"
	"	along = size > 1e-3 ? along / size : vec2(second ? -1.0 : 1.0, 0.0);\n"
	"	float side = a_side.w > 0.0 ? reach : -reach;\n"
	"	vec2 off = vec2(-along.y, along.x) * (second ? -side : side) - along * reach;\n"
	"	v_at = vec3(second ? size + reach : -reach, side, size);\n"
	"	vec3 x = vec3(u_clip[0][0], u_clip[1][0], u_clip[2][0]);\n"
	"	vec3 y = vec3(u_clip[0][1], u_clip[1][1], u_clip[2][1]);\n"
	"	vec2 step = off / u_picture.xy * here.w;\n"
	"	float meets = dot(a_side.xyz, p + x * (step.x / dot(x, x)) + y * (step.y / dot(y, y)));\n"
	"	float nearer = abs(meets) > 1e-6 ? 1.0 - dot(a_side.xyz, p) / meets : 0.0;\n"
	"	nearer = (clamp(nearer * u_picture.z, 0.0, 12.0) + 3.0) / u_picture.z;\n"
	"	vec4 lifted = u_clip * vec4(p * (1.0 - nearer), 1.0);\n"
	"	gl_Position = vec4((at + off) / u_picture.xy, lifted.z / lifted.w, 1.0);\n"
	"}\n";

static const char line_fragment[] =
	"varying FINE vec3 v_at;\n"
	"varying float v_cut;\n"
	"void main() {\n"
	"	FINE vec2 off = vec2(v_at.x - clamp(v_at.x, 0.0, v_at.z), v_at.y);\n"
	"	float alpha = 1.0 - smoothstep(2.0, 3.0, length(off));\n"
	"	if (alpha <= 0.0 || v_cut > 0.0) discard;\n"
	"	gl_FragColor = vec4(1.0, 0.78, 0.25, alpha);\n"
	"}\n";

static const char tint_vertex[] =
	"invariant gl_Position;\n"
	"attribute vec3 a_position, a_base;\n"
	"uniform mat4 u_clip;\n"
	"uniform vec4 u_lattice;\n"
	"uniform vec4 u_cut;\n"
	"varying float v_cut;\n"
	"void main() {\n"
	"	vec3 p = u_lattice.xyz + u_lattice.w * (a_base + a_position);\n"
	"	v_cut = dot(u_cut.xyz, p) - u_cut.w;\n"
	"	gl_Position = u_clip * vec4(p, 1.0);\n"
	"}\n";

static const char tint_fragment[] = "varying float v_cut;\n"
				    "void main() {\n"
				    "	if (v_cut > 0.0) discard;\n"
				    "	gl_FragColor = vec4(1.0, 0.78, 0.25, 0.14);\n"
				    "}\n";

static int build(struct outline_lines_program *out, const struct gl_program_source *source)
{
	int rc = gl_program_build(&out->program, source);
	out->clip = glGetUniformLocation(out->program, "u_clip");
	out->lattice = glGetUniformLocation(out->program, "u_lattice");
	out->cut = glGetUniformLocation(out->program, "u_cut");
	out->picture = glGetUniformLocation(out->program, "u_picture");
	return rc;
}

static int make_quads(struct outline_renderer *outlines)
{
	uint16_t *indices = malloc(QUADS * 6 * sizeof(*indices));
	if (!indices)
		return -ENOMEM;
	for (uint32_t i = 0; i < QUADS * 6; i++) {
		static const uint8_t corner[6] = { 0, 1, 2, 2, 1, 3 };
		indices[i] = (uint16_t)(i / 6 * 4 + corner[i % 6]);
	}
	glGenBuffers(1, &outlines->quads);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, outlines->quads);
	glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)(QUADS * 6 * sizeof(*indices)), indices,
		     GL_STATIC_DRAW);
	free(indices);
	return gl_check("making the lines' quads");
}

int outline_renderer_init(struct outline_renderer *outlines)
{
	memset(outlines, 0, sizeof(*outlines));
	const struct gl_program_source line = {
		.name = "outline",
		.vertex = (const char *const[]){ line_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, line_fragment, NULL },
		.attributes =
			(const char *const[]){ "a_position", "a_other", "a_side", "a_base", NULL },
	};
	const struct gl_program_source tint = {
		.name = "tint",
		.vertex = (const char *const[]){ tint_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, tint_fragment, NULL },
		.attributes = (const char *const[]){ "a_position", "a_normal", "a_colour", "a_base",
						     NULL },
	};
	int rc = build(&outlines->line, &line);
	if (rc == 0)
		rc = build(&outlines->tint, &tint);
	return rc < 0 ? rc : make_quads(outlines);
}

void outline_renderer_finish(struct outline_renderer *outlines)
{
	if (outlines->line.program)
		glDeleteProgram(outlines->line.program);
	if (outlines->tint.program)
		glDeleteProgram(outlines->tint.program);
	if (outlines->quads)
		glDeleteBuffers(1, &outlines->quads);
	memset(outlines, 0, sizeof(*outlines));
}

/* ---- an outline */

static void put(GLuint *out, GLenum target, const void *data, size_t bytes)
{
	if (bytes == 0)
		return;
	glGenBuffers(1, out);
	glBindBuffer(target, *out);
	glBufferData(target, (GLsizeiptr)bytes, data, GL_STATIC_DRAW);
}

static void set_corners(struct vertex corner[4], const struct outline_line *line)
{
	static const int8_t sides[4] = { 1, -1, 2, -2 };
	for (int k = 0; k < 4; k++) {
		memcpy(corner[k].at, line->at[k / 2], sizeof(corner[k].at));
		memcpy(corner[k].other, line->at[1 - k / 2], sizeof(corner[k].other));
		for (int i = 0; i < 3; i++)
			corner[k].normal[i] = (int8_t)lrintf(127 * line->normal[i]);
		corner[k].side = sides[k];
	}
}

int outline_lines_make(struct outline_lines *out, const struct outline *outline, uint32_t serial)
{
	const size_t bytes = 4 * sizeof(struct vertex) * outline->line_count;
	struct vertex *vertices = malloc(bytes + 1);
	outline_lines_finish(out);
	if (!vertices)
		return -ENOMEM;
	for (uint32_t i = 0; i < outline->line_count; i++)
		set_corners(&vertices[4 * i], &outline->lines[i]);
	put(&out->lines, GL_ARRAY_BUFFER, vertices, bytes);
	put(&out->whole, GL_ELEMENT_ARRAY_BUFFER, outline->whole,
	    outline->whole_count * sizeof(*outline->whole));
	put(&out->within, GL_ARRAY_BUFFER, outline->within,
	    outline->within_count * sizeof(*outline->within));
	free(vertices);
	out->line_count = outline->line_count;
	out->whole_count = outline->whole_count;
	out->within_count = outline->within_count;
	out->serial = serial;
	return gl_check("uploading an outline");
}

void outline_lines_finish(struct outline_lines *lines)
{
	if (lines->lines)
		glDeleteBuffers(1, &lines->lines);
	if (lines->whole)
		glDeleteBuffers(1, &lines->whole);
	if (lines->within)
		glDeleteBuffers(1, &lines->within);
	memset(lines, 0, sizeof(*lines));
}

/* ---- drawing */

static void begin(const struct outline_lines_program *program, const struct view *view,
		  const struct root_page *root)
{
	const struct lattice *lattice = &root->lattice;
	const float *eye = view->eye_m;
	glUseProgram(program->program);
	glUniformMatrix4fv(program->clip, 1, GL_FALSE, view->clip);
	glUniform4f(program->lattice, (float)(lattice->origin_m[0] - eye[0]),
		    (float)(lattice->origin_m[1] - eye[1]), (float)(lattice->origin_m[2] - eye[2]),
		    (float)lattice->step_m);
	glUniform4fv(program->cut, 1, view->cut);
	if (program->picture >= 0)
		glUniform4f(program->picture, (float)view->width_px / 2, (float)view->height_px / 2,
			    view->focal_px, 0);
	glEnable(GL_BLEND);
	/* Keep the alpha (coverage) that the surface wrote. */
	glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
	glDepthFunc(GL_LEQUAL);
	glDepthMask(GL_FALSE);
	glEnableVertexAttribArray(0);
}

void outline_renderer_begin_tints(const struct outline_renderer *outlines, const struct view *view,
				  const struct root_page *root)
{
	begin(&outlines->tint, view, root);
	glPolygonOffset(-1, -2);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
}

void outline_lines_tint(const struct outline_lines *lines)
{
	if (lines->whole_count > 0) {
		glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, lines->whole);
		glDrawElements(GL_TRIANGLES, (GLsizei)lines->whole_count, GL_UNSIGNED_SHORT, NULL);
	}
	if (lines->within_count > 0) {
		glBindBuffer(GL_ARRAY_BUFFER, lines->within);
		glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, NULL);
		/* Parts of a triangle have its depth except for rounding, so they need an
		 * offset. */
		glEnable(GL_POLYGON_OFFSET_FILL);
		glDrawArrays(GL_TRIANGLES, 0, (GLsizei)lines->within_count);
		glDisable(GL_POLYGON_OFFSET_FILL);
	}
}

void outline_renderer_begin_lines(const struct outline_renderer *outlines, const struct view *view,
				  const struct root_page *root)
{
	begin(&outlines->line, view, root);
	glEnableVertexAttribArray(1);
	glEnableVertexAttribArray(2);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, outlines->quads);
}

void outline_lines_lines(const struct outline_lines *lines)
{
	const GLsizei stride = sizeof(struct vertex);
	if (lines->line_count > 0)
		glBindBuffer(GL_ARRAY_BUFFER, lines->lines);
	for (uint32_t first = 0; first < lines->line_count; first += QUADS) {
		uint32_t count = lines->line_count - first;
		const uintptr_t from = 4 * (uintptr_t)first * sizeof(struct vertex);
		count = count < QUADS ? count : QUADS;
		glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride,
				      (void *)(from + offsetof(struct vertex, at)));
		glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, stride,
				      (void *)(from + offsetof(struct vertex, other)));
		glVertexAttribPointer(2, 4, GL_BYTE, GL_FALSE, stride,
				      (void *)(from + offsetof(struct vertex, normal)));
		glDrawElements(GL_TRIANGLES, (GLsizei)(6 * count), GL_UNSIGNED_SHORT, NULL);
	}
}

void outline_renderer_end(void)
{
	glDepthMask(GL_TRUE);
	glDepthFunc(GL_LESS);
	glDisable(GL_BLEND);
}
