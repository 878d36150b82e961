/* The figurative carvings of the demo temple, as height fields. x runs from -1 to 1 across the
 * field's half width times its aspect, y from 0 to 1 up it; the height is a share of the relief's
 * depth, about 0 to 1. Used by temple_relief.c alone. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_FIGURES_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_FIGURES_H

#include <stdint.h>

/* aspect: width over height of the field; x in -aspect/2 .. aspect/2. */
float figure_devata(float x, float y, float aspect, uint32_t seed);
float figure_march(float x_m, float y_m, float height_m, uint32_t seed);
float figure_lintel(float x, float y, float aspect);
float figure_tympanum(float x, float y, float aspect, float shape);
float figure_door(float x, float y, float aspect);
float figure_window(float x, float y, float aspect);
float figure_face(float x, float y, float aspect);
float figure_lion(float x, float y);
float figure_hood(float x, float y, float aspect);
float figure_flame(float x, float y, float aspect, float shape);

#endif
