/* What the light does on a surface of scenery (struct scenery_material), and what fog does to it:
 * in C, which is the truth, and in GLSL, which is compared with it (docs/materials.md).
 *
 *   surface   = own colour * substance / mean of the substance
 *   normal    = that of the mesh, or of the normal map, less the slope of the relief
 *   light     = light.h, with the whole sky open; where the model has the scan's own colours, what
 *               normal map and relief change of it
 *   highlight = min(1, 4 * max(0, n.sun)) * max(0, n.h) ^ shininess    h: half way between eye and
 * sun colour    = min(1, mix(surface * light + emissive, what is mirrored, mirror)
 *                      + specular * highlight)
 *   fog       = d / range, or 1 - exp(-d / (range - d))    d: distance from the eye; 1 beyond range
 *
 * Light, highlight and fog are the formulas of VRML97 (4.14.4) under the one sun that a release
 * has; the relief is Blinn's bump mapping (1978) in object space (paper 003, appendix A.2), normal
 * maps lie as in glTF 2.0 (3.9.3). All
 * colours are sRGB, 0 to 1, and not made linear, as in light.h. */
#ifndef GOPURA_GEOMETRY_APPEARANCE_H
#define GOPURA_GEOMETRY_APPEARANCE_H

#include "format/scenery.h"

/* What is around a scenery, as the six faces of a cube map of GL, in its order; each side_px x
 * side_px pixels of 4 bytes. Borrowed. */
struct appearance_cube {
	const uint8_t *faces[6];
	int side_px;
};

struct appearance_light {
	float sun[3];                         /* unit vector towards it */
	bool is_lit;                          /* root_page.lit */
	const struct appearance_cube *around; /* NULL: nothing is mirrored */
};

/* A place on a surface. */
struct appearance_place {
	float surface[3]; /* its own colour */
	float normal[3];  /* unit vector, on the side of the eye */
	float to_eye[3];  /* unit vector */
	float in_node[3]; /* in metres of the node */
	/* For a material with a normal map: what that has there, 0 to 1; ways in which its right
	 * and its top lie, of any length; and whether normal is that of the back. */
	float map[3], right[3], top[3];
	bool is_back;
	float footprint_m; /* side of a pixel there */
};

/* How a substance lies in a node. Matrices are column by column. */
struct appearance_solid {
	float place[9]; /* from the node to the substance's metres, of which z is the grain */
	float slope[9]; /* from a gradient there to the model's axes */
	float tint[3];  /* 1 / mean colour of the substance; 1 without */
};
/* matrix: from the node to the model, as pose_node has it. */
void appearance_solid_init(struct appearance_solid *out, const struct scenery_material *material,
			   const float matrix[16]);

/* Computes the colour of a place. solid may be NULL for a material without substance and relief. */
void appearance_colour(float rgb[3], const struct scenery_material *material,
		       const struct appearance_solid *solid, const struct appearance_place *place,
		       const struct appearance_light *light);
/* Returns the share of the fog's colour at a distance, for a range above 0. */
float appearance_fog(float distance_m, float range_m, bool is_exponential);

/* GLSL ES 1.00 source of
 *   float highlight(vec3 n, vec3 to_eye, vec3 sun, float shininess)
 *   float fog_share(float d, bool is_exponential), d as a share of the range
 *   vec3 pattern_at(vec3 p, float footprint_m): the colour of a substance, or how high hewn stone
 * is there; the brightness of both is the height of the relief. It needs substance_glsl before it,
 * and SOLID defined as the function of a substance if there is one. */
extern const char appearance_glsl[], appearance_fog_glsl[], appearance_pattern_glsl[];

#endif
