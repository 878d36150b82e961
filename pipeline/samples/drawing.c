/* Uploads the pieces of a surface and the scan's textures, and draws the visible pieces from near
 * to far. */
#include "pipeline/samples/drawing.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "geometry/light.h"
#include "geometry/noise.h"
#include "pipeline/material/material.h"
#include "pipeline/samples/recency.h"
#include "render/display/gl.h"

enum { AT_POSITION, AT_NORMAL, AT_COLOUR, AT_UV };

/* How much of the surface is kept on the GPU. */
enum { RESIDENT_BYTES = 256 << 20 };

/* A piece on the GPU. */
struct resident {
	GLuint vertices, uvs, indices; /* 0: it is not there */
	uint32_t index_count, bytes;
};

struct drawing {
	struct model *model;        /* borrowed */
	struct sight *sight;        /* owned */
	struct resident *residents; /* owned; one per piece of the surface */
	struct recency recency;     /* of those that are there */
	uint64_t resident_bytes;
	GLuint program;
	GLint matrix_at, eye_at, px_at;
	uint32_t texture_count;
	GLuint *textures; /* owned */
};

static const char *const attributes[] = { "position", "normal", "colour", "uv", NULL };

static const char vertex_text[] =
	"uniform mat4 matrix;\n"
	"attribute vec3 position; attribute vec4 normal; attribute vec4 colour; attribute vec2 uv;\n"
	"varying vec3 v_at; varying vec3 v_normal; varying vec4 v_colour; varying vec2 v_uv;\n"
	"void main() {\n"
	"	v_at = position; v_normal = normal.xyz; v_colour = colour; v_uv = uv;\n"
	"	gl_Position = matrix * vec4(position, 1.0);\n"
	"}\n";

static const char fragment_head[] =
	"precision highp float;\n"
	"uniform vec3 sun; uniform vec3 eye; uniform float px_radians; uniform sampler2D image;\n"
	"varying vec3 v_at; varying vec3 v_normal; varying vec4 v_colour; varying vec2 v_uv;\n";

static const char scan_colour[] = "vec3 base() { return v_colour.rgb; }\n";
/* Row 0 of a texture is its top, where v is 1. */
static const char image_colour[] =
	"vec3 base() { return texture2D(image, vec2(v_uv.x, 1.0 - v_uv.y)).rgb; }\n";
static const char material[] =
	"vec3 base() {\n"
	"	return material_colour(v_at, normalize(v_normal), distance(v_at, eye) * px_radians);\n"
	"}\n";
/* Of substance_glsl; the name of the substance is put in. */
static const char substance_base[] =
	"vec3 base() {\n"
	"	return %s_colour(v_at.x, v_at.y, v_at.z, distance(v_at, eye) * px_radians);\n"
	"}\n";
static const char no_light[] = "float shade() { return 1.0; }\n";
static const char sun_light[] =
	"float shade() { return light(normalize(v_normal), v_colour.a, sun); }\n";

static const char fragment_main[] =
	"void main() {\n"
	"	gl_FragColor = vec4(min(vec3(1.0), base() * shade()),\n"
	"			    gl_FrontFacing ? 1.0 : 254.0 / 255.0);\n"
	"}\n";

static int build_program(struct drawing *drawing, const struct drawing_options *options)
{
	const bool is_substance = options->procedural && options->substance != SUBSTANCE_NONE;
	char of_substance[sizeof(substance_base) + 32];
	const char *colour = is_substance             ? of_substance
			     : options->procedural    ? material
			     : drawing->texture_count ? image_colour
						      : scan_colour;
	const char *const vertex[] = { vertex_text, NULL };
	const char *const fragment[] = { fragment_head,
					 options->procedural ? noise_glsl : "",
					 is_substance          ? substance_glsl
					 : options->procedural ? material_glsl
							       : "",
					 options->lit ? light_glsl : "",
					 colour,
					 options->lit ? sun_light : no_light,
					 fragment_main,
					 NULL };
	const struct gl_program_source source = { "drawing", vertex, fragment, attributes };
	int rc;

	snprintf(of_substance, sizeof(of_substance), substance_base,
		 substance_names[options->substance]);
	rc = gl_program_build(&drawing->program, &source);
	if (rc < 0)
		return rc;
	drawing->matrix_at = glGetUniformLocation(drawing->program, "matrix");
	drawing->eye_at = glGetUniformLocation(drawing->program, "eye");
	drawing->px_at = glGetUniformLocation(drawing->program, "px_radians");
	glUseProgram(drawing->program);
	glUniform3fv(glGetUniformLocation(drawing->program, "sun"), 1, options->sun);
	glUniform1i(glGetUniformLocation(drawing->program, "image"), 0);
	return 0;
}

