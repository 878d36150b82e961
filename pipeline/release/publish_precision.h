/* How exactly the positions of published vertices are stored (docs/patch.md, "What is
 * published"). */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_PRECISION_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_PRECISION_H

#include <stdint.h>

/* Returns how many low bits of positions say less than an eighth of the error, 0 to 12. */
int precision_zeros_for(float error_m, double step_m);
/* Rounds to multiples of 2^zeros. places: how many the lattice has along an axis. */
void precision_round_position(int32_t position[3], int zeros, int32_t places);

#endif
