/* The tiny release of the test that runs: made before it, removed after it. */
#ifndef GOPURA_TESTS_PIPELINE_RELEASE_TINY_FIXTURE_H
#define GOPURA_TESTS_PIPELINE_RELEASE_TINY_FIXTURE_H

#include "tests/pipeline/release/tiny_release.h"

static struct tiny tiny;

static int set_up(void **state)
{
	(void)state;
	tiny_make(&tiny);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	tiny_remove(&tiny);
	return 0;
}

#endif
