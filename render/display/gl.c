/* Implements the GLES2 helpers. Each program is checked after linking for how many uniforms,
 * attributes and texture units it uses. */
#include "render/display/gl.h"

#include <assert.h>
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "render/display/fences.h"

enum { PARTS_MAX = 16, NAME_BYTES = 128, INFO_BYTES = 4096 };

static const char *error_name(GLenum error)
{
	switch (error) {
	case GL_INVALID_ENUM:
		return "invalid enum";
	case GL_INVALID_VALUE:
		return "invalid value";
	case GL_INVALID_OPERATION:
		return "invalid operation";
	case GL_INVALID_FRAMEBUFFER_OPERATION:
		return "invalid framebuffer operation";
	case GL_OUT_OF_MEMORY:
		return "out of memory";
	default:
		return "unknown error";
	}
}

int gl_check(const char *doing)
{
	int rc = 0;
	GLenum error;

	/* A driver that has failed may report errors for ever. */
	for (int n = 0; n < 8 && (error = glGetError()) != GL_NO_ERROR; n++) {
		if (error == GL_CONTEXT_LOST_KHR)
			return -ENOTRECOVERABLE;
		log_error("render", "%s: GL says %s", doing, error_name(error));
		rc = error == GL_OUT_OF_MEMORY ? -ENOMEM : -EIO;
	}
	return rc;
}

/* Returns whether word occurs in text, not as a part of a longer name. */
static bool has_word(const char *text, const char *word)
{
	size_t size = strlen(word);

	for (const char *at = text; (at = strstr(at, word)); at += size) {
		bool starts = at == text || !(isalnum((unsigned char)at[-1]) || at[-1] == '_');
		bool ends = !(isalnum((unsigned char)at[size]) || at[size] == '_');

		if (starts && ends)
			return true;
	}
	return false;
}

bool gl_has_extension(const char *name)
{
	const char *all = (const char *)glGetString(GL_EXTENSIONS);

	return all && has_word(all, name);
}

bool gl_has_highp(void)
{
	GLint range[2] = { 0, 0 }, bits = 0;

	glGetShaderPrecisionFormat(GL_FRAGMENT_SHADER, GL_HIGH_FLOAT, range, &bits);
	return bits > 0;
}

int gl_texture_most_px(void)
{
	const int limit = gl_has_highp() ? GL_LIMIT_TEXTURE_PX : GL_LIMIT_MEDIUMP_PX;
	GLint most = 0;

	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	return most < limit ? most : limit;
}

const char gl_fine_fragment[] = "#ifdef GL_FRAGMENT_PRECISION_HIGH\n"
				"precision highp float;\n"
				"#define FINE highp\n"
				"#else\n"
				"precision mediump float;\n"
				"#define FINE mediump\n"
				"#endif\n";

static int compile(GLuint *out, GLenum kind, const char *name, const char *const *parts)
{
	GLuint shader = glCreateShader(kind);
	GLint good = 0;
	GLsizei count = 0;

	while (parts[count])
		count++;
	assert(count <= PARTS_MAX);
	glShaderSource(shader, count, (const GLchar *const *)parts, NULL);
	glCompileShader(shader);
	glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
	if (!good) {
		char info[INFO_BYTES] = "";

		glGetShaderInfoLog(shader, sizeof(info), NULL, info);
		log_error("render", "kiosk bug: %s shader '%s' does not compile: %s",
			  kind == GL_VERTEX_SHADER ? "vertex" : "fragment", name, info);
		glDeleteShader(shader);
		return -EINVAL;
	}
	*out = shader;
	return 0;
}

static bool parts_have_word(const char *const *parts, const char *word)
{
	for (; *parts; parts++)
		if (has_word(*parts, word))
			return true;
	return false;
}

/* Returns how many components (quarters of a vec4) a uniform takes, assuming the packing of
 * appendix A of the GLSL ES 1.00 specification. */
