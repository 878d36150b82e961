/* Turns the shells of a mesh outwards, draws the closed surface around them, and gives it what
 * the scan has on its faces. */
#include "pipeline/octree/closed_surface.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "base/spill.h"
#include "geometry/vec.h"
#include "pipeline/octree/closed_field.h"
#include "pipeline/octree/cube_surface.h"
#include "pipeline/octree/mesh_parts.h"
#include "pipeline/octree/mesh_shells.h"
#include "pipeline/octree/reconstruct.h"
#include "pipeline/octree/scan_transfer.h"

/* A part with a smaller share of the largest part's triangles is noise. */
static const double small_share = 0.001;
/* Cubes of the default size along the longest side. */
static const double least_cubes = 256, most_cubes = 4096;
/* Where the box begins, in cubes from the lowest corner: what is built on whole millimetres then
 * lies less often exactly on corners. */
static const double margin = 2.379;

enum { TRIED_TRIANGLES = 20000, RANGE_TRIED = 500 };

struct closing {
	const struct mesh *mesh;
	struct closed_surface_report *report;
	struct diagnostics *diagnostics;
	struct triangle_tree tree;
	struct corner_field field;
	float longest; /* side of the box, metres */
	double area;   /* of the triangles, square metres */
};

/* ---- the cubes */

static double area_of(const struct mesh *mesh, uint32_t triangle)
{
	const uint32_t *corners = mesh->triangles[triangle];
	float a[3], b[3], cross[3];

	vec_sub(a, mesh->positions[corners[1]], mesh->positions[corners[0]]);
	vec_sub(b, mesh->positions[corners[2]], mesh->positions[corners[0]]);
	vec_cross(cross, a, b);
	return 0.5 * (double)vec_length(cross);
}

double closed_surface_cell(double asked_m, double area, uint32_t triangles, double longest_m)
{
	const double alike = sqrt(CLOSED_SURFACE_TRIANGLES * area / fmax(1, triangles));

	if (asked_m > 0)
		return asked_m;
	return fmax(longest_m / most_cubes, fmin(longest_m / least_cubes, alike));
}

static int choose_cell(struct closing *closing, double cell_m)
{
	const struct mesh *mesh = closing->mesh;
	float low[3], high[3];

	mesh_box(mesh, low, high);
	for (int k = 0; k < 3; k++)
		closing->longest = vec_most(closing->longest, high[k] - low[k]);
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		closing->area += area_of(mesh, t);
		spill_pass(t);
	}
	if (!(closing->area > 0))
		return diagnostics_add(closing->diagnostics, -EINVAL, NULL, 0,
				       "surface = octree: the scans have no area; export them "
				       "again, or remove the line");
	cell_m = closed_surface_cell(cell_m, closing->area, mesh->triangle_count,
				     (double)closing->longest);
	if ((double)closing->longest / cell_m > ldexp(1, RECONSTRUCT_DEPTH_MAX))
		return diagnostics_add(closing->diagnostics, -EINVAL, NULL, 0,
				       "cell_mm = %g makes over %d cubes along the longest side of "
				       "%g m: write a larger one, or correct the unit",
				       1000 * cell_m, 1 << RECONSTRUCT_DEPTH_MAX,
				       (double)closing->longest);
	closing->report->cell_m = closing->field.cell = cell_m;
	for (int k = 0; k < 3; k++)
		closing->field.origin[k] = (double)low[k] - margin * cell_m;
	return 0;
}

/* ---- the shells */

static int turn_shells(struct closing *closing)
{
	struct closed_surface_report *report = closing->report;
	uint8_t *turned = spill_alloc(closing->mesh->triangle_count + (size_t)1);
	struct mesh_shells shells = { 0 };
	int rc = turned ? mesh_shells_find(&shells, closing->mesh) : -errno;

	report->shells = shells.count;
	if (rc == 0)
		rc = mesh_shells_judge(turned, &report->turned_shells, &shells, closing->mesh,
				       &closing->tree, 0.01f * (float)closing->field.cell);
	mesh_shells_finish(&shells);
	if (rc == 0 && report->turned_shells > 0)
		rc = triangle_tree_turn(&closing->tree, turned);
	spill_free(turned);
	return rc;
}

/* ---- what the surface leaves out */

struct shares {
	const struct closing *closing;
	uint32_t step;
	double inner[64], sheet[64], all[64]; /* areas, of each worker */
};

