/* Simulates a weak board on a strong one: preloaded (LD_PRELOAD) before GLES2, it hides what such a
 * board lacks and rejects what such a driver rejects. WEAK_GL names the limits, separated by
 * commas:
 *
 *   size     textures, renderbuffers and viewports of at most 2048 pixels per side
 *   units    eight texture units, none for vertices
 *   mediump  no highp in fragment shaders; Mesa's llvmpipe then computes them in 16 bits
 *   rgba8    no GL_OES_rgb8_rgba8: renderbuffers of RGBA4, RGB565, RGB5_A1 and depth
 *   index    no GL_OES_element_index_uint: indices of at most 16 bits
 *   depth24  no GL_OES_depth24: 16 bits of depth
 *   bgra     no GL_EXT_texture_format_BGRA8888: textures in no order of bytes but RGBA
 *   all      all of them
 *
 * At exit it writes a line of JSON to the file that WEAK_GL_REPORT names: how often something was
 * rejected, and the maximum bytes of textures at once, of RGB (tiles and depths, which a board's
 * budget covers) and of all. Every rejection is printed on stderr. */
#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GL_GLEXT_PROTOTYPES
#include <GLES2/gl2.h>
#include <GLES2/gl2ext.h>

enum { SIDE_MAX = 2048, UNITS_MAX = 8, NAMES_MAX = 65536, PROGRAMS_MAX = 64 };

/* The function that the product would have called. */
#define REAL(name) ((__typeof__(&(name)))real(#name))

static void *real(const char *name)
{
	void *found = dlsym(RTLD_NEXT, name);
	if (!found) {
		fprintf(stderr, "weak_gl: there is no %s\n", name);
		abort();
	}
	return found;
}

static GLenum pending = GL_NO_ERROR;
static unsigned refusals;
static bool used;

static struct {
	size_t bytes;
	bool rgb;
} held[NAMES_MAX];
static size_t all_bytes, all_most, rgb_bytes, rgb_most;
static GLuint unlinked[PROGRAMS_MAX]; /* programs that ask for too much */
static unsigned unlinked_count;

/* ---- what holds, what was refused */

static bool holds(const char *limit)
{
	const char *list = getenv("WEAK_GL");
	size_t size = strlen(limit);
	for (const char *at = list; at && *at; at += strcspn(at, ","), at += *at == ',') {
		size_t word = strcspn(at, ",");
		if ((word == size && strncmp(at, limit, size) == 0) ||
		    (word == 3 && strncmp(at, "all", 3) == 0))
			return true;
	}
	return false;
}

static void refuse(GLenum error, const char *what, int a, int b)
{
	fprintf(stderr, "weak_gl: refused: %s (%d, %d)\n", what, a, b);
	refusals++;
	if (pending == GL_NO_ERROR)
		pending = error;
}

GL_APICALL GLenum GL_APIENTRY glGetError(void)
{
	GLenum error = pending;
	pending = GL_NO_ERROR;
	return error != GL_NO_ERROR ? error : REAL(glGetError)();
}

__attribute__((destructor)) static void report(void)
{
	const char *path = getenv("WEAK_GL_REPORT");
	FILE *file = used && path ? fopen(path, "w") : NULL;
	if (!file)
		return;
	fprintf(file, "{\"refusals\": %u, \"rgb_bytes\": %zu, \"all_bytes\": %zu}\n", refusals,
		rgb_most, all_most);
	fclose(file);
}

/* ---- what the board says of itself */

static const char *hidden_by(const char *limit)
{
	static const char *const table[][2] = {
		{ "rgba8", "GL_OES_rgb8_rgba8" },
		{ "rgba8", "GL_ARM_rgba8" },
		{ "index", "GL_OES_element_index_uint" },
		{ "depth24", "GL_OES_depth24" },
		{ "bgra", "GL_EXT_texture_format_BGRA8888" },
	};
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++)
		if (strcmp(table[i][1], limit) == 0)
			return table[i][0];
	return NULL;
}

GL_APICALL const GLubyte *GL_APIENTRY glGetString(GLenum name)
{
	static char kept[65536];
	const GLubyte *all = REAL(glGetString)(name);
	if (name != GL_EXTENSIONS || !all)
		return all;
	char *words = strdup((const char *)all), *rest = words, *word;
	size_t at = 0;
	while ((word = strsep(&rest, " "))) {
		const char *limit = hidden_by(word);
		if (*word && !(limit && holds(limit)) && at + strlen(word) + 2 < sizeof(kept))
			at += (size_t)snprintf(kept + at, sizeof(kept) - at, "%s ", word);
	}
	free(words);
	return (const GLubyte *)kept;
}

