/* Draws pieces as numbers and depths into 320 x 180 pixels, reads them back and decodes single
 * pixels. */
#include "render/lumigraph/visibility.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"

/* The near limit: at most this, and this share of the far one, since models may be a hand wide. */
static const float near_most_m = 0.05f, near_share = 2e-3f;
/* So many times farther away than all pieces, what is beside them is as far as the sky. */
static const float beside_most = 10;

static const char visibility_vertex[] =
	"attribute vec3 a_position, a_base;\n"
	"#ifdef BESIDE\n"
	"uniform mat4 u_model;\n"
	"#else\n"
	"uniform vec4 u_lattice;\n"
	"#endif\n"
	/* right and up are divided by the tangents of the field of view */
	"uniform vec3 u_right, u_up, u_forward;\n"
	"uniform vec2 u_range;\n" /* near and far limit */
	/* The number goes through the vertices: drivers that draw on the processor copy all state
	 * of the fragments where one of their uniforms changes, and it changes with each piece. */
	"uniform vec2 u_number;\n"
	"varying vec3 v_depth;\n" /* and the number */
	"#ifdef CUT\n"
	"uniform vec4 u_cut;\n"
	"varying float v_cut;\n"
	"#endif\n"
	"void main() {\n"
	"#ifdef BESIDE\n"
	"	vec3 p = (u_model * vec4(a_position, 1.0)).xyz;\n"
	"#else\n"
	"	vec3 p = u_lattice.xyz + u_lattice.w * (a_base + a_position);\n"
	"#endif\n"
	"	float z = dot(p, u_forward), n = u_range.x, f = u_range.y;\n"
	"	v_depth = vec3(z / f * 65535.0 / 256.0, u_number);\n"
	"#ifdef CUT\n"
	"	v_cut = dot(u_cut.xyz, p) - u_cut.w;\n"
	"#endif\n"
	"	gl_Position = vec4(dot(p, u_right), dot(p, u_up),\n"
	"			   ((f + n) * z - 2.0 * f * n) / (f - n), z);\n"
	"}\n";

static const char visibility_fragment[] =
	"varying vec3 v_depth;\n"
	"#ifdef CUT\n"
	"varying float v_cut;\n"
	"#endif\n"
	"void main() {\n"
	"#ifdef CUT\n"
	"	if (v_cut > 0.0)\n"
	"		discard;\n"
	"#endif\n"
	"	float high = floor(v_depth.x);\n"
	"	float low = floor((v_depth.x - high) * 256.0);\n"
	"	float back = gl_FrontFacing ? 0.0 : 128.0;\n"
	"	gl_FragColor = vec4(back / 255.0 + v_depth.y, v_depth.z, vec2(high, low) / 255.0);\n"
	"}\n";

static int build(struct visibility_program *out, unsigned kind)
{
	static const char *const all[VISIBILITY_PROGRAMS] = { "", "#define CUT\n",
							      "#define BESIDE\n",
							      "#define CUT\n#define BESIDE\n" };
	const char *const defines = all[kind];
	const struct gl_program_source source = {
		.name = "visibility",
		.vertex = (const char *const[]){ defines, visibility_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, defines, visibility_fragment,
						   NULL },
		.attributes = (const char *const[]){ "a_position", "a_normal", "a_colour", "a_base",
						     NULL },
	};
	int rc = gl_program_build(&out->program, &source);
	if (rc < 0)
		return rc;
	out->right = glGetUniformLocation(out->program, "u_right");
	out->up = glGetUniformLocation(out->program, "u_up");
	out->forward = glGetUniformLocation(out->program, "u_forward");
	out->range = glGetUniformLocation(out->program, "u_range");
	out->lattice = glGetUniformLocation(out->program, "u_lattice");
	out->number = glGetUniformLocation(out->program, "u_number");
	out->cut = glGetUniformLocation(out->program, "u_cut");
	out->model = glGetUniformLocation(out->program, "u_model");
	return 0;
}

int visibility_init(struct visibility *visibility)
{
	memset(visibility, 0, sizeof(*visibility));
	visibility->pixels = calloc(VISIBILITY_WIDTH * VISIBILITY_HEIGHT, 4);
	int rc = visibility->pixels ? build(&visibility->programs[0], 0) : -ENOMEM;
	if (rc == 0)
		rc = gl_target_create(&visibility->target, VISIBILITY_WIDTH, VISIBILITY_HEIGHT);
	if (rc < 0) {
		visibility_finish(visibility);
		return rc;
	}
	return 0;
}

/* Returns the program for pieces (0) or for what is beside them in the pass's view, built if it is
 * not there, or NULL. */
static const struct visibility_program *find_program(struct visibility *visibility, unsigned beside)
{
	const unsigned kind = beside | (view_is_cut(&visibility->view) ? VISIBILITY_CUT : 0);
	struct visibility_program *p = &visibility->programs[kind];
	if (!p->program && !p->is_refused)
		p->is_refused = build(p, kind) < 0;
	return p->program ? p : NULL;
}

