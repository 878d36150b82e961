#include "render/lumigraph/visibility.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"

static const float far_m = 1000; /* depths are 16 bits of it: 15 mm */

static const char census_vertex[] =
	"attribute vec3 a_position;\n"
	"uniform vec4 u_lattice;\n"
	"uniform vec3 u_right, u_up, u_forward;\n" /* right and up over the tangents */
	"varying float v_depth;\n"
	"#ifdef CUT\n"
	"uniform vec4 u_cut;\n"
	"varying float v_cut;\n"
	"#endif\n"
	"void main() {\n"
	"	vec3 p = u_lattice.xyz + u_lattice.w * a_position;\n"
	"	float z = dot(p, u_forward), n = 0.05, f = 1000.0;\n"
	"	v_depth = z / f * 65535.0 / 256.0;\n"
	"#ifdef CUT\n"
	"	v_cut = dot(u_cut.xyz, p) - u_cut.w;\n"
	"#endif\n"
	"	gl_Position = vec4(dot(p, u_right), dot(p, u_up),\n"
	"			   ((f + n) * z - 2.0 * f * n) / (f - n), z);\n"
	"}\n";

static const char census_fragment[] =
	"uniform vec2 u_number;\n"
	"varying float v_depth;\n"
	"#ifdef CUT\n"
	"varying float v_cut;\n"
	"#endif\n"
	"void main() {\n"
	"#ifdef CUT\n"
	"	if (v_cut > 0.0)\n"
	"		discard;\n"
	"#endif\n"
	"	float high = floor(v_depth);\n"
	"	float low = floor((v_depth - high) * 256.0);\n"
	"	float back = gl_FrontFacing ? 0.0 : 128.0;\n"
	"	gl_FragColor = vec4(back / 255.0 + u_number.x, u_number.y, vec2(high, low) / 255.0);\n"
	"}\n";

static int build(struct census_program *out, const char *defines)
{
	const struct gl_program_source source = {
		.name = "census",
		.vertex = (const char *const[]){ defines, census_vertex, NULL },
		.fragment =
			(const char *const[]){ gl_fine_fragment, defines, census_fragment, NULL },
		.attributes = (const char *const[]){ "a_position", NULL },
	};
	int rc = gl_program_build(&out->program, &source);
	if (rc < 0)
		return rc;
	out->right = glGetUniformLocation(out->program, "u_right");
	out->up = glGetUniformLocation(out->program, "u_up");
	out->forward = glGetUniformLocation(out->program, "u_forward");
	out->lattice = glGetUniformLocation(out->program, "u_lattice");
	out->number = glGetUniformLocation(out->program, "u_number");
	out->cut = glGetUniformLocation(out->program, "u_cut");
	return 0;
}

int census_init(struct census *census)
{
	memset(census, 0, sizeof(*census));
	census->pixels = calloc(CENSUS_WIDTH * CENSUS_HEIGHT, 4);
	int rc = census->pixels ? build(&census->whole, "") : -ENOMEM;
	if (rc == 0)
		rc = gl_target_create(&census->target, CENSUS_WIDTH, CENSUS_HEIGHT);
	if (rc < 0) {
		census_finish(census);
		return rc;
	}
	return 0;
}

static const struct census_program *program_for(struct census *census)
{
	if (!view_is_cut(&census->view))
		return &census->whole;
	if (!census->section.program && build(&census->section, "#define CUT\n") < 0)
		return &census->whole; /* what is cut away then hides what it hid */
	return &census->section;
}

void census_finish(struct census *census)
{
	if (census->whole.program)
		glDeleteProgram(census->whole.program);
	if (census->section.program)
		glDeleteProgram(census->section.program);
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
	const struct census_program *program = census->used = program_for(census);
	glUseProgram(program->program);
	glUniform4f(program->lattice, (float)(lattice->origin_m[0] - view->eye_m[0]),
		    (float)(lattice->origin_m[1] - view->eye_m[1]),
		    (float)(lattice->origin_m[2] - view->eye_m[2]), (float)lattice->step_m);
	const float *r = view->right, *u = view->up, *f = view->forward;
	float x = 1 / view->tan_x, y = 1 / view->tan_y;
	glUniform3f(program->right, x * r[0], x * r[1], x * r[2]);
	glUniform3f(program->up, y * u[0], y * u[1], y * u[2]);
	glUniform3f(program->forward, f[0], f[1], f[2]);
	if (program->cut >= 0)
		glUniform4fv(program->cut, 1, view->cut);
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
	glUniform2f(census->used->number, (float)((piece + 1) >> 8) / 255,
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