static void limit_value(GLint *value, GLint most)
{
	if (*value > most)
		*value = most;
}

GL_APICALL void GL_APIENTRY glGetIntegerv(GLenum name, GLint *out)
{
	REAL(glGetIntegerv)(name, out);
	if (holds("size") && (name == GL_MAX_TEXTURE_SIZE || name == GL_MAX_RENDERBUFFER_SIZE ||
			      name == GL_MAX_CUBE_MAP_TEXTURE_SIZE))
		limit_value(out, SIDE_MAX);
	if (holds("size") && name == GL_MAX_VIEWPORT_DIMS) {
		limit_value(&out[0], SIDE_MAX);
		limit_value(&out[1], SIDE_MAX);
	}
	if (holds("units") && name == GL_MAX_VERTEX_TEXTURE_IMAGE_UNITS)
		*out = 0;
	if (holds("units") &&
	    (name == GL_MAX_TEXTURE_IMAGE_UNITS || name == GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS))
		limit_value(out, UNITS_MAX);
}

GL_APICALL void GL_APIENTRY glGetShaderPrecisionFormat(GLenum kind, GLenum precision, GLint *range,
						       GLint *bits)
{
	REAL(glGetShaderPrecisionFormat)(kind, precision, range, bits);
	if (!holds("mediump") || kind != GL_FRAGMENT_SHADER)
		return;
	if (precision == GL_HIGH_FLOAT || precision == GL_HIGH_INT)
		range[0] = range[1] = *bits = 0;
	if (precision == GL_MEDIUM_FLOAT) {
		range[0] = range[1] = 14;
		*bits = 10;
	}
}

/* ---- textures */

static size_t bytes_of(GLsizei width, GLsizei height, GLenum format, GLenum type)
{
	size_t pixel = format == GL_RGBA              ? 4
		       : format == GL_BGRA_EXT        ? 4
		       : format == GL_RGB             ? 3
		       : format == GL_LUMINANCE_ALPHA ? 2
						      : 1;
	if (type != GL_UNSIGNED_BYTE)
		pixel = 2;
	return pixel * (size_t)width * (size_t)height;
}

static void hold(GLuint name, size_t bytes, bool rgb)
{
	used = true;
	if (name >= NAMES_MAX)
		abort();
	all_bytes += bytes - held[name].bytes;
	if (held[name].rgb)
		rgb_bytes -= held[name].bytes;
	if (rgb)
		rgb_bytes += bytes;
	held[name].bytes = bytes;
	held[name].rgb = rgb;
	all_most = all_bytes > all_most ? all_bytes : all_most;
	rgb_most = rgb_bytes > rgb_most ? rgb_bytes : rgb_most;
}

static GLuint bound(void)
{
	GLint name = 0;
	REAL(glGetIntegerv)(GL_TEXTURE_BINDING_2D, &name);
	return (GLuint)name;
}

GL_APICALL void GL_APIENTRY glTexImage2D(GLenum target, GLint level, GLint internal, GLsizei width,
					 GLsizei height, GLint border, GLenum format, GLenum type,
					 const void *pixels)
{
	if (holds("size") && (width > SIDE_MAX || height > SIDE_MAX)) {
		refuse(GL_INVALID_VALUE, "a texture of that size", width, height);
		return;
	}
	if ((GLenum)internal != format) { /* GLES2 knows no sized formats */
		refuse(GL_INVALID_OPERATION, "a texture of that format", internal, (int)format);
		return;
	}
	if (holds("bgra") && format == GL_BGRA_EXT) {
		refuse(GL_INVALID_ENUM, "a texture of BGRA", width, height);
		return;
	}
	if (level == 0)
		hold(bound(), bytes_of(width, height, format, type), format == GL_RGB);
	REAL(glTexImage2D)
	(target, level, internal, width, height, border, format, type, pixels);
}

GL_APICALL void GL_APIENTRY glGenerateMipmap(GLenum target)
{
	GLuint name = bound();
	hold(name, held[name].bytes + held[name].bytes / 3, held[name].rgb);
	REAL(glGenerateMipmap)(target);
}

GL_APICALL void GL_APIENTRY glDeleteTextures(GLsizei count, const GLuint *names)
{
	for (GLsizei i = 0; i < count; i++)
		hold(names[i], 0, false);
	REAL(glDeleteTextures)(count, names);
}

GL_APICALL void GL_APIENTRY glActiveTexture(GLenum unit)
{
	if (holds("units") && unit >= GL_TEXTURE0 + UNITS_MAX)
		refuse(GL_INVALID_ENUM, "a texture unit", (int)(unit - GL_TEXTURE0), 0);
	else
		REAL(glActiveTexture)(unit);
}

/* ---- what is drawn into */

