/* A small hierarchy that is a graph, not a tree: group 0 holds patches 0 and 1; group 1 replaces
 * patch 0, group 2 replaces patch 1, group 3 replaces one patch of each of them. The second half
 * lies 20 m to the east. */
#ifndef GOPURA_TESTS_RENDER_PATCHES_LITTLE_HIERARCHY_H
#define GOPURA_TESTS_RENDER_PATCHES_LITTLE_HIERARCHY_H

#include <math.h>

#include "format/hierarchy.h"

static struct hierarchy_group groups[4] = {
	{ 0, 2, INFINITY, { 10, 0, 0 }, 30 },
	{ 2, 2, 0.4f, { 0, 0, 0 }, 5 },
	{ 4, 2, 0.4f, { 20, 0, 0 }, 5 },
	{ 6, 2, 0.1f, { 1, 0, 0 }, 3 },
};
static struct hierarchy_patch patches[8] = {
	{ .group = 0, .finer = 1 },
	{ .group = 0, .finer = 2 },
	{ .group = 1, .finer = 3 },
	{ .group = 1, .finer = HIERARCHY_NONE },
	{ .group = 2, .finer = 3 },
	{ .group = 2, .finer = HIERARCHY_NONE },
	{ .group = 3, .finer = HIERARCHY_NONE },
	{ .group = 3, .finer = HIERARCHY_NONE },
};
static const struct hierarchy hierarchy = { 4, 8, groups, patches };

#endif
