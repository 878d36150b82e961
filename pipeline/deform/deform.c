/* Runs the steps of a deformation over a mesh. */
#include "pipeline/deform/deform.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "base/spill.h"
#include "pipeline/deform/bend_split.h"
#include "pipeline/deform/fold_check.h"
#include "pipeline/deform/lattice_step.h"
#include "pipeline/deform/surface_warp.h"

enum { RANGE_VERTICES = 1 << 14, LINE_PLACES = 257 };

/* More triangles than this are no result but a tolerance that is too small. */
enum { GROWTH_MAX = 8, TRIANGLES_LEAST = 4000000 };

/* A tolerance that no eye sees, for those who do not say one. */
#define TOLERANCE_OF_DIAGONAL 1e-4

struct deforming {
	struct mesh *mesh;              /* borrowed */
	const struct deform_plan *plan; /* borrowed */
	const char *path;
	struct diagnostics *diagnostics;
	struct deform_report *report;
	uint32_t jobs;
	double lines[3][LINE_PLACES][3];
};

/* ---- lines through the box */

static void begin_lines(struct deforming *d)
{
	const struct mesh_measure *box = &d->report->before;

	for (int axis = 0; axis < 3; axis++)
		for (int i = 0; i < LINE_PLACES; i++)
			for (int k = 0; k < 3; k++) {
				const double low = (double)box->low[k], high = (double)box->high[k];
				const double share = k == axis ? i / (LINE_PLACES - 1.0) : 0.5;

				d->lines[axis][i][k] = low + share * (high - low);
			}
}

static void measure_lines(const struct deforming *d, double length[3])
{
	for (int axis = 0; axis < 3; axis++) {
		length[axis] = 0;
		for (int i = 1; i < LINE_PLACES; i++) {
			const double *a = d->lines[axis][i - 1], *b = d->lines[axis][i];

			length[axis] +=
				sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
				     (a[2] - b[2]) * (a[2] - b[2]));
		}
	}
}

static void move_lines(struct deforming *d, const struct warp *warp)
{
	for (int axis = 0; axis < 3; axis++)
		for (int i = 0; i < LINE_PLACES; i++) {
			double to[3];

			warp->place(warp->data, d->lines[axis][i], to, NULL);
			memcpy(d->lines[axis][i], to, sizeof(to));
		}
}

/* ---- vertices */

struct growth {
	double least, most;
	uint32_t least_at; /* the vertex */
};

struct mover {
	struct mesh *mesh;
	const struct warp *warp;
	struct growth *ranges; /* of each range of vertices; owned */
};

static double growth_at(const struct mover *m, uint32_t v, double to[3])
{
	const float *position = m->mesh->positions[v];
	const double from[3] = { (double)position[0], (double)position[1], (double)position[2] };

	return fold_growth(m->warp, from, to);
}

static int check_range(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	const struct mover *m = user;
	struct growth growth = { INFINITY, -INFINITY, first };
	(void)worker;

	for (uint32_t v = first; v < after; v++) {
		double to[3];
		const double grows = growth_at(m, v, to);

		/* Written so that what is not a number counts as the least. */
		if (!(grows >= growth.least)) {
			growth.least = isfinite(grows) ? grows : -INFINITY;
			growth.least_at = v;
		}
		growth.most = fmax(growth.most, grows);
		spill_pass(v);
	}
	m->ranges[first / RANGE_VERTICES] = growth;
	return 0;
}

static int move_range(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	const struct mover *m = user;
	(void)worker;

	for (uint32_t v = first; v < after; v++) {
		double to[3];

		growth_at(m, v, to);
		for (int k = 0; k < 3; k++)
			m->mesh->positions[v][k] = (float)to[k];
		spill_pass(v);
	}
	return 0;
}

/* A step, ready to be done. */
struct ready_step {
	const struct deform_step *step; /* borrowed */
	struct control_lattice lattice; /* owned */
	struct surface_warp *surface;   /* owned; NULL: the step is a lattice */
	double low[3], high[3];         /* of the lattice */
	struct warp warp;
};

