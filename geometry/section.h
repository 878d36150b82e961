/* A vertical section plane that cuts the model open. What lies in front of it is hidden from the
 * picture, from touch and from labels alike. Pure functions on a plain value; docs/tools.md. */
#ifndef GOPURA_GEOMETRY_SECTION_H
#define GOPURA_GEOMETRY_SECTION_H

#include <stdbool.h>

struct section {
	bool on;
	/* angle of the plane's normal, from x to y; it points to the side cut away */
	float turn_rad;
	float push_m; /* distance of the plane from the middle of the box along the normal */
	/* of the model's box: its middle, and half its horizontal diagonal */
	float middle_m[3], reach_m;
};

/* Initialises a section that is off, for a model with this bounding box. */
void section_init(struct section *section, const float box_min_m[3], const float box_max_m[3]);
/* Switches the section on. It faces the eye and goes through the middle of the model, or lies just
 * in front of the eye where the eye is already beyond the middle. forward is the unit viewing
 * direction. */
void section_face(struct section *section, const float eye_m[3], const float forward[3]);
/* Moves the plane along its normal; positive is towards the side that is cut away. It stays within
 * the model. */
void section_push(struct section *section, float by_m);
/* Sets the angle of the plane's normal, in radians. */
void section_turn(struct section *section, float turn_rad);

/* Writes the plane as a half space: points with dot(cut, p) <= cut[3] are kept, where p is in
 * metres from from_m. Where the section is off cut is 0 0 0 1, which keeps everything. */
void section_cut(const struct section *section, const float from_m[3], float cut[4]);
/* Returns whether the point is kept; always true where the section is off. */
bool section_keeps(const struct section *section, const float point_m[3]);
/* Clips the interval *least_m to *most_m of a ray to the side that is kept; direction is a unit
 * vector. Returns false where nothing is left. */
bool section_clip(const struct section *section, const float from_m[3], const float direction[3],
		  float *least_m, float *most_m);

#endif
