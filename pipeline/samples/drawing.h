/* Draws a surface with GLES2 from any viewpoint, for samples and reference pictures. What of it is
 * on the GPU is bounded: pieces are uploaded when they are drawn, and those that were drawn longest
 * ago go. The colour comes from the scan's vertices, its textures, or the procedural material,
 * times the light if the model is lit (geometry/light.h). Alpha tells what a pixel shows: 255 the
 * front of a surface, 254 its back (DRAWING_BACK), 0 nothing. Both sides of triangles are drawn, as
 * the open border of a scan requires.
 *
 * Call everything from the thread that owns the GL context. */
#ifndef GOPURA_PIPELINE_SAMPLES_DRAWING_H
#define GOPURA_PIPELINE_SAMPLES_DRAWING_H

#include <stdbool.h>

#include "geometry/substance.h"
#include "pipeline/import/mesh.h"
#include "pipeline/samples/sight.h"

enum { DRAWING_BACK = 254 };

struct drawing_options {
	bool lit;
	float sun[3];    /* unit vector */
	bool procedural; /* colours from a material */
	/* which; SUBSTANCE_NONE: that of pipeline/material/material.h */
	enum substance_kind substance;
};

struct drawing;

/* *out is owned by the caller; NULL on failure. model is borrowed for the drawing's lifetime; so
 * are the textures, but only for this call (texture_count 0: none). Returns -ENOMEM or the errors
 * of GL. */
must_check int drawing_create(struct drawing **out, struct model *model,
			      const struct mesh_texture *textures, uint32_t texture_count,
			      const struct drawing_options *options);
void drawing_destroy(struct drawing *drawing); /* NULL is fine */

/* Returns what chooses the pieces that are drawn: call sight_look before drawing_draw, and again
 * when the eye moves. Borrowed for the drawing's lifetime. */
struct sight *drawing_sight(struct drawing *drawing);
/* Clears the bound framebuffer and draws. matrix: world to clip space, as camera_matrix.
 * px_radians: the size of a pixel at distance one; procedural detail finer than a pixel is left
 * out. Errors as model_load, or of GL. */
must_check int drawing_draw(struct drawing *drawing, const float matrix[16], const float eye_m[3],
			    float px_radians);

#endif
