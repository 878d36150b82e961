/* One buffer of vertices and one of indices for all meshes; a matrix for each node. */
#include "render/scenery/scenery_picture.h"

#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/compiler.h"
#include "geometry/vec.h"

int scenery_picture_load(struct scenery_picture *picture, const struct scenery *scenery)
{
	struct scenery_offset end = { 0 };
	int rc;

	scenery_picture_drop(picture);
	picture->offsets = calloc((size_t)scenery->mesh_count + 1, sizeof(*picture->offsets));
	if (!picture->offsets)
		return -ENOMEM;
	for (uint32_t i = 0; i < scenery->mesh_count; i++) {
		picture->offsets[i] = end;
		end.vertex_bytes += scenery->meshes[i].vertex_count * sizeof(struct scenery_vertex);
		end.index_bytes += scenery->meshes[i].triangle_count * 3 * sizeof(uint16_t);
	}
	glGenBuffers(1, &picture->vertices);
	glGenBuffers(1, &picture->indices);
	glGenBuffers(1, &picture->ordered);
	glBindBuffer(GL_ARRAY_BUFFER, picture->vertices);
	glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)end.vertex_bytes, NULL, GL_STATIC_DRAW);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, picture->indices);
	glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)end.index_bytes, NULL, GL_STATIC_DRAW);
	for (uint32_t i = 0; i < scenery->mesh_count; i++) {
		const struct scenery_mesh *mesh = &scenery->meshes[i];
		const struct scenery_offset *at = &picture->offsets[i];

		glBufferSubData(GL_ARRAY_BUFFER, (GLintptr)at->vertex_bytes,
				(GLsizeiptr)(mesh->vertex_count * sizeof(*mesh->vertices)),
				mesh->vertices);
		glBufferSubData(GL_ELEMENT_ARRAY_BUFFER, (GLintptr)at->index_bytes,
				(GLsizeiptr)(mesh->triangle_count * sizeof(*mesh->triangles)),
				mesh->triangles);
	}
	rc = gl_check("uploading scenery");
	return rc < 0 ? rc : scenery_textures_load(&picture->textures, scenery);
}

int scenery_cube_create(GLuint *out, const struct appearance_cube *faces)
{
	glGenTextures(1, out);
	glActiveTexture(GL_TEXTURE0);
	glBindTexture(GL_TEXTURE_CUBE_MAP, *out);
	glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	for (GLenum i = 0; i < 6; i++)
		glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + i, 0, GL_RGBA, faces->side_px,
			     faces->side_px, 0, GL_RGBA, GL_UNSIGNED_BYTE, faces->faces[i]);
	return gl_check("making what mirrors show");
}

void scenery_picture_surround(struct scenery_picture *picture, GLuint cube)
{
	if (picture->around)
		glDeleteTextures(1, &picture->around);
	picture->around = cube;
}

void scenery_picture_drop(struct scenery_picture *picture)
{
	GLuint *const buffers[] = { &picture->vertices, &picture->indices, &picture->ordered };

	for (size_t i = 0; i < ARRAY_COUNT(buffers); i++) {
		if (*buffers[i])
			glDeleteBuffers(1, buffers[i]);
		*buffers[i] = 0;
	}
	scenery_picture_surround(picture, 0);
	scenery_textures_finish(&picture->textures);
	free(picture->offsets);
	free(picture->triangles);
	picture->offsets = NULL;
	picture->triangles = NULL;
	scenery_order_finish(&picture->order);
}

void scenery_picture_finish(struct scenery_picture *picture)
{
	scenery_picture_drop(picture);
	scenery_programs_finish(&picture->programs);
	*picture = (struct scenery_picture){ 0 };
}