static int quarters_of(GLenum type)
{
	switch (type) {
	case GL_FLOAT:
	case GL_INT:
	case GL_BOOL:
		return 1;
	case GL_FLOAT_VEC2:
	case GL_INT_VEC2:
	case GL_BOOL_VEC2:
		return 2;
	case GL_FLOAT_MAT2:
		return 8;
	case GL_FLOAT_MAT3:
		return 12;
	case GL_FLOAT_MAT4:
		return 16;
	default:
		return 4;
	}
}

/* Checks a program against the limits. GLES2 cannot tell which stage uses a uniform, so its name is
 * searched for in the text of each stage. */
static int judge_limits(GLuint program, const struct gl_program_source *source)
{
	GLint uniforms = 0, attributes = 0, units = 0, of_vertex = 0, of_fragment = 0;

	glGetProgramiv(program, GL_ACTIVE_ATTRIBUTES, &attributes);
	glGetProgramiv(program, GL_ACTIVE_UNIFORMS, &uniforms);
	for (GLint i = 0; i < uniforms; i++) {
		char name[NAME_BYTES] = "";
		GLint size = 0;
		GLenum type = 0;

		glGetActiveUniform(program, (GLuint)i, sizeof(name), NULL, &size, &type, name);
		name[strcspn(name, "[.")] = '\0';
		if (type == GL_SAMPLER_2D || type == GL_SAMPLER_CUBE) {
			units += size;
			if (parts_have_word(source->vertex, name))
				/* GLES2 guarantees no textures in vertex shaders */
				units += GL_LIMIT_UNITS;
			continue;
		}
		if (parts_have_word(source->vertex, name))
			of_vertex += size * quarters_of(type);
		if (parts_have_word(source->fragment, name))
			of_fragment += size * quarters_of(type);
	}
	of_vertex = (of_vertex + 3) / 4;
	of_fragment = (of_fragment + 3) / 4;
	if (units <= GL_LIMIT_UNITS && attributes <= GL_LIMIT_ATTRIBUTES &&
	    of_vertex <= GL_LIMIT_VERTEX_UNIFORMS && of_fragment <= GL_LIMIT_FRAGMENT_UNIFORMS)
		return 0;
	log_error("render",
		  "kiosk bug: program '%s' takes %d texture units, %d attributes, %d vertex and %d "
		  "fragment uniforms: more than every board has",
		  source->name, units, attributes, of_vertex, of_fragment);
	return -E2BIG;
}

static int link_program(GLuint program, const struct gl_program_source *source)
{
	GLint good = 0;

	for (GLuint i = 0; source->attributes[i]; i++)
		glBindAttribLocation(program, i, source->attributes[i]);
	glLinkProgram(program);
	glGetProgramiv(program, GL_LINK_STATUS, &good);
	if (!good) {
		char info[INFO_BYTES] = "";

		glGetProgramInfoLog(program, sizeof(info), NULL, info);
		log_error("render", "kiosk bug: program '%s' does not link: %s", source->name,
			  info);
		return -EINVAL;
	}
	return judge_limits(program, source);
}

int gl_program_build(GLuint *out, const struct gl_program_source *source)
{
	GLuint vertex = 0, fragment = 0, program = 0;
	int rc;

	*out = 0;
	rc = compile(&vertex, GL_VERTEX_SHADER, source->name, source->vertex);
	if (rc == 0)
		rc = compile(&fragment, GL_FRAGMENT_SHADER, source->name, source->fragment);
	if (rc == 0) {
		program = glCreateProgram();
		glAttachShader(program, vertex);
		glAttachShader(program, fragment);
		rc = link_program(program, source);
	}
	glDeleteShader(vertex);
	glDeleteShader(fragment);
	if (rc < 0) {
		glDeleteProgram(program);
		return rc;
	}
	*out = program;
	return 0;
}

static bool is_power_of_two(int n)
{
	return n > 0 && (n & (n - 1)) == 0;
}

