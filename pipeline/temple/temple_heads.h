/* The carvings of heads, as height fields. Arguments and results are as in temple_figures.h. Only
 * temple_relief.c uses them. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_HEADS_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_HEADS_H

/* A great smiling face. */
float figure_face(float x, float y, float aspect);
/* The mask of a lion; its height may be negative outside the mane. */
float figure_lion(float x, float y);
/* The seven heads of a naga; aspect is not used. */
float figure_hood(float x, float y, float aspect);

#endif