static int refuse_lattice(const struct deforming *d, const struct ready_step *ready,
			  const double place[3])
{
	struct lattice_blame blame;
	int rc = lattice_step_blame(&blame, ready->step, ready->low, ready->high, place);

	if (rc < 0)
		return rc;
	return diagnostics_add(d->diagnostics, -EDOM, d->path,
			       blame.line > 0 ? blame.line : ready->step->line,
			       "the scan would fold over at %g %g %g: move point %d %d %d of level "
			       "%u less, or its neighbours with it",
			       place[0], place[1], place[2], blame.point[0], blame.point[1],
			       blame.point[2], blame.level);
}

static int refuse_fold(const struct deforming *d, const struct ready_step *ready,
		       const double place[3])
{
	uint32_t point[2] = { 0, 0 };

	if (!ready->surface)
		return refuse_lattice(d, ready, place);
	surface_warp_nearest(ready->surface, place, point);
	return diagnostics_add(
		d->diagnostics, -EDOM, d->path, ready->step->line,
		"the scan would fold over at %g %g %g, near point %u of row %u: the "
		"surface ends before the scan does, or is too far from it for its bend",
		place[0], place[1], place[2], point[0], point[1]);
}

/* Refuses a step that folds a vertex, the worst of which is given, or a triangle between its
 * vertices. */
static int check_folds(const struct deforming *d, const struct ready_step *ready,
		       const struct growth *growth)
{
	const float *at = d->mesh->positions[growth->least_at];
	double place[3] = { (double)at[0], (double)at[1], (double)at[2] };
	int rc = 1;

	if (growth->least > FOLD_GROWTH_LEAST)
		rc = fold_find(place, d->mesh, &ready->warp, d->jobs);
	return rc == 1 ? refuse_fold(d, ready, place) : rc;
}

/* Checks all vertices and triangles, and moves them if none folds. */
static int move_vertices(struct deforming *d, const struct ready_step *ready)
{
	const uint32_t count = d->mesh->vertex_count;
	const uint32_t ranges = (count + RANGE_VERTICES - 1) / RANGE_VERTICES;
	struct mover m = { d->mesh, &ready->warp, calloc(ranges + 1, sizeof(*m.ranges)) };
	struct growth growth = { INFINITY, -INFINITY, 0 };
	int rc = m.ranges ? parallel_ranges(d->jobs, count, RANGE_VERTICES, check_range, &m)
			  : -ENOMEM;

	for (uint32_t i = 0; i < ranges && rc == 0; i++) {
		if (m.ranges[i].least < growth.least) {
			growth.least = m.ranges[i].least;
			growth.least_at = m.ranges[i].least_at;
		}
		growth.most = fmax(growth.most, m.ranges[i].most);
	}
	free(m.ranges);
	if (rc == 0)
		rc = check_folds(d, ready, &growth);
	if (rc == 0) {
		d->report->least_growth = fmin(d->report->least_growth, growth.least);
		d->report->most_growth = fmax(d->report->most_growth, growth.most);
		rc = parallel_ranges(d->jobs, count, RANGE_VERTICES, move_range, &m);
	}
	return rc;
}

/* ---- steps */

/* A flat model still needs a box of some thickness. */
static void find_box(const struct deforming *d, const struct deform_step *step, double low[3],
		     double high[3])
{
	float box[2][3];
	double thickest = 0;

	mesh_box(d->mesh, box[0], box[1]);
	for (int k = 0; k < 3; k++) {
		low[k] = step->has_box ? step->low[k] : (double)box[0][k];
		high[k] = step->has_box ? step->high[k] : (double)box[1][k];
		thickest = fmax(thickest, high[k] - low[k]);
	}
	for (int k = 0; k < 3; k++)
		if (high[k] - low[k] < thickest * 1e-6) {
			low[k] -= thickest * 1e-3;
			high[k] += thickest * 1e-3;
		}
}

