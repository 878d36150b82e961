/* A vertical plane that cuts the model open: what lies before it is not there, for the picture, for
 * fingers and for labels alike. Pure; docs/tools.md. */
#ifndef GOPURA_GEOMETRY_SECTION_H
#define GOPURA_GEOMETRY_SECTION_H

#include <stdbool.h>

struct section {
	bool on;
	float turn_rad; /* of the plane's normal, which points to what is cut away: from x to y */
	float push_m;   /* how far it lies from the box's middle along the normal */
	float middle_m[3], reach_m; /* of the model's box: its middle, its farthest corner */
};

/* Off, for a model with this box. */
void section_init(struct section *section, const float box_min_m[3], const float box_max_m[3]);
/* On: it faces the eye and lies in the middle of the model, or before the eye where that has gone
 * past it. */
void section_face(struct section *section, const float eye_m[3], const float forward[3]);
/* Along its normal, towards what is cut away; it stays within the model. */
void section_push(struct section *section, float by_m);
void section_turn(struct section *section, float turn_rad);

/* What is kept is where dot(cut, p) <= cut[3], p metres from that point. Off: 0 0 0 1, which keeps
 * all. */
void section_cut(const struct section *section, const float from_m[3], float cut[4]);
bool section_keeps(const struct section *section, const float point_m[3]);
/* Shortens what is looked at of a ray, its direction a unit vector, to what is kept. false: nothing
 * is. */
bool section_clip(const struct section *section, const float from_m[3], const float direction[3],
		  float *least_m, float *most_m);

#endif
