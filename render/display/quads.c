/* Uploads the bitmaps of ui as textures and draws them as rotated, blended quads. */
#include "render/display/quads.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "render/display/gl.h"

struct quads_texture {
	GLuint name;
	uint32_t revision; /* 0: nothing uploaded */
	int width_px, height_px;
};

struct quads {
	GLuint program;
	GLint to_clip, alpha;
	GLenum format; /* of textures */
	struct quads_texture textures[QUADS_TEXTURES_MAX];
	uint8_t *rows;      /* owned; scratch for bitmaps with padded rows */
	uint32_t rows_room; /* bytes */
};

static const char vertex_source[] =
	"attribute vec2 position;\n"
	"attribute vec2 source;\n"
	"uniform mat3 to_clip;\n"
	"varying vec2 at;\n"
	"void main() {\n"
	"	at = source;\n"
	"	gl_Position = vec4((to_clip * vec3(position, 1.0)).xy, 0.0, 1.0);\n"
	"}\n";

/* Cairo's bytes are B, G, R, A: where textures cannot be, ORDER swaps the channels. */
static const char fragment_source[] = "uniform FINE sampler2D picture;\n"
				      "uniform float alpha;\n"
				      "varying vec2 at;\n"
				      "void main() {\n"
				      "	gl_FragColor = texture2D(picture, at) ORDER * alpha;\n"
				      "}\n";

int quads_create(struct quads **out)
{
	static const char *const vertex[] = { vertex_source, NULL };
	const GLenum format = gl_picture_format();
	const char *const order = format == GL_RGBA ? "#define ORDER .bgra\n" : "#define ORDER\n";
	const char *const fragment[] = { gl_fine_fragment, order, fragment_source, NULL };
	static const char *const attributes[] = { "position", "source", NULL };
	const struct gl_program_source source = { "quads", vertex, fragment, attributes };
	struct quads *quads = calloc(1, sizeof(*quads));
	int rc;

	*out = NULL;
	if (!quads)
		return -ENOMEM;
	rc = gl_program_build(&quads->program, &source);
	if (rc < 0) {
		free(quads);
		return rc;
	}
	quads->format = format;
	quads->to_clip = glGetUniformLocation(quads->program, "to_clip");
	quads->alpha = glGetUniformLocation(quads->program, "alpha");
	*out = quads;
	return 0;
}

void quads_destroy(struct quads *quads)
{
	if (!quads)
		return;
	for (size_t i = 0; i < QUADS_TEXTURES_MAX; i++)
		if (quads->textures[i].name)
			glDeleteTextures(1, &quads->textures[i].name);
	glDeleteProgram(quads->program);
	free(quads->rows);
	free(quads);
}

/* Returns the pixels without padding between rows, because GLES2 cannot skip padding. NULL: out of
 * memory. */
static const uint8_t *packed_rows(struct quads *quads, const struct quads_pixels *pixels)
{
	const size_t row = (size_t)pixels->width_px * 4, bytes = row * (size_t)pixels->height_px;

	if ((size_t)pixels->stride_bytes == row)
		return pixels->bgra;
	if (ARRAY_RESERVE(quads->rows, quads->rows_room, bytes, UINT32_MAX) < 0)
		return NULL;
	for (int y = 0; y < pixels->height_px; y++)
		memcpy(quads->rows + (size_t)y * row,
		       pixels->bgra + (size_t)y * (size_t)pixels->stride_bytes, row);
	return quads->rows;
}

