/* One buffer of vertices and one of indices for all meshes; a matrix for each node. */
#include "render/scenery/scenery_picture.h"

#include <stddef.h>
#include <string.h>

#include "geometry/light.h"
#include "geometry/vec.h"

/* Positions are in metres relative to the eye, so that floats suffice anywhere in the model. A back
 * that is seen has the light of its own side. */
static const char scenery_vertex[] =
	"uniform mat4 u_model;\n"
	"uniform vec3 u_turned[3];\n" /* columns */
	"uniform float u_sides;\n"
	"void main() {\n"
	"	vec3 p = (u_model * vec4(a_position, 1.0)).xyz;\n"
	"	vec3 e = unit_normal();\n"
	"	vec3 n = normalize(u_turned[0] * e.x + u_turned[1] * e.y + u_turned[2] * e.z);\n"
	"	if (u_sides > 0.5 && dot(n, p) > 0.0)\n"
	"		n = -n;\n"
	"	v_colour = vec4(own_colour(n), 1.0);\n"
	"	use_tools(p, n);\n"
	"	gl_Position = u_clip * vec4(p, 1.0);\n"
	"}\n";

static int build(struct scenery_program *p, unsigned tools, bool dissolves)
{
	const char *defines = surface_defines[tools], *vertex = "", *fragment = "";
	int rc;

	if (tools & SURFACE_RAKE) {
		vertex = rake_vertex_glsl;
		fragment = rake_fragment_glsl;
	}
	const struct gl_program_source source = {
		.name = "scenery",
		.vertex = (const char *const[]){ defines, light_glsl, vertex, surface_vertex_glsl,
						 scenery_vertex, NULL },
		.fragment = (const char *const[]){ "precision mediump float;\n", defines, fragment,
						   surface_tools_glsl,
						   dissolves ? surface_dissolve_glsl
							     : surface_whole_glsl,
						   surface_plain_glsl, NULL },
		.attributes = surface_attributes,
	};
	rc = gl_program_build(&p->program, &source);
	if (rc < 0)
		return rc;
	p->clip = glGetUniformLocation(p->program, "u_clip");
	p->model = glGetUniformLocation(p->program, "u_model");
	p->normal = glGetUniformLocation(p->program, "u_turned");
	p->sides = glGetUniformLocation(p->program, "u_sides");
	p->sun = glGetUniformLocation(p->program, "u_sun");
	p->share = glGetUniformLocation(p->program, "u_share");
	p->range = glGetUniformLocation(p->program, "u_range");
	p->rake = glGetUniformLocation(p->program, "u_rake");
	p->cut = glGetUniformLocation(p->program, "u_cut");
	return 0;
}

/* Returns the program, built where it is missing; NULL: the driver refuses it. */
static const struct scenery_program *program_of(struct scenery_picture *picture, unsigned tools,
						bool dissolves)
{
	const unsigned i = tools + (dissolves ? SURFACE_TOOLS : 0);

	if (!picture->of[i].program && !picture->lacks[i])
		picture->lacks[i] = build(&picture->of[i], tools, dissolves) < 0;
	return picture->lacks[i] ? NULL : &picture->of[i];
}

int scenery_picture_load(struct scenery_picture *picture, const struct scenery *scenery)
{
	GLsizeiptr vertices = 0, indices = 0;

	scenery_picture_drop(picture);
	for (uint32_t i = 0; i < scenery->mesh_count; i++) {
		vertices += (GLsizeiptr)(scenery->meshes[i].vertex_count *
					 sizeof(struct scenery_vertex));
		indices += (GLsizeiptr)(scenery->meshes[i].triangle_count * 3 * sizeof(uint16_t));
	}
	glGenBuffers(1, &picture->vertices);
	glGenBuffers(1, &picture->indices);
	glBindBuffer(GL_ARRAY_BUFFER, picture->vertices);
	glBufferData(GL_ARRAY_BUFFER, vertices, NULL, GL_STATIC_DRAW);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, picture->indices);
	glBufferData(GL_ELEMENT_ARRAY_BUFFER, indices, NULL, GL_STATIC_DRAW);
	vertices = indices = 0;
	for (uint32_t i = 0; i < scenery->mesh_count; i++) {
		const struct scenery_mesh *mesh = &scenery->meshes[i];
		const GLsizeiptr vertex_bytes =
			(GLsizeiptr)(mesh->vertex_count * sizeof(*mesh->vertices));
		const GLsizeiptr index_bytes =
			(GLsizeiptr)(mesh->triangle_count * sizeof(*mesh->triangles));

		glBufferSubData(GL_ARRAY_BUFFER, vertices, vertex_bytes, mesh->vertices);
		glBufferSubData(GL_ELEMENT_ARRAY_BUFFER, indices, index_bytes, mesh->triangles);
		vertices += vertex_bytes;
		indices += index_bytes;
	}
	return gl_check("uploading scenery");
}

