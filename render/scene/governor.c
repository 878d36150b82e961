/* Integrates the load of frames into a level, and maps the level to an effort. */
#include "render/scene/governor.h"

#include <math.h>

#include "render/plan/plan.h"

enum {
	REFRESH_US = 16667,
	SLOWEST_US = 34000,         /* the longest frame it aims at: 30 a second */
	PATIENCE_LEAST_US = 400000, /* quiet time before the level rises */
	PATIENCE_MOST_US = 6400000,
	RELAPSE_US = 2000000, /* a fall so soon after a rise means that the rise was too much */
	FORGET_US = 8000000,  /* without a fall, patience becomes shorter again */
};

/* A load is the time of a frame as a share of its target. Between the two nothing changes. */
static const float load_low = 0.92f, load_high = 1.0f, load_goal = 0.95f;
/* The level's change for each unit of load above or below the goal, and the largest fall. A rise
 * adds to a load at most what it is below the goal, so it never leads from below the dead band to
 * above it. */
static const float gain = 0.35f, fall_most = 0.4f;
/* Below this level, or with such a load, a lower rate of frames harms less than a still smaller
 * picture. */
static const float level_of_rate = 0.7f, load_of_rate = 1.5f;
/* Below 0 a picture is drawn over several frames: from this share of it in each just there, where
 * showing the last one costs no more than is gained, to the least. */
static const float level_share = -0.4f, share_most = 0.67f, share_least = 0.1f;
/* Below that such pictures become smaller, to this part of the least scale of whole ones. */
static const float level_least = -0.7f, scale_least = 0.7f;
/* Where the parts of the effort begin to give way, in the order of what a picture loses for the
 * time that is gained (docs/figures.md, Levels of the governor): the scale first. */
static const float level_faces = 0.4f, level_triangles = 0.2f, level_budget = 0.1f;
/* At level 0 and below: the share of the time budgets. */
static const float budget_least = 0.25f;
/* What a frame at level 0 takes of one at full effort (docs/figures.md). */
static const float cost_least = 0.3f;
/* Fewer triangles cost the picture more than they save (docs/figures.md). */
enum { FACES_LEAST = 1, TRIANGLES_LEAST = 60000 };

void governor_init(struct governor *governor, const struct governor_bounds *bounds)
{
	*governor = (struct governor){ .bounds = *bounds,
				       .level = 1,
				       .divisor = 1,
				       .patience_us = PATIENCE_LEAST_US,
				       .risen_us = RELAPSE_US };
	if (governor->bounds.refresh_us == 0)
		governor->bounds.refresh_us = REFRESH_US;
}

bool governor_is_fixed(const struct governor *governor)
{
	return governor->bounds.scale_least >= 1;
}

int64_t governor_target_us(const struct governor *governor)
{
	return (int64_t)governor->bounds.refresh_us * governor->divisor;
}

static bool may_slow_down(const struct governor *governor)
{
	return (int64_t)governor->bounds.refresh_us * (governor->divisor + 1) <= SLOWEST_US;
}

static void be_quiet(struct governor *governor)
{
	governor->quiet_us = 0;
	governor->most[0] = governor->most[1] = 0;
}

/* Returns the largest load of the quiet time but one: a single frame may have had more to do. */
static float most(const struct governor *governor)
{
	return governor->most[1];
}

static void note_load(struct governor *governor, float load)
{
	governor->most[1] = fmaxf(governor->most[1], fminf(load, governor->most[0]));
	governor->most[0] = fmaxf(governor->most[0], load);
}

/* Two late frames in a row count, because one may have had more to load. */
static void fall(struct governor *governor, float load)
{
	if (governor->risen_us < RELAPSE_US && governor->patience_us < PATIENCE_MOST_US)
		governor->patience_us *= 2;
	governor->risen_us = RELAPSE_US;
	governor->held_us = 0;
	while (load > load_high && may_slow_down(governor) &&
	       (load > load_of_rate || governor->level <= level_of_rate)) {
		load *= (float)governor->divisor / (float)(governor->divisor + 1);
		governor->divisor++;
	}
	if (load > load_high)
		governor->level -= fminf(gain * (load - load_goal), fall_most);
	governor->level = fmaxf(governor->level, level_least);
}

