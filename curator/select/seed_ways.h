/* How far each superpixel is from the seeds of a side, where crossing a strong border is far:
 * geodesic distances (Bai and Sapiro 2007) tell what lies behind a border even where both sides
 * look alike. */
#ifndef GOPURA_CURATOR_SELECT_SEED_WAYS_H
#define GOPURA_CURATOR_SELECT_SEED_WAYS_H

#include "base/compiler.h"
#include "curator/select/superpixels.h"

/* seeds: how many pixels of each superpixel are seeds. *out has a length for each, in strong
 * borders, INFINITY where no way leads; it is owned by the caller (free), NULL on failure.
 * -ENOMEM. */
must_check int seed_ways_find(float **out, const struct superpixels *superpixels,
			      const uint32_t *seeds);

#endif
