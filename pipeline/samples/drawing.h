/* The model at its finest, drawn by GLES2 from anywhere: what samples and reference pictures are
 * made of. Colour is the scan's vertices, its pictures, or the procedural stone, times the light
 * where the model is lit (geometry/light.h). Alpha tells what a pixel shows: 255 the front of a
 * surface, 254 its back (DRAWING_BACK), 0 nothing. Surfaces instead of colours are for shading.h,
 * which knows how they are packed. Both sides are drawn, as a scan's rim needs.
 *
 * Every call is from the thread that owns the GL context. */
#ifndef GOPURA_PIPELINE_SAMPLES_DRAWING_H
#define GOPURA_PIPELINE_SAMPLES_DRAWING_H

#include <stdbool.h>

#include "pipeline/samples/chunks.h"

enum { DRAWING_BACK = 254 };

struct drawing_options {
	bool lit;
	float sun[3];    /* unit vector */
	bool procedural; /* colours from pipeline/material/material.h */
	bool surfaces;   /* procedural only: draw what shading.h makes the colours of, not these */
};

struct drawing;

/* chunks is borrowed for as long as the drawing lives, mesh (for its textures) only here. */
must_check int drawing_create(struct drawing **out, const struct chunks *chunks,
			      const struct mesh *mesh, const struct drawing_options *options);
void drawing_destroy(struct drawing *drawing); /* NULL is fine */

/* Near and far planes that hold all there is before an eye which looks along forward (unit
 * vector), as far apart as depth buffers bear: near is never below a four-thousandth of the
 * model's diagonal, nor need it be above 2 cm. false: nothing is there at all. */
bool drawing_range(const struct drawing *drawing, const float eye_m[3], const float forward[3],
		   float *near_m, float *far_m);
/* Chunks that may show in that clip space. */
uint32_t drawing_visible(const struct drawing *drawing, const float matrix[16]);
/* Clears the bound framebuffer and draws. matrix: world to clip space, as camera_matrix.
 * px_radians: what a pixel covers at distance one; procedural detail finer than a pixel is left
 * out. Returns the triangles drawn. */
uint64_t drawing_draw(struct drawing *drawing, const float matrix[16], const float eye_m[3],
		      float px_radians);

#endif
