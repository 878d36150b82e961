/* Draws the patches in their own colours into a small cube map, from the middle of all mirrors. One
 * place for all of them is right for what is far away, and near enough for a boss on a door. */
#include "render/scene/scene_around.h"

#include <string.h>

#include "base/log.h"
#include "geometry/vec.h"

/* The faces of a cube map as cameras see them: GL counts its rows from where t is 0, which is the
 * lower edge of what is drawn (OpenGL ES 2.0, table 3.21). */
static const struct {
	int8_t forward[3], up[3];
} faces[6] = {
	{ { 1, 0, 0 }, { 0, -1, 0 } }, { { -1, 0, 0 }, { 0, -1, 0 } },
	{ { 0, 1, 0 }, { 0, 0, 1 } },  { { 0, -1, 0 }, { 0, 0, -1 } },
	{ { 0, 0, 1 }, { 0, -1, 0 } }, { { 0, 0, -1 }, { 0, -1, 0 } },
};

static const float near_m = 0.02f;

/* Adds the vertices of a mesh to a sum of places. */
static void add_places(float sum[3], const struct scenery_mesh *mesh, const float m[16])
{
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		for (int row = 0; row < 3; row++) {
			sum[row] += m[12 + row];
			for (int k = 0; k < 3; k++)
				sum[row] += m[4 * k + row] *
					    (mesh->origin_m[k] +
					     mesh->step_m * mesh->vertices[v].place[k]);
		}
}

/* Sets out to the middle of the meshes that are mirrors. Returns false: there are none. */
static bool find_middle(float out[3], const struct scene_scenery *scenery)
{
	const struct scenery *content = &scenery->content;
	uint32_t count = 0;

	for (int k = 0; k < 3; k++)
		out[k] = 0;
	for (uint32_t i = 0; i < content->mesh_count; i++) {
		const struct scenery_mesh *mesh = &content->meshes[i];

		if (!(content->materials[mesh->material].mirror > 0))
			continue;
		add_places(out, mesh, scenery->pose.nodes[mesh->node].matrix);
		count += mesh->vertex_count;
	}
	if (count > 0)
		vec_scale(out, 1 / (float)count, out);
	return count > 0;
}

static void draw_face(struct scene *scene, int face, const float from_m[3])
{
	const struct root_page *root = &scene->root;
	struct camera camera = { .fov_deg = 90,
				 .near_m = near_m,
				 .far_m = 3 * vec_distance(root->box_min_m, root->box_max_m),
				 .width_px = SCENE_AROUND_PX,
				 .height_px = SCENE_AROUND_PX };
	struct surface_frame frame = { .root = root };
	const uint8_t *sky = root->background;
	struct view view;

	for (int k = 0; k < 3; k++) {
		camera.eye_m[k] = from_m[k];
		camera.target_m[k] = from_m[k] + faces[face].forward[k];
		camera.up[k] = faces[face].up[k];
	}
	view_from_camera(&view, &camera);
	frame.view = &view;
	glClearColor(sky[0] / 255.0f, sky[1] / 255.0f, sky[2] / 255.0f, 1);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	surface_begin(&scene->surface, &frame, 0);
	for (uint32_t i = 0; i < scene->around.patch_count; i++) {
		const uint32_t p = scene->around.patches[i];
		const struct hierarchy_patch *patch = &scene->hierarchy.patches[p];

		if (!view_sees_sphere(&view, patch->centre_m, patch->radius_m))
			continue;
		geometry_bind(&scene->geometry, p);
		geometry_draw(&scene->geometry, 0,
			      scene->geometry.patches[p].content.mesh.triangle_count);
	}
	glCopyTexSubImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + (GLenum)face, 0, 0, 0, 0, 0,
			    SCENE_AROUND_PX, SCENE_AROUND_PX);
}

/* Draws the next face into the cube map that is being made. */
static int draw_next(struct scene *scene, const float from_m[3])
{
	static const struct appearance_cube empty = { .side_px = SCENE_AROUND_PX };
	const struct cut_options options = { .error_px = 1,
					     .triangle_budget = scene->options.triangle_budget };
	struct scene_around *around = &scene->scenery.around;
	struct gl_target target;
	int rc;

	if (!around->coming) {
		rc = scenery_cube_create(&around->coming, &empty);
		if (rc < 0)
			return rc;
	}
	rc = gl_target_create(&target, SCENE_AROUND_PX, SCENE_AROUND_PX);
	if (rc < 0)
		return rc;
	glActiveTexture(GL_TEXTURE0);
	glBindTexture(GL_TEXTURE_CUBE_MAP, around->coming);
	cut_update_around(&scene->around, from_m, (float)SCENE_AROUND_PX / 2,
			  scene->geometry.loaded, &options);
	glDisable(GL_BLEND);
	glDisable(GL_CULL_FACE);
	glEnable(GL_DEPTH_TEST);
	glDepthMask(GL_TRUE);
	glDepthFunc(GL_LESS);
	draw_face(scene, around->face, from_m);
	rc = gl_check("drawing what mirrors show");
	gl_target_destroy(&target);
	return rc;
}

bool scene_around_waits(const struct scene *scene)
{
	const struct scene_around *around = &scene->scenery.around;
	float from_m[3];

	return around->face > 0 ||
	       (around->cut != scene->cut_signature && find_middle(from_m, &scene->scenery));
}

void scene_update_around(struct scene *scene, bool moved)
{
	struct scene_scenery *scenery = &scene->scenery;
	struct scene_around *around = &scenery->around;
	float from_m[3] = { 0 };

	/* Of a face of depths that is half drawn, the list of patches is still needed. */
	if ((moved && (scenery->is_ready || scenery->picture.around)) ||
	    scene->depth_task.is_begun || !scene_around_waits(scene))
		return;
	if (around->face == 0)
		around->cut = scene->cut_signature;
	if (!find_middle(from_m, scenery) || draw_next(scene, from_m) < 0) {
		scene_drop_around(scene);
		around->cut = scene->cut_signature; /* not again before it changes */
		return;
	}
	around->face++;
	if (around->face < 6)
		return;
	scenery_picture_surround(&scenery->picture, around->coming);
	around->coming = 0;
	around->face = 0;
}

void scene_drop_around(struct scene *scene)
{
	struct scene_around *around = &scene->scenery.around;

	if (around->coming)
		glDeleteTextures(1, &around->coming);
	*around = (struct scene_around){ 0 };
}
