/* Resolves a multisampled frame into a picture with a fragment shader, which also computes the
 * procedural material. */
#include "pipeline/samples/shading.h"

#include <errno.h>
#include <stdlib.h>

#include "geometry/light.h"
#include "pipeline/material/material.h"
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
	"uniform highp sampler2D colour; uniform highp sampler2D depth;\n"
	"uniform vec2 size; uniform vec2 planes; uniform float px_radians;\n"
	"uniform vec3 eye; uniform vec3 corner_ray; uniform vec3 right; uniform vec3 up;\n"
	"uniform vec3 sun; varying vec2 v_at;\n"
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

static const char no_light[] = "float shade(vec3 n, float open) { return 1.0; }\n";
static const char sun_light[] = "float shade(vec3 n, float open) { return light(n, open, sun); }\n";

/* Unpacks a sample's surface, as drawing.c packs it. */
static const char unpack[] =
	"vec3 at[4]; vec3 normal[4]; float shine[4]; float left[4]; float mine[4];\n"
	"vec3 middle; float spread;\n"
	"vec3 position(vec2 px) {\n"
	"	float d = texture2D(depth, px / size).r;\n"
	"	float z = planes.x * planes.y / (planes.y - d * (planes.y - planes.x));\n"
	"	return eye + (corner_ray + px.x * right + px.y * up) * z;\n"
	"}\n"
	"vec3 pick(int i) { return i == 0 ? at[0] : i == 1 ? at[1] : i == 2 ? at[2] : at[3]; }\n"
	"float is_mine(int i) {\n"
	"	return i == 0 ? mine[0] : i == 1 ? mine[1] : i == 2 ? mine[2] : mine[3];\n"
	"}\n";

/* Each loop ends with a break at its very end, on purpose. A software rasteriser executes both
 * sides of a condition, and after a break the rest of the loop's body. */
static const char material_means[] =
	"float mean_detail(float frequency, float footprint) {\n"
	"	float cells = frequency * footprint, sum = 0.0, weight = 0.0;\n"
	"	float count = cells >= 1.0 ? 0.0 : cells < 0.15 ? 1.0 : float(SAMPLES);\n"
	"	int i = 0;\n"
	"	while (true) {\n"
	"		float w = count < 2.0 ? 1.0 : is_mine(i);\n"
	"		vec3 p = count < 2.0 ? middle : pick(i);\n"
	"		sum += w * material_detail(p, frequency, footprint);\n"
	"		weight += w;\n"
	"		i++;\n"
	"		if (float(i) >= count) break;\n"
	"	}\n"
	"	return weight > 0.0 ? sum / weight : 0.5;\n"
	"}\n"
	"vec4 mean_block(vec3 n, float footprint) {\n"
	"	vec4 sum = vec4(0.0);\n"
	"	float weight = 0.0;\n"
	"	int i = -1;\n"
	"	while (true) {\n"
	"		vec4 block = material_block(i < 0 ? middle : pick(i), n, footprint);\n"
	"		if (i < 0 && block.w > 0.014 + 1.2 * spread) {\n"
	"			sum = block;\n"
	"			weight = 1.0;\n"
	"			i = SAMPLES;\n"
	"		} else if (i >= 0) {\n"
	"			sum += is_mine(i) * block;\n"
	"			weight += is_mine(i);\n"
	"		}\n"
	"		i++;\n"
	"		if (i >= SAMPLES) break;\n"
	"	}\n"
	"	return sum / weight;\n"
	"}\n"
	"vec3 base(vec3 n) {\n"
	"	float footprint = distance(middle, eye) * px_radians;\n"
	"	return material_paint(middle, n, footprint, mean_block(n, footprint),\n"
	"			   mean_detail(23.0, footprint), mean_detail(97.0, footprint));\n"
	"}\n";

/* Samples that lie together are shaded together. Each round starts with the first sample that is
 * left. */
