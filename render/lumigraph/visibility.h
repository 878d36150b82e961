/* Which surface is in sight, counted: the pieces in the frustum are drawn into a small picture as
 * numbers, sides and depths, and read back. What is hidden wants nothing, and what shows is judged
 * by the places of it that show. */
#ifndef GOPURA_RENDER_LUMIGRAPH_VISIBILITY_H
#define GOPURA_RENDER_LUMIGRAPH_VISIBILITY_H

#include "format/root_page.h"
#include "geometry/view.h"
#include "render/display/gl.h"

enum { VISIBILITY_WIDTH = 320, VISIBILITY_HEIGHT = 180, VISIBILITY_PIECES_MAX = 32767 };

struct visibility {
	struct gl_target target;
	struct visibility_program {
		GLuint program;
		GLint right, up, forward, lattice, number, cut;
	} whole, section; /* the latter for views that are cut, made when first needed */
	const struct visibility_program *used;
	uint8_t *pixels; /* owned */
	struct view view;
};

struct visibility_point {
	uint32_t piece; /* as numbered */
	bool back;      /* of a triangle: it turns clockwise to the eye */
	float at_m[3];
};

must_check int visibility_init(struct visibility *visibility);
void visibility_finish(struct visibility *visibility);

/* Afterwards for each piece visibility_number, then its patch bound and its triangles drawn. */
void visibility_begin(struct visibility *visibility, const struct view *view,
		      const struct root_page *root);
/* The same once more where other things were drawn between. */
void visibility_resume(struct visibility *visibility, const struct root_page *root);
void visibility_number(const struct visibility *visibility,
		       uint32_t piece); /* below VISIBILITY_PIECES_MAX */
/* Reads the picture. */
must_check int visibility_end(struct visibility *visibility);
/* What shows at a place of it; false: nothing. */
bool visibility_at(const struct visibility *visibility, int x, int y, struct visibility_point *out);

#endif