static bool is_refused_format(GLenum format)
{
	switch (format) {
	case GL_RGB8_OES:
	case GL_RGBA8_OES:
		return holds("rgba8");
	case GL_DEPTH_COMPONENT24_OES:
		return holds("depth24");
	default:
		return false;
	}
}

GL_APICALL void GL_APIENTRY glRenderbufferStorage(GLenum target, GLenum format, GLsizei width,
						  GLsizei height)
{
	if (holds("size") && (width > SIDE_MAX || height > SIDE_MAX))
		refuse(GL_INVALID_VALUE, "a renderbuffer of that size", width, height);
	else if (is_refused_format(format))
		refuse(GL_INVALID_ENUM, "a renderbuffer of that format", (int)format, 0);
	else
		REAL(glRenderbufferStorage)(target, format, width, height);
}

/* A driver clamps without a word, and the picture is wrong: counted, so that a test sees it. */
GL_APICALL void GL_APIENTRY glViewport(GLint x, GLint y, GLsizei width, GLsizei height)
{
	if (holds("size") && (width > SIDE_MAX || height > SIDE_MAX)) {
		refuse(GL_NO_ERROR, "a viewport of that size", width, height);
		limit_value(&width, SIDE_MAX);
		limit_value(&height, SIDE_MAX);
	}
	REAL(glViewport)(x, y, width, height);
}

GL_APICALL void GL_APIENTRY glDrawElements(GLenum mode, GLsizei count, GLenum type,
					   const void *indices)
{
	if (holds("index") && type == GL_UNSIGNED_INT)
		refuse(GL_INVALID_ENUM, "indices of 32 bits", count, 0);
	else
		REAL(glDrawElements)(mode, count, type, indices);
}

/* ---- programs */

/* The text with one word for another of the same length. */
static void replace(char *text, const char *word, const char *by)
{
	for (char *at = text; (at = strstr(at, word)); at += strlen(by))
		memcpy(at, by, strlen(by));
}

static char *join(GLsizei count, const GLchar *const *parts, const GLint *lengths)
{
	size_t bytes = 1;
	for (GLsizei i = 0; i < count; i++)
		bytes += lengths && lengths[i] >= 0 ? (size_t)lengths[i] : strlen(parts[i]);
	char *text = calloc(bytes, 1);
	for (GLsizei i = 0; text && i < count; i++)
		strncat(text, parts[i],
			lengths && lengths[i] >= 0 ? (size_t)lengths[i] : strlen(parts[i]));
	return text;
}

/* Without highp its macro is not there, and the word does not compile. */
GL_APICALL void GL_APIENTRY glShaderSource(GLuint shader, GLsizei count, const GLchar *const *parts,
					   const GLint *lengths)
{
	GLint kind = 0;
	glGetShaderiv(shader, GL_SHADER_TYPE, &kind);
	char *text = holds("mediump") ? join(count, parts, lengths) : NULL;
	if (!text) {
		REAL(glShaderSource)(shader, count, parts, lengths);
		return;
	}
	replace(text, "GL_FRAGMENT_PRECISION_HIGH", "GL_FRAGMENT_PRECISION_NONE");
	const GLchar *both[] = {
		kind == GL_FRAGMENT_SHADER ? "#define highp this_board_has_no_highp\n" : "", text
	};
	REAL(glShaderSource)(shader, 2, both, NULL);
	free(text);
}

static GLint samplers_of(GLuint program)
{
	GLint uniforms = 0, units = 0;
	glGetProgramiv(program, GL_ACTIVE_UNIFORMS, &uniforms);
	for (GLint i = 0; i < uniforms; i++) {
		char name[256];
		GLint size = 0;
		GLenum type = 0;
		glGetActiveUniform(program, (GLuint)i, sizeof(name), NULL, &size, &type, name);
		if (type == GL_SAMPLER_2D || type == GL_SAMPLER_CUBE)
			units += size;
	}
	return units;
}

GL_APICALL void GL_APIENTRY glLinkProgram(GLuint program)
{
	REAL(glLinkProgram)(program);
	GLint units = holds("units") ? samplers_of(program) : 0;
	if (units <= UNITS_MAX)
		return;
	refuse(GL_NO_ERROR, "a program of that many texture units", units, 0);
	if (unlinked_count < PROGRAMS_MAX)
		unlinked[unlinked_count++] = program;
}

GL_APICALL void GL_APIENTRY glGetProgramiv(GLuint program, GLenum name, GLint *out)
{
	REAL(glGetProgramiv)(program, name, out);
	for (unsigned i = 0; name == GL_LINK_STATUS && i < unlinked_count; i++)
		if (unlinked[i] == program)
			*out = GL_FALSE;
}