void scenery_picture_bend(struct scenery_picture *picture, const struct pose *pose)
{
	for (uint32_t i = 0; i < pose->scenery->mesh_count; i++) {
		const struct bend_mesh *bent = &pose->bend.meshes[i];
		struct scenery_offset *at = &picture->offsets[i];

		if (at->bend_version == bent->version)
			continue;
		at->bend_version = bent->version;
		glBindBuffer(GL_ARRAY_BUFFER, picture->vertices);
		glBufferSubData(GL_ARRAY_BUFFER, (GLintptr)at->vertex_bytes,
				(GLsizeiptr)(pose->scenery->meshes[i].vertex_count *
					     sizeof(*bent->vertices)),
				bent->vertices);
	}
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

	glUseProgram(p->program);
	glUniformMatrix4fv(p->clip, 1, GL_FALSE, frame->view->clip);
	for (size_t i = 0; i < ARRAY_COUNT(p->sun); i++)
		glUniform4f(p->sun[i], sun[0], sun[1], sun[2], frame->root->lit ? 1 : 0);
	glUniform1f(p->pixel, 1 / frame->view->focal_px);
	surface_set_tools(&p->tools, frame);
}

static void set_colour(GLint at, const uint8_t rgb[3], float fourth)
{
	glUniform4f(at, (float)rgb[0] / 255, (float)rgb[1] / 255, (float)rgb[2] / 255, fourth);
}

static void set_material(const struct scenery_program *p, const struct scenery_material *material)
{
	const uint8_t *rgb = material->emissive;

	glUniform1f(p->opacity, material->opacity);
	glUniform1f(p->relief, material->relief_m);
	glUniform1f(p->mirror, material->mirror);
	set_colour(p->specular, material->specular, material->shininess);
	glUniform3f(p->emissive, (float)rgb[0] / 255, (float)rgb[1] / 255, (float)rgb[2] / 255);
}

/* Sets how the substance lies in the lattice of a mesh. */
static void set_solid(const struct scenery_program *p, const struct scenery_material *material,
		      const struct scenery_mesh *mesh, const float matrix[16])
{
	struct appearance_solid solid;
	float place[16] = { 0 };

	if (p->solid < 0)
		return;
	appearance_solid_init(&solid, material, matrix);
	for (int row = 0; row < 3; row++)
		for (int k = 0; k < 3; k++) {
			place[4 * k + row] = solid.place[3 * k + row] * mesh->step_m;
			place[12 + row] += solid.place[3 * k + row] * mesh->origin_m[k];
		}
	place[15] = 1;
	glUniformMatrix4fv(p->solid, 1, GL_FALSE, place);
	glUniformMatrix3fv(p->slope, 1, GL_FALSE, solid.slope);
	glUniform3fv(p->tint, 1, solid.tint);
}

static void set_mesh(const struct scenery_program *p, const struct scenery_mesh *mesh,
		     const struct pose_node *node, const struct surface_frame *frame,
		     bool has_two_sides)
{
	const float *m = node->matrix;
	float model[16], turned[9];

	lattice_matrix(model, mesh, m, frame->view->eye_m);
	matrix_cofactors(turned, m);
	glUniformMatrix4fv(p->model, 1, GL_FALSE, model);
	glUniform3fv(p->normal, 3, turned);
	glUniform1f(p->sides, has_two_sides);
	if (p->range >= 0)
		glUniform2f(p->range, node->low, node->high);
	if (has_two_sides || p->tools.cut >= 0)
		glDisable(GL_CULL_FACE);
	else
		glEnable(GL_CULL_FACE);
}

/* What stays the same while meshes are drawn. */
struct drawing {
	struct scenery_picture *picture;
	const struct pose *pose;
	const struct surface_frame *frame;
	GLuint used; /* program; 0: none yet */
};

/* Whether a picture is there: 1 + its index. */
static bool has_texture(const struct drawing *drawing, uint16_t texture)
{
	const struct scenery_textures *textures = &drawing->picture->textures;

	return texture > 0 && texture <= textures->count && textures->names[texture - 1];
}

static unsigned features_of(const struct drawing *drawing, uint32_t mesh,
			    struct dissolve_range range)
{
	const struct scenery_material material = pose_material(drawing->pose, mesh);
	const uint8_t *s = material.specular, *e = material.emissive;
	const bool is_glossy = s[0] || s[1] || s[2] || e[0] || e[1] || e[2];

