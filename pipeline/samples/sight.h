/* What an eye sees of a model: the pieces chosen for it, those in front of a camera, and how far
 * they reach. */
#ifndef GOPURA_PIPELINE_SAMPLES_SIGHT_H
#define GOPURA_PIPELINE_SAMPLES_SIGHT_H

#include <stdbool.h>

#include "pipeline/samples/model.h"

struct sight;

/* *out is owned by the caller; NULL on failure. The model is borrowed for its lifetime. Returns
 * -ENOMEM. */
must_check int sight_create(struct sight **out, struct model *model);
void sight_destroy(struct sight *sight); /* NULL is fine */

/* Chooses what of the surface is drawn for an eye; see model_choose. To be called before the
 * functions below, and again when the eye moves. */
void sight_look(struct sight *sight, const float eye_m[3], float detail_rad);
/* Returns the chosen pieces; borrowed until the next sight_look. */
const uint32_t *sight_pieces(const struct sight *sight, uint32_t *count);
/* Sets near and far planes that contain everything in front of an eye that looks along forward
 * (unit vector), with a ratio that depth buffers can handle: near is at least 2 cm or 1/4000 of the
 * model's diagonal, whichever is less. Returns false if nothing is in front of the eye. */
bool sight_range(const struct sight *sight, const float eye_m[3], const float forward[3],
		 float *near_m, float *far_m);
/* Returns the chosen pieces that may be visible in a clip space (camera_matrix), the nearest to the
 * eye first; borrowed until the next call. */
const uint32_t *sight_visible(struct sight *sight, const float matrix[16], const float eye_m[3],
			      uint32_t *count);

#endif
