/* Holds the small target and the program that enlarges it. */
#include "render/lumigraph/enlargement.h"

#include <math.h>
#include <string.h>

/* Steps of the scale: each change of size allocates a target. */
static const float scale_steps = 32;

/* The coordinate is used as it is interpolated: even where fragments have only mediump, hardware
 * interpolates texture coordinates more exactly than it computes. */
static const char enlarge_fragment[] = "uniform FINE sampler2D u_picture;\n"
				       "varying vec2 v_at;\n"
				       "void main() {\n"
				       "	gl_FragColor = texture2D(u_picture, v_at);\n"
				       "}\n";

void enlargement_view(struct view *small, const struct view *view, float scale)
{
	const float rounded = ceilf(scale * scale_steps) / scale_steps;
	*small = *view;
	small->width_px = (int)ceilf((float)view->width_px * rounded);
	small->height_px = (int)ceilf((float)view->height_px * rounded);
	small->focal_px = view->focal_px * rounded;
	small->picture_px = (float)small->width_px * (float)small->height_px;
}

static int build(struct enlargement *enlargement)
{
	const struct gl_program_source source = {
		.name = "enlargement",
		.vertex = (const char *const[]){ gl_square_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, enlarge_fragment, NULL },
		.attributes = gl_square_attributes,
	};
	int rc = enlargement->program ? 0 : gl_program_build(&enlargement->program, &source);
	if (rc < 0)
		return rc;
	glUseProgram(enlargement->program);
	glUniform1i(glGetUniformLocation(enlargement->program, "u_picture"), 0);
	return 0;
}

static int allocate(struct enlargement *enlargement, int width_px, int height_px)
{
	gl_target_destroy(&enlargement->small);
	int rc = build(enlargement);
	if (rc == 0)
		rc = gl_target_create(&enlargement->small, width_px, height_px);
	if (rc < 0)
		return rc;
	gl_bind_texture(0, enlargement->small.colour);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	return 0;
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
	glDisable(GL_DEPTH_TEST);
	glDisable(GL_BLEND);
	glUseProgram(enlargement->program);
	gl_bind_texture(0, enlargement->small.colour);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
	gl_draw_square();
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
