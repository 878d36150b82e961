/* Steps the share of each group towards 0 or 1 and keeps it below the shares that it depends on. */
#include "render/patches/dissolve.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"

int dissolve_init(struct dissolve *dissolve, const struct cut *cut)
{
	const size_t groups = cut->hierarchy->group_count + 1;
	*dissolve = (struct dissolve){ .cut = cut };
	dissolve->share = calloc(groups, sizeof(*dissolve->share));
	dissolve->waited_ms = calloc(groups, sizeof(*dissolve->waited_ms));
	dissolve->unready = calloc(groups, 1);
	if (dissolve->share && dissolve->waited_ms && dissolve->unready)
		return 0;
	dissolve_finish(dissolve);
	return -ENOMEM;
}

void dissolve_finish(struct dissolve *dissolve)
{
	free(dissolve->share);
	free(dissolve->waited_ms);
	free(dissolve->unready);
	memset(dissolve, 0, sizeof(*dissolve));
}

/* Returns the smallest share of the groups that a group depends on. */
static float share_below(const struct dissolve *dissolve, uint32_t group)
{
	uint32_t count;
	const uint32_t *replaced = cut_replaced(dissolve->cut, group, &count);
	float share = 1;
	for (uint32_t i = 0; i < count; i++)
		share = vec_least(
			share,
			dissolve->share[dissolve->cut->hierarchy->patches[replaced[i]].group]);
	return share;
}

/* Returns the largest share of the groups that depend on a group. */
static float share_above(const struct dissolve *dissolve, uint32_t group)
{
	const struct hierarchy *h = dissolve->cut->hierarchy;
	const struct hierarchy_group *g = &h->groups[group];
	float share = 0;
	for (uint32_t p = g->first_patch; p < g->first_patch + g->patch_count; p++)
		if (h->patches[p].finer != HIERARCHY_NONE)
			share = vec_most(share, dissolve->share[h->patches[p].finer]);
	return share;
}

static bool waits(struct dissolve *dissolve, uint32_t group, float passed_ms)
{
	if (dissolve->share[group] > 0 || !dissolve->unready[group] ||
	    dissolve->waited_ms[group] >= DISSOLVE_WAIT_MS)
		return false;
	dissolve->waited_ms[group] += passed_ms;
	return true;
}

/* Returns whether the root group waits: with it, every group that the cut shows begins to appear.
 */
static bool root_waits(struct dissolve *dissolve, float passed_ms)
{
	const uint32_t groups = dissolve->cut->hierarchy->group_count;
	for (uint32_t g = 0; g < groups && !dissolve->unready[0]; g++)
		dissolve->unready[0] = dissolve->unready[g];
	return waits(dissolve, 0, passed_ms);
}

static void step_root(struct dissolve *dissolve, float passed_ms)
{
	const float step = passed_ms / DISSOLVE_MS;
	float *share = &dissolve->share[0];
	if (dissolve->root == ROOT_AT_ONCE)
		*share = 1;
	else if (dissolve->root == ROOT_HELD)
		*share = 0;
	else if (!root_waits(dissolve, passed_ms))
		*share = vec_least(*share + step, 1);
}

void dissolve_step(struct dissolve *dissolve, const uint8_t *loaded, float passed_ms)
{
	const struct cut *cut = dissolve->cut;
	const float step = passed_ms / DISSOLVE_MS;
	dissolve->moving = false;
	/* Coarse groups come before fine ones: none may exceed what it depends on. */
	for (uint32_t g = 0; g < cut->hierarchy->group_count; g++) {
		float *share = &dissolve->share[g], most = share_below(dissolve, g);
		if (!loaded[g] || !cut->shown[g])
			dissolve->waited_ms[g] = 0;
		if (!loaded[g])
			*share = 0;
		else if (g == 0)
			step_root(dissolve, passed_ms);
		else if (cut->shown[g] && !waits(dissolve, g, passed_ms))
			*share += step;
		*share = vec_least(*share, most);
		dissolve->moving |= cut->shown[g] && *share < 1;
	}
	for (uint32_t g = cut->hierarchy->group_count; g-- > 1;) {
		float *share = &dissolve->share[g];
		if (!cut->shown[g])
			*share = vec_most(*share - step, share_above(dissolve, g));
		dissolve->moving |= !cut->shown[g] && *share > 0;
	}
	if (dissolve->root == ROOT_HELD)
		dissolve->moving = false;
	memset(dissolve->unready, 0, cut->hierarchy->group_count);
}

void dissolve_hold(struct dissolve *dissolve, uint32_t group)
{
	dissolve->unready[group] = 1;
}

struct dissolve_range dissolve_range(const struct dissolve *dissolve, uint32_t patch)
{
	const struct hierarchy_patch *p = &dissolve->cut->hierarchy->patches[patch];
	const float low = p->finer == HIERARCHY_NONE ? 0 : dissolve->share[p->finer];
	return (struct dissolve_range){ low, dissolve->share[p->group] };
}

bool dissolve_draws(struct dissolve_range range)
{
	return range.high > range.low;
}

bool dissolve_is_whole(struct dissolve_range range)
{
	return range.low <= 0 && range.high >= 1;
}
