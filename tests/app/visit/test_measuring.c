/* What is measured between two places, and how exact that is. */
#include <math.h>

#include "app/visit/measuring.h"
#include "tests/check.h"

static const struct measured_end ends[] = {
	{ { 1, 2, 3 }, 0.03f },
	{ { 1, 5, 7 }, 0.04f },
	{ { 0, 0, 0 }, 0 },
};

static void a_third_end_begins_anew(void **state)
{
	struct measuring measuring = { .on = true };

	(void)state;
	for (unsigned i = 0; i < 7; i++) {
		measuring_add(&measuring, &ends[i % 3]);
		CHECK(measuring.on && measuring.count == 1 + i % 2);
		CHECK(measuring.ends[i % 2].at_m[2] == ends[i % 3].at_m[2]);
	}
}

static void errors_add_as_squares(void **state)
{
	struct measuring measuring = { .on = true };

	(void)state;
	measuring_add(&measuring, &ends[0]);
	measuring_add(&measuring, &ends[1]);
	CHECK(measuring_length_m(&measuring) == 5);
	CHECK(fabsf(measuring_error_m(&measuring, 0) - 0.05f) < 1e-6f);
	CHECK(fabsf(measuring_error_m(&measuring, 0.12f / (float)M_SQRT2) - 0.13f) < 1e-6f);
	/* Two places that are the same are not exact either. */
	measuring.ends[0] = measuring.ends[1] = ends[2];
	CHECK(measuring_length_m(&measuring) == 0);
	CHECK(fabsf(measuring_error_m(&measuring, 1) - (float)M_SQRT2) < 1e-6f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_third_end_begins_anew),
		cmocka_unit_test(errors_add_as_squares),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
