/* A recorded visit: the way of the eye, leg by leg, for benchmarks (tests/bench/visit.txt). */
#ifndef GOPURA_TESTS_BENCH_VISIT_H
#define GOPURA_TESTS_BENCH_VISIT_H

#include <stdbool.h>
#include <stdint.h>

#include "geometry/camera.h"

enum { VISIT_LEGS_MAX = 2000 };

enum visit_gait { VISIT_START, VISIT_GO, VISIT_ON, VISIT_FLING, VISIT_REST };

struct visit_leg {
	float seconds, eye_m[3], target_m[3];
	enum visit_gait gait;
};

/* leg[0] is where the visit begins; it takes no time. */
struct visit {
	struct visit_leg leg[VISIT_LEGS_MAX];
	uint32_t leg_count;
};

/* Dies with a reason where the file is not a visit. */
void visit_read(struct visit *visit, const char *path);
/* Sets eye, target and lens of the camera at a share (0 to 1) of a leg's time; leg is at least 1.
 */
void visit_camera(struct camera *camera, const struct visit *visit, uint32_t leg, float share);

#endif
