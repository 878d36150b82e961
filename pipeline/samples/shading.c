/* Resolves a multisampled frame into a picture with a fragment shader. */
#include "pipeline/samples/shading.h"

#include <errno.h>
#include <stdlib.h>

#include "render/display/gl.h"

struct shading {
	const struct cube_frame *frame; /* borrowed */
	int width_px, height_px;        /* of the frame */
	int side;                       /* samples per pixel and axis */
	struct gl_target picture;
	GLuint mask, program;
	uint8_t *pixels; /* owned */
};

/* As in cube_frame.c, samplers are explicitly highp and gl_FragCoord is not used. */
static const char one_sample[] = "#define SIDE 1\n";
static const char four_samples[] = "#define SIDE 2\n";
static const char fragment_head[] =
	"precision highp float;\n"
	"const int SAMPLES = SIDE * SIDE;\n"
	"float code(float covered, float backs) {\n" /* see shading.h */
	"	return float(4 / SAMPLES) * (covered * 8.0 + backs) / 255.0;\n"
	"}\n"
	"uniform highp sampler2D colour; uniform vec2 size; varying vec2 v_at;\n"
	"vec2 place(int i) {\n"
	"	vec2 odd = vec2(mod(float(i), float(SIDE)), floor(float(i) / float(SIDE)));\n"
	"	return floor(v_at * size / float(SIDE)) * float(SIDE) + 0.5 + odd;\n"
	"}\n";

/* A software rasteriser skips a shader only where no pixel passes the depth test. So the mask sets
 * the depth of the pixels that need shading. */
static const char mask_text[] = "precision highp float;\n"
				"uniform highp sampler2D blocks; varying vec2 v_at;\n"
				"void main() {\n"
				"	if (texture2D(blocks, v_at) == vec4(1.0)) discard;\n"
				"	gl_FragColor = vec4(0.0);\n"
				"}\n";

static const char colour_main[] =
	"void main() {\n"
	"	vec3 sum = vec3(0.0);\n"
	"	float covered = 0.0, backs = 0.0;\n"
	"	for (int i = 0; i < SAMPLES; i++) {\n"
	"		vec4 texel = texture2D(colour, place(i) / size);\n"
	"		float there = step(0.5, texel.a);\n"
	"		sum += there * texel.rgb;\n"
	"		covered += there;\n"
	"		backs += there * step(texel.a, 254.5 / 255.0);\n"
	"	}\n"
	"	gl_FragColor = vec4(sum / max(covered, 1.0), code(covered, backs));\n"
	"}\n";

static int build_program(struct shading *shading)
{
	const char *const vertex[] = { gl_square_vertex, NULL };
	const char *const side = shading->side == 1 ? one_sample : four_samples;
	const char *const fragment[] = { side, fragment_head, colour_main, NULL };
	const struct gl_program_source source = { "shading", vertex, fragment,
						  gl_square_attributes };
	const char *const mask[] = { mask_text, NULL };
	const struct gl_program_source mask_source = { "mask", vertex, mask, gl_square_attributes };
	int rc = gl_program_build(&shading->mask, &mask_source);

	if (rc == 0)
		rc = gl_program_build(&shading->program, &source);
	if (rc < 0)
		return rc;
	glUseProgram(shading->mask);
	glUniform1i(glGetUniformLocation(shading->mask, "blocks"), 2);
	glUseProgram(shading->program);
	glUniform1i(glGetUniformLocation(shading->program, "colour"), 0);
	glUniform2f(glGetUniformLocation(shading->program, "size"), (float)shading->width_px,
		    (float)shading->height_px);
	return gl_check("making the shading");
}

int shading_create(struct shading **out, const struct cube_frame *frame, int width_px,
		   int height_px, int side)
{
	struct shading *shading = calloc(1, sizeof(*shading));
	int rc;

	*out = NULL;
	if (!shading)
		return -ENOMEM;
	shading->frame = frame;
	shading->width_px = width_px;
	shading->height_px = height_px;
	shading->side = side;
	shading->pixels = malloc((size_t)(width_px / side) * (size_t)(height_px / side) * 4);
	rc = shading->pixels ? 0 : -ENOMEM;
	if (rc == 0)
		rc = gl_target_create(&shading->picture, width_px / side, height_px / side);
	if (rc == 0)
		rc = build_program(shading);
	if (rc < 0) {
		shading_destroy(shading);
		return rc;
	}
	*out = shading;
	return 0;
}

void shading_destroy(struct shading *shading)
{
	if (!shading)
		return;
	gl_target_destroy(&shading->picture);
	glDeleteProgram(shading->mask);
	glDeleteProgram(shading->program);
	free(shading->pixels);
	free(shading);
}

int shading_take(struct shading *shading, const uint8_t **rgba)
{
	gl_target_bind(&shading->picture);
	glClearColor(0, 0, 0, 0);
	glClearDepthf(1);
	glDepthMask(GL_TRUE);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	glEnable(GL_DEPTH_TEST);
	glDisable(GL_BLEND);
	cube_frame_bind_textures(shading->frame, 0, 1, 2);
	glUseProgram(shading->mask);
	glDepthFunc(GL_LESS);
	gl_draw_square();
	glUseProgram(shading->program);
	glDepthFunc(GL_EQUAL);
	glDepthMask(GL_FALSE);
	gl_draw_square();
	glDepthMask(GL_TRUE);
	*rgba = shading->pixels;
	return gl_target_read(&shading->picture, shading->pixels);
}
