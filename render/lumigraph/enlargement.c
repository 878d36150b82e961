/* Holds the small target and the program that enlarges it. */
#include "render/lumigraph/enlargement.h"

#include <math.h>
#include <string.h>

/* Steps of the scale: each change of size allocates a target. */
static const float scale_steps = 32;

void enlargement_view(struct view *small, const struct view *view, float scale)
{
	const float rounded = ceilf(scale * scale_steps) / scale_steps;
	*small = *view;
	small->width_px = (int)ceilf((float)view->width_px * rounded);
	small->height_px = (int)ceilf((float)view->height_px * rounded);
	small->focal_px = view->focal_px * rounded;
	small->picture_px = (float)small->width_px * (float)small->height_px;
}

static int allocate(struct enlargement *enlargement, int width_px, int height_px)
{
	gl_target_destroy(&enlargement->small);
	int rc = enlargement->program ? 0 : gl_copy_build(&enlargement->program);
	if (rc == 0)
		rc = gl_target_create(&enlargement->small, width_px, height_px);
	if (rc == 0)
		gl_target_smooth(&enlargement->small);
	return rc;
}

int enlargement_begin(struct enlargement *enlargement, const struct view *small)
{
	int rc = 0;
	if (!enlargement->small.framebuffer || enlargement->small.width_px != small->width_px ||
	    enlargement->small.height_px != small->height_px)
		rc = allocate(enlargement, small->width_px, small->height_px);
	if (rc == 0)
		gl_target_bind(&enlargement->small);
	return rc;
}

void enlargement_end(const struct enlargement *enlargement, const struct gl_place *place,
		     int width_px, int height_px)
{
	gl_place_bind(place, width_px, height_px);
	glDisable(GL_BLEND);
	gl_copy_draw(enlargement->program, enlargement->small.colour);
}

void enlargement_let_go(struct enlargement *enlargement)
{
	gl_target_destroy(&enlargement->small);
}

void enlargement_finish(struct enlargement *enlargement)
{
	enlargement_let_go(enlargement);
	if (enlargement->program)
		glDeleteProgram(enlargement->program);
	memset(enlargement, 0, sizeof(*enlargement));
}
