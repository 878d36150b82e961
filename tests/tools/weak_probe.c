/* Requests from GLES2 what a weak board lacks, one thing after the other, and prints whether each
 * was given. A test of weak boards uses it to check that weak_gl removes what it names. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/display/gl.h"
#include "render/display/headless.h"

enum { LARGE_PX = 2049, UNITS = 9 };

static bool no_error(void)
{
	bool none = true;
	while (glGetError() != GL_NO_ERROR)
		none = false;
	return none;
}

static bool gives_texture(GLenum format, int width_px)
{
	GLuint name;
	GLint most = 0;
	glGenTextures(1, &name);
	glBindTexture(GL_TEXTURE_2D, name);
	glTexImage2D(GL_TEXTURE_2D, 0, (GLint)format, width_px, 8, 0, format, GL_UNSIGNED_BYTE,
		     NULL);
	bool given = no_error();
	glDeleteTextures(1, &name);
	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	return given && most >= width_px;
}

/* Whether a framebuffer stands on it. */
static bool gives_renderbuffer(GLenum format, GLenum attachment, int side_px)
{
	GLuint buffer, frame;
	glGenRenderbuffers(1, &buffer);
	glGenFramebuffers(1, &frame);
	glBindRenderbuffer(GL_RENDERBUFFER, buffer);
	glBindFramebuffer(GL_FRAMEBUFFER, frame);
	glRenderbufferStorage(GL_RENDERBUFFER, format, side_px, 8);
	glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
	bool whole = attachment != GL_COLOR_ATTACHMENT0 ||
		     glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
	bool given = no_error() && whole;
	glDeleteFramebuffers(1, &frame);
	glDeleteRenderbuffers(1, &buffer);
	return given;
}

static bool gives_unit(void)
{
	glActiveTexture(GL_TEXTURE0 + UNITS - 1);
	bool given = no_error();
	glActiveTexture(GL_TEXTURE0);
	return given;
}

/* Whether a square is drawn so; what stands in its first pixel then. */
static bool draws(const char *fragment, GLenum index, uint8_t rgba[4])
{
	static const uint32_t wide[] = { 0, 1, 2, 2, 1, 3 };
	static const uint16_t narrow[] = { 0, 1, 2, 2, 1, 3 };
	static const float corners[] = { -1, -1, 1, -1, -1, 1, 1, 1 };
	const struct gl_program_source source = {
		.name = "probe",
		.vertex = (const char *const[]){ gl_square_vertex, NULL },
		.fragment = (const char *const[]){ fragment, NULL },
		.attributes = gl_square_attributes,
	};
	struct gl_target target;
	GLuint program;
	if (gl_target_create_flat(&target, 1, 1) < 0)
		return false;
	bool drawn = gl_program_build(&program, &source) == 0;
	if (drawn) {
		glUseProgram(program);
		glUniform2f(glGetUniformLocation(program, "u_numbers"), 2048, 1);
		glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, corners);
		glEnableVertexAttribArray(0);
		glDrawElements(GL_TRIANGLES, 6, index,
			       index == GL_UNSIGNED_INT ? (const void *)wide : narrow);
		drawn = no_error() && gl_target_read(&target, rgba) == 0;
		glDeleteProgram(program);
	}
	gl_target_destroy(&target);
	return drawn;
}

static bool gives_wide_indices(void)
{
	uint8_t rgba[4];
	return draws("void main() { gl_FragColor = vec4(1.0); }\n", GL_UNSIGNED_INT, rgba) &&
	       gl_has_extension("GL_OES_element_index_uint");
}

static bool gives_highp(void)
{
	uint8_t rgba[4];
	return draws("precision highp float;\nvoid main() { gl_FragColor = vec4(1.0); }\n",
		     GL_UNSIGNED_SHORT, rgba);
}

/* Whether floats that only promise mediump tell 2049 from 2048, as 16 bits cannot. */
static bool gives_more_than_mediump(void)
{
	uint8_t rgba[4] = { 0 };
	return draws("precision mediump float;\nuniform vec2 u_numbers;\nvoid main() {\n"
		     "	gl_FragColor = vec4(mod(u_numbers.x + u_numbers.y, 2.0));\n"
		     "}\n",
		     GL_UNSIGNED_SHORT, rgba) &&
	       rgba[0] == 255;
}

static void say(const char *what, bool given)
{
	printf("%s %s\n", what, given ? "given" : "refused");
}

int main(void)
{
	struct headless *headless;
	if (headless_create(&headless) < 0)
		return EXIT_FAILURE;
	say("large texture", gives_texture(GL_RGBA, LARGE_PX));
	say("large renderbuffer",
	    gives_renderbuffer(GL_DEPTH_COMPONENT16, GL_DEPTH_ATTACHMENT, LARGE_PX));
	say("ninth unit", gives_unit());
	say("highp", gives_highp());
	say("more than mediump", gives_more_than_mediump());
	say("rgba8", gives_renderbuffer(GL_RGBA8_OES, GL_COLOR_ATTACHMENT0, 8));
	say("wide indices", gives_wide_indices());
	say("depth24", gives_renderbuffer(GL_DEPTH_COMPONENT24_OES, GL_DEPTH_ATTACHMENT, 8));
	say("bgra",
	    gives_texture(GL_BGRA_EXT, 8) && gl_has_extension("GL_EXT_texture_format_BGRA8888"));
	headless_destroy(headless);
	return EXIT_SUCCESS;
}