int gl_texture_create(GLuint *out, const struct gl_texture_options *options)
{
	int width = options->width_px, height = options->height_px, rc;
	GLint wrap = options->repeat ? GL_REPEAT : GL_CLAMP_TO_EDGE;
	bool powers = is_power_of_two(width) && is_power_of_two(height);

	*out = 0;
	int most = options->large ? INT_MAX : GL_LIMIT_TEXTURE_PX;
	if (width < 1 || height < 1 || width > most || height > most ||
	    ((options->mipmaps || options->repeat) && !powers))
		return -EINVAL;
	glGenTextures(1, out);
	glBindTexture(GL_TEXTURE_2D, *out);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, (GLint)options->filter);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER,
			options->mipmaps ? GL_LINEAR_MIPMAP_LINEAR : (GLint)options->filter);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
	glTexImage2D(GL_TEXTURE_2D, 0, (GLint)options->format, width, height, 0, options->format,
		     options->type ? options->type : GL_UNSIGNED_BYTE, options->pixels);
	if (options->mipmaps && options->pixels)
		glGenerateMipmap(GL_TEXTURE_2D);
	rc = gl_check("making a texture");
	if (rc < 0) {
		glDeleteTextures(1, out);
		*out = 0;
	}
	return rc;
}

const char gl_square_vertex[] = "attribute vec2 a_position;\n"
				"varying vec2 v_at;\n"
				"void main() {\n"
				"	v_at = a_position * 0.5 + 0.5;\n"
				"	gl_Position = vec4(a_position, 0.0, 1.0);\n"
				"}\n";

const char *const gl_square_attributes[] = { "a_position", NULL };

void gl_draw_square(void)
{
	static const float corners[] = { -1, -1, 1, -1, 1, 1, 1, 1, -1, 1, -1, -1 };

	glBindBuffer(GL_ARRAY_BUFFER, 0);
	glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, corners);
	glEnableVertexAttribArray(0);
	glDrawArrays(GL_TRIANGLES, 0, 6); /* as a strip, llvmpipe takes twice as long */
	glDisableVertexAttribArray(0);
}

/* The coordinate is used as it is interpolated: even where fragments have only mediump, hardware
 * interpolates texture coordinates more exactly than it computes. */
static const char copy_fragment[] = "uniform FINE sampler2D u_picture;\n"
				    "varying vec2 v_at;\n"
				    "void main() {\n"
				    "	gl_FragColor = texture2D(u_picture, v_at);\n"
				    "}\n";

int gl_copy_build(GLuint *out)
{
	const struct gl_program_source source = {
		.name = "copy",
		.vertex = (const char *const[]){ gl_square_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, copy_fragment, NULL },
		.attributes = gl_square_attributes,
	};
	int rc = gl_program_build(out, &source);

	if (rc < 0)
		return rc;
	glUseProgram(*out);
	glUniform1i(glGetUniformLocation(*out, "u_picture"), 0);
	return 0;
}

void gl_copy_draw(GLuint program, GLuint texture)
{
	glDisable(GL_DEPTH_TEST);
	glUseProgram(program);
	gl_bind_texture(0, texture);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
	gl_draw_square();
}

void gl_bind_texture(unsigned unit, GLuint texture)
{
	assert(unit < GL_LIMIT_UNITS);
	glActiveTexture(GL_TEXTURE0 + unit);
	glBindTexture(GL_TEXTURE_2D, texture);
}

static void add_depth(struct gl_target *out)
{
	bool deep = gl_has_extension("GL_OES_depth24");

	out->depth_bits = deep ? 24 : 16;
	glGenRenderbuffers(1, &out->depth);
	glBindRenderbuffer(GL_RENDERBUFFER, out->depth);
	glRenderbufferStorage(GL_RENDERBUFFER,
			      deep ? GL_DEPTH_COMPONENT24_OES : GL_DEPTH_COMPONENT16, out->width_px,
			      out->height_px);
	glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, out->depth);
}

