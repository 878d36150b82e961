/* The colour of weathered temple stone at a place: sandstone, laterite in the lower courses,
 * joints, lichen, dark runs of rain. It is one function in two languages, so that a picture can be
 * textured down to a centimetre from geometry alone. All randomness comes from integer hashes that
 * 32-bit floats represent exactly, so both agree (a test compares them). No state, no I/O. */
#ifndef GOPURA_PIPELINE_MATERIAL_MATERIAL_H
#define GOPURA_PIPELINE_MATERIAL_MATERIAL_H

/* Computes the colour. rgb: sRGB 0..1. position_m: metres, z up, within 1000 m of the origin.
 * normal: unit. footprint_m: size on the surface of a pixel, or the spacing of vertices; finer
 * detail is left out; 0 keeps all detail. */
void material_colour(float rgb[3], const float position_m[3], const float normal[3],
		     float footprint_m);

/* GLSL ES 1.00 source of vec3 material_colour(vec3 position_m, vec3 normal, float footprint_m). It
 * needs "precision highp float" where it is included. Its parts serve a shader that averages what
 * is finer than its pixels, and evaluates the rest once for several of them:
 *
 * - vec4 material_block(vec3 position_m, vec3 normal, float footprint_m): tone and tint of the
 *   block, the share of a joint here (these three may be averaged), and the distance of the joint's
 *   middle in metres, or more.
 * - float material_detail(vec3 position_m, float frequency, float footprint_m): noise, 0..1.
 * - vec3 material_paint(vec3 position_m, vec3 normal, float footprint_m, vec4 block, float inch,
 *   float grain): the colour; inch is the detail of frequency 23, grain that of 97. */
extern const char material_glsl[];

#endif
