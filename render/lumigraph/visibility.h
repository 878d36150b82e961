/* Which surface is in sight, counted: the pieces in the frustum are drawn into a small picture as
 * numbers, sides and depths, and read back. What is hidden wants nothing, and what shows is judged
 * by the places of it that show. */
#ifndef GOPURA_RENDER_LUMIGRAPH_VISIBILITY_H
#define GOPURA_RENDER_LUMIGRAPH_VISIBILITY_H

#include "format/root_page.h"
#include "geometry/view.h"
#include "render/display/gl.h"

enum { CENSUS_WIDTH = 320, CENSUS_HEIGHT = 180, CENSUS_PIECES_MOST = 32767 };

struct census {
	struct gl_target target;
	struct census_program {
		GLuint program;
		GLint right, up, forward, lattice, number, cut;
	} whole, section; /* the latter for views that are cut, made when first needed */
	const struct census_program *used;
	uint8_t *pixels; /* owned */
	struct view view;
};

struct census_point {
	uint32_t piece; /* as numbered */
	bool back;      /* of a triangle: it turns clockwise to the eye */
	float at_m[3];
};

must_check int census_init(struct census *census);
void census_finish(struct census *census);

/* Afterwards for each piece census_number, then its patch bound and its triangles drawn. */
void census_begin(struct census *census, const struct view *view, const struct root_page *root);
/* The same once more where other things were drawn between. */
void census_resume(struct census *census, const struct root_page *root);
void census_number(const struct census *census, uint32_t piece); /* below CENSUS_PIECES_MOST */
/* Reads the picture. */
must_check int census_end(struct census *census);
/* What shows at a place of it; false: nothing. */
bool census_at(const struct census *census, int x, int y, struct census_point *out);

#endif
