/* The carvings of doors, windows and the fields above them, as height fields. Arguments and results
 * are as in temple_figures.h. Only temple_relief.c uses them. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_DOORS_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_DOORS_H

/* A kala's head over a garland. */
float figure_lintel(float x, float y, float aspect);
/* A pediment: naga arch, deity, worshippers. */
float figure_tympanum(float x, float y, float aspect, float shape);
/* A false door. */
float figure_door(float x, float y, float aspect);
/* A window with turned balusters. */
float figure_window(float x, float y, float aspect);
/* An antefix: flames around a seated figure. */
float figure_flame(float x, float y, float aspect, float shape);

#endif
