/* What an eye sees of a surface whose pieces count how often they are drawn. */
#include "pipeline/samples/sight.h"

#include <math.h>
#include <string.h>

#include "geometry/camera.h"
#include "pipeline/samples/face_renderer.h"
#include "tests/check.h"

/* Boxes along the x axis, a metre wide and three apart: 0 around the origin, then away from it. */
enum { BOXES = 3 };

struct boxes {
	struct model model; /* first */
	struct model_piece pieces[BOXES];
	struct model_vertex vertices[3];
	uint32_t loads;
};

static const uint16_t corners[3] = { 0, 1, 2 };

static uint32_t choose_all(const struct model *model, const float eye_m[3], float detail_rad,
			   uint32_t *pieces)
{
	(void)eye_m;
	(void)detail_rad;
	for (uint32_t i = 0; i < model->piece_count; i++)
		pieces[i] = i;
	return model->piece_count;
}

/* A triangle across the box. */
static int load(struct model *model, uint32_t piece, struct model_mesh *out)
{
	struct boxes *boxes = (struct boxes *)model;
	const struct model_piece *box = &boxes->pieces[piece];

	memset(boxes->vertices, 0, sizeof(boxes->vertices));
	for (int i = 0; i < 3; i++) {
		struct model_vertex *vertex = &boxes->vertices[i];

		vertex->position_m[0] = (box->low_m[0] + box->high_m[0]) / 2;
		vertex->position_m[1] = i == 1 ? box->high_m[1] : box->low_m[1];
		vertex->position_m[2] = i == 2 ? box->high_m[2] : box->low_m[2];
		vertex->normal[0] = 127;
		memset(vertex->colour, 200, sizeof(vertex->colour));
	}
	boxes->loads++;
	*out = (struct model_mesh){
		.vertex_count = 3, .index_count = 3, .vertices = boxes->vertices, .indices = corners
	};
	return 0;
}

static void keep(struct model *model)
{
	(void)model;
}

static void set_boxes(struct boxes *boxes)
{
	static const struct model_methods methods = { choose_all, load, keep };

	*boxes = (struct boxes){ .model = { .methods = &methods, .piece_count = BOXES } };
	boxes->model.pieces = boxes->pieces;
	for (int i = 0; i < BOXES; i++) {
		const float low[3] = { 3.0f * (float)i - 0.5f, -0.5f, -0.5f };

		for (int k = 0; k < 3; k++) {
			boxes->pieces[i].low_m[k] = low[k];
			boxes->pieces[i].high_m[k] = low[k] + 1;
		}
	}
	memcpy(boxes->model.low_m, boxes->pieces[0].low_m, sizeof(boxes->model.low_m));
	memcpy(boxes->model.high_m, boxes->pieces[BOXES - 1].high_m, sizeof(boxes->model.high_m));
}

/* Sees it from an eye on the x axis, looking along x with 90 degrees. */
static uint32_t look(struct sight *sight, float x, float ahead, const uint32_t **visible)
{
	struct camera camera = { .width_px = 64, .height_px = 64, .fov_deg = 90 };
	uint32_t count = 0;
	float matrix[16], forward[3] = { ahead, 0, 0 };

	camera.eye_m[0] = x;
	camera.target_m[0] = x + ahead;
	camera.up[2] = 1;
	sight_look(sight, camera.eye_m, 0);
	if (!sight_range(sight, camera.eye_m, forward, &camera.near_m, &camera.far_m))
		return 0;
	camera_matrix(&camera, matrix);
	*visible = sight_visible(sight, matrix, camera.eye_m, &count);
	return count;
}

static void sees_the_nearest_first(void **state)
{
	struct boxes boxes;
	struct sight *sight;
	const uint32_t *visible;

	(void)state;
	set_boxes(&boxes);
	CHECK(sight_create(&sight, &boxes.model) == 0);
	CHECK(look(sight, -5, 1, &visible) == 3);
	CHECK(visible[0] == 0 && visible[1] == 1 && visible[2] == 2);
	CHECK(look(sight, 11, -1, &visible) == 3);
	CHECK(visible[0] == 2 && visible[1] == 1 && visible[2] == 0);
	sight_destroy(sight);
}