/* Halves a picture with a box filter. Returns a new array, or NULL without memory. */
static uint8_t *halve(const uint8_t *rgb, uint32_t *width, uint32_t *height)
{
	uint32_t w = *width > 1 ? *width / 2 : 1, h = *height > 1 ? *height / 2 : 1;
	uint8_t *out = malloc((size_t)w * h * 3);

	for (size_t i = 0; out && i < (size_t)w * h * 3; i++) {
		size_t x = i / 3 % w, y = i / 3 / w, c = i % 3;
		size_t right = 2 * x + 1 < *width ? 3 : 0;
		size_t down = 2 * y + 1 < *height ? 3 * (size_t)*width : 0;
		const uint8_t *p = rgb + (2 * y * *width + 2 * x) * 3 + c;

		out[i] = (uint8_t)((p[0] + p[right] + p[down] + p[right + down] + 2) / 4);
	}
	*width = w;
	*height = h;
	return out;
}

/* Uploads a scan's texture at its own size if the driver allows it. We choose the pipeline's
 * machines, so the kiosk's limit (gl_texture_create) does not apply here. */
static int upload_texture(GLuint texture, const struct mesh_texture *source)
{
	uint32_t width = source->width, height = source->height;
	bool any_size = gl_has_extension("GL_OES_texture_npot");
	const uint8_t *rgb = source->rgb;
	uint8_t *owned = NULL;
	GLint most = 0;

	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	while (width > (uint32_t)most || height > (uint32_t)most) {
		uint8_t *half = halve(rgb, &width, &height);

		free(owned);
		if (!half)
			return -ENOMEM;
		rgb = owned = half;
	}
	if ((width & (width - 1)) == 0 && (height & (height - 1)) == 0)
		any_size = true;
	glBindTexture(GL_TEXTURE_2D, texture);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER,
			any_size ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, any_size ? GL_REPEAT : GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, any_size ? GL_REPEAT : GL_CLAMP_TO_EDGE);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
	glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB, (GLsizei)width, (GLsizei)height, 0, GL_RGB,
		     GL_UNSIGNED_BYTE, rgb);
	if (any_size)
		glGenerateMipmap(GL_TEXTURE_2D);
	free(owned);
	return gl_check("uploading a scan's picture");
}

static int upload_textures(struct drawing *drawing, const struct mesh_texture *textures)
{
	int rc = 0;

	glGenTextures((GLsizei)drawing->texture_count, drawing->textures);
	for (uint32_t i = 0; rc == 0 && i < drawing->texture_count; i++)
		rc = upload_texture(drawing->textures[i], &textures[i]);
	return rc;
}

int drawing_create(struct drawing **out, struct model *model, const struct mesh_texture *textures,
		   uint32_t texture_count, const struct drawing_options *options)
{
	struct drawing *drawing = calloc(1, sizeof(*drawing));
	size_t count = model->piece_count;
	int rc = 0;

	*out = NULL;
	if (!drawing)
		return -ENOMEM;
	drawing->model = model;
	drawing->residents = calloc(count, sizeof(*drawing->residents));
	drawing->textures = calloc(texture_count + 1, sizeof(*drawing->textures));
	if (!drawing->residents || !drawing->textures)
		rc = -ENOMEM;
	else
		drawing->texture_count = texture_count;
	if (rc == 0)
		rc = recency_init(&drawing->recency, model->piece_count);
	if (rc == 0)
		rc = sight_create(&drawing->sight, model);
	if (rc == 0)
		rc = build_program(drawing, options);
	if (rc == 0)
		rc = upload_textures(drawing, textures);
	if (rc < 0) {
		drawing_destroy(drawing);
		return rc;
	}
	*out = drawing;
	return 0;
}

/* ---- pieces on the GPU */

static void evict(struct drawing *drawing, uint32_t piece)
{
	struct resident *resident = &drawing->residents[piece];
	const GLuint buffers[3] = { resident->vertices, resident->uvs, resident->indices };

	recency_remove(&drawing->recency, piece);
	drawing->resident_bytes -= resident->bytes;
	glDeleteBuffers(3, buffers);
	*resident = (struct resident){ 0 };
}

static GLuint upload_buffer(GLenum kind, const void *data, size_t bytes)
{
	GLuint buffer;

	glGenBuffers(1, &buffer);
	glBindBuffer(kind, buffer);
	glBufferData(kind, (GLsizeiptr)bytes, data, GL_STATIC_DRAW);
	return buffer;
}

