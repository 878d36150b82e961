/* Solid texturing: a colour for every place in space, so that a cut or a chip shows what it would
 * in the real thing, without seams or distortion (paper 003, section 4.3; docs/substance.md). One
 * text is compiled as C and handed to the GLSL compiler. No state, any thread. */
#ifndef GOPURA_GEOMETRY_SUBSTANCE_H
#define GOPURA_GEOMETRY_SUBSTANCE_H

#include <stdint.h>

enum substance_kind {
	SUBSTANCE_NONE,
	SUBSTANCE_MARBLE,    /* veins bent by turbulence */
	SUBSTANCE_WOOD,      /* rings about an upright axis, fibres along it */
	SUBSTANCE_SANDSTONE, /* nearly level beds of wavering thickness, in fine laminae */
	SUBSTANCE_LATERITE,  /* red clay full of pores */
	SUBSTANCE_KINDS,
};

/* Names as in temple.ini, "none" first. */
extern const char *const substance_names[SUBSTANCE_KINDS];
/* Returns the kind of a name; SUBSTANCE_KINDS: there is none. */
enum substance_kind substance_named(const char *name);

/* Computes the colours of count places: sRGB, 0..1, as red, green and blue. kind: not
 * SUBSTANCE_NONE. at_m: x, y and z; metres, z up, within 90 m of the origin for the finest detail,
 * 1000 m without it. footprint_m: side of a pixel or voxel there; finer detail fades into its mean,
 * 0 keeps all.
 */
void substance_colours(float *const rgb[3], enum substance_kind kind, const float *const at_m[3],
		       const float *footprint_m, uint32_t count);
/* The same for one place. */
void substance_colour(float rgb[3], enum substance_kind kind, const float position_m[3],
		      float footprint_m);

/* GLSL ES 1.00 source of vec3 NAME_colour(float x, float y, float z, float footprint_m) for each
 * name but "none". It needs noise_glsl before it. */
extern const char substance_glsl[];

#endif