static void leaves_out_what_is_behind_the_eye(void **state)
{
	struct boxes boxes;
	struct sight *sight;
	const uint32_t *visible;

	(void)state;
	set_boxes(&boxes);
	CHECK(sight_create(&sight, &boxes.model) == 0);
	CHECK(look(sight, 1.5f, 1, &visible) == 2);
	CHECK(visible[0] == 1 && visible[1] == 2);
	CHECK(look(sight, 1.5f, -1, &visible) == 1 && visible[0] == 0);
	CHECK(look(sight, 3, 1, &visible) == 2); /* from within the second box */
	CHECK(visible[0] == 1 && visible[1] == 2);
	CHECK(look(sight, 11, 1, &visible) == 0);
	sight_destroy(sight);
}

static void planes_enclose_what_is_in_front(void **state)
{
	const float eye_m[3] = { 1.5f, 0, 0 }, forward[3] = { 1, 0, 0 }, back[3] = { -1, 0, 0 };
	const float beyond_m[3] = { 11, 0, 0 }, within_m[3] = { 0, 0, 0 };
	float near_m = 0, far_m = 0;
	struct boxes boxes;
	struct sight *sight;

	(void)state;
	set_boxes(&boxes);
	CHECK(sight_create(&sight, &boxes.model) == 0);
	sight_look(sight, eye_m, 0);
	CHECK(sight_range(sight, eye_m, forward, &near_m, &far_m));
	CHECK(near_m <= 1 && near_m > 0.99f && far_m >= 5 && far_m < 5.1f);
	CHECK(sight_range(sight, eye_m, back, &near_m, &far_m));
	CHECK(near_m <= 1 && far_m >= 2 && far_m < 2.1f);
	/* A box around the eye: as near as a depth buffer allows. */
	CHECK(sight_range(sight, within_m, back, &near_m, &far_m));
	CHECK(near_m > 0 && near_m <= 0.02f && far_m >= 0.5f);
	CHECK(!sight_range(sight, beyond_m, forward, &near_m, &far_m));
	sight_destroy(sight);
}

/* face: of format/cube.h. Returns how many pieces were loaded. */
static uint32_t take(struct boxes *boxes, const float point_m[3], int face, struct shot *shot)
{
	const struct face_renderer_options options = {
		.model = &boxes->model, .level_count = 1, .quality = 80, .effort = TILE_QUICK
	};
	struct face_renderer *renderer;

	boxes->loads = 0;
	CHECK(face_renderer_create(&renderer, &options) == 0);
	sight_look(face_renderer_sight(renderer), point_m, 0);
	CHECK(face_renderer_take(renderer, shot, point_m, face, NULL) == 0);
	face_renderer_destroy(renderer);
	return boxes->loads;
}

static void a_point_without_a_view_is_not_drawn(void **state)
{
	static const float beyond_m[3] = { 11, 0, 0 }, above_m[3] = { 3, 0, 30 };
	struct boxes boxes;
	struct shot shot;

	(void)state;
	set_boxes(&boxes);
	shot_init(&shot);
	for (int face = 0; face < CUBE_FACES; face++) {
		const float *forward = cube_axes[face].forward;
		uint32_t loads = take(&boxes, beyond_m, face, &shot);

		CHECK((loads > 0) == (forward[0] < -0.5f));
		CHECK((shot.tile_count > 0) == (loads > 0) && (shot.coverage != 0) == (loads > 0));
		/* From far above, the boxes are below the frustums of the faces to the sides. */
		loads = take(&boxes, above_m, face, &shot);
		CHECK((loads > 0) == (forward[2] < -0.5f));
	}
	shot_finish(&shot);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sees_the_nearest_first),
		cmocka_unit_test(leaves_out_what_is_behind_the_eye),
		cmocka_unit_test(planes_enclose_what_is_in_front),
		cmocka_unit_test(a_point_without_a_view_is_not_drawn),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