static const char material_main[] =
	"void main() {\n"
	"	vec3 sum = vec3(0.0);\n"
	"	float covered = 0.0, backs = 0.0;\n"
	"	for (int i = 0; i < 4; i++)\n"
	"		left[i] = mine[i] = 0.0;\n"
	"	for (int i = 0; i < SAMPLES; i++) {\n"
	"		vec4 surface = texture2D(colour, place(i) / size);\n"
	"		float open = floor(surface.a * 255.0 + 0.5);\n"
	"		bool back = open < 128.0;\n"
	"		left[i] = open > 0.0 ? 1.0 : 0.0;\n"
	"		covered += left[i];\n"
	"		backs += back ? left[i] : 0.0;\n"
	"		open = back ? (open - 1.0) / 126.0 : (open - 128.0) / 127.0;\n"
	"		normal[i] = normalize(surface.rgb * 2.0 - 1.0);\n"
	"		shine[i] = shade(normal[i], open);\n"
	"		at[i] = position(place(i));\n"
	"	}\n"
	"	while (true) {\n"
	"		int first = left[0] > 0.5 ? 0 : left[1] > 0.5 ? 1 : left[2] > 0.5 ? 2 : 3;\n"
	"		vec3 from = pick(first);\n"
	"		vec3 ahead = first == 0 ? normal[0] : first == 1 ? normal[1]\n"
	"			   : first == 2 ? normal[2] : normal[3];\n"
	"		vec3 n = vec3(0.0);\n"
	"		float count = 0.0;\n"
	"		middle = vec3(0.0);\n"
	"		for (int i = 0; i < SAMPLES; i++) {\n"
	"			bool away = distance(at[i], from) > 0.1 ||\n"
	"				    dot(normal[i], ahead) < 0.7;\n"
	"			mine[i] = away ? 0.0 : left[i];\n"
	"			left[i] -= mine[i];\n"
	"			middle += mine[i] * at[i];\n"
	"			n += mine[i] * normal[i];\n"
	"			count += mine[i];\n"
	"		}\n"
	"		middle /= max(count, 1.0);\n"
	"		spread = 0.0;\n"
	"		for (int i = 0; i < SAMPLES; i++)\n"
	"			spread = max(spread, mine[i] * distance(at[i], middle));\n"
	"		vec3 rgb = base(normalize(n));\n"
	"		for (int i = 0; i < SAMPLES; i++)\n"
	"			sum += mine[i] * min(vec3(1.0), rgb * shine[i]);\n"
	"		if (left[0] + left[1] + left[2] + left[3] < 0.5) break;\n"
	"	}\n"
	"	vec3 mean = covered > 0.5 ? sum / covered : vec3(0.0);\n"
	"	gl_FragColor = vec4(mean, code(covered, backs));\n"
	"}\n";

static int build_program(struct shading *shading, const struct drawing_options *options)
{
	const char *const vertex[] = { gl_square_vertex, NULL };
	const char *const side = shading->side == 1 ? one_sample : four_samples;
	const char *const plain[] = { side, fragment_head, colour_main, NULL };
	const char *const material[] = { side,
					 fragment_head,
					 material_glsl,
					 options->lit ? light_glsl : "",
					 options->lit ? sun_light : no_light,
					 unpack,
					 material_means,
					 material_main,
					 NULL };
	const struct gl_program_source source = { "shading", vertex,
						  options->procedural ? material : plain,
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
	glUniform1i(glGetUniformLocation(shading->program, "depth"), 1);
	glUniform2f(glGetUniformLocation(shading->program, "size"), (float)shading->width_px,
		    (float)shading->height_px);
	glUniform3fv(glGetUniformLocation(shading->program, "sun"), 1, options->sun);
	return gl_check("making the shading");
}

int shading_create(struct shading **out, const struct cube_frame *frame, int width_px,
		   int height_px, int side, const struct drawing_options *options)
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
		rc = build_program(shading, options);
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

/* A ray from the eye to the plane one metre in front of it, through a point of the frame. */
static void ray_to(float out[3], const struct camera *camera, float x_px, float y_px)
{
	float middle[3], along = 0;

	camera_ray(camera, (float)camera->width_px / 2, (float)camera->height_px / 2, middle);
	camera_ray(camera, x_px, y_px, out);
	for (int i = 0; i < 3; i++)
		along += out[i] * middle[i];
	for (int i = 0; i < 3; i++)
		out[i] /= along;
}

/* Sets the rays of GL's pixels, whose rows go upwards: corner_ray + x * right + y * up. */
static void set_camera(const struct shading *shading, const struct camera *camera)
{
	float width = (float)camera->width_px, height = (float)camera->height_px;
	float corner[3], right[3], up[3];
	GLuint program = shading->program;

	ray_to(corner, camera, 0, height);
	ray_to(right, camera, width, height);
	ray_to(up, camera, 0, 0);
	for (int i = 0; i < 3; i++) {
		right[i] = (right[i] - corner[i]) / width;
		up[i] = (up[i] - corner[i]) / height;
	}
	glUniform3fv(glGetUniformLocation(program, "eye"), 1, camera->eye_m);
	glUniform3fv(glGetUniformLocation(program, "corner_ray"), 1, corner);
	glUniform3fv(glGetUniformLocation(program, "right"), 1, right);
	glUniform3fv(glGetUniformLocation(program, "up"), 1, up);
	glUniform2f(glGetUniformLocation(program, "planes"), camera->near_m, camera->far_m);
	glUniform1f(glGetUniformLocation(program, "px_radians"), 1 / camera_px_per_radian(camera));
}

int shading_take(struct shading *shading, const struct camera *camera, const uint8_t **rgba)
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
	set_camera(shading, camera);
	glDepthFunc(GL_EQUAL);
	glDepthMask(GL_FALSE);
	gl_draw_square();
	glDepthMask(GL_TRUE);
	*rgba = shading->pixels;
	return gl_target_read(&shading->picture, shading->pixels);
}