int quads_upload(struct quads *quads, const struct quads_pixels *pixels)
{
	struct quads_texture *texture;
	const uint8_t *rows;

	if (pixels->id >= QUADS_TEXTURES_MAX)
		return -EINVAL;
	texture = &quads->textures[pixels->id];
	if (texture->revision == pixels->revision)
		return 0;
	rows = packed_rows(quads, pixels);
	if (!rows)
		return -ENOMEM;
	if (texture->name && texture->width_px == pixels->width_px &&
	    texture->height_px == pixels->height_px) {
		gl_bind_texture(0, texture->name);
		glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, pixels->width_px, pixels->height_px,
				quads->format, GL_UNSIGNED_BYTE, rows);
	} else {
		const struct gl_texture_options options = {
			.width_px = pixels->width_px,
			.height_px = pixels->height_px,
			.format = quads->format,
			.filter = GL_LINEAR,
			.large = true, /* such as a page over a whole wall of panels */
			.pixels = rows,
		};
		int rc;

		if (texture->name)
			glDeleteTextures(1, &texture->name);
		*texture = (struct quads_texture){ 0 };
		rc = gl_texture_create(&texture->name, &options);
		if (rc < 0)
			return rc;
		texture->width_px = pixels->width_px;
		texture->height_px = pixels->height_px;
	}
	texture->revision = pixels->revision;
	return 0;
}

void quads_drop(struct quads *quads, uint32_t id)
{
	if (id >= QUADS_TEXTURES_MAX)
		return;
	if (quads->textures[id].name)
		glDeleteTextures(1, &quads->textures[id].name);
	quads->textures[id] = (struct quads_texture){ 0 };
}

void quads_forget(struct quads *quads)
{
	for (size_t i = 0; i < QUADS_TEXTURES_MAX; i++)
		quads->textures[i].revision = 0;
}

/* Writes the matrix from the visitor's pixels to clip space, column-major. The panel shows the
 * framebuffer rotated clockwise by rotation_deg, so the drawing is rotated back. */
static void clip_matrix(float out[9], int width_px, int height_px, int rotation_deg)
{
	const bool sideways = rotation_deg == 90 || rotation_deg == 270;
	const float w = (float)(sideways ? height_px : width_px);
	const float h = (float)(sideways ? width_px : height_px);
	const float angle = (float)rotation_deg * (float)M_PI / 180;
	const float c = roundf(cosf(angle)), s = roundf(sinf(angle));

	/* Upright: x = 2 px / w - 1, y = 1 - 2 py / h; then rotated anticlockwise. */
	out[0] = c * 2 / w;
	out[1] = s * 2 / w;
	out[2] = 0;
	out[3] = s * 2 / h;
	out[4] = -c * 2 / h;
	out[5] = 0;
	out[6] = -c - s;
	out[7] = -s + c;
	out[8] = 1;
}

void quads_begin(struct quads *quads, const int shift_px[2], int width_px, int height_px,
		 int rotation_deg)
{
	float to_clip[9];

	clip_matrix(to_clip, width_px, height_px, rotation_deg);
	glViewport(shift_px[0], shift_px[1], width_px, height_px);
	glUseProgram(quads->program);
	glUniformMatrix3fv(quads->to_clip, 1, GL_FALSE, to_clip);
	glDisable(GL_DEPTH_TEST);
	glDisable(GL_CULL_FACE);
	glEnable(GL_BLEND);
	glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
	glBindBuffer(GL_ARRAY_BUFFER, 0);
	glEnableVertexAttribArray(0);
	glEnableVertexAttribArray(1);
}

void quads_draw(struct quads *quads, uint32_t id, const float corners_px[4][2],
		const float source[4], float alpha)
{
	const float at[4][2] = { { source[0], source[1] },
				 { source[2], source[1] },
				 { source[2], source[3] },
				 { source[0], source[3] } };

	if (id >= QUADS_TEXTURES_MAX || !quads->textures[id].name)
		return;
	gl_bind_texture(0, quads->textures[id].name);
	glUniform1f(quads->alpha, alpha);
	glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, corners_px);
	glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, 0, at);
	glDrawArrays(GL_TRIANGLE_FAN, 0, 4);
}

void quads_end(struct quads *quads)
{
	(void)quads;
	glDisableVertexAttribArray(0);
	glDisableVertexAttribArray(1);
	glDisable(GL_BLEND);
}
