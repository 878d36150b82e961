/* A framebuffer with a depth texture, and a shader that reduces its depth to nearest and farthest
 * values of 8 x 8 blocks. */
#include "pipeline/samples/cube_frame.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "base/log.h"
#include "render/display/gl.h"

enum { BLOCK_PX = 8, STEPS = 65534 };

struct cube_frame {
	int width_px, height_px;
	GLuint framebuffer, colour, depth;
	struct gl_target blocks; /* nearest and farthest of each square of BLOCK_PX */
	GLuint program;
	uint8_t *block_pixels; /* owned */
};

/* Packs the logarithms of the nearest and the farthest distance, 16 bits each, as a share of the
 * way from near to far plane; 65535 in both means nothing. The sampler is declared highp
 * explicitly: its default is lowp, whatever the default of floats is, and Mesa then reads it with
 * 16 bits. gl_FragCoord is always mediump, and 16 bits cannot distinguish the rows of a large
 * frame. */
static const char fragment_text[] =
	"precision highp float;\n"
	"uniform highp sampler2D depth; uniform vec2 size; uniform vec2 planes;\n"
	"varying vec2 v_at;\n"
	"float share(float d) {\n"
	"	float z = planes.x * planes.y / (planes.y - d * (planes.y - planes.x));\n"
	"	return clamp(log(z / planes.x) / log(planes.y / planes.x), 0.0, 1.0) * 65534.0;\n"
	"}\n"
	"vec2 bytes(float v) { return vec2(floor(v / 256.0), mod(v, 256.0)) / 255.0; }\n"
	"void main() {\n"
	"	vec2 first = floor(v_at * size / 8.0) * 8.0 + 0.5;\n"
	"	float low = 1.0, high = -1.0;\n"
	"	for (int y = 0; y < 8; y++) {\n"
	"		for (int x = 0; x < 8; x++) {\n"
	"			float d = texture2D(depth, (first + vec2(x, y)) / size).r;\n"
	"			low = min(low, d);\n"
	"			high = max(high, d < 1.0 ? d : -1.0);\n"
	"		}\n"
	"	}\n"
	"	gl_FragColor = high < 0.0 ? vec4(1.0)\n"
	"		: vec4(bytes(floor(share(low))), bytes(ceil(share(high))));\n"
	"}\n";

static int build_program(struct cube_frame *frame)
{
	const char *const vertex[] = { gl_square_vertex, NULL };
	const char *const fragment[] = { fragment_text, NULL };
	const struct gl_program_source source = { "range", vertex, fragment, gl_square_attributes };

	return gl_program_build(&frame->program, &source);
}

static GLuint make_texture(int width, int height, GLenum format, GLenum type)
{
	GLuint texture;

	glGenTextures(1, &texture);
	glBindTexture(GL_TEXTURE_2D, texture);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	glTexImage2D(GL_TEXTURE_2D, 0, (GLint)format, width, height, 0, format, type, NULL);
	return texture;
}

static int build_framebuffer(struct cube_frame *frame)
{
	int width = frame->width_px, height = frame->height_px, rc;

	frame->colour = make_texture(width, height, GL_RGBA, GL_UNSIGNED_BYTE);
	frame->depth = make_texture(width, height, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT);
	glGenFramebuffers(1, &frame->framebuffer);
	cube_frame_bind(frame);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, frame->colour,
			       0);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, frame->depth, 0);
	rc = gl_check("making a frame");
	if (rc == 0 && glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
		log_error("pipeline", "the GL driver cannot render %d x %d pixels", width, height);
		rc = -ENOTSUP;
	}
	return rc;
}

