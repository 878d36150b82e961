/* The figurative carvings of the demo temple, as height fields. y runs from 0 to 1 from the bottom
 * to the top of the field; x is in the same unit, 0 in the middle. The result is a share of the
 * relief's depth, about 0 to 1. Only temple_relief.c uses them. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_FIGURES_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_FIGURES_H

#include <stdint.h>

/* A goddess in her niche. For all figures but the procession: aspect is width over height of the
 * field, and x runs over -aspect/2 .. aspect/2; where the outline narrows shape is the share of the
 * width left at this height, and scales x as well. seed varies the figure. */
float figure_devata(float x, float y, float aspect, uint32_t seed);
/* A procession, in metres from the lower left corner, for a field of any width. */
float figure_march(float x_m, float y_m, float height_m, uint32_t seed);

#endif
