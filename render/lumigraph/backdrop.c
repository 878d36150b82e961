/* Draws the sides of a cube around the eye, each with the tiles of its face. */
#include "render/lumigraph/backdrop.h"

#include <stdio.h>
#include <string.h>

#include "format/cube.h"

/* Whatever its distance, no plane of the frustum in front or behind cuts the cube. */
static const char backdrop_vertex[] = "attribute vec2 a_position;\n"
				      "uniform mat4 u_clip;\n"
				      "uniform vec3 u_forward, u_right, u_up;\n"
				      "varying vec2 v_at;\n" /* 0..1 to the right and down */
				      "void main() {\n"
				      "	v_at = vec2(0.5, -0.5) * a_position + 0.5;\n"
				      "	vec3 p = u_forward + u_right * a_position.x\n"
				      "		 + u_up * a_position.y;\n"
				      "	gl_Position = u_clip * vec4(p, 1.0);\n"
				      "	gl_Position.z = 0.0;\n"
				      "}\n";

/* The look-up of a tile is that of surface.c. */
static const char backdrop_fragment[] =
	"uniform sampler2D u_tiles;\n"
	"uniform FINE sampler2D u_cells;\n"
	"uniform vec2 u_place;\n" /* the face's first cell in the texture */
	"uniform vec3 u_sky;\n"
	"varying vec2 v_at;\n"
	"void main() {\n"
	"	vec2 way = v_at * CELLS;\n"
	"	vec2 cell = clamp(floor(way), 0.0, CELLS - 1.0);\n"
	"	vec4 tile = texture2D(u_cells, (u_place + cell + 0.5) / CELL_GRID) * 255.0;\n"
	"	if (tile.b < 0.5)\n"
	"		discard;\n"
	"	float share = floor(tile.b + 0.5) / CELLS;\n"
	"	vec2 local = way * share - floor((cell + 0.5) * share);\n"
	"	vec2 at = floor(tile.rg + 0.5 - MIDDLE) * IMAGE + (local * TILE + APRON);\n"
	"	vec3 colour = texture2D(u_tiles, at).rgb, off = colour - u_sky;\n"
	/* Alpha is coverage, for pictures that are kept. Images have none, but the more a texel
	 * differs from the background, the more of the model is in it. */
	"	gl_FragColor = vec4(colour, clamp(2.4 * length(off) - 0.07, 0.0, 1.0));\n"
	"}\n";

static int build(struct backdrop *backdrop, const struct tiles *tiles)
{
	char constants[TILES_CONSTANTS_BYTES];
	const struct gl_program_source source = {
		.name = "backdrop",
		.vertex = (const char *const[]){ backdrop_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, constants, backdrop_fragment,
						   NULL },
		.attributes = gl_square_attributes,
	};
	tiles_constants(constants, tiles);
	int rc = gl_program_build(&backdrop->program, &source);
	if (rc < 0)
		return rc;
	const GLuint program = backdrop->program;
	backdrop->clip = glGetUniformLocation(program, "u_clip");
	backdrop->forward = glGetUniformLocation(program, "u_forward");
	backdrop->right = glGetUniformLocation(program, "u_right");
	backdrop->up = glGetUniformLocation(program, "u_up");
	backdrop->place = glGetUniformLocation(program, "u_place");
	backdrop->sky = glGetUniformLocation(program, "u_sky");
	glUseProgram(program);
	glUniform1i(glGetUniformLocation(program, "u_tiles"), 0);
	glUniform1i(glGetUniformLocation(program, "u_cells"), 1);
	return 0;
}

void backdrop_draw(struct backdrop *backdrop, const struct tiles *tiles, const struct view *view,
		   const uint8_t sky[3], uint32_t point, float share)
{
	if (!backdrop->program && !backdrop->lacks)
		backdrop->lacks = build(backdrop, tiles) < 0;
	if (backdrop->lacks)
		return;
	glUseProgram(backdrop->program);
	glUniformMatrix4fv(backdrop->clip, 1, GL_FALSE, view->clip);
	glUniform3f(backdrop->sky, sky[0] / 255.0f, sky[1] / 255.0f, sky[2] / 255.0f);
	gl_bind_texture(0, tiles->atlas);
	gl_bind_texture(1, tiles->indirection);
	glDisable(GL_DEPTH_TEST);
	glEnable(GL_BLEND);
	glBlendColor(0, 0, 0, share);
	glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
	for (uint32_t face = 0; face < CUBE_FACES; face++) {
		const int slot = tiles_face_slot(tiles, point * CUBE_FACES + face);
		const struct cube_axes *axes = &cube_axes[face];
		if (slot < 0)
			continue;
		glUniform3fv(backdrop->forward, 1, axes->forward);
		glUniform3fv(backdrop->right, 1, axes->right);
		glUniform3fv(backdrop->up, 1, axes->up);
		glUniform2f(backdrop->place, (float)(slot % (int)tiles->faces_across * TILES_CELLS),
			    (float)(slot / (int)tiles->faces_across * TILES_CELLS));
		gl_draw_square();
	}
	glDisable(GL_BLEND);
	glEnable(GL_DEPTH_TEST);
}

void backdrop_finish(struct backdrop *backdrop)
{
	if (backdrop->program)
		glDeleteProgram(backdrop->program);
	memset(backdrop, 0, sizeof(*backdrop));
}
