#include "render/census.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "render/vec.h"

static const float far_m = 1000; /* depths are 16 bits of it: 15 mm */

static const char census_vertex[] =
	"attribute vec3 a_position;\n"
	"uniform vec4 u_lattice;\n"
	"uniform vec3 u_right, u_up, u_forward;\n" /* right and up over the tangents */
	"varying float v_depth;\n"
	"void main() {\n"
	"	vec3 p = u_lattice.xyz + u_lattice.w * a_position;\n"
	"	float z = dot(p, u_forward), n = 0.05, f = 1000.0;\n"
	"	v_depth = z / f * 65535.0 / 256.0;\n"
	"	gl_Position = vec4(dot(p, u_right), dot(p, u_up),\n"
	"			   ((f + n) * z - 2.0 * f * n) / (f - n), z);\n"
	"}\n";

static const char census_fragment[] =
	"uniform vec2 u_number;\n"
	"varying float v_depth;\n"
	"void main() {\n"
	"	float high = floor(v_depth);\n"
	"	float low = floor((v_depth - high) * 256.0);\n"
	"	float back = gl_FrontFacing ? 0.0 : 128.0;\n"
	"	gl_FragColor = vec4(back / 255.0 + u_number.x, u_number.y, vec2(high, low) / 255.0);\n"
	"}\n";

int census_init(struct census *census)
{
	memset(census, 0, sizeof(*census));
	const struct gl_program_source source = {
		.name = "census",
		.vertex = (const char *const[]){ census_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, census_fragment, NULL },
		.attributes = (const char *const[]){ "a_position", NULL },
	};
	census->pixels = calloc(CENSUS_WIDTH * CENSUS_HEIGHT, 4);
	int rc = census->pixels ? gl_program_build(&census->program, &source) : -ENOMEM;
	if (rc == 0)
		rc = gl_target_create(&census->target, CENSUS_WIDTH, CENSUS_HEIGHT);
	if (rc < 0) {
		census_finish(census);
		return rc;
	}
	census->right = glGetUniformLocation(census->program, "u_right");
	census->up = glGetUniformLocation(census->program, "u_up");
	census->forward = glGetUniformLocation(census->program, "u_forward");
	census->lattice = glGetUniformLocation(census->program, "u_lattice");
	census->number = glGetUniformLocation(census->program, "u_number");
	return 0;
}

void census_finish(struct census *census)
{
	if (census->program)
		glDeleteProgram(census->program);
	gl_target_destroy(&census->target);
	free(census->pixels);
	memset(census, 0, sizeof(*census));
}

void census_resume(struct census *census, const struct root_page *root)
{
	const struct lattice *lattice = &root->lattice;
	const struct view *view = &census->view;
	gl_target_bind(&census->target);
	glDisable(GL_BLEND);
	glDisable(GL_CULL_FACE);
	glEnable(GL_DEPTH_TEST);
	glDepthMask(GL_TRUE);
	glDepthFunc(GL_LESS);
	glUseProgram(census->program);
	glUniform4f(census->lattice, (float)(lattice->origin_m[0] - view->eye_m[0]),
		    (float)(lattice->origin_m[1] - view->eye_m[1]),
		    (float)(lattice->origin_m[2] - view->eye_m[2]), (float)lattice->step_m);
	const float *r = view->right, *u = view->up, *f = view->forward;
	float x = 1 / view->tan_x, y = 1 / view->tan_y;
	glUniform3f(census->right, x * r[0], x * r[1], x * r[2]);
	glUniform3f(census->up, y * u[0], y * u[1], y * u[2]);
	glUniform3f(census->forward, f[0], f[1], f[2]);
	glEnableVertexAttribArray(0);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
}

void census_begin(struct census *census, const struct view *view, const struct root_page *root)
{
	census->view = *view;
	census_resume(census, root);
	glClearColor(0, 0, 0, 0);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void census_number(const struct census *census, uint32_t piece)
{
	glUniform2f(census->number, (float)((piece + 1) >> 8) / 255,
		    (float)((piece + 1) & 255) / 255);
}

int census_end(struct census *census)
{
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	glReadPixels(0, 0, CENSUS_WIDTH, CENSUS_HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, census->pixels);
	return gl_check("taking the census");
}

bool census_at(const struct census *census, int x, int y, struct census_point *out)
{
	const uint8_t *pixel = census->pixels + 4 * (y * CENSUS_WIDTH + x);
	const struct view *view = &census->view;
	uint32_t number = (uint32_t)(pixel[0] & 127) << 8 | pixel[1];
	if (number == 0)
		return false;
	out->piece = number - 1;
	out->back = pixel[0] & 128;
	float depth = (float)(pixel[2] << 8 | pixel[3]) / 65535 * far_m;
	float right = (2 * ((float)x + 0.5f) / CENSUS_WIDTH - 1) * view->tan_x * depth;
	float up = (2 * ((float)y + 0.5f) / CENSUS_HEIGHT - 1) * view->tan_y * depth;
	for (int i = 0; i < 3; i++)
		out->at_m[i] = view->eye_m[i] + depth * view->forward[i] + right * view->right[i] +
			       up * view->up[i];
	return true;
}