/* Looks half a cube before and behind some triangles. */
static int look_at_triangles(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	struct shares *shares = user;
	const struct triangle_tree *tree = &shares->closing->tree;
	const float away = 0.5f * (float)shares->closing->field.cell;

	for (uint32_t i = first; i < after; i++) {
		const float(*corners)[3] = tree->corners[i * shares->step];
		float a[3], b[3], normal[3], front[3], back[3], area;
		int inside;

		vec_sub(a, corners[1], corners[0]);
		vec_sub(b, corners[2], corners[0]);
		vec_cross(normal, a, b);
		area = vec_normalise(normal);
		for (int k = 0; k < 3; k++) {
			const float middle = (corners[0][k] + corners[1][k] + corners[2][k]) / 3;

			front[k] = middle + away * normal[k];
			back[k] = middle - away * normal[k];
		}
		inside = (triangle_tree_winding(tree, front) > 0.5) +
			 (triangle_tree_winding(tree, back) > 0.5);
		shares->all[worker] += (double)area;
		shares->inner[worker] += inside == 2 ? (double)area : 0;
		shares->sheet[worker] += inside == 0 ? (double)area : 0;
	}
	return 0;
}

static int judge_shares(struct closing *closing)
{
	struct shares shares = { .closing = closing,
				 .step = (closing->tree.triangle_count - 1) / TRIED_TRIANGLES + 1 };
	struct closed_surface_report *report = closing->report;
	double inner = 0, sheet = 0, all = 0;
	const int rc = parallel_ranges(parallel_cores(),
				       (closing->tree.triangle_count - 1) / shares.step + 1,
				       RANGE_TRIED, look_at_triangles, &shares);

	for (int i = 0; i < 64; i++) {
		inner += shares.inner[i];
		sheet += shares.sheet[i];
		all += shares.all[i];
	}
	report->inner_share = all > 0 ? inner / all : 0;
	report->sheet_share = all > 0 ? sheet / all : 0;
	return rc;
}

/* ---- all of it */

static int draw(struct closing *closing, struct mesh *out)
{
	const struct cube_surface_options open = { .is_closed = false };
	const struct coarse_fill none = { 0 };
	struct closed_surface_report *report = closing->report;
	int rc = closed_field_fill(&closing->field, &closing->tree);

	if (rc == 0)
		rc = cube_surface_draw(out, &closing->field, &none, &open);
	corner_field_finish(&closing->field);
	if (rc == 0 && out->triangle_count == 0)
		return diagnostics_add(closing->diagnostics, -EINVAL, NULL, 0,
				       "surface = octree: the scans enclose nothing that cubes of "
				       "%g mm can show; write a smaller cell_mm, or remove the "
				       "line",
				       1000 * report->cell_m);
	if (rc == 0)
		rc = mesh_parts_drop(out, small_share, true, &report->dropped_parts);
	if (rc == 0)
		rc = mesh_parts_count(out, &report->parts);
	if (rc == 0)
		rc = scan_transfer(out, closing->mesh, &closing->tree, (float)report->cell_m);
	return rc;
}

static int close_mesh(struct closing *closing, struct mesh *out, double cell_m)
{
	int rc = choose_cell(closing, cell_m);

	if (rc == 0)
		rc = triangle_tree_init(&closing->tree, closing->mesh);
	if (rc == 0)
		rc = turn_shells(closing);
	if (rc == 0)
		rc = judge_shares(closing);
	if (rc == 0)
		rc = draw(closing, out);
	return rc;
}

int closed_surface_make(struct mesh *mesh, double cell_m, struct closed_surface_report *report,
			struct diagnostics *diagnostics)
{
	struct closing closing = { .mesh = mesh, .report = report, .diagnostics = diagnostics };
	struct mesh made = { 0 };
	int rc;

	*report = (struct closed_surface_report){ 0 };
	rc = mesh_drop_copies(mesh, &report->copies);
	report->triangles = mesh->triangle_count;
	if (rc == 0)
		rc = close_mesh(&closing, &made, cell_m);
	triangle_tree_finish(&closing.tree);
	corner_field_finish(&closing.field);
	if (rc == 0) {
		mesh_finish(mesh);
		*mesh = made;
	} else {
		mesh_finish(&made);
	}
	if (rc < 0 && rc != -EINVAL)
		diagnostics_add(diagnostics, rc, NULL, 0,
				"surface = octree: %s; write a larger cell_mm, or set TMPDIR to a "
				"larger disk",
				strerror(-rc));
	return rc;
}
