/* Does the moves of a step. */
#include "pipeline/deform/lattice_step.h"

#include <math.h>

/* Who changes a place most, while moves are done. NULL where nobody asks. */
struct blaming {
	const double *place;
	double most;
	struct lattice_blame *blame;
};

/* Turns a place counter-clockwise about an axis (Rodrigues' formula) and gives the difference. */
static void turn(const struct deform_move *move, const double place[3], double by[3])
{
	const double angle = move->turn_deg * M_PI / 180, s = sin(angle), c = cos(angle);
	const double *axis = move->axis;
	double arm[3], along = 0;

	for (int k = 0; k < 3; k++) {
		arm[k] = place[k] - move->place[k];
		along += axis[k] * arm[k];
	}
	for (int k = 0; k < 3; k++) {
		const int a = (k + 1) % 3, b = (k + 2) % 3;

		by[k] = (c - 1) * (arm[k] - along * axis[k]) +
			s * (axis[a] * arm[b] - axis[b] * arm[a]);
	}
}

static void move_point(const struct control_lattice *lattice, const struct deform_move *move,
		       const int point[3], struct blaming *blaming)
{
	double *total = control_lattice_move(lattice, point), place[3], by[3], influence;

	control_lattice_point(lattice, point, place);
	for (int k = 0; k < 3; k++)
		by[k] = move->kind == DEFORM_BY ? move->place[k] : move->place[k] - place[k];
	if (move->kind == DEFORM_TURN)
		turn(move, place, by);
	for (int k = 0; k < 3; k++)
		total[k] += by[k];
	if (!blaming)
		return;
	influence = control_lattice_weight(lattice, point, blaming->place) *
		    sqrt(by[0] * by[0] + by[1] * by[1] + by[2] * by[2]);
	if (influence > blaming->most) {
		blaming->most = influence;
		*blaming->blame = (struct lattice_blame){ move->line,
							  move->level,
							  { point[0], point[1], point[2] } };
	}
}

static void do_move(const struct control_lattice *lattice, const struct deform_move *move,
		    struct blaming *blaming)
{
	int point[3];

	for (point[2] = move->first[2]; point[2] <= move->last[2]; point[2]++)
		for (point[1] = move->first[1]; point[1] <= move->last[1]; point[1]++)
			for (point[0] = move->first[0]; point[0] <= move->last[0]; point[0]++)
				move_point(lattice, move, point, blaming);
}

static int make(struct control_lattice *out, const struct deform_step *step, const double low[3],
		const double high[3], struct blaming *blaming)
{
	uint32_t levels = 0;
	int rc = control_lattice_init(out, low, high, step->cells);

	for (uint32_t i = 0; i < step->move_count; i++)
		if (step->moves[i].level > levels)
			levels = step->moves[i].level;
	for (uint32_t level = 0; level <= levels && rc == 0; level++) {
		if (level > 0)
			rc = control_lattice_refine(out);
		for (uint32_t i = 0; i < step->move_count && rc == 0; i++)
			if (step->moves[i].level == level)
				do_move(out, &step->moves[i], blaming);
	}
	if (rc == 0)
		rc = control_lattice_ready(out);
	if (rc < 0)
		control_lattice_finish(out);
	return rc;
}

int lattice_step_make(struct control_lattice *out, const struct deform_step *step,
		      const double low[3], const double high[3])
{
	return make(out, step, low, high, NULL);
}

int lattice_step_blame(struct lattice_blame *out, const struct deform_step *step,
		       const double low[3], const double high[3], const double place[3])
{
	struct blaming blaming = { place, 0, out };
	struct control_lattice lattice;
	int rc;

	*out = (struct lattice_blame){ 0 };
	rc = make(&lattice, step, low, high, &blaming);
	control_lattice_finish(&lattice);
	return rc;
}

/* ---- the lattice as a warp */

static void warp_place(const void *data, const double from[3], double to[3], double jacobian[3][3])
{
	double by[3];

	control_lattice_displace(data, from, by, jacobian);
	for (int k = 0; k < 3; k++) {
		to[k] = from[k] + by[k];
		if (jacobian)
			jacobian[k][k] += 1;
	}
}

static double warp_bound(const void *data, const double low[3], const double high[3], double *grain)
{
	const struct control_lattice *lattice = data;

	*grain = INFINITY;
	for (int k = 0; k < 3; k++)
		*grain = fmin(*grain, (lattice->high[k] - lattice->low[k]) / lattice->cells[k] / 2);
	return control_lattice_strength(lattice, low, high).bend;
}

struct warp lattice_warp(const struct control_lattice *lattice)
{
	return (struct warp){ .place = warp_place, .bound = warp_bound, .data = lattice };
}
