/* A depth map of each resident face of a sampling point. The kiosk renders it from its own patches,
 * so it costs no download and fits the mesh that is tested against it.
 *
 * A texel is the depth along the face's axis divided by far_limit_m, 16 bits as 5, 6 and 5. At a
 * depth step the nearer surface is grown by one texel, so that nothing behind a silhouette takes
 * the silhouette's colour. */
#ifndef GOPURA_RENDER_LUMIGRAPH_DEPTH_H
#define GOPURA_RENDER_LUMIGRAPH_DEPTH_H

#include "format/root_page.h"
#include "render/display/gl.h"
#include "render/lumigraph/tiles.h"

enum { DEPTH_SHEETS_MAX = 8 };

/* Squares of face_px, one for each face slot of the tiles, row by row and sheet by sheet. A sheet
 * is a texture. Without highp its sides must be powers of two (gl_texture_most_px). */
struct depth_layout {
	int face_px, across, rows, sheets;
};

struct depth {
	struct gl_target raw; /* the face being drawn */
	/* 0: not made, because there was no face in it yet */
	GLuint sheet[DEPTH_SHEETS_MAX], framebuffer[DEPTH_SHEETS_MAX];
	GLenum format, type; /* of a sheet */
	GLuint draw_program, grow_program;
	GLint lattice, axes, far_m, window, base, high;
	struct depth_layout layout;
	bool repeats; /* textures repeat; without highp, to keep coordinates near 0 */
	float far_limit_m;
	/* The face being drawn: its window, its forward axis, and the sampling point's coordinate
	 * along that axis. */
	float begun[4], forward[3], point_m;
	struct depth_face {
		bool ready;
		face_key key;
		uint64_t cut; /* identifies the cut it was rendered from */
		/* the area of the face (-1..1) that the square holds: middle, half sides */
		float window[4];
	} face[TILES_FACES_MAX];
};

/* Builds programs and finds a format; needs a current GL context. -ENOTSUP: the driver can draw
 * into neither texture format. Other errors as gl_program_build and gl_texture_create. On failure
 * it is finished. */
must_check int depth_init(struct depth *depth, const struct depth_layout *layout);
/* Frees the GL objects; zeroed is fine. */
void depth_finish(struct depth *depth);
/* Forgets all faces and sets the far limit of depths in metres. */
void depth_clear(struct depth *depth, float far_m);
/* Returns by how much a depth may differ, beside the error of the patches, and still belong to the
 * same surface: 2 cm in a temple of 40 m, which is ten steps of the 16 bits. */
float depth_slack_m(const struct depth *depth);

/* Begins a face. Then the caller draws the patches (attribute 0: lattice position), each after
 * depth_patch, and calls depth_end. The square holds only the area of the face in which the model's
 * bounding box is visible; from outside the model this makes texels several times smaller. */
void depth_begin(struct depth *depth, face_key face, const float sample_m[3],
		 const struct root_page *root);
/* Goes on with the face that was begun with these, after others have drawn. */
void depth_resume(struct depth *depth, face_key face, const float sample_m[3],
		  const struct root_page *root);
/* Prepares one patch: fragments compute depths relative to its centre, so that mediump resolves all
 * steps. */
void depth_patch(const struct depth *depth, const float centre_m[3]);
/* Writes the face into the square of its slot. cut identifies what was drawn. Leaves the depth
 * framebuffer bound. Without memory for the slot's sheet this is logged, and the face has
 * no depths until it is drawn again. */
void depth_end(struct depth *depth, int slot, face_key face, uint64_t cut);
/* The position of a face slot. */
struct depth_place {
	int sheet, column, row;
};
/* Returns the position of a slot. */
struct depth_place depth_place(const struct depth *depth, int slot);
/* Returns whether the slot holds the depths of this face. */
bool depth_ready(const struct depth *depth, int slot, face_key face);

#endif
