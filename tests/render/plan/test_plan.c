#include <math.h>
#include <string.h>

#include "geometry/vec.h"
#include "render/plan/plan.h"
#include "render/plan/plan_quality.h"
#include "tests/check.h"

static const struct plan_eye eye = { { 0, -10, 0 }, 800, 1.2f };
static const float wall[3] = { 0, 0, 0 }, towards[3] = { 0, -1, 0 };

static float quality(float x, float y, float half_px, float error_m)
{
	const float sample[3] = { x, y, 0 };
	return plan_quality(&eye, wall, towards, sample, half_px, error_m);
}

static void a_sample_at_the_eye_as_sharp_as_the_screen_is_perfect(void **state)
{
	(void)state;
	CHECK(fabsf(quality(0, -10, 800, 0.1f) - 1) < 1e-4f);
}

static void what_sees_the_back_is_worth_nothing(void **state)
{
	(void)state;
	CHECK(quality(0, 5, 4000, 0) == 0);
	CHECK(quality(-10, 0, 4000, 0) == 0); /* along the wall */
}

static void quality_falls_with_blur_angle_and_parallax(void **state)
{
	(void)state;
	float last = 1.1f;
	for (float half_px = 800; half_px > 50; half_px /= 2) {
		CHECK(quality(0, -10, half_px, 0) < last);
		last = quality(0, -10, half_px, 0);
	}
	last = 1.1f;
	for (float x = 0; x < 20; x += 2) {
		CHECK(quality(x, -10, 1e5f, 0) < last);
		CHECK(quality(x, -10, 1e5f, 0.1f) <= quality(x, -10, 1e5f, 0));
		last = quality(x, -10, 1e5f, 0);
	}
	CHECK(quality(6, -10, 1e5f, 0.1f) < quality(6, -10, 1e5f, 0.01f));
	/* Nearer, the same image is sharper on the wall. */
	CHECK(quality(0, -3, 256, 0) > quality(0, -10, 256, 0));
}

static void quality_is_continuous_in_the_eyes_place(void **state)
{
	(void)state;
	const float sample[3] = { 3, -7, 2 };
	float last = -1;
	for (int i = 0; i <= 4000; i++) {
		struct plan_eye moving = { { -20 + 0.01f * (float)i, -10, 1 }, 800, 1.2f };
		float now = plan_quality(&moving, wall, towards, sample, 256, 0.05f);
		CHECK(last < 0 || fabsf(now - last) < 0.01f);
		last = now;
	}
}

static void the_level_is_the_coarsest_that_is_sharp(void **state)
{
	(void)state;
	CHECK(plan_level(10, 3) == 0);
	CHECK(plan_level(100, 3) == 1);
	CHECK(plan_level(1e6f, 3) == 2);
	const float sample[3] = { 0, -10, 0 };
	CHECK(fabsf(plan_needed_half_px(&eye, wall, towards, sample) - 800) < 1);
}

static void priorities_stay_between_their_anchors_and_follow_gain_per_byte(void **state)
{
	(void)state;
	uint32_t last = 0;
	for (float gain = 1e-6f; gain < 1e8f; gain *= 3) {
		uint32_t priority = plan_priority(gain, 4000);
		CHECK(priority >= MESSAGE_PRIORITY_PICTURE && priority < MESSAGE_PRIORITY_INDEX);
		CHECK(priority >= last);
		last = priority;
	}
	CHECK(plan_priority(500, 4000) > plan_priority(400, 4000));
	CHECK(plan_priority(500, 4000) == plan_priority(1000, 8000));
}

/* ---- a world of 2 x 2 x 1 points over the wall; no page has come, so all may show something */

struct world {
	struct repository repository;
	struct plan_world plan;
	face_key resident[8];
	uint32_t blocked; /* bit per point: something is between */
};

static int level_at(void *data, face_key face, float u, float v)
{
	(void)data;
	(void)face;
	(void)u;
	(void)v;
	return 2;
}

static bool sees(void *data, const float sample_m[3], const float point_m[3])
{
	const struct world *world = data;
	(void)point_m;
	for (uint32_t p = 0; p < world->repository.point_count; p++) {
		float at[3];
		repository_point_m(&world->repository, p, at);
		if (vec_distance(at, sample_m) < 1e-4f)
			return !(world->blocked >> p & 1);
	}
	return true;
}

static struct brick_entry *no_brick[1];
static struct page_child brick_child = { .size = 100, .is_page = true };
static uint32_t brick_index;

static void make_world(struct world *world)
{
	memset(world, 0, sizeof(*world));
	world->repository = (struct repository){
		.ready = true,
		.point_count = 4,
		.grid = { .origin_m = { -4, -10, 0 },
			  .spacing_m = { 8, 4, 1 },
			  .count = { 2, 2, 1 },
			  .level_count = 3,
			  .bricks = { 1, 1, 1 },
			  .brick_child = &brick_index },
		.page = { .child_count = 1, .children = &brick_child },
		.bricks = no_brick,
	};
	world->plan = (struct plan_world){ .repository = &world->repository,
					   .resident = world->resident,
					   .level_at = level_at,
					   .sees = sees,
					   .data = world };
}

static struct piece small_piece(void)
{
	struct piece piece = {
		.radius_m = 0.5f, .normal = { 0, -1, 0 }, .flatness = 1, .spacing_m = 1
	};
	for (int k = 0; k < PIECE_PROBES; k++)
		piece.extent_m[k % 6][0] = 0.02f * (float)k;
	return piece;
}