void scenery_picture_drop(struct scenery_picture *picture)
{
	if (picture->vertices)
		glDeleteBuffers(1, &picture->vertices);
	if (picture->indices)
		glDeleteBuffers(1, &picture->indices);
	picture->vertices = picture->indices = 0;
}

void scenery_picture_finish(struct scenery_picture *picture)
{
	scenery_picture_drop(picture);
	for (int i = 0; i < SCENERY_PROGRAMS; i++)
		if (picture->of[i].program)
			glDeleteProgram(picture->of[i].program);
	*picture = (struct scenery_picture){ 0 };
}

/* ---- drawing */

/* The ball around a mesh, in metres of the model. */
static float ball_of(const struct scenery_mesh *mesh, const float m[16], float centre[3])
{
	const float half = mesh->step_m * SCENERY_PLACE_MAX / 2;
	float longest = 0;

	for (int row = 0; row < 3; row++) {
		centre[row] = m[12 + row];
		for (int k = 0; k < 3; k++)
			centre[row] += m[4 * k + row] * (mesh->origin_m[k] + half);
	}
	for (int k = 0; k < 3; k++)
		longest = vec_most(longest, vec_length(&m[4 * k]));
	/* Three axes that are scaled and sheared reach no farther than this. */
	return longest * half * 3;
}

/* The matrix from a mesh's lattice to metres from the eye. */
static void lattice_matrix(float out[16], const struct scenery_mesh *mesh, const float m[16],
			   const float eye_m[3])
{
	for (int row = 0; row < 3; row++) {
		out[12 + row] = m[12 + row] - eye_m[row];
		for (int k = 0; k < 3; k++) {
			out[4 * k + row] = m[4 * k + row] * mesh->step_m;
			out[12 + row] += m[4 * k + row] * mesh->origin_m[k];
		}
	}
	for (int k = 0; k < 4; k++)
		out[4 * k + 3] = k == 3;
}

static void set_frame(const struct scenery_program *p, const struct surface_frame *frame)
{
	const float *sun = frame->root->sun;
	float towards[3];

	glUseProgram(p->program);
	glUniformMatrix4fv(p->clip, 1, GL_FALSE, frame->view->clip);
	glUniform4f(p->sun, sun[0], sun[1], sun[2], frame->root->lit ? 1 : 0);
	glUniform1f(p->share, 0);
	if (p->rake >= 0) {
		rake_direction(&frame->rake, frame->view->right, frame->view->up,
			       frame->view->forward, towards);
		glUniform3fv(p->rake, 1, towards);
	}
	if (p->cut >= 0)
		glUniform4fv(p->cut, 1, frame->view->cut);
}

static void set_mesh(const struct scenery_program *p, const struct scenery_mesh *mesh,
		     const struct pose_node *node, const struct surface_frame *frame)
{
	const float *m = node->matrix;
	float model[16], turned[9];

	lattice_matrix(model, mesh, m, frame->view->eye_m);
	/* Normals go by the cofactors, whatever the scale. */
	vec_cross(&turned[0], &m[4], &m[8]);
	vec_cross(&turned[3], &m[8], &m[0]);
	vec_cross(&turned[6], &m[0], &m[4]);
	glUniformMatrix4fv(p->model, 1, GL_FALSE, model);
	glUniform3fv(p->normal, 3, turned);
	glUniform1f(p->sides, mesh->has_two_sides);
	if (p->range >= 0)
		glUniform2f(p->range, node->low, node->high);
	if (mesh->has_two_sides || p->cut >= 0)
		glDisable(GL_CULL_FACE);
	else
		glEnable(GL_CULL_FACE);
}

static void draw_mesh(const struct scenery_mesh *mesh, size_t vertex_bytes, size_t index_bytes)
{
	const GLsizei stride = sizeof(struct scenery_vertex);

	glVertexAttribPointer(0, 3, GL_UNSIGNED_SHORT, GL_FALSE, stride,
			      (void *)(vertex_bytes + offsetof(struct scenery_vertex, place)));
	glVertexAttribPointer(1, 2, GL_BYTE, GL_FALSE, stride,
			      (void *)(vertex_bytes + offsetof(struct scenery_vertex, normal)));
	glVertexAttribPointer(2, 3, GL_UNSIGNED_BYTE, GL_TRUE, stride,
			      (void *)(vertex_bytes + offsetof(struct scenery_vertex, rgb)));
	glDrawElements(GL_TRIANGLES, (GLsizei)(3 * mesh->triangle_count), GL_UNSIGNED_SHORT,
		       (void *)index_bytes);
}

