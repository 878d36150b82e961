/* What each resident face of a sampling point can see, as depth: rendered by the kiosk from its own
 * patches, so that it costs no bytes and fits the mesh it is tested against.
 *
 * A texel is depth along the face's axis over far_limit_m, 16 bits as 5, 6 and 5.
 * Nearer surfaces are grown by one texel over a step, so that nothing behind a silhouette takes
 * the silhouette's colour. */
#ifndef GOPURA_RENDER_DEPTH_H
#define GOPURA_RENDER_DEPTH_H

#include "format/root_page.h"
#include "render/gl.h"
#include "render/tiles.h"

struct depth {
	struct gl_target raw; /* the face that is being drawn */
	GLuint atlas, framebuffer, draw_program, grow_program;
	GLint lattice, axes, far_m, window;
	int face_px, atlas_width_px, atlas_height_px;
	float far_limit_m;
	float begun[4]; /* window of the face that is being drawn */
	struct depth_face {
		bool ready;
		face_key key;
		uint64_t cut;    /* what it was rendered from */
		float window[4]; /* of the face (-1..1) what the square holds: middle, half sides */
	} face[TILES_FACES_MOST];
};

/* A square of face_px for each of the tiles' face slots. */
must_check int depth_init(struct depth *depth, int face_px, uint32_t face_rows);
void depth_finish(struct depth *depth);
void depth_clear(struct depth *depth, float far_m);
/* How far a depth may be off without being another surface's, besides the error of the patches:
 * 2 cm of a temple of 40 m, ten steps of the 16 bits. */
float depth_slack_m(const struct depth *depth);

/* Begins a face: afterwards the caller draws patches (attribute 0: lattice position), then calls
 * depth_end. The square holds that part of the face in which the model's box shows: from outside
 * the model a texel is several times smaller so. */
void depth_begin(struct depth *depth, face_key face, const float sample_m[3],
		 const struct root_page *root);
/* Into the square of the face's slot. Leaves the depth framebuffer bound. */
void depth_end(struct depth *depth, int slot, face_key face, uint64_t cut);
bool depth_ready(const struct depth *depth, int slot, face_key face);

#endif
