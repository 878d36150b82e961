/* Finds the vantage point that the eye is at, and fades its images in and out. */
#include "render/scene/scene_backdrop.h"

#include <math.h>

#include "base/clock.h"
#include "geometry/vec.h"
#include "render/plan/plan_quality.h"
#include "render/scene/scene_scenery.h"
#include "render/scene/scene_stream.h"

enum { LOOKS_ACROSS = 32, LOOKS_HIGH = BACKDROP_LOOKS / LOOKS_ACROSS, AWAIT_MS = 5000 };

/* The eye is at a point if what is as far away as the middle of the model moves by less than this
 * many pixels from one to the other. */
static const float at_px = 0.5f;

static const float fade_ms = 300;

/* Quality of the coarse mesh's own colours: its vertices are some twenty pixels apart. */
static const float coarse_quality = 0.01f;

/* Returns whether an image could be shown as it is: nothing is cut away, lit or veiled. */
static bool is_plain(const struct scene *scene)
{
	return scene->options.mode == SCENE_LUMIGRAPH && gl_has_highp() && !scene->tools.rake.on &&
	       !view_is_cut(&scene->view) && scene_fog(scene).share <= 0;
}

/* Returns the vantage point that the eye is at, -1: none. */
static int point_of(const struct scene *scene)
{
	const struct samples_page *grid = &scene->repository.grid;
	const float *low = scene->root.box_min_m, *high = scene->root.box_max_m;
	float centre[3];
	if (!scene->repository.ready || !scene->has_view)
		return -1;
	vec_mix(centre, low, high, 0.5f);
	for (uint32_t i = 0; i < grid->vantage_count; i++) {
		const float *at = grid->vantage_m[i];
		const float away = vec_distance(at, centre);
		if (vec_distance(at, scene->view.eye_m) * scene->view.focal_px < at_px * away)
			return (int)(scene->repository.point_count - grid->vantage_count + i);
	}
	return -1;
}

/* Returns whether finer patches are on their way. */
static bool lacks_mesh(const struct scene *scene)
{
	return !scene_first_cut_is_here(scene) || scene->groups_are_wanted ||
	       scene->dissolve.moving;
}

static void look_around(struct scene *scene)
{
	const struct view *view = &scene->view;
	for (uint32_t i = 0; i < BACKDROP_LOOKS; i++) {
		const float x = ((float)(i % LOOKS_ACROSS) + 0.5f) / LOOKS_ACROSS * 2 - 1;
		const float y = ((float)(i / LOOKS_ACROSS) + 0.5f) / LOOKS_HIGH * 2 - 1;
		struct backdrop_look *look = &scene->backdrop.looks[i];
		float way[3], depth;
		vec_copy(way, view->forward);
		vec_add_scaled(way, way, x * view->tan_x, view->right);
		vec_add_scaled(way, way, y * view->tan_y, view->up);
		look->face = (face_key)scene->backdrop.point * CUBE_FACES +
			     (face_key)cube_project(way, &look->u, &look->v);
		vec_normalise(way);
		depth = vec_most(fabsf(way[0]), vec_most(fabsf(way[1]), fabsf(way[2])));
		look->level = (uint8_t)plan_level(view->focal_px * depth,
						  repository_levels(&scene->repository));
	}
	scene->backdrop.look_count = BACKDROP_LOOKS;
}

/* As plan_quality, without parallax. */
static float quality_of(const struct scene *scene, int level)
{
	float blur, penalty;
	if (level < 0)
		return coarse_quality;
	blur = vec_most(scene->view.focal_px / plan_level_half_px((uint32_t)level) - 1, 0);
	penalty = 1 + plan_tuning.blur * blur;
	return 1 / (penalty * penalty);
}

static bool has_tile(const struct scene *scene, const struct backdrop_look *look, uint32_t level)
{
	const float count = (float)(1u << level);
	const struct tile_name name = { .face = look->face,
					.level = (uint8_t)level,
					.row = (uint8_t)((1 - look->v) / 2 * count),
					.column = (uint8_t)((look->u + 1) / 2 * count) };
	return repository_tile(&scene->repository, name, NULL) &&
	       !tiles_is_declined(&scene->tiles, name);
}

float scene_backdrop_worth(const struct scene *scene, int level, int before)
{
	return plan_worth(quality_of(scene, level), quality_of(scene, before));
}

bool scene_awaits_backdrop(const struct scene *scene)
{
	const struct scene_backdrop *backdrop = &scene->backdrop;
	if (scene->options.mode != SCENE_LUMIGRAPH || clock_now_ms() - scene->opened_ms > AWAIT_MS)
		return false;
	if (!scene->repository.ready)
		return true;
	for (uint32_t i = 0; i < backdrop->look_count; i++) {
		const struct backdrop_look *look = &backdrop->looks[i];
		const uint32_t level = look->level > 0 ? look->level - 1u : 0;
		const enum repository_state state =
			repository_face(&scene->repository, look->face, NULL, NULL);
		if (state == REPOSITORY_EMPTY ||
		    tiles_level_at(&scene->tiles, look->face, look->u, look->v) >= (int)level)
			continue;
		if (state != REPOSITORY_READY || has_tile(scene, look, level))
			return true;
	}
	return false;
}

static void touch(struct scene *scene)
{
	for (uint32_t i = 0; i < scene->backdrop.look_count; i++) {
		const struct backdrop_look *look = &scene->backdrop.looks[i];
		tiles_touch(&scene->tiles, look->face, look->u, look->v, look->u, look->v);
	}
}

void scene_step_backdrop(struct scene *scene, float passed_ms)
{
	struct scene_backdrop *backdrop = &scene->backdrop;
	const int point = is_plain(scene) ? point_of(scene) : -1;
	const float step = passed_ms / fade_ms;
	float left;
	if (point >= 0)
		backdrop->point = point;
	backdrop->look_count = 0;
	if (point >= 0 && lacks_mesh(scene))
		look_around(scene);
	left = (backdrop->look_count > 0 ? 1 : 0) - backdrop->share;
	backdrop->share += vec_least(vec_most(left, -step), step);
	backdrop->moves =
		left != 0 || (backdrop->share > 0 && backdrop->version != scene->tiles.version);
	backdrop->version = scene->tiles.version;
	touch(scene);
}

void scene_draw_backdrop(struct scene *scene, const struct view *view)
{
	if (scene->backdrop.share > 0)
		backdrop_draw(&scene->backdrop.picture, &scene->tiles, view, scene->root.background,
			      (uint32_t)scene->backdrop.point, scene->backdrop.share);
}