	return surface_tools(drawing->frame) |
	       (dissolve_is_whole(range) ? 0u : (unsigned)SCENERY_DISSOLVES) |
	       (material.by_pixel ? (unsigned)SCENERY_BY_PIXEL : 0u) |
	       (is_glossy ? (unsigned)SCENERY_GLOSSY : 0u) |
	       (material.relief_m > 0 ? (unsigned)SCENERY_RELIEF : 0u) |
	       (material.mirror > 0 && drawing->picture->around ? (unsigned)SCENERY_MIRROR : 0u) |
	       (has_texture(drawing, material.texture) ? (unsigned)SCENERY_TEXTURE : 0u) |
	       (has_texture(drawing, material.normals) ? (unsigned)SCENERY_NORMALS : 0u) |
	       (unsigned)SCENERY_SUBSTANCE * material.substance;
}

static bool is_seen(const struct drawing *drawing, uint32_t mesh)
{
	const struct scenery_mesh *of = &drawing->pose->scenery->meshes[mesh];
	const struct pose_node *node = &drawing->pose->nodes[of->node];
	const struct dissolve_range range = { node->low, node->high };
	float centre[3], radius;

	if (!dissolve_draws(range))
		return false;
	radius = ball_of(of, node->matrix, centre);
	return view_sees_sphere(drawing->frame->view, centre, radius);
}

/* Sets up a program and the attributes of a mesh. */
static void begin_mesh_with(struct drawing *drawing, uint32_t mesh, const struct scenery_program *p)
{
	const struct scenery *scenery = drawing->pose->scenery;
	const struct scenery_mesh *of = &scenery->meshes[mesh];
	const struct scenery_material material = pose_material(drawing->pose, mesh);
	const struct pose_node *node = &drawing->pose->nodes[of->node];
	const size_t first = drawing->picture->offsets[mesh].vertex_bytes;
	const GLsizei stride = sizeof(struct scenery_vertex);

	if (p->program != drawing->used)
		set_frame(p, drawing->frame);
	drawing->used = p->program;
	set_material(p, &material);
	set_solid(p, &material, of, node->matrix);
	set_mesh(p, of, node, drawing->frame, material.has_two_sides);
	glVertexAttribPointer(0, 3, GL_UNSIGNED_SHORT, GL_FALSE, stride,
			      (void *)(first + offsetof(struct scenery_vertex, place)));
	glVertexAttribPointer(1, 2, GL_BYTE, GL_FALSE, stride,
			      (void *)(first + offsetof(struct scenery_vertex, normal)));
	glVertexAttribPointer(2, 3, GL_UNSIGNED_BYTE, GL_TRUE, stride,
			      (void *)(first + offsetof(struct scenery_vertex, rgb)));
	if (p->uv < 0) {
		glDisableVertexAttribArray(3);
		return;
	}
	glUniform4f(p->uv, of->uv_origin[0], of->uv_origin[1], of->uv_step[0], of->uv_step[1]);
	scenery_textures_bind(&drawing->picture->textures, scenery, mesh);
	glBindBuffer(GL_ARRAY_BUFFER, drawing->picture->vertices);
}

/* The same with the program of its material. Returns false where there is none to draw with. */
static bool begin_mesh(struct drawing *drawing, uint32_t mesh)
{
	const struct scenery_mesh *of = &drawing->pose->scenery->meshes[mesh];
	const struct pose_node *node = &drawing->pose->nodes[of->node];
	const struct dissolve_range range = { node->low, node->high };
	const struct scenery_program *p = scenery_programs_get(&drawing->picture->programs,
							       features_of(drawing, mesh, range));

	if (p)
		begin_mesh_with(drawing, mesh, p);
	return p;
}

static void draw_triangles(size_t index_bytes, uint32_t count)
{
	glDrawElements(GL_TRIANGLES, (GLsizei)(3 * count), GL_UNSIGNED_SHORT, (void *)index_bytes);
}

