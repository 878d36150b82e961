/* Leaves out keys of a camera's way that what remains passes anyway. Private to pipeline/content.
 */
#ifndef GOPURA_PIPELINE_CONTENT_TOUR_KEYS_H
#define GOPURA_PIPELINE_CONTENT_TOUR_KEYS_H

#include "base/compiler.h"
#include "pipeline/import/import_scenery.h"

/* Leaves at most `most` views of a way, at least 2, such that at the time of each one that is left
 * out the eye, and the place a metre ahead of it, are within *off_m of where the straight way
 * between its neighbours has them. Tries a millimetre first, and twice as much until it is enough.
 * Where a quarter of a metre is not, nothing is left out. -ENOMEM. */
must_check int tour_keys_thin(struct import_views *views, uint32_t most, float *off_m);

#endif