int cube_frame_create(struct cube_frame **out, int width_px, int height_px)
{
	struct cube_frame *frame = calloc(1, sizeof(*frame));
	int rc;

	*out = NULL;
	assert(width_px % BLOCK_PX == 0 && height_px % BLOCK_PX == 0);
	if (!frame)
		return -ENOMEM;
	frame->width_px = width_px;
	frame->height_px = height_px;
	frame->block_pixels =
		malloc((size_t)(width_px / BLOCK_PX) * (size_t)(height_px / BLOCK_PX) * 4);
	rc = frame->block_pixels ? 0 : -ENOMEM;
	if (rc == 0 && !gl_has_extension("GL_OES_depth_texture")) {
		log_error("pipeline", "the GL driver has no depth textures; run with "
				      "LIBGL_ALWAYS_SOFTWARE=1");
		rc = -ENOTSUP;
	}
	if (rc == 0)
		rc = gl_target_create(&frame->blocks, width_px / BLOCK_PX, height_px / BLOCK_PX);
	if (rc == 0)
		rc = build_program(frame);
	if (rc == 0)
		rc = build_framebuffer(frame);
	if (rc < 0) {
		cube_frame_destroy(frame);
		return rc;
	}
	*out = frame;
	return 0;
}

void cube_frame_destroy(struct cube_frame *frame)
{
	if (!frame)
		return;
	gl_target_destroy(&frame->blocks);
	if (frame->program)
		glDeleteProgram(frame->program);
	if (frame->framebuffer)
		glDeleteFramebuffers(1, &frame->framebuffer);
	if (frame->colour)
		glDeleteTextures(1, &frame->colour);
	if (frame->depth)
		glDeleteTextures(1, &frame->depth);
	free(frame->block_pixels);
	free(frame);
}

void cube_frame_bind(const struct cube_frame *frame)
{
	glBindFramebuffer(GL_FRAMEBUFFER, frame->framebuffer);
	glViewport(0, 0, frame->width_px, frame->height_px);
}

void cube_frame_bind_textures(const struct cube_frame *frame, unsigned colour_unit,
			      unsigned depth_unit, unsigned blocks_unit)
{
	gl_bind_texture(colour_unit, frame->colour);
	gl_bind_texture(depth_unit, frame->depth);
	gl_bind_texture(blocks_unit, frame->blocks.colour);
}

static void draw_blocks(struct cube_frame *frame, float plane_near_m, float plane_far_m)
{
	gl_target_bind(&frame->blocks);
	glDisable(GL_DEPTH_TEST);
	glDisable(GL_BLEND);
	glUseProgram(frame->program);
	gl_bind_texture(0, frame->depth);
	glUniform1i(glGetUniformLocation(frame->program, "depth"), 0);
	glUniform2f(glGetUniformLocation(frame->program, "size"), (float)frame->width_px,
		    (float)frame->height_px);
	glUniform2f(glGetUniformLocation(frame->program, "planes"), plane_near_m, plane_far_m);
	gl_draw_square();
}

int cube_frame_range(struct cube_frame *frame, float plane_near_m, float plane_far_m, bool *found,
		     float *near_m, float *far_m)
{
	int low = STEPS + 1, high = -1, count = frame->blocks.width_px * frame->blocks.height_px;
	float ratio = plane_far_m / plane_near_m;
	int rc;

	draw_blocks(frame, plane_near_m, plane_far_m);
	rc = gl_target_read(&frame->blocks, frame->block_pixels);
	if (rc < 0)
		return rc;
	for (int i = 0; i < count; i++) {
		const uint8_t *p = frame->block_pixels + 4 * i;
		int nearest = p[0] << 8 | p[1], farthest = p[2] << 8 | p[3];

		if (nearest > STEPS)
			continue;
		low = nearest < low ? nearest : low;
		high = farthest > high ? farthest : high;
	}
	*found = high >= 0;
	if (!*found)
		return 0;
	/* Widen by half a part in 1000, for the precision of the shader's logarithm. */
	*near_m = plane_near_m * powf(ratio, (float)low / STEPS) * 0.9995f;
	*far_m = plane_near_m * powf(ratio, (float)high / STEPS) * 1.0005f;
	return 0;
}
