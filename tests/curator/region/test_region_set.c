/* Regions of a strip of triangles: changes, their ranges, undo and redo, rings and faces. */
#include "tests/check.h"

#include <stdlib.h>

#include "curator/region/region_set.h"

enum { TRIANGLES = 200, VERTICES = TRIANGLES + 2 };

/* Triangle t has the vertices t, t + 1, t + 2, so it shares one with t - 2 to t + 2. The second
 * half is another scan. Faces are counted from 0 in each; two triangles are a face. */
struct strip {
	struct mesh mesh;
	uint32_t triangles[TRIANGLES][3], faces[TRIANGLES];
};

static void make_strip(struct strip *strip)
{
	*strip = (struct strip){
		.mesh = { .vertex_count = VERTICES, .triangle_count = TRIANGLES, .scan_count = 2 }
	};
	strip->mesh.triangles = strip->triangles;
	strip->mesh.faces = strip->faces;
	for (uint32_t s = 0; s < 2; s++)
		strip->mesh.scans[s] = (struct mesh_scan){ TRIANGLES / 2, TRIANGLES / 4 };
	for (uint32_t t = 0; t < TRIANGLES; t++) {
		for (uint32_t k = 0; k < 3; k++)
			strip->triangles[t][k] = t + k;
		strip->faces[t] = t % (TRIANGLES / 2) / 2;
	}
}

static void start(struct region_set *set)
{
	CHECK(region_set_init(set, TRIANGLES) == 0);
}

/* Adds or takes triangles first to last. */
static void change(struct region_set *set, uint32_t first, uint32_t last, bool in)
{
	region_set_begin(set);
	for (uint32_t t = first; t <= last; t++)
		region_set_put(set, t, in);
	CHECK(region_set_commit(set) == 0);
}

/* Whether the region is first to last and nothing else. */
static bool is_range(const struct region_set *set, uint32_t first, uint32_t last)
{
	for (uint32_t t = 0; t < TRIANGLES; t++)
		if (region_set_has(set, t) != (t >= first && t <= last))
			return false;
	return set->count == last - first + 1;
}

static bool is_empty(const struct region_set *set)
{
	for (uint32_t t = 0; t < TRIANGLES; t++)
		if (region_set_has(set, t))
			return false;
	return set->count == 0;
}

static void starts_empty_with_nothing_to_undo(void **state)
{
	struct region_set set;

	(void)state;
	start(&set);
	CHECK(is_empty(&set));
	CHECK(!region_set_undo(&set));
	CHECK(!region_set_redo(&set));
	region_set_finish(&set);
	region_set_finish(&set); /* zeroed */
	region_set_finish(NULL);
}

static void undoes_and_redoes_every_change(void **state)
{
	struct region_set set;

	(void)state;
	start(&set);
	change(&set, 10, 90, true);
	change(&set, 50, 130, true);
	change(&set, 10, 20, false);
	CHECK(is_range(&set, 21, 130));
	CHECK(region_set_undo(&set) && is_range(&set, 10, 130));
	CHECK(region_set_undo(&set) && is_range(&set, 10, 90));
	CHECK(region_set_undo(&set) && is_empty(&set));
	CHECK(!region_set_undo(&set));
	CHECK(region_set_redo(&set) && is_range(&set, 10, 90));
	CHECK(region_set_redo(&set) && is_range(&set, 10, 130));
	CHECK(region_set_redo(&set) && is_range(&set, 21, 130));
	CHECK(!region_set_redo(&set));
	region_set_finish(&set);
}

static void keeps_a_change_as_the_ranges_that_it_flipped(void **state)
{
	struct region_set set;

	(void)state;
	start(&set);
	change(&set, 60, 70, true);
	change(&set, 50, 100, true);
	CHECK(set.steps[1].count == 2);
	CHECK(set.steps[1].ranges[0].first == 50 && set.steps[1].ranges[0].last == 59);
	CHECK(set.steps[1].ranges[1].first == 71 && set.steps[1].ranges[1].last == 100);
	region_set_finish(&set);
}

static void takes_a_change_of_nothing_for_no_step(void **state)
{
	struct region_set set;

	(void)state;
	start(&set);
	change(&set, 5, 9, true);
	CHECK(region_set_undo(&set));
	change(&set, 5, 9, false);
	CHECK(set.done_count == 0 && set.step_count == 1);
	CHECK(region_set_redo(&set) && is_range(&set, 5, 9));
	region_set_finish(&set);
}

static void drops_undone_steps_at_a_new_change(void **state)
{
	struct region_set set;

	(void)state;
	start(&set);
	change(&set, 0, 9, true);
	change(&set, 10, 19, true);
	CHECK(region_set_undo(&set) && region_set_undo(&set));
	change(&set, 150, 199, true);
	CHECK(!region_set_redo(&set));
	CHECK(set.step_count == 1 && is_range(&set, 150, 199));
	region_set_finish(&set);
}

static void undoes_and_redoes_nothing_past_what_it_forgot(void **state)
{
	struct region_set set;

	(void)state;
	start(&set);
	change(&set, 10, 20, true);
	change(&set, 30, 40, true);
	CHECK(region_set_undo(&set));
	region_set_forget(&set);
	CHECK(!region_set_undo(&set) && !region_set_redo(&set) && is_range(&set, 10, 20));
	change(&set, 21, 30, true);
	CHECK(region_set_undo(&set) && is_range(&set, 10, 20) && !region_set_undo(&set));
	region_set_finish(&set);
}

