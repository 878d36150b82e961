/* The colour of weathered temple stone at a place: sandstone, laterite in the lower courses,
 * joints, lichen, dark runs of rain. It is one function in two languages, so that a picture can be
 * textured down to a centimetre from geometry alone. Its noise is geometry/noise.h; a test compares
 * both languages. No state, no I/O. */
#ifndef GOPURA_PIPELINE_MATERIAL_MATERIAL_H
#define GOPURA_PIPELINE_MATERIAL_MATERIAL_H

#include <stdint.h>

/* Computes the colour. rgb: sRGB 0..1. position_m: metres, z up, within 1000 m of the origin.
 * normal: unit. footprint_m: size on the surface of a pixel, or the spacing of vertices; finer
 * detail is left out; 0 keeps all detail. */
void material_colour(float rgb[3], const float position_m[3], const float normal[3],
		     float footprint_m);

/* Places as arrays, one number for each: metres, unit normals, footprints as above. */
struct material_places {
	uint32_t count;
	const float *x, *y, *z, *normal_x, *normal_y, *normal_z, *footprint_m;
};

/* The block of each place: its tone and tint, the share of a joint here (these three may be
 * averaged), and the distance of the joint's middle in metres, or more. */
struct material_blocks {
	float *tone, *tint, *joint, *edge_m;
};

/* The parts of material_colour, for many places at once; for pictures that average what is finer
 * than their pixels. Arrays do not overlap. */

/* Sets out to noise of that frequency, 0..1, as far as the footprint keeps it. Ignores normals. */
void material_details(float *out, const struct material_places *places, float frequency);
/* Fills the arrays of blocks. */
void material_blocks(const struct material_blocks *out, const struct material_places *places);
/* Sets the arrays of red, green and blue. inch is the detail of frequency 23, grain that of 97. */
void material_paints(float *const rgb[3], const struct material_places *places,
		     const struct material_blocks *blocks, const float *inch, const float *grain);

/* GLSL ES 1.00 source of vec3 material_colour(vec3 position_m, vec3 normal, float footprint_m). It
 * needs noise_glsl before it. */
extern const char material_glsl[];

#endif
