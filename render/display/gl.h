/* Helpers for GLES2 that return errors as negative errno. They allow only what GLES2 guarantees on
 * every board: llvmpipe and desktop drivers allow more, so requests are checked against the limits
 * below. Call everything on the thread that owns the context. */
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

/* Logs every pending GL error as "doing: NAME". Returns 0, -ENOMEM or -EIO; or -ENOTRECOVERABLE,
 * which is not logged: the GPU lost its context. */
must_check int gl_check(const char *doing);
/* Returns whether the context has the extension; the whole name must match. */
bool gl_has_extension(const char *name);
/* Returns whether fragment shaders have highp; only mediump with 11 bits is guaranteed. */
bool gl_has_highp(void);
/* Returns the largest side of a texture in pixels: what this board accepts, within the limits
 * above. Textures with power-of-two sides may repeat; coordinates from -0.5 to 0.5 then address
 * 2048 pixels to a quarter of a pixel even in mediump. */
int gl_texture_most_px(void);
/* First part of a fragment shader: sets the best available precision for floats and defines FINE,
 * the qualifier of the same precision. */
extern const char gl_fine_fragment[];

struct gl_program_source {
	const char *name;              /* for log messages */
	const char *const *vertex;     /* parts that are concatenated; NULL at the end */
	const char *const *fragment;   /* likewise */
	const char *const *attributes; /* names bound to locations 0, 1, ...; NULL at the end */
};

/* Compiles and links a program. The caller deletes *out with glDeleteProgram; it is 0 on failure,
 * which is logged with the driver's message. -EINVAL: it does not compile or link. -E2BIG: it
 * exceeds the limits above. */
must_check int gl_program_build(GLuint *out, const struct gl_program_source *source);

/* Parts to draw over the whole viewport. gl_square_vertex is a vertex shader with the varying v_at,
 * 0..1 to the right and up; its program is linked with gl_square_attributes. */
extern const char gl_square_vertex[];
extern const char *const gl_square_attributes[];
/* Draws the viewport as two triangles with the current program; leaves attribute 0 disabled. */
void gl_draw_square(void);

/* Builds the program that draws a texture over the whole viewport, as it is or enlarged. As
 * gl_program_build. */
must_check int gl_copy_build(GLuint *out);
/* Draws the texture with that program, without depth; leaves attributes 0 to 2 disabled. llvmpipe,
 * which draws on the processor, takes a third to a sixth of its usual time for it on x86, if
 * framebuffer and texture are as of gl_target_create_flat (docs/picture.md). */
void gl_copy_draw(GLuint program, GLuint texture);

struct gl_texture_options {
	int width_px, height_px;
	GLenum format;      /* GL_RGB, GL_RGBA, GL_LUMINANCE, GL_ALPHA; or of gl_picture_format */
	GLenum type;        /* 0: 8 bits per channel; or GL_UNSIGNED_SHORT_5_6_5 */
	GLenum filter;      /* GL_NEAREST or GL_LINEAR; with mipmaps: trilinear */
	bool mipmaps;       /* sides must be powers of two (GLES2) */
	bool repeat;        /* likewise */
	bool large;         /* may exceed the guaranteed size, for a panel or the pipeline */
	const void *pixels; /* borrowed for the call; rows without padding; NULL: undefined */
};

/* Creates a texture and leaves it bound to the active unit. The caller deletes *out; it is 0 on
 * failure. -EINVAL: more than GLES2 guarantees. -ENOMEM, -EIO. */
must_check int gl_texture_create(GLuint *out, const struct gl_texture_options *options);
/* Binds a texture to unit 0 .. GL_LIMIT_UNITS - 1, and leaves that unit active. */
void gl_bind_texture(unsigned unit, GLuint texture);

/* Returns the format of pictures: GL_BGRA_EXT where the driver has it, as panels and Cairo order
 * bytes, else GL_RGBA. */
GLenum gl_picture_format(void);

/* A render target: a texture of gl_picture_format and a depth buffer (24 bits where the driver has
 * them). */
struct gl_target {
	GLuint framebuffer, colour, depth; /* depth: a renderbuffer */
	GLuint depths;                     /* instead of it, a texture of them */
	int width_px, height_px;
	int depth_bits;
};

/* Where a picture is drawn: an existing framebuffer, and the picture's lower left corner in it. */
struct gl_place {
	GLuint framebuffer;
	int x_px, y_px;
	bool has_depth; /* a depth buffer; without one, a model is drawn elsewhere and copied */
};
/* Bind a framebuffer, and wait until all is drawn, with a fence before (render/display/fences.h).
 */
void gl_bind_framebuffer(GLuint framebuffer);
void gl_finish(void);
/* Binds the framebuffer and sets the viewport to the picture. */
void gl_place_bind(const struct gl_place *place, int width_px, int height_px);

/* Creates a render target, binds it and sets the viewport to all of it. *out is zeroed on failure.
 * -EINVAL, -ENOMEM, -EIO. */
must_check int gl_target_create(struct gl_target *out, int width_px, int height_px);
/* The same without a depth buffer. */
must_check int gl_target_create_flat(struct gl_target *out, int width_px, int height_px);
/* The same with its depths in a texture; needs GL_OES_depth_texture. */
must_check int gl_target_create_deep(struct gl_target *out, int width_px, int height_px);
/* Has the target looked up with bilinear filtering from now on; a new one is with the nearest
 * pixel. */
void gl_target_smooth(const struct gl_target *target);
/* Deletes its GL objects. NULL and a zeroed target are fine. */
void gl_target_destroy(struct gl_target *target);
/* Binds the target and sets the viewport to all of it. */
void gl_target_bind(const struct gl_target *target);
/* Reads the target: 4 bytes a pixel, row 0 at the top; rgba is the caller's, of width x height x 4
 * bytes. Binds the target and waits for the GPU. -ENOMEM, or as gl_check. */
must_check int gl_target_read(const struct gl_target *target, uint8_t *rgba);

#endif
