/* The visibility pass: finds which surface is visible. The pieces in the frustum are drawn into a
 * small picture as numbers, sides and depths, and read back. A hidden piece wants nothing, and a
 * visible one is judged by its visible points. Needs a current GL context. */
#ifndef GOPURA_RENDER_LUMIGRAPH_VISIBILITY_H
#define GOPURA_RENDER_LUMIGRAPH_VISIBILITY_H

#include "format/root_page.h"
#include "geometry/view.h"
#include "render/display/gl.h"

enum { VISIBILITY_WIDTH = 320, VISIBILITY_HEIGHT = 180, VISIBILITY_PIECES_MAX = 32767 };

/* What a program of the pass is for, beside pieces in a whole view. */
enum {
	VISIBILITY_CUT = 1,    /* views with a section plane */
	VISIBILITY_BESIDE = 2, /* what is no piece */
	VISIBILITY_PROGRAMS = 4,
};

struct visibility {
	struct gl_target target;
	struct visibility_program {
		GLuint program; /* 0: not built yet, or refused */
		bool is_refused;
		GLint right, up, forward, range, lattice, number, cut, model;
	} programs[VISIBILITY_PROGRAMS];
	const struct visibility_program *used;
	uint8_t *pixels; /* owned */
	struct view view;
	float far_m; /* far limit of the pass's depths, which have 16 bits */
};

struct visibility_point {
	uint32_t piece; /* the number given to visibility_number */
	bool back;      /* a back face: clockwise as seen from the eye */
	float at_m[3];
};

/* Builds the program and the target. -ENOMEM, or as gl_program_build and gl_target_create. */
must_check int visibility_init(struct visibility *visibility);
/* Frees everything; zeroed is fine. */
void visibility_finish(struct visibility *visibility);

/* Begins the pass. Then, for each piece, call visibility_number, bind its patch and draw its
 * triangles. beside_m: how far from the eye what is no piece may be; 0: the pass has pieces alone.
 */
void visibility_begin(struct visibility *visibility, const struct view *view,
		      const struct root_page *root, float beside_m);
/* Continues the pass after other things were drawn. */
void visibility_resume(struct visibility *visibility, const struct root_page *root);
/* Sets the number of the next piece, below VISIBILITY_PIECES_MAX. */
void visibility_number(const struct visibility *visibility, uint32_t piece);
/* What is drawn next is no piece: it hides pieces, and has a depth but no number. model is its
 * matrix to metres from the view's eye, column-major. Attribute 0 is the place. false: it cannot be
 * drawn. */
bool visibility_beside(struct visibility *visibility, const float model[16]);
/* Reads the picture back; waits for the GPU. Errors as gl_check. */
must_check int visibility_end(struct visibility *visibility);
/* Writes which piece is visible at a pixel of the small picture; y counts upwards. Returns false
 * where there is none. */
bool visibility_at(const struct visibility *visibility, int x, int y, struct visibility_point *out);
/* Returns the depth along the view's forward axis in metres at that pixel, INFINITY where there is
 * nothing. */
float visibility_depth_m(const struct visibility *visibility, int x, int y);

#endif
