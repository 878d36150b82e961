/* Reads scans twice, adds them to the field, and draws its surface. */
#include "pipeline/octree/reconstruct.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "base/progress.h"
#include "base/spill.h"
#include "pipeline/import/mesh_edges.h"
#include "pipeline/octree/coarse_fill.h"
#include "pipeline/octree/cube_surface.h"
#include "pipeline/octree/field_flip.h"
#include "pipeline/octree/mesh_parts.h"

static const double default_cell_spacings = 1.5;
/* Places of the surface are floats: their steps may be as large as this share of a cube. */
static const double coarsest_step = 0.125;
static const uint32_t default_depth = 8;
/* A part with a smaller share of the largest part's triangles is noise. */
static const double small_share = 0.001;

enum { CLEANING_ROUNDS = 8 };

struct work {
	const struct reconstruct_scan *scans;
	uint32_t count;
	const struct reconstruct_options *options;
	struct reconstruct_report *report;
	struct diagnostics *diagnostics;
	struct corner_field field;
	struct coarse_fill fill;
};

static int read_scan(const struct work *work, uint32_t i, struct range_scan *out)
{
	return range_scan_read(out, work->scans[i].path, work->scans[i].transform,
			       work->options->sight, work->diagnostics);
}

/* ---- first reading: the box and the spacing */