static bool is_solid(const struct scenery *scenery, uint32_t mesh)
{
	return scenery->materials[scenery->meshes[mesh].material].opacity >= 1;
}

/* Lists the transparent triangles that are seen, in order, and uploads their corners. */
static int prepare_ordered(struct drawing *drawing)
{
	struct scenery_picture *picture = drawing->picture;
	const struct scenery *scenery = drawing->pose->scenery;
	struct scenery_order *order = &picture->order;
	int rc = 0;

	order->count = 0;
	for (uint32_t i = 0; i < scenery->mesh_count && rc == 0; i++)
		if (!is_solid(scenery, i) && is_seen(drawing, i))
			rc = scenery_order_add(order, drawing->pose, i,
					       drawing->frame->view->eye_m);
	if (rc < 0 || order->count == 0)
		return rc;
	scenery_order_sort(order);
	if (!picture->triangles)
		picture->triangles =
			malloc(SCENERY_CLEAR_TRIANGLES_MAX * sizeof(*picture->triangles));
	if (!picture->triangles)
		return -ENOMEM;
	for (uint32_t i = 0; i < order->count; i++)
		memcpy(picture->triangles[i],
		       scenery->meshes[order->triangles[i].mesh]
			       .triangles[order->triangles[i].triangle],
		       sizeof(*picture->triangles));
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, picture->ordered);
	glBufferData(GL_ELEMENT_ARRAY_BUFFER,
		     (GLsizeiptr)(order->count * sizeof(*picture->triangles)), picture->triangles,
		     GL_STREAM_DRAW);
	return 0;
}

/* What is transparent is blended over the picture. Alpha, which says where the model is, only
 * grows. */
static void begin_blending(void)
{
	glEnable(GL_BLEND);
	glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
	glDepthMask(GL_FALSE);
}

static void end_blending(void)
{
	glDepthMask(GL_TRUE);
	glDisable(GL_BLEND);
}

static void draw_ordered(struct drawing *drawing)
{
	const struct scenery_order *order = &drawing->picture->order;
	uint32_t after;

	if (prepare_ordered(drawing) < 0 || order->count == 0)
		return;
	begin_blending();
	for (uint32_t i = 0; i < order->count; i = after) {
		const uint32_t mesh = order->triangles[i].mesh;

		for (after = i + 1; after < order->count && order->triangles[after].mesh == mesh;)
			after++;
		if (begin_mesh(drawing, mesh))
			draw_triangles(i * sizeof(*drawing->picture->triangles), after - i);
	}
	end_blending();
}

static void begin(const struct drawing *drawing)
{
	struct scenery_picture *picture = drawing->picture;

	scenery_programs_begin(&picture->programs, drawing->frame->root->cut);
	glActiveTexture(GL_TEXTURE0);
	glBindTexture(GL_TEXTURE_CUBE_MAP, picture->around);
	glBindBuffer(GL_ARRAY_BUFFER, picture->vertices);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, picture->indices);
	for (GLuint i = 0; i < 3; i++)
		glEnableVertexAttribArray(i);
}

bool scenery_picture_draw(struct scenery_picture *picture, const struct pose *pose,
			  const struct surface_frame *frame)
{
	struct drawing drawing = { .picture = picture, .pose = pose, .frame = frame };
	const struct scenery *scenery = pose->scenery;

	begin(&drawing);
	for (uint32_t i = 0; i < scenery->mesh_count; i++)
		if (is_solid(scenery, i) && is_seen(&drawing, i) && begin_mesh(&drawing, i))
			draw_triangles(picture->offsets[i].index_bytes,
				       scenery->meshes[i].triangle_count);
	draw_ordered(&drawing);
	glDisable(GL_CULL_FACE);
	glDisableVertexAttribArray(3);
	return !picture->programs.lacks;
}

/* Drivers leave a part of the work to the first triangle that is drawn with a program. This one is
 * drawn in no pixel. */