/* The rate rises last, and only if a frame then still has room. */
static void come_back(struct governor *governor)
{
	const float divisor = (float)governor->divisor;
	if (governor->level < 1) {
		governor->level = fminf(governor->level + gain * (load_goal - most(governor)), 1);
		governor->risen_us = 0;
	} else if (governor->divisor > 1 && most(governor) * divisor < load_low * (divisor - 1)) {
		governor->divisor--;
		governor->risen_us = 0;
	}
}

static bool limits_triangles(const struct governor *governor)
{
	return governor->level < level_triangles && governor->whole > TRIANGLES_LEAST;
}

void governor_note(struct governor *governor, int64_t spent_us, uint32_t triangles)
{
	const int64_t target_us = governor_target_us(governor);
	const float load = (float)spent_us / (float)target_us;
	const int64_t passed_us = spent_us > target_us ? spent_us : target_us;
	if (governor_is_fixed(governor))
		return;
	/* the first frame of all has a new view and nothing to show */
	governor->has_moved = governor->has_moved || triangles > 0;
	if (!limits_triangles(governor))
		governor->whole = triangles;
	governor->quiet_us += load > load_high ? 0 : target_us;
	governor->risen_us += passed_us;
	governor->held_us += passed_us;
	note_load(governor, load);
	const float over = load > load_high ? load : 0;
	const float both = fminf(over, governor->over);
	governor->over = over;
	if (both > 0)
		fall(governor, both);
	if (both > 0 || most(governor) > load_low)
		be_quiet(governor);
	if (governor->held_us > FORGET_US && governor->patience_us > PATIENCE_LEAST_US) {
		governor->patience_us /= 2;
		governor->held_us = 0;
	}
	if (governor->quiet_us < governor->patience_us)
		return;
	come_back(governor);
	be_quiet(governor);
}

/* Returns where a level lies between two, 0 to 1. */
static float between(float level, float low, float high)
{
	return fminf(fmaxf((level - low) / (high - low), 0), 1);
}

/* Returns how much of a picture is drawn in a frame. Each rise of the level adds the same part. */
static float share_at(float level)
{
	if (level >= 0)
		return 1;
	return share_most * powf(share_least / share_most, fminf(level / level_share, 1));
}

/* Returns the level at which a frame takes that part of one at full effort. */
static float level_for(float part)
{
	if (part >= cost_least)
		return fminf((part - cost_least) / (1 - cost_least), 1);
	const float level =
		level_share * logf(part / cost_least / share_most) / logf(share_least / share_most);
	return fminf(fmaxf(level, level_share), 0);
}

void governor_expect(struct governor *governor, int64_t spent_us, uint32_t triangles)
{
	if (governor->has_moved || governor_is_fixed(governor) || spent_us <= 0)
		return;
	governor->whole = triangles;
	governor->divisor = 1;
	while (spent_us > governor_target_us(governor) && may_slow_down(governor))
		governor->divisor++;
	governor->level =
		level_for(load_goal * (float)governor_target_us(governor) / (float)spent_us);
}

struct scene_effort governor_effort(const struct governor *governor)
{
	const float level = governor->level;
	const float small =
		scale_least + (1 - scale_least) * between(level, level_least, level_share);
	const float least = small * governor->bounds.scale_least;
	const float faces = between(level, level_triangles, level_faces);
	const float triangles = between(level, level_budget, level_triangles);
	return (struct scene_effort){
		.scale = least + (1 - least) * between(level, level_faces, 1),
		.faces = FACES_LEAST + (uint32_t)lroundf((PLAN_ENTRIES - FACES_LEAST) * faces),
		.triangles = limits_triangles(governor)
				     ? (uint32_t)(TRIANGLES_LEAST *
						  powf((float)governor->whole / TRIANGLES_LEAST,
						       triangles))
				     : UINT32_MAX,
		.budget = budget_least + (1 - budget_least) * between(level, 0, level_budget),
		.share = share_at(level),
	};
}
