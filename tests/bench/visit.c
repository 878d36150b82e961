/* Reads a visit's legs and moves a camera along them. */
#include "tests/bench/visit.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/bench/stage.h"

static enum visit_gait gait_of(const char *name)
{
	static const char *const names[] = { "start", "go", "on", "fling", "rest" };

	for (int i = 0; i < 5; i++)
		if (!strcmp(name, names[i]))
			return (enum visit_gait)i;
	stage_die(name, -EINVAL);
	return VISIT_REST;
}

void visit_read(struct visit *visit, const char *path)
{
	FILE *file = fopen(path, "re");
	char line[256], gait[16];

	if (!file)
		stage_die(path, -errno);
	while (visit->leg_count < VISIT_LEGS_MAX && fgets(line, sizeof(line), file)) {
		struct visit_leg *leg = &visit->leg[visit->leg_count];
		float *e = leg->eye_m, *t = leg->target_m;

		if (sscanf(line, "%f %f %f %f %f %f %f %15s", &leg->seconds, &e[0], &e[1], &e[2],
			   &t[0], &t[1], &t[2], gait) == 8) {
			leg->gait = gait_of(gait);
		} else if (sscanf(line, "%f %15s", &leg->seconds, gait) == 2 &&
			   visit->leg_count > 0) {
			*leg = (struct visit_leg){ .seconds = leg->seconds, .gait = gait_of(gait) };
			memcpy(e, leg[-1].eye_m, sizeof(leg->eye_m));
			memcpy(t, leg[-1].target_m, sizeof(leg->target_m));
		} else {
			continue;
		}
		visit->leg_count++;
	}
	fclose(file);
	if (visit->leg_count < 2)
		stage_die(path, -EINVAL);
}

static float eased(enum visit_gait gait, float t)
{
	return gait == VISIT_GO      ? t * t * (3 - 2 * t)
	       : gait == VISIT_FLING ? 1 - (1 - t) * (1 - t) * (1 - t)
				     : t;
}

/* Round the vertical axis, the shorter way. */
static void turn(float out[3], const float from[3], const float to[3], float t)
{
	const float r0 = hypotf(from[0], from[1]), r1 = hypotf(to[0], to[1]);
	const float a0 = atan2f(from[1], from[0]);
	float by = atan2f(to[1], to[0]) - a0;

	if (by > (float)M_PI)
		by -= 2 * (float)M_PI;
	if (by < -(float)M_PI)
		by += 2 * (float)M_PI;
	out[0] = (r0 + t * (r1 - r0)) * cosf(a0 + t * by);
	out[1] = (r0 + t * (r1 - r0)) * sinf(a0 + t * by);
	out[2] = from[2] + t * (to[2] - from[2]);
}

void visit_camera(struct camera *camera, const struct visit *visit, uint32_t leg, float share)
{
	const struct visit_leg *to = &visit->leg[leg], *from = to - 1;
	const float t = eased(to->gait, share);

	camera->up[0] = camera->up[1] = 0;
	camera->up[2] = 1;
	camera->near_m = 0.1f;
	camera->far_m = 2000;
	camera->fov_deg = 45;
	turn(camera->eye_m, from->eye_m, to->eye_m, t);
	for (int k = 0; k < 3; k++)
		camera->target_m[k] = from->target_m[k] + t * (to->target_m[k] - from->target_m[k]);
}