void scenery_picture_draw(struct scenery_picture *picture, const struct pose *pose,
			  const struct surface_frame *frame)
{
	const struct scenery_program *used = NULL;
	size_t vertex_bytes = 0, index_bytes = 0;

	glBindBuffer(GL_ARRAY_BUFFER, picture->vertices);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, picture->indices);
	for (GLuint i = 0; i < 3; i++)
		glEnableVertexAttribArray(i);
	for (uint32_t i = 0; i < pose->scenery->mesh_count; i++) {
		const struct scenery_mesh *mesh = &pose->scenery->meshes[i];
		const struct pose_node *node = &pose->nodes[mesh->node];
		const struct dissolve_range range = { node->low, node->high };
		const struct scenery_program *p;
		float centre[3], radius = ball_of(mesh, node->matrix, centre);

		p = dissolve_draws(range) && view_sees_sphere(frame->view, centre, radius)
			    ? program_of(picture, surface_tools(frame), !dissolve_is_whole(range))
			    : NULL;
		if (p && p != used)
			set_frame(p, frame);
		if (p) {
			set_mesh(p, mesh, node, frame);
			draw_mesh(mesh, vertex_bytes, index_bytes);
			used = p;
		}
		vertex_bytes += mesh->vertex_count * sizeof(*mesh->vertices);
		index_bytes += mesh->triangle_count * sizeof(*mesh->triangles);
	}
	glDisable(GL_CULL_FACE);
}

/* ---- rays */

/* Whether a ray meets a ball. */
static bool is_near(const float from[3], const float direction[3], const float centre[3],
		    float radius)
{
	float to[3], along;

	vec_sub(to, centre, from);
	along = vec_dot(to, direction);
	return vec_dot(to, to) - along * along <= radius * radius;
}

/* The test of Moeller and Trumbore 1997, on both sides. A ray through a common edge must not slip
 * between its two triangles. */
static bool hits(const float corners[3][3], const float direction[3], float least_m,
		 float *distance_m)
{
	const float edge = 1e-5f;
	float ab[3], ac[3], p[3], q[3], to[3], det, u, v, at;

	vec_sub(ab, corners[1], corners[0]);
	vec_sub(ac, corners[2], corners[0]);
	vec_cross(p, direction, ac);
	det = vec_dot(ab, p);
	if (fabsf(det) < 1e-12f)
		return false;
	vec_scale(to, -1, corners[0]); /* corners are relative to the ray's origin */
	u = vec_dot(to, p) / det;
	vec_cross(q, to, ab);
	v = vec_dot(direction, q) / det;
	at = vec_dot(ac, q) / det;
	if (u < -edge || v < -edge || u + v > 1 + edge || at < least_m || at >= *distance_m)
		return false;
	*distance_m = at;
	return true;
}

static bool ray_mesh(const struct scenery_mesh *mesh, const float m[16], const float from_m[3],
		     const float direction[3], float least_m, float *distance_m)
{
	bool found = false;
	float model[16];

	lattice_matrix(model, mesh, m, from_m);
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		float corners[3][3];

		for (int k = 0; k < 3; k++) {
			const uint16_t *place = mesh->vertices[mesh->triangles[t][k]].place;

			for (int row = 0; row < 3; row++)
				corners[k][row] = model[row] * place[0] +
						  model[4 + row] * place[1] +
						  model[8 + row] * place[2] + model[12 + row];
		}
		found |= hits((const float(*)[3])corners, direction, least_m, distance_m);
	}
	return found;
}

uint32_t scenery_ray(const struct pose *pose, const float from_m[3], const float direction[3],
		     float least_m, float *distance_m)
{
	uint32_t found = SCENERY_NONE;

	for (uint32_t i = 0; i < pose->scenery->mesh_count; i++) {
		const struct scenery_mesh *mesh = &pose->scenery->meshes[i];
		const struct pose_node *node = &pose->nodes[mesh->node];
		float centre[3], radius = ball_of(mesh, node->matrix, centre);

		if (node->high - node->low > 0.5f && is_near(from_m, direction, centre, radius) &&
		    ray_mesh(mesh, node->matrix, from_m, direction, least_m, distance_m))
			found = mesh->node;
	}
	return found;
}
