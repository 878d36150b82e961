/* Computes the default first view of a model from its bounding box. */
#include "pipeline/content/start_view.h"

#include <math.h>

static const double margin = 0.95; /* usable share of half the picture */

/* Unit vectors: from the model to the eye, and the axes of the picture. */
struct start_axes {
	double back[3], right[3], up[3];
};

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static struct start_axes front_corner(void)
{
	struct start_axes axes = { .back = { 0.62, -0.74, 0.27 } };
	double length = sqrt(dot(axes.back, axes.back)), flat;

	for (int i = 0; i < 3; i++)
		axes.back[i] /= length;
	flat = hypot(axes.back[0], axes.back[1]);
	axes.right[0] = -axes.back[1] / flat;
	axes.right[1] = axes.back[0] / flat;
	axes.up[0] = axes.back[1] * axes.right[2] - axes.back[2] * axes.right[1];
	axes.up[1] = axes.back[2] * axes.right[0] - axes.back[0] * axes.right[2];
	axes.up[2] = axes.back[0] * axes.right[1] - axes.back[1] * axes.right[0];
	return axes;
}

/* Returns the distance of the eye at which a corner (relative to the centre) is just visible. */
static double distance_for(const struct start_axes *axes, const double corner[3])
{
	const double tangent = margin * tan(START_VIEW_FOV_DEG * M_PI / 360);
	double high = fabs(dot(corner, axes->up)) / tangent;
	double wide = fabs(dot(corner, axes->right)) / (tangent * START_VIEW_ASPECT);

	return fmax(high, wide) + dot(corner, axes->back);
}

void start_view(float eye_m[3], float target_m[3], const float box_min_m[3],
		const float box_max_m[3])
{
	const struct start_axes axes = front_corner();
	double half[3], distance = 0;

	for (int i = 0; i < 3; i++)
		half[i] = ((double)box_max_m[i] - box_min_m[i]) / 2;
	for (unsigned corner = 0; corner < 8; corner++) {
		double at[3];

		for (int i = 0; i < 3; i++)
			at[i] = corner >> i & 1 ? half[i] : -half[i];
		distance = fmax(distance, distance_for(&axes, at));
	}
	if (!(distance > 0))
		distance = 1;
	for (int i = 0; i < 3; i++) {
		target_m[i] = (float)(box_min_m[i] + half[i]);
		eye_m[i] = (float)(box_min_m[i] + half[i] + distance * axes.back[i]);
	}
}