static int compare_doubles(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static void measure_scan(struct work *work, const struct range_scan *scan)
{
	struct reconstruct_report *report = work->report;

	for (uint32_t i = 0; i < scan->count; i++) {
		for (int k = 0; k < 3; k++) {
			report->low[k] = fmin(report->low[k], scan->points[i].at[k]);
			report->high[k] = fmax(report->high[k], scan->points[i].at[k]);
		}
		spill_pass(i);
	}
	report->points += scan->count;
	report->dropped += scan->dropped;
	report->range_images += scan->grid_columns > 0;
	work->field.has_colour |= scan->has_colour;
}

static int measure(struct work *work)
{
	double *spacings = calloc(work->count, sizeof(*spacings));
	struct progress *progress = progress_start("measuring", "scans", work->count);
	uint32_t known = 0;
	int rc = spacings ? 0 : -ENOMEM;

	for (int k = 0; k < 3; k++) {
		work->report->low[k] = INFINITY;
		work->report->high[k] = -INFINITY;
	}
	for (uint32_t i = 0; i < work->count && rc == 0; i++) {
		struct range_scan scan;

		rc = read_scan(work, i, &scan);
		if (rc < 0)
			break;
		measure_scan(work, &scan);
		if (scan.spacing > 0)
			spacings[known++] = scan.spacing;
		range_scan_finish(&scan);
		progress_add(progress, 1);
	}
	progress_end(progress);
	if (known > 0) {
		qsort(spacings, known, sizeof(*spacings), compare_doubles);
		work->report->spacing = spacings[known / 2];
	}
	free(spacings);
	return rc;
}

/* ---- the cubes */

/* Refuses a box so far from the origin that places on the surface would be rounded to a stair. */
static int judge_distance(const struct work *work, double cell)
{
	double farthest = 0, step;

	for (int k = 0; k < 3; k++)
		farthest = fmax(farthest,
				fmax(fabs(work->report->low[k]), fabs(work->report->high[k])));
	step = ldexp(1, ilogb(farthest) + 1 - FLT_MANT_DIG);
	if (step <= coarsest_step * cell)
		return 0;
	return diagnostics_add(
		work->diagnostics, -EINVAL, work->scans[0].path, 0,
		"the scans lie up to %.9g from the origin, where places are known to "
		"%.3g only, and leaf cubes are %.3g (in the unit of the files): move "
		"all scans by the same way to the origin, as the matrices of an .aln "
		"do, or choose larger cubes",
		farthest, step, cell);
}

static int choose_cell(struct work *work)
{
	const struct reconstruct_options *options = work->options;
	struct reconstruct_report *report = work->report;
	double longest = 0, cell = options->cell;

	for (int k = 0; k < 3; k++)
		longest = fmax(longest, report->high[k] - report->low[k]);
	if (!(longest > 0) || !isfinite(longest))
		return diagnostics_add(work->diagnostics, -EINVAL, work->scans[0].path, 0,
				       "all its points are at one place; export it again");
	if (!(cell > 0) && options->depth == 0 && report->spacing > 0)
		cell = default_cell_spacings * report->spacing;
	if (!(cell > 0))
		cell = ldexp(longest, -(int)(options->depth ? options->depth : default_depth));
	if (longest / cell > ldexp(1, RECONSTRUCT_DEPTH_MAX))
		return diagnostics_add(work->diagnostics, -EINVAL, NULL, 0,
				       "leaf cubes of %g are over %d along the longest side of %g "
				       "(in the unit of the files): choose larger ones (--cell, "
				       "cell_mm of temple.ini), remove points far from the others, "
				       "or correct the unit",
				       cell, 1 << RECONSTRUCT_DEPTH_MAX, longest);
	work->field.cell = report->cell = cell;
	memcpy(work->field.origin, report->low, sizeof(work->field.origin));
	return judge_distance(work, cell);
}

static int start_fill(struct work *work)
{
	const int32_t reach = FIELD_REACH_MAX + 1;
	int32_t low[3], high[3];

	for (int k = 0; k < 3; k++) {
		low[k] = -reach;
		high[k] = (int32_t)ceil((work->report->high[k] - work->report->low[k]) /
					work->field.cell) +
			  reach;
	}
	return coarse_fill_init(&work->fill, low, high);
}

/* ---- second reading: the distances */

static int add_scans(struct work *work)
{
	struct progress *progress = progress_start("merging", "points", work->report->points);
	int rc = 0;

	for (uint32_t i = 0; i < work->count && rc == 0; i++) {
		struct range_scan scan;

		rc = read_scan(work, i, &scan);
		if (rc < 0)
			break;
		rc = corner_field_add(&work->field, &scan);
		coarse_fill_look(&work->fill, &work->field, &scan);
		progress_add(progress, scan.count);
		range_scan_finish(&scan);
	}
	progress_end(progress);
	return rc;
}

/* Removes small bodies and cavities from the field, layer by layer. */
static int clean(struct work *work)
{
	const struct cube_surface_options surface = { .is_closed = true };
	int rc = 0;

	for (int round = 0; round < CLEANING_ROUNDS && rc == 0; round++) {
		struct mesh mesh;
		uint32_t parts = 0;

		rc = cube_surface_draw(&mesh, &work->field, &work->fill, &surface);
		if (rc == 0)
			rc = field_flip_small(&work->field, &mesh, small_share, &parts);
		mesh_finish(&mesh);
		if (round == 0)
			work->report->dropped_parts = parts;
		if (parts == 0)
			break;
	}
	return rc;
}

static int run(struct work *work, struct mesh *out)
{
	const struct cube_surface_options surface = { .is_closed = work->options->is_closed,
						      .leaf = work->options->leaf,
						      .data = work->options->data };
	int rc = measure(work);

	if (rc == 0)
		rc = choose_cell(work);
	if (rc == 0)
		rc = start_fill(work);
	if (rc == 0)
		rc = add_scans(work);
	work->report->blocks = work->field.block_count;
	if (rc == 0 && surface.is_closed)
		rc = coarse_fill_solve(&work->fill, &work->field);
	if (rc == 0 && surface.is_closed && !work->options->keep_small)
		rc = clean(work);
	if (rc == 0)
		rc = cube_surface_draw(out, &work->field, &work->fill, &surface);
	return rc;
}

int reconstruct(struct mesh *out, const struct reconstruct_scan *scans, uint32_t count,
		const struct reconstruct_options *options, struct reconstruct_report *report,
		struct diagnostics *diagnostics)
{
	struct work work = { .scans = scans,
			     .count = count,
			     .options = options,
			     .report = report,
			     .diagnostics = diagnostics };
	int rc;

	*report = (struct reconstruct_report){ 0 };
	*out = (struct mesh){ 0 };
	rc = count > 0 ? run(&work, out) : -ENODATA;
	corner_field_finish(&work.field);
	coarse_fill_finish(&work.fill);
	if (rc == 0 && out->triangle_count == 0)
		rc = -ENODATA;
	if (rc == 0 && !options->keep_small && !options->is_closed)
		rc = mesh_parts_drop(out, small_share, false, &report->dropped_parts);
	if (rc == 0)
		rc = reconstruct_judge(out, report);
	if (rc == -ENODATA)
		diagnostics_add(diagnostics, rc, count > 0 ? scans[0].path : NULL, 0,
				"its points are too far apart for leaf cubes of this size; choose "
				"larger ones");
	else if (rc == -ENOSPC)
		diagnostics_add(
			diagnostics, rc, NULL, 0,
			"the disk has no room for the points and distances; make some, set TMPDIR "
			"to a larger disk, or choose larger leaf cubes");
	else if (spill_folder_cure(rc))
		diagnostics_add(diagnostics, rc, NULL, 0, "%s", spill_folder_cure(rc));
	else if (rc < 0)
		diagnostics_add(diagnostics, rc, NULL, 0, "%s; choose larger leaf cubes",
				strerror(-rc));
	if (rc < 0)
		mesh_finish(out);
	return rc;
}

/* ---- what came out */

static void count_edge(void *data, const struct mesh_edge *edge)
{
	struct reconstruct_report *report = data;

	report->border_edges += edge->face_count == 1;
	report->crowded_edges += edge->face_count > 2;
}

int reconstruct_judge(const struct mesh *mesh, struct reconstruct_report *report)
{
	struct mesh_edges edges;
	int rc = mesh_parts_count(mesh, &report->parts);

	report->border_edges = report->crowded_edges = 0;
	if (rc == 0)
		rc = mesh_edges_init(&edges, mesh, parallel_cores());
	if (rc < 0)
		return rc;
	rc = mesh_edges_each(&edges, count_edge, report);
	mesh_edges_finish(&edges);
	return rc;
}
