/* GLES2, with errors in our form, and nothing beyond what GLES2 promises every board: llvmpipe and
 * desktop drivers allow more, so what is asked for is held against these limits here. Every call
 * is from the thread that owns the context. */
#ifndef GOPURA_RENDER_DISPLAY_GL_H
#define GOPURA_RENDER_DISPLAY_GL_H

#include <stdbool.h>
#include <stdint.h>

#include <GLES2/gl2.h>
#include <GLES2/gl2ext.h>

#include "base/compiler.h"

enum {
	GL_LIMIT_UNITS = 8,              /* texture units of a fragment shader */
	GL_LIMIT_ATTRIBUTES = 8,         /* vec4 each */
	GL_LIMIT_FRAGMENT_UNIFORMS = 16, /* vec4 each, scalars packed by four */
	GL_LIMIT_VERTEX_UNIFORMS = 128,  /* vec4 each */
	GL_LIMIT_TEXTURE_PX = 4096,      /* a side */
	GL_LIMIT_MEDIUMP_PX = 2048,      /* a side, where fragments have no highp */
};

/* Logs every pending GL error as "doing: NAME". 0, or -ENOMEM, or -EIO; -ENOTRECOVERABLE, which is
 * not logged: the GPU lost its context. */
must_check int gl_check(const char *doing);
/* Whole words only. */
bool gl_has_extension(const char *name);
/* Whether fragments have more than mediump, of which eleven bits are promised. */
bool gl_has_highp(void);
/* A side of the largest texture to make: what this board takes, within the limits above. Sides
 * that are powers of two may repeat, and coordinates from -0.5 to 0.5 then name 2048 pixels to
 * a quarter of one even in mediump. */
int gl_texture_most_px(void);
/* Begins a fragment shader: floats, and what is declared FINE, in the best precision there is. */
extern const char gl_fine_fragment[];

struct gl_program_source {
	const char *name;              /* for complaints */
	const char *const *vertex;     /* parts put one after another; NULL at the end */
	const char *const *fragment;   /* likewise */
	const char *const *attributes; /* names bound to locations 0, 1, ...; NULL at the end */
};

/* *out is deleted by the caller with glDeleteProgram; 0 on failure, which is logged with the
 * driver's words. -EINVAL: does not compile or link. -E2BIG: more than the limits above. */
must_check int gl_program_build(GLuint *out, const struct gl_program_source *source);

/* The whole viewport as two triangles: a vertex shader that gives v_at, 0..1 across and up, and
 * what draws them with the program in use, built with gl_square_attributes. Leaves attribute 0 off.
 */
extern const char gl_square_vertex[];
extern const char *const gl_square_attributes[];
void gl_draw_square(void);

struct gl_texture_options {
	int width_px, height_px;
	GLenum format;      /* GL_RGB, GL_RGBA, GL_LUMINANCE, GL_ALPHA */
	GLenum type;        /* 0: 8 bits each; GL_UNSIGNED_SHORT_5_6_5 */
	GLenum filter;      /* GL_NEAREST or GL_LINEAR; with mipmaps: trilinear */
	bool mipmaps;       /* sides must be powers of two: GLES2 */
	bool repeat;        /* likewise */
	bool large;         /* may be past what every board has, as a panel or the pipeline asks */
	const void *pixels; /* rows without padding; NULL: undefined */
};

/* Leaves the texture bound to the active unit. -EINVAL past what GLES2 allows. */
must_check int gl_texture_create(GLuint *out, const struct gl_texture_options *options);
/* To unit 0 .. GL_LIMIT_UNITS - 1, which is active afterwards. */
void gl_bind_texture(unsigned unit, GLuint texture);

/* A picture to draw into: RGBA texture and depth (24 bits where the driver has them). */
struct gl_target {
	GLuint framebuffer, colour, depth;
	int width_px, height_px;
	int depth_bits;
};

/* Where a picture goes: a framebuffer that is there, and the picture's lower left corner in it. */
struct gl_place {
	GLuint framebuffer;
	int x_px, y_px;
};
/* Binds it and sets the viewport to the picture. */
void gl_place_bind(const struct gl_place *place, int width_px, int height_px);

/* Leaves it bound, the viewport set to all of it. *out is zeroed on failure. */
must_check int gl_target_create(struct gl_target *out, int width_px, int height_px);
/* The same without a depth buffer. */
must_check int gl_target_create_flat(struct gl_target *out, int width_px, int height_px);
void gl_target_destroy(struct gl_target *target); /* NULL and zeroed are fine */
void gl_target_bind(const struct gl_target *target);
/* 4 bytes a pixel, row 0 on top. Binds the target. */
must_check int gl_target_read(const struct gl_target *target, uint8_t *rgba);

#endif
