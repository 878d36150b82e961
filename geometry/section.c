/* The section plane: an angle and an offset from the middle of the model, and clipping against
 * it. */
#include "geometry/section.h"

#include <math.h>
#include <string.h>

#include "geometry/vec.h"

/* share of reach_m in front of the eye, if the eye is beyond the middle */
static const float before_eye = 0.12f;
static const float along_eye = 1e-5f;

void section_init(struct section *section, const float box_min_m[3], const float box_max_m[3])
{
	*section = (struct section){ 0 };
	for (int k = 0; k < 3; k++)
		section->middle_m[k] = (box_min_m[k] + box_max_m[k]) / 2;
	section->reach_m = hypotf(box_max_m[0] - box_min_m[0], box_max_m[1] - box_min_m[1]) / 2;
}

static void normal_of(const struct section *section, float normal[3])
{
	normal[0] = cosf(section->turn_rad);
	normal[1] = sinf(section->turn_rad);
	normal[2] = 0;
}

/* Returns the distance of a point from the middle of the model along the normal. */
static float place_of(const struct section *section, const float point_m[3])
{
	float normal[3], from[3];

	normal_of(section, normal);
	vec_sub(from, point_m, section->middle_m);
	return vec_dot(normal, from);
}

void section_face(struct section *section, const float eye_m[3], const float forward[3])
{
	float x = -forward[0], y = -forward[1], eye_at;

	if (hypotf(x, y) < 0.2f) { /* it looks down: use the direction from the middle to the eye */
		x = eye_m[0] - section->middle_m[0];
		y = eye_m[1] - section->middle_m[1];
	}
	section->on = true;
	section->turn_rad = atan2f(y, x);
	section->push_m = 0;
	eye_at = place_of(section, eye_m) - before_eye * section->reach_m;
	section_push(section, fminf(eye_at, 0));
}

void section_push(struct section *section, float by_m)
{
	section->push_m = fmaxf(-section->reach_m, fminf(section->push_m + by_m, section->reach_m));
}

void section_turn(struct section *section, float turn_rad)
{
	section->turn_rad = turn_rad;
}

void section_cut(const struct section *section, const float from_m[3], float cut[4])
{
	memset(cut, 0, 4 * sizeof(*cut));
	cut[3] = 1;
	if (!section->on)
		return;
	normal_of(section, cut);
	cut[3] = section->push_m - place_of(section, from_m);
}

bool section_keeps(const struct section *section, const float point_m[3])
{
	return !section->on || place_of(section, point_m) <= section->push_m;
}

bool section_clip(const struct section *section, const float from_m[3], const float direction[3],
		  float *least_m, float *most_m)
{
	float cut[4], along, at;

	section_cut(section, from_m, cut);
	along = vec_dot(cut, direction);
	if (fabsf(along) < along_eye)
		return cut[3] >= 0;
	at = cut[3] / along;
	if (along > 0)
		*most_m = fminf(*most_m, at);
	else
		*least_m = fmaxf(*least_m, at);
	return *least_m < *most_m;
}