static struct plan_surface even_surface(const struct piece *piece)
{
	static struct piece_probe probe[PIECE_PROBES];
	struct plan_surface surface = { .piece = piece, .probe = probe };
	for (int k = 0; k < PIECE_PROBES; k++) {
		probe[k] = (struct piece_probe){ .at_m = { 0.02f * (float)k } };
		memcpy(probe[k].normal, piece->normal, sizeof(probe[k].normal));
		surface.weight[k] = 1.0f / PIECE_PROBES;
	}
	return surface;
}

static void a_piece_wants_the_best_point_that_sees_it(void **state)
{
	(void)state;
	struct world world;
	struct plan_choice choice = { 0 };
	const struct piece piece = small_piece();
	const struct plan_surface surface = even_surface(&piece);
	make_world(&world);
	plan_piece(&choice, &world.plan, &eye, &surface);
	CHECK(choice.entry_count == 0 && choice.want_count >= 1);
	uint32_t best = choice.want[0].face / CUBE_FACES;
	CHECK(choice.want[0].gain > 0.1f && choice.want[0].gain <= 1);
	/* Behind a pillar it is no use: another one is wanted. */
	struct plan_choice anew = { 0 };
	world.blocked = 1u << best;
	plan_piece(&anew, &world.plan, &eye, &surface);
	CHECK(anew.want_count >= 1 && anew.want[0].face / CUBE_FACES != best);
	world.blocked = 15;
	memset(&anew, 0, sizeof(anew));
	plan_piece(&anew, &world.plan, &eye, &surface);
	CHECK(anew.want_count == 0);
}

static void what_is_good_enough_is_not_fetched_again(void **state)
{
	(void)state;
	struct world world;
	struct plan_choice choice = { 0 };
	const struct piece piece = small_piece();
	const struct plan_surface surface = even_surface(&piece);
	make_world(&world);
	plan_piece(&choice, &world.plan, &eye, &surface);
	float first_gain = choice.want[0].gain;
	/* As if the best had come; level_at says its finest tiles are there. */
	world.resident[0] = choice.want[0].face;
	world.plan.resident_count = 1;
	plan_piece(&choice, &world.plan, &eye, &surface);
	CHECK(choice.entry_count == 1 && choice.entry[0].face == world.resident[0]);
	for (uint32_t i = 0; i < choice.want_count; i++)
		CHECK(choice.want[i].face != world.resident[0] && choice.want[i].gain < first_gain);
}

static void an_eye_that_barely_moves_keeps_its_faces(void **state)
{
	(void)state;
	struct world world;
	struct plan_choice choice = { 0 };
	const struct piece piece = small_piece();
	const struct plan_surface surface = even_surface(&piece);
	make_world(&world);
	for (uint32_t p = 0; p < 4; p++) {
		float at[3], to[3], u, v;
		repository_point_m(&world.repository, p, at);
		vec_sub(to, piece.centre_m, at);
		world.resident[p] = p * CUBE_FACES + (uint32_t)cube_project(to, &u, &v);
	}
	world.plan.resident_count = 4;
	plan_piece(&choice, &world.plan, &eye, &surface);
	struct plan_choice was = choice;
	CHECK(was.entry_count > 1);
	struct plan_eye moved = eye;
	moved.eye_m[0] += 0.01f;
	plan_piece(&choice, &world.plan, &moved, &surface);
	CHECK(choice.entry_count == was.entry_count);
	for (uint32_t i = 0; i < was.entry_count; i++) {
		bool kept = false;
		for (uint32_t k = 0; k < choice.entry_count; k++)
			kept |= choice.entry[k].face == was.entry[i].face;
		CHECK(kept);
	}
}

static void the_corners_of_the_cell_weigh_one_together(void **state)
{
	(void)state;
	struct world world;
	struct plan_choice choice = { 0 };
	const struct piece piece = small_piece();
	const struct plan_surface surface = even_surface(&piece);
	make_world(&world);
	for (uint32_t p = 0; p < 4; p++) {
		float at[3], to[3], u, v;
		repository_point_m(&world.repository, p, at);
		vec_sub(to, piece.centre_m, at);
		world.resident[p] = p * CUBE_FACES + (uint32_t)cube_project(to, &u, &v);
	}
	world.plan.resident_count = 4;
	const struct plan_eye inside = { { 1, -9, 0 }, 800, 1.2f };
	plan_piece_corners(&choice, &world.plan, &inside, &surface);
	float sum = 0;
	for (uint32_t i = 0; i < choice.entry_count; i++)
		sum += choice.entry[i].share;
	CHECK(choice.entry_count == 4 && fabsf(sum - 1) < 1e-4f);
	CHECK(choice.entry[0].share >= choice.entry[3].share);
}

static void tile_names_pack_and_unpack(void **state)
{
	(void)state;
	const struct tile_name name = { 64 * 64 * 64 * 6 - 1, 4, 15, 9 };
	struct tile_name back = tile_name_unpack(tile_name_pack(name));
	CHECK(back.face == name.face && back.level == 4 && back.row == 15 && back.column == 9);
	CHECK(tile_name_pack(name) < 1ull << 48);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_sample_at_the_eye_as_sharp_as_the_screen_is_perfect),
		cmocka_unit_test(what_sees_the_back_is_worth_nothing),
		cmocka_unit_test(quality_falls_with_blur_angle_and_parallax),
		cmocka_unit_test(quality_is_continuous_in_the_eyes_place),
		cmocka_unit_test(the_level_is_the_coarsest_that_is_sharp),
		cmocka_unit_test(priorities_stay_between_their_anchors_and_follow_gain_per_byte),
		cmocka_unit_test(a_piece_wants_the_best_point_that_sees_it),
		cmocka_unit_test(what_is_good_enough_is_not_fetched_again),
		cmocka_unit_test(an_eye_that_barely_moves_keeps_its_faces),
		cmocka_unit_test(the_corners_of_the_cell_weigh_one_together),
		cmocka_unit_test(tile_names_pack_and_unpack),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