static int add_depths(struct gl_target *out)
{
	const struct gl_texture_options depths = { .width_px = out->width_px,
						   .height_px = out->height_px,
						   .format = GL_DEPTH_COMPONENT,
						   .type = GL_UNSIGNED_INT,
						   .filter = GL_NEAREST,
						   .large = true };
	int rc = gl_texture_create(&out->depths, &depths);

	if (rc == 0)
		glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D,
				       out->depths, 0);
	return rc;
}

GLenum gl_picture_format(void)
{
	return gl_has_extension("GL_EXT_texture_format_BGRA8888") ? GL_BGRA_EXT : GL_RGBA;
}

enum kind { FLAT, USUAL, DEEP };

static int create_target(struct gl_target *out, int width_px, int height_px, enum kind kind)
{
	const struct gl_texture_options colour = { .width_px = width_px,
						   .height_px = height_px,
						   .format = gl_picture_format(),
						   .filter = GL_NEAREST,
						   .large = true };
	int rc;

	*out = (struct gl_target){ .width_px = width_px, .height_px = height_px };
	rc = gl_texture_create(&out->colour, &colour);
	if (rc < 0)
		goto fail;
	glGenFramebuffers(1, &out->framebuffer);
	gl_target_bind(out);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, out->colour, 0);
	if (kind == USUAL)
		add_depth(out);
	if (kind == DEEP)
		rc = add_depths(out);
	if (rc == 0)
		rc = gl_check("making a framebuffer");
	if (rc == 0 && glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
		log_error("render", "the driver cannot create a framebuffer of %d x %d", width_px,
			  height_px);
		rc = -EIO;
	}
	if (rc == 0)
		return 0;
fail:
	gl_target_destroy(out);
	return rc;
}

int gl_target_create(struct gl_target *out, int width_px, int height_px)
{
	return create_target(out, width_px, height_px, USUAL);
}

int gl_target_create_flat(struct gl_target *out, int width_px, int height_px)
{
	return create_target(out, width_px, height_px, FLAT);
}

int gl_target_create_deep(struct gl_target *out, int width_px, int height_px)
{
	return create_target(out, width_px, height_px, DEEP);
}

void gl_target_smooth(const struct gl_target *target)
{
	gl_bind_texture(0, target->colour);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
}

void gl_target_destroy(struct gl_target *target)
{
	if (!target)
		return;
	if (target->framebuffer)
		glDeleteFramebuffers(1, &target->framebuffer);
	if (target->depth)
		glDeleteRenderbuffers(1, &target->depth);
	if (target->colour)
		glDeleteTextures(1, &target->colour);
	if (target->depths)
		glDeleteTextures(1, &target->depths);
	*target = (struct gl_target){ 0 };
}

void gl_bind_framebuffer(GLuint framebuffer)
{
	fences_add();
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
}

void gl_finish(void)
{
	fences_add();
	glFinish();
}

void gl_target_bind(const struct gl_target *target)
{
	gl_bind_framebuffer(target->framebuffer);
	glViewport(0, 0, target->width_px, target->height_px);
}

int gl_target_read(const struct gl_target *target, uint8_t *rgba)
{
	size_t row = (size_t)target->width_px * 4;
	uint8_t *spare = malloc(row);

	if (!spare)
		return -ENOMEM;
	gl_target_bind(target);
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	glReadPixels(0, 0, target->width_px, target->height_px, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
	for (int y = 0; y < target->height_px / 2; y++) {
		uint8_t *low = rgba + (size_t)y * row;
		uint8_t *high = rgba + (size_t)(target->height_px - 1 - y) * row;

		memcpy(spare, low, row);
		memcpy(low, high, row);
		memcpy(high, spare, row);
	}
	free(spare);
	return gl_check("reading a picture");
}

void gl_place_bind(const struct gl_place *place, int width_px, int height_px)
{
	gl_bind_framebuffer(place->framebuffer);
	glViewport(place->x_px, place->y_px, width_px, height_px);
}
