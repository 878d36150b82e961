/* The file that says how a scan is deformed: a list of steps, read from JSON (docs/deform.md). */
#ifndef GOPURA_PIPELINE_DEFORM_DEFORM_PLAN_H
#define GOPURA_PIPELINE_DEFORM_DEFORM_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "base/diagnostics.h"

enum { DEFORM_STEPS_MAX = 64, DEFORM_MOVES_MAX = 100000, DEFORM_LEVEL_MAX = 6 };

enum deform_move_kind { DEFORM_BY, DEFORM_TO, DEFORM_TURN };

/* Points of a lattice that are moved together. */
struct deform_move {
	enum deform_move_kind kind;
	unsigned line;
	uint32_t level;        /* the lattice's cells are halved so often */
	int first[3], last[3]; /* numbers of the points along each axis; see control_lattice.h */
	double place[3];       /* how far; where to; or a place on the axis of the turn */
	double axis[3];        /* of the turn, length 1 */
	double turn_deg;       /* counter-clockwise, seen from the end of the axis */
};

/* A surface along which the scan is bent; its arrays are owned. */
struct deform_surface {
	uint32_t order[2], count[2]; /* along u and v; count 0: the step is a lattice */
	float *points, *weights, *knots[2];
	bool is_flattening; /* what lies along the surface is laid flat; otherwise the way back */
};

struct deform_step {
	unsigned line;
	struct deform_surface surface;
	bool has_box; /* otherwise it is the model's box */
	double low[3], high[3];
	uint32_t cells[3];
	struct deform_move *moves; /* owned */
	uint32_t move_count;
};

struct deform_plan {
	double tolerance;          /* in the unit of the scan; 0: not given */
	struct deform_step *steps; /* in the order in which they are done; owned */
	uint32_t step_count;
};

/* *out is for deform_plan_finish, also on failure. A negative errno; diagnostics names the file,
 * the line and the cure. */
must_check int deform_plan_read(struct deform_plan *out, const char *path,
				struct diagnostics *diagnostics);
/* Frees everything. Zeroed is fine. */
void deform_plan_finish(struct deform_plan *plan);

#endif
