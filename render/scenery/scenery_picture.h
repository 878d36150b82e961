/* Draws scenery over the patches: with the same depths, light and tools, by the cheapest fragments.
 */
#ifndef GOPURA_RENDER_SCENERY_SCENERY_PICTURE_H
#define GOPURA_RENDER_SCENERY_SCENERY_PICTURE_H

#include "render/lumigraph/surface.h"
#include "render/scenery/pose.h"

/* A program for each set of tools, and as many again for what dissolves. */
enum { SCENERY_PROGRAMS = 2 * SURFACE_TOOLS };

struct scenery_program {
	GLuint program; /* 0: not built yet */
	GLint clip, model, normal, sides, sun, share, range, rake, cut;
};

/* Zeroed is empty: nothing is built before there is scenery. */
struct scenery_picture {
	struct scenery_program of[SCENERY_PROGRAMS];
	bool lacks[SCENERY_PROGRAMS]; /* the driver refused it */
	GLuint vertices, indices;
};

/* Uploads the meshes in place of any before. Errors as gl_check. */
must_check int scenery_picture_load(struct scenery_picture *picture, const struct scenery *scenery);
/* Frees the meshes. */
void scenery_picture_drop(struct scenery_picture *picture);
/* Frees everything. */
void scenery_picture_finish(struct scenery_picture *picture);

/* Draws what the pose shows, with the depth test of the picture. Culling is off afterwards. */
void scenery_picture_draw(struct scenery_picture *picture, const struct pose *pose,
			  const struct surface_frame *frame);

/* Finds the nearest mesh along a ray, of those that are more than half solid; direction is a unit
 * vector. Returns its node and lowers *distance_m to where it is, or SCENERY_NONE where none is
 * from least_m to *distance_m. */
uint32_t scenery_ray(const struct pose *pose, const float from_m[3], const float direction[3],
		     float least_m, float *distance_m);

#endif
