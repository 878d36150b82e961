/* The colour of weathered temple stone at a place: sandstone, laterite in the lower courses,
 * joints, lichen, dark runs of rain. One function in two languages, so that a picture can be
 * textured down to a centimetre from geometry alone. All chance comes from integer hashes that
 * 32-bit floats hold exactly, so both agree (a test compares them). No state, no I/O. */
#ifndef GOPURA_PIPELINE_MATERIAL_MATERIAL_H
#define GOPURA_PIPELINE_MATERIAL_MATERIAL_H

/* rgb: sRGB 0..1. position_m: metres, z up, within 1000 m of the origin. normal: unit.
 * footprint_m: what a pixel or the spacing of vertices covers on the surface; detail finer than
 * that is left out, 0: all of it. */
void material_colour(float rgb[3], const float position_m[3], const float normal[3],
		     float footprint_m);

/* GLSL ES 1.00: vec3 material_colour(vec3 position_m, vec3 normal, float footprint_m). Needs
 * precision highp float where it is included. Its parts, for a shader that averages what is finer
 * than its pixels and evaluates the rest once for several of them:
 *
 * - vec4 material_block(vec3 position_m, vec3 normal, float footprint_m): tone and tint of the
 * block, how much of a joint this is (these three may be averaged), and how far the joint's middle
 * is, metres or more.
 * - float material_detail(vec3 position_m, float frequency, float footprint_m): noise, 0..1.
 * - vec3 material_paint(vec3 position_m, vec3 normal, float footprint_m, vec4 block, float inch,
 *   float grain): the colour; inch is the detail of frequency 23, grain that of 97. */
extern const char material_glsl[];

#endif