static void undoes_thousands_of_changes(void **state)
{
	struct region_set set;

	(void)state;
	start(&set);
	for (uint32_t n = 0; n < 5000; n++)
		change(&set, n % TRIANGLES, n % TRIANGLES, n / TRIANGLES % 2 == 0);
	for (uint32_t n = 0; n < 5000; n++)
		CHECK(region_set_undo(&set));
	CHECK(is_empty(&set) && !region_set_undo(&set));
	region_set_finish(&set);
}

static void puts_all_and_none(void **state)
{
	struct region_set set;

	(void)state;
	for (uint32_t count = 1; count <= 130; count++) {
		CHECK(region_set_init(&set, count) == 0);
		region_set_begin(&set);
		region_set_put_all(&set, true);
		CHECK(region_set_commit(&set) == 0 && set.count == count);
		region_set_begin(&set);
		region_set_put_all(&set, false);
		CHECK(region_set_commit(&set) == 0 && set.count == 0);
		region_set_finish(&set);
	}
}

static void grows_and_shrinks_by_one_ring(void **state)
{
	struct region_set set;
	struct strip strip;

	(void)state;
	make_strip(&strip);
	start(&set);
	change(&set, 60, 70, true);
	CHECK(region_set_grow(&set, &strip.mesh) == 0 && is_range(&set, 58, 72));
	CHECK(region_set_shrink(&set, &strip.mesh) == 0 && is_range(&set, 60, 70));
	CHECK(region_set_undo(&set) && is_range(&set, 58, 72));
	CHECK(region_set_undo(&set) && is_range(&set, 60, 70));
	/* At the border of the scan there is nothing to grow into, nor to shrink from. */
	change(&set, 0, TRIANGLES - 1, true);
	CHECK(region_set_grow(&set, &strip.mesh) == 0 && is_range(&set, 0, TRIANGLES - 1));
	CHECK(region_set_shrink(&set, &strip.mesh) == 0 && is_range(&set, 0, TRIANGLES - 1));
	region_set_finish(&set);
}

static void shrinks_a_small_region_to_nothing(void **state)
{
	struct region_set set;
	struct strip strip;

	(void)state;
	make_strip(&strip);
	start(&set);
	change(&set, 63, 64, true);
	CHECK(region_set_shrink(&set, &strip.mesh) == 0 && is_empty(&set));
	CHECK(region_set_grow(&set, &strip.mesh) == 0 && is_empty(&set));
	region_set_finish(&set);
}

static void names_the_faces_of_each_scan(void **state)
{
	struct region_set set;
	struct face_list faces;
	struct strip strip;
	uint32_t *triangles, count;

	(void)state;
	make_strip(&strip);
	start(&set);
	change(&set, 90, 109, true);
	change(&set, 150, 151, true);
	CHECK(region_set_faces(&faces, &set, &strip.mesh, 0) == 0);
	CHECK(faces.count == 1 && faces.ranges[0].first == 45 && faces.ranges[0].last == 49);
	face_list_finish(&faces);
	CHECK(region_set_faces(&faces, &set, &strip.mesh, 1) == 0);
	CHECK(faces.count == 2 && faces.ranges[0].first == 0 && faces.ranges[0].last == 4);
	CHECK(faces.ranges[1].first == 25 && faces.ranges[1].last == 25);
	/* And back again. */
	CHECK(face_list_triangles(&triangles, &count, &faces, &strip.mesh, 1) == 0);
	CHECK(count == 12 && triangles[0] == 100 && triangles[11] == 151);
	free(triangles);
	face_list_finish(&faces);
	region_set_finish(&set);
}

static void names_no_face_without_numbers(void **state)
{
	struct region_set set;
	struct face_list faces;
	struct strip strip;

	(void)state;
	make_strip(&strip);
	start(&set);
	change(&set, 0, 99, true);
	for (uint32_t t = 2; t < TRIANGLES; t++)
		strip.faces[t] = MESH_NO_FACE; /* as repair adds them */
	CHECK(region_set_faces(&faces, &set, &strip.mesh, 0) == 0);
	CHECK(faces.count == 1 && faces.ranges[0].first == 0 && faces.ranges[0].last == 0);
	face_list_finish(&faces);
	strip.mesh.scans[0].face_count = 0;
	CHECK(region_set_faces(&faces, &set, &strip.mesh, 0) == 0 && faces.count == 0);
	face_list_finish(&faces);
	strip.mesh.faces = NULL;
	CHECK(region_set_faces(&faces, &set, &strip.mesh, 1) == 0 && faces.count == 0);
	face_list_finish(&faces);
	region_set_finish(&set);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(starts_empty_with_nothing_to_undo),
		cmocka_unit_test(undoes_and_redoes_every_change),
		cmocka_unit_test(keeps_a_change_as_the_ranges_that_it_flipped),
		cmocka_unit_test(takes_a_change_of_nothing_for_no_step),
		cmocka_unit_test(drops_undone_steps_at_a_new_change),
		cmocka_unit_test(undoes_and_redoes_nothing_past_what_it_forgot),
		cmocka_unit_test(undoes_thousands_of_changes),
		cmocka_unit_test(puts_all_and_none),
		cmocka_unit_test(grows_and_shrinks_by_one_ring),
		cmocka_unit_test(shrinks_a_small_region_to_nothing),
		cmocka_unit_test(names_the_faces_of_each_scan),
		cmocka_unit_test(names_no_face_without_numbers),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