static void draw_unseen(struct drawing *drawing, uint32_t mesh, const struct scenery_program *p)
{
	const bool blends = !is_solid(drawing->pose->scenery, mesh);

	if (blends)
		begin_blending();
	begin_mesh_with(drawing, mesh, p);
	glUniform2f(p->range, 2, 2);
	draw_triangles(drawing->picture->offsets[mesh].index_bytes, 1);
	glDisableVertexAttribArray(3);
	if (blends)
		end_blending();
	glDisable(GL_CULL_FACE);
}

bool scenery_picture_prepare(struct scenery_picture *picture, const struct pose *pose,
			     const struct surface_frame *frame)
{
	struct drawing drawing = { .picture = picture, .pose = pose, .frame = frame };
	const struct scenery *scenery = pose->scenery;
	const struct dissolve_range part = { 0, 0.5f };

	begin(&drawing);
	for (uint32_t i = 0; i < scenery->mesh_count && !picture->programs.is_built; i++) {
		const struct scenery_program *p =
			scenery_programs_make(&picture->programs, features_of(&drawing, i, part));

		if (p)
			draw_unseen(&drawing, i, p);
	}
	return !picture->programs.is_built;
}

/* ---- depths */

void scenery_picture_depths(struct scenery_picture *picture, const struct pose *pose,
			    struct visibility *visibility)
{
	const struct surface_frame frame = { .view = &visibility->view };
	const struct drawing drawing = { .picture = picture, .pose = pose, .frame = &frame };
	const struct scenery *scenery = pose->scenery;

	glBindBuffer(GL_ARRAY_BUFFER, picture->vertices);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, picture->indices);
	for (uint32_t i = 0; i < scenery->mesh_count; i++) {
		const struct scenery_mesh *mesh = &scenery->meshes[i];
		const struct pose_node *node = &pose->nodes[mesh->node];
		const struct scenery_offset *at = &picture->offsets[i];
		float model[16];

		if (!is_solid(scenery, i) || !is_seen(&drawing, i) ||
		    !dissolve_is_whole((struct dissolve_range){ node->low, node->high }))
			continue;
		lattice_matrix(model, mesh, node->matrix, visibility->view.eye_m);
		if (!visibility_beside(visibility, model))
			return;
		glVertexAttribPointer(
			0, 3, GL_UNSIGNED_SHORT, GL_FALSE, sizeof(struct scenery_vertex),
			(void *)(at->vertex_bytes + offsetof(struct scenery_vertex, place)));
		draw_triangles(at->index_bytes, mesh->triangle_count);
	}
}

float scenery_picture_far_m(const struct pose *pose, const float eye_m[3])
{
	float far_m = 0;

	for (uint32_t i = 0; i < pose->scenery->mesh_count; i++) {
		const struct scenery_mesh *mesh = &pose->scenery->meshes[i];
		const struct pose_node *node = &pose->nodes[mesh->node];
		float centre[3], radius;

		if (!dissolve_draws((struct dissolve_range){ node->low, node->high }))
			continue;
		radius = ball_of(mesh, node->matrix, centre);
		far_m = vec_most(far_m, vec_distance(centre, eye_m) + radius);
	}
	return far_m;
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

static bool ray_mesh(const struct scenery_mesh *mesh, const struct scenery_vertex *vertices,
		     const float m[16], const float from_m[3], const float direction[3],
		     float least_m, float *distance_m)
{
	bool found = false;
	float model[16];

	lattice_matrix(model, mesh, m, from_m);
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		float corners[3][3];

		for (int k = 0; k < 3; k++) {
			const uint16_t *place = vertices[mesh->triangles[t][k]].place;

			matrix_place(corners[k], model,
				     (const float[3]){ place[0], place[1], place[2] });
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
		    ray_mesh(mesh, bend_vertices(&pose->bend, pose->scenery, i), node->matrix,
			     from_m, direction, least_m, distance_m))
			found = mesh->node;
	}
	return found;
}
