/* What each resident face of a sampling point can see, as depth: rendered by the kiosk from its own
 * patches, so that it costs no bytes and fits the mesh it is tested against.
 *
 * A texel is depth along the face's axis over far_limit_m, 16 bits as 5, 6 and 5.
 * Nearer surfaces are grown by one texel over a step, so that nothing behind a silhouette takes
 * the silhouette's colour. */
#ifndef GOPURA_RENDER_LUMIGRAPH_DEPTH_H
#define GOPURA_RENDER_LUMIGRAPH_DEPTH_H

#include "format/root_page.h"
#include "render/display/gl.h"
#include "render/lumigraph/tiles.h"

enum { DEPTH_SHEETS_MAX = 8 };

/* Squares of face_px, one for each of the tiles' face slots, row by row and sheet by sheet. A sheet
 * is a texture. Without highp its sides must be powers of two (gl_texture_most_px). */
struct depth_layout {
	int face_px, across, rows, sheets;
};

struct depth {
	struct gl_target raw; /* the face that is being drawn */
	GLuint sheet[DEPTH_SHEETS_MAX], framebuffer[DEPTH_SHEETS_MAX];
	GLuint draw_program, grow_program;
	GLint lattice, axes, far_m, window, base, high;
	struct depth_layout layout;
	bool repeats; /* without highp, so that coordinates are near 0 */
	float far_limit_m;
	/* The face that is being drawn: its window, forward and the point along it. */
	float begun[4], forward[3], point_m;
	struct depth_face {
		bool ready;
		face_key key;
		uint64_t cut;    /* what it was rendered from */
		float window[4]; /* of the face (-1..1) what the square holds: middle, half sides */
	} face[TILES_FACES_MAX];
};

must_check int depth_init(struct depth *depth, const struct depth_layout *layout);
void depth_finish(struct depth *depth);
void depth_clear(struct depth *depth, float far_m);
/* How far a depth may be off without being another surface's, besides the error of the patches:
 * 2 cm of a temple of 40 m, ten steps of the 16 bits. */
float depth_slack_m(const struct depth *depth);

/* Begins a face: afterwards the caller draws patches (attribute 0: lattice position), each after
 * depth_patch, then calls depth_end. The square holds that part of the face in which the model's
 * box shows: from outside the model a texel is several times smaller so. */
void depth_begin(struct depth *depth, face_key face, const float sample_m[3],
		 const struct root_page *root);
/* Fragments count depths from the patch's middle, so that mediump tells all the steps there are. */
void depth_patch(const struct depth *depth, const float centre_m[3]);
/* Into the square of the face's slot. Leaves the depth framebuffer bound. */
void depth_end(struct depth *depth, int slot, face_key face, uint64_t cut);
/* Where a face slot lies. */
struct depth_place {
	int sheet, column, row;
};
struct depth_place depth_place(const struct depth *depth, int slot);
bool depth_ready(const struct depth *depth, int slot, face_key face);

#endif