static uint32_t triangles_most(const struct deforming *d)
{
	const uint64_t most = (uint64_t)d->report->before.triangles * GROWTH_MAX + TRIANGLES_LEAST;

	return most < INT32_MAX ? (uint32_t)most : INT32_MAX;
}

static int explain_split(const struct deforming *d, const struct deform_step *step, int rc)
{
	if (rc == -EDOM)
		diagnostics_add(d->diagnostics, rc, d->path, step->line,
				"the tolerance of %g is too small for a scan of this size: write a "
				"larger \"tolerance\"",
				d->report->tolerance);
	if (rc == -EFBIG)
		diagnostics_add(d->diagnostics, rc, d->path, step->line,
				"the scan would have more than %u triangles: write a larger "
				"\"tolerance\" than %g",
				triangles_most(d), d->report->tolerance);
	return rc;
}

static int make_ready(struct ready_step *out, const struct deforming *d,
		      const struct deform_step *step)
{
	const struct deform_surface *s = &step->surface;
	const struct nurbs_surface surface = {
		{ { s->order[0], s->count[0], s->knots[0] },
		  { s->order[1], s->count[1], s->knots[1] } },
		s->points,
		s->weights,
	};
	int rc;

	*out = (struct ready_step){ .step = step };
	if (s->count[0] > 0) {
		rc = surface_warp_create(&out->surface, &surface, s->is_flattening);
		if (rc == 0)
			out->warp = surface_warp_of(out->surface);
		if (rc == -EDOM)
			diagnostics_add(
				d->diagnostics, rc, d->path, step->line,
				"the surface has no normal in its middle: spread its points");
		return rc;
	}
	find_box(d, step, out->low, out->high);
	rc = lattice_step_make(&out->lattice, step, out->low, out->high);
	if (rc == 0)
		out->warp = lattice_warp(&out->lattice);
	return rc;
}

static int do_step(struct deforming *d, const struct deform_step *step)
{
	struct ready_step ready;
	int rc = make_ready(&ready, d, step);

	if (rc == 0)
		rc = explain_split(d, step,
				   bend_split(d->mesh, &ready.warp, d->report->tolerance,
					      triangles_most(d), d->jobs));
	if (rc == 0)
		rc = move_vertices(d, &ready);
	if (rc == 0)
		move_lines(d, &ready.warp);
	control_lattice_finish(&ready.lattice);
	surface_warp_destroy(ready.surface);
	return rc;
}

static double diagonal(const struct mesh_measure *box)
{
	double sum = 0;

	for (int k = 0; k < 3; k++)
		sum += ((double)box->high[k] - (double)box->low[k]) *
		       ((double)box->high[k] - (double)box->low[k]);
	return sqrt(sum);
}

int deform(struct mesh *mesh, const struct deform_plan *plan, const char *path, uint32_t jobs,
	   struct deform_report *report, struct diagnostics *diagnostics)
{
	struct deforming d = { mesh, plan, path, diagnostics, report, jobs, { { { 0 } } } };
	int rc;

	*report = (struct deform_report){ .least_growth = INFINITY, .most_growth = -INFINITY };
	rc = mesh_measure(&report->before, mesh, jobs);
	report->tolerance = plan->tolerance > 0 ? plan->tolerance
						: TOLERANCE_OF_DIAGONAL * diagonal(&report->before);
	begin_lines(&d);
	measure_lines(&d, report->length_before);
	for (uint32_t i = 0; i < plan->step_count && rc == 0; i++)
		rc = do_step(&d, &plan->steps[i]);
	measure_lines(&d, report->length_after);
	if (rc == 0)
		rc = mesh_measure(&report->after, mesh, jobs);
	if (rc < 0)
		diagnostics_add(diagnostics, rc, path, 0, "%s", strerror(-rc));
	return rc;
}