static const struct visibility_program *program_for(struct visibility *visibility)
{
	const struct visibility_program *p = find_program(visibility, 0);
	/* without it, the part that is cut away still hides what is behind it */
	return p ? p : &visibility->programs[0];
}

void visibility_finish(struct visibility *visibility)
{
	for (unsigned kind = 0; kind < VISIBILITY_PROGRAMS; kind++)
		if (visibility->programs[kind].program)
			glDeleteProgram(visibility->programs[kind].program);
	gl_target_destroy(&visibility->target);
	free(visibility->pixels);
	memset(visibility, 0, sizeof(*visibility));
}

/* Uses a program with the pass's view. */
static void use(struct visibility *visibility, const struct visibility_program *program)
{
	const struct view *view = &visibility->view;
	const float *r = view->right, *u = view->up, *f = view->forward;
	const float x = 1 / view->tan_x, y = 1 / view->tan_y;
	visibility->used = program;
	glUseProgram(program->program);
	glUniform3f(program->right, x * r[0], x * r[1], x * r[2]);
	glUniform3f(program->up, y * u[0], y * u[1], y * u[2]);
	glUniform3f(program->forward, f[0], f[1], f[2]);
	glUniform2f(program->range, fminf(near_share * visibility->far_m, near_most_m),
		    visibility->far_m);
	if (program->cut >= 0)
		glUniform4fv(program->cut, 1, view->cut);
}

void visibility_resume(struct visibility *visibility, const struct root_page *root)
{
	const struct lattice *lattice = &root->lattice;
	const struct view *view = &visibility->view;
	gl_target_bind(&visibility->target);
	glDisable(GL_BLEND);
	glDisable(GL_CULL_FACE);
	glEnable(GL_DEPTH_TEST);
	glDepthMask(GL_TRUE);
	glDepthFunc(GL_LESS);
	use(visibility, program_for(visibility));
	glUniform4f(visibility->used->lattice, (float)(lattice->origin_m[0] - view->eye_m[0]),
		    (float)(lattice->origin_m[1] - view->eye_m[1]),
		    (float)(lattice->origin_m[2] - view->eye_m[2]), (float)lattice->step_m);
	glEnableVertexAttribArray(0);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
}

/* Returns the greatest distance that a corner of the model's box may have. */
static float find_far(const struct view *view, const struct root_page *root)
{
	float farthest[3];
	for (int k = 0; k < 3; k++)
		farthest[k] = fmaxf(fabsf(root->box_min_m[k] - view->eye_m[k]),
				    fabsf(root->box_max_m[k] - view->eye_m[k]));
	/* simplified, it may reach beyond */
	return 1.01f * sqrtf(vec_dot(farthest, farthest));
}

void visibility_begin(struct visibility *visibility, const struct view *view,
		      const struct root_page *root, float beside_m)
{
	const float far_m = find_far(view, root);
	visibility->view = *view;
	visibility->far_m = fminf(fmaxf(far_m, beside_m), beside_most * far_m);
	visibility_resume(visibility, root);
	glClearColor(0, 0, 0, 0);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void visibility_number(const struct visibility *visibility, uint32_t piece)
{
	glUniform2f(visibility->used->number, (float)((piece + 1) >> 8) / 255,
		    (float)((piece + 1) & 255) / 255);
}

bool visibility_beside(struct visibility *visibility, const float model[16])
{
	const struct visibility_program *p = find_program(visibility, VISIBILITY_BESIDE);
	if (!p)
		return false;
	if (p != visibility->used)
		use(visibility, p);
	glUniformMatrix4fv(p->model, 1, GL_FALSE, model);
	return true;
}

int visibility_end(struct visibility *visibility)
{
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	glReadPixels(0, 0, VISIBILITY_WIDTH, VISIBILITY_HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE,
		     visibility->pixels);
	return gl_check("taking the visibility pass");
}

static uint32_t number_of(const uint8_t pixel[4])
{
	return (uint32_t)(pixel[0] & 127) << 8 | pixel[1];
}

float visibility_depth_m(const struct visibility *visibility, int x, int y)
{
	const uint8_t *pixel = visibility->pixels + 4 * (y * VISIBILITY_WIDTH + x);
	const int depth = pixel[2] << 8 | pixel[3];
	return depth > 0 ? (float)depth / 65535 * visibility->far_m : INFINITY;
}

bool visibility_at(const struct visibility *visibility, int x, int y, struct visibility_point *out)
{
	const uint8_t *pixel = visibility->pixels + 4 * (y * VISIBILITY_WIDTH + x);
	const struct view *view = &visibility->view;
	uint32_t number = number_of(pixel);
	if (number == 0)
		return false;
	out->piece = number - 1;
	out->back = pixel[0] & 128;
	float depth = visibility_depth_m(visibility, x, y);
	float right = (2 * ((float)x + 0.5f) / VISIBILITY_WIDTH - 1) * view->tan_x * depth;
	float up = (2 * ((float)y + 0.5f) / VISIBILITY_HEIGHT - 1) * view->tan_y * depth;
	for (int i = 0; i < 3; i++)
		out->at_m[i] = view->eye_m[i] + depth * view->forward[i] + right * view->right[i] +
			       up * view->up[i];
	return true;
}