/* Puts a piece on the GPU. */
static int upload(struct drawing *drawing, uint32_t piece)
{
	struct resident *resident = &drawing->residents[piece];
	struct model_mesh mesh;
	size_t vertex_bytes, uv_bytes = 0, index_bytes;
	int rc = model_load(drawing->model, piece, &mesh);

	if (rc < 0)
		return rc;
	vertex_bytes = mesh.vertex_count * sizeof(*mesh.vertices);
	index_bytes = mesh.index_count * sizeof(*mesh.indices);
	resident->vertices = upload_buffer(GL_ARRAY_BUFFER, mesh.vertices, vertex_bytes);
	if (drawing->texture_count && mesh.uvs) {
		uv_bytes = mesh.vertex_count * sizeof(*mesh.uvs);
		resident->uvs = upload_buffer(GL_ARRAY_BUFFER, mesh.uvs, uv_bytes);
	}
	resident->indices = upload_buffer(GL_ELEMENT_ARRAY_BUFFER, mesh.indices, index_bytes);
	resident->index_count = mesh.index_count;
	resident->bytes = (uint32_t)(vertex_bytes + uv_bytes + index_bytes);
	drawing->resident_bytes += resident->bytes;
	recency_add(&drawing->recency, piece);
	while (drawing->resident_bytes > RESIDENT_BYTES && drawing->recency.oldest != piece)
		evict(drawing, drawing->recency.oldest);
	return gl_check("uploading the model");
}

static int make_resident(struct drawing *drawing, uint32_t piece)
{
	if (!drawing->residents[piece].vertices)
		return upload(drawing, piece);
	recency_remove(&drawing->recency, piece);
	recency_add(&drawing->recency, piece);
	return 0;
}

void drawing_destroy(struct drawing *drawing)
{
	if (!drawing)
		return;
	while (drawing->recency.links && drawing->recency.oldest != RECENCY_NONE)
		evict(drawing, drawing->recency.oldest);
	glDeleteProgram(drawing->program);
	glDeleteTextures((GLsizei)drawing->texture_count, drawing->textures);
	free(drawing->textures);
	free(drawing->residents);
	recency_finish(&drawing->recency);
	sight_destroy(drawing->sight);
	free(drawing);
}

static void point_at(const struct drawing *drawing, uint32_t piece)
{
	const GLsizei stride = sizeof(struct model_vertex);
	const struct resident *resident = &drawing->residents[piece];
	const char *base = (const char *)0;

	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, resident->indices);
	glBindBuffer(GL_ARRAY_BUFFER, resident->vertices);
	glVertexAttribPointer(AT_POSITION, 3, GL_FLOAT, GL_FALSE, stride, base);
	glVertexAttribPointer(AT_NORMAL, 4, GL_BYTE, GL_TRUE, stride,
			      base + offsetof(struct model_vertex, normal));
	glVertexAttribPointer(AT_COLOUR, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride,
			      base + offsetof(struct model_vertex, colour));
	if (!drawing->texture_count)
		return;
	glBindBuffer(GL_ARRAY_BUFFER, resident->uvs);
	glVertexAttribPointer(AT_UV, 2, GL_FLOAT, GL_FALSE, 0, base);
	glBindTexture(GL_TEXTURE_2D, drawing->textures[drawing->model->pieces[piece].texture]);
}

static void set_up(struct drawing *drawing)
{
	glClearColor(0, 0, 0, 0);
	glClearDepthf(1);
	glDepthMask(GL_TRUE);
	glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LESS);
	glDisable(GL_CULL_FACE);
	glDisable(GL_BLEND);
	glDisable(GL_DITHER);
	glUseProgram(drawing->program);
	glActiveTexture(GL_TEXTURE0);
	for (GLuint i = AT_POSITION; i <= (drawing->texture_count ? AT_UV : AT_COLOUR); i++)
		glEnableVertexAttribArray(i);
}

struct sight *drawing_sight(struct drawing *drawing)
{
	return drawing->sight;
}

int drawing_draw(struct drawing *drawing, const float matrix[16], const float eye_m[3],
		 float px_radians)
{
	uint32_t count;
	const uint32_t *pieces = sight_visible(drawing->sight, matrix, eye_m, &count);
	int rc = 0;

	set_up(drawing);
	glUniformMatrix4fv(drawing->matrix_at, 1, GL_FALSE, matrix);
	glUniform3fv(drawing->eye_at, 1, eye_m);
	glUniform1f(drawing->px_at, px_radians);
	for (uint32_t n = 0; n < count && rc == 0; n++) {
		uint32_t piece = pieces[n];

		rc = make_resident(drawing, piece);
		if (rc < 0)
			break;
		point_at(drawing, piece);
		glDrawElements(GL_TRIANGLES, (GLsizei)drawing->residents[piece].index_count,
			       GL_UNSIGNED_SHORT, NULL);
	}
	for (GLuint i = AT_POSITION; i <= AT_UV; i++)
		glDisableVertexAttribArray(i);
	return rc;
}
