/* Draws scenery over the patches: with the same depths, light and tools, by the cheapest fragments.
 */
#ifndef GOPURA_RENDER_SCENERY_SCENERY_PICTURE_H
#define GOPURA_RENDER_SCENERY_SCENERY_PICTURE_H

#include "geometry/appearance.h"
#include "render/lumigraph/visibility.h"
#include "render/scenery/pose.h"
#include "render/scenery/scenery_order.h"
#include "render/scenery/scenery_program.h"
#include "render/scenery/scenery_textures.h"

/* Where a mesh is in the buffers. */
struct scenery_offset {
	size_t vertex_bytes, index_bytes;
	uint32_t bend_version; /* of the vertices that were uploaded */
};

/* Zeroed is empty: nothing is built before there is scenery. */
struct scenery_picture {
	struct scenery_programs programs;
	GLuint vertices, indices;
	GLuint ordered;                 /* indices of transparent triangles, of the last frame */
	uint16_t (*triangles)[3];       /* the same before they are uploaded; owned */
	struct scenery_order order;     /* of the last frame */
	struct scenery_offset *offsets; /* of each mesh; owned */
	struct scenery_textures textures;
	GLuint around; /* cube map of what mirrors show; 0: nothing yet. Owned */
};

/* Uploads the meshes in place of any before; their pictures are uploaded by scenery_textures_next.
 * -ENOMEM, or as gl_check. */
must_check int scenery_picture_load(struct scenery_picture *picture, const struct scenery *scenery);
/* Makes a cube map with linear filters of six faces as geometry/appearance.h has them; NULL faces
 * are undefined. The caller deletes *out, whatever is returned. Errors as gl_check. */
must_check int scenery_cube_create(GLuint *out, const struct appearance_cube *faces);
/* Takes the cube map that mirrors show from now on, in place of any before; 0: none. */
void scenery_picture_surround(struct scenery_picture *picture, GLuint cube);
/* Uploads the vertices of meshes that motions bent or coloured since the last call. */
void scenery_picture_bend(struct scenery_picture *picture, const struct pose *pose);
/* Frees the meshes. */
void scenery_picture_drop(struct scenery_picture *picture);
/* Frees everything. */
void scenery_picture_finish(struct scenery_picture *picture);

/* Draws what the pose shows, with the depth test of the picture: first what is solid, then what is
 * transparent, from far to near. Culling and blending are off afterwards. Builds one program at
 * most, so what needs another one may be plainer, or not drawn yet: then it returns false, and the
 * picture has to be drawn again. */
bool scenery_picture_draw(struct scenery_picture *picture, const struct pose *pose,
			  const struct surface_frame *frame);
/* Builds one of the programs in which all of it dissolves under the tools of the frame, into the
 * bound target without changing its picture. Returns whether there was none left to build. */
bool scenery_picture_prepare(struct scenery_picture *picture, const struct pose *pose,
			     const struct surface_frame *frame);

/* Draws what is solid and does not dissolve into a visibility pass, beside the pieces. */
void scenery_picture_depths(struct scenery_picture *picture, const struct pose *pose,
			    struct visibility *visibility);
/* Returns how far from an eye what the pose shows may be; metres, 0: nothing is shown. */
float scenery_picture_far_m(const struct pose *pose, const float eye_m[3]);

/* Finds the nearest mesh along a ray, of those that are more than half solid; direction is a unit
 * vector. Returns its node and lowers *distance_m to where it is, or SCENERY_NONE where none is
 * from least_m to *distance_m. */
uint32_t scenery_ray(const struct pose *pose, const float from_m[3], const float direction[3],
		     float least_m, float *distance_m);

#endif
