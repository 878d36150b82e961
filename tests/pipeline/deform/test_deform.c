/* Leaning and bent pillars made straight, bends without cracks, folds and bad files refused. */
#include "pipeline/deform/deform.h"

#include <errno.h>
#include <math.h>

#include "format/picture.h"
#include "pipeline/deform/bend_split.h"
#include "pipeline/deform/lattice_step.h"
#include "pipeline/deform/mesh_obj.h"
#include "pipeline/deform/surface_warp.h"
#include "pipeline/import/import.h"
#include "tests/check.h"
#include "tests/pipeline/import/scan_text.h"
#include "tests/pipeline/shapes.h"

enum { SIDES = 12, RINGS = 9, JOBS = 3 };

/* A closed pillar 4 high; lean(z) says how far its axis is off at z. */
static struct mesh pillar(float (*lean)(float z))
{
	struct mesh mesh;
	uint32_t foot, head;

	shape_room(&mesh, SIDES * RINGS + 2, 2 * SIDES * RINGS);
	for (uint32_t r = 0; r < RINGS; r++)
		for (uint32_t s = 0; s < SIDES; s++) {
			const float z = 4.0f * (float)r / (RINGS - 1),
				    turn = 6.2831853f * (float)s / SIDES;

			shape_vertex(&mesh, 0.5f * cosf(turn) + lean(z), 0.5f * sinf(turn), z);
		}
	foot = shape_vertex(&mesh, lean(0), 0, 0);
	head = shape_vertex(&mesh, lean(4), 0, 4);
	for (uint32_t s = 0; s < SIDES; s++) {
		const uint32_t next = (s + 1) % SIDES, top = (RINGS - 1) * SIDES;

		shape_triangle(&mesh, foot, next, s);
		shape_triangle(&mesh, head, top + s, top + next);
		for (uint32_t r = 0; r + 1 < RINGS; r++) {
			const uint32_t a = r * SIDES + s, b = r * SIDES + next;

			shape_triangle(&mesh, a, b, a + SIDES);
			shape_triangle(&mesh, b, b + SIDES, a + SIDES);
		}
	}
	return mesh;
}

static float leans(float z)
{
	return 0.1f * z;
}

static float bends(float z)
{
	return 0.05f * z * z;
}

/* Deforms a mesh as JSON says. message gets the first diagnostic, without the folder. */
static int run(struct mesh *mesh, const char *json, struct deform_report *report,
	       char message[DIAGNOSTIC_BYTES])
{
	struct diagnostics diagnostics = { 0 };
	struct deform_plan plan;
	char path[256];
	int rc;

	scan_write(path, "bend.json", json, strlen(json));
	rc = deform_plan_read(&plan, path, &diagnostics);
	if (rc == 0)
		rc = deform(mesh, &plan, path, JOBS, report, &diagnostics);
	snprintf(message, DIAGNOSTIC_BYTES, "%s",
		 rc < 0 ? strrchr(diagnostics_cause(&diagnostics, rc), '/') : "");
	deform_plan_finish(&plan);
	scan_remove(path);
	return rc;
}

static struct deform_report deformed(struct mesh *mesh, const char *json)
{
	char message[DIAGNOSTIC_BYTES];
	struct deform_report report;

	if (run(mesh, json, &report, message) < 0)
		fail_msg("%s", message);
	return report;
}

/* How far the vertices of a pillar's mantle are from a radius of 0.5 about the z axis at most. */
static double off_axis(const struct mesh *mesh)
{
	double worst = 0;

	for (uint32_t v = 0; v < SIDES * RINGS; v++)
		worst = fmax(worst, fabs(hypot((double)mesh->positions[v][0],
					       (double)mesh->positions[v][1]) -
					 0.5));
	return worst;
}

static void keeps_every_bit_if_no_point_moves(void **state)
{
	struct mesh mesh = pillar(bends), same = pillar(bends);
	struct deform_report report;
	(void)state;

	report = deformed(&mesh,
			  "{\"steps\": [{\"lattice\": [2, 3, 4], \"moves\": ["
			  "{\"points\": [\"all\", 1, 2], \"level\": 1, \"by\": [0, 0, 0]}]}]}");
	CHECK(mesh.vertex_count == same.vertex_count && mesh.triangle_count == same.triangle_count);
	CHECK(memcmp(mesh.positions, same.positions, same.vertex_count * sizeof(*same.positions)) ==
	      0);
	CHECK(report.before.volume == report.after.volume && report.least_growth == 1.0 &&
	      report.most_growth == 1.0);
	mesh_finish(&mesh);
	mesh_finish(&same);
}

/* The lattice's point k lies at z = k, so it goes back by what the pillar leans there. */
static void makes_a_leaning_pillar_upright_without_new_triangles(void **state)
{
	char json[1200] = "{\"steps\": [{\"lattice\": [1, 1, 4], \"moves\": [";
	struct mesh mesh = pillar(leans);
	const uint32_t triangles = mesh.triangle_count;
	struct deform_report report;
	(void)state;

	for (int k = -1; k <= 5; k++)
		snprintf(json + strlen(json), sizeof(json) - strlen(json),
			 "{\"points\": [\"all\", [-1, 2], %d], \"by\": [%g, 0, 0]}%s", k, -0.1 * k,
			 k < 5 ? "," : "]}]}");
	CHECK(off_axis(&mesh) > 0.3);
	report = deformed(&mesh, json);
	CHECK(off_axis(&mesh) < 1e-6);
	CHECK(mesh.triangle_count == triangles);
	CHECK(fabs(report.after.volume - report.before.volume) < 1e-6);
	CHECK(report.before.border_edges == 0 && report.after.border_edges == 0);
	CHECK(fabs(report.length_before[2] - 4) < 1e-9);
	CHECK(fabs(report.length_after[2] - 4 * sqrt(1.01)) <
	      1e-9); /* the box's middle leans now */
	mesh_finish(&mesh);
}

/* Control points of z * z on a grid of distance 1 are k * k - 1/3. */
static void makes_a_bent_pillar_straight_within_the_tolerance(void **state)
{
	char json[1200] =
		"{\"tolerance\": 0.002, \"steps\": [{\"lattice\": [1, 1, 4], \"moves\": [";
	struct mesh mesh = pillar(bends);
	const uint32_t triangles = mesh.triangle_count;
	struct deform_report report;
	double worst = 0;
	(void)state;

	for (int k = -1; k <= 5; k++)
		snprintf(json + strlen(json), sizeof(json) - strlen(json),
			 "{\"points\": [\"all\", \"all\", %d], \"by\": [%.9f, 0, 0]}%s", k,
			 -0.05 * (k * k - 1 / 3.0), k < 5 ? "," : "]}]}");
	report = deformed(&mesh, json);
	CHECK(off_axis(&mesh) < 1e-6);
	/* A ring's distance of 0.5 bends by 0.05 * 0.5^2 / 4 = 0.003, so edges are halved once. */
	CHECK(mesh.triangle_count > triangles && mesh.triangle_count <= 4 * triangles);
	CHECK(report.after.border_edges == 0);
	for (uint32_t v = SIDES * RINGS + 2; v < mesh.vertex_count; v++)
		worst = fmax(worst, fabs((double)mesh.positions[v][0]) - 0.5);
	CHECK(worst < 0.0035); /* the middle of a chord that had bent so far before */
	mesh_finish(&mesh);
}

/* Twelve stones, whose faces share no vertices: neighbours are known by place only. */
static struct mesh loose_box(void)
{
	struct mesh box, mesh;

	shape_room(&box, 8, 12);
	shape_add_box(&box, 0, 0, 0, 4);
	shape_room(&mesh, 36, 12);
	for (uint32_t t = 0; t < 12; t++) {
		for (int k = 0; k < 3; k++) {
			const float *p = box.positions[box.triangles[t][k]];

			shape_vertex(&mesh, p[0], p[1], p[2]);
		}
		shape_triangle(&mesh, 3 * t, 3 * t + 1, 3 * t + 2);
	}
	mesh_finish(&box);
	return mesh;
}

/* Every edge, once divided, goes where space goes within the tolerance, at places that the splitter
 * did not look at. */
static void divides_only_where_it_bends_and_without_cracks(void **state)
{
	static const double low[3] = { 0, 0, 0 }, high[3] = { 4, 4, 4 };
	struct deform_move move = {
		.kind = DEFORM_BY, .first = { 6, 6, 8 }, .last = { 6, 6, 8 }, .place = { 0, 0, 0.6 }
	};
	struct deform_step step = { .cells = { 8, 8, 8 }, .moves = &move, .move_count = 1 };
	struct control_lattice lattice;
	struct mesh_measure measure;
	struct mesh mesh = loose_box();
	struct warp warp;
	uint32_t far = 0;
	double worst = 0;
	(void)state;

	CHECK(lattice_step_make(&lattice, &step, low, high) == 0);
	warp = lattice_warp(&lattice);
	CHECK(bend_split(&mesh, &warp, 0.01, 100000, JOBS) == 0);
	CHECK(mesh.triangle_count > 100 && mesh.triangle_count < 4000);
	CHECK(mesh_measure(&measure, &mesh, JOBS) == 0);
	CHECK(measure.border_edges == 0 && fabs(measure.volume - 64) < 1e-9);
	for (uint32_t t = 0; t < mesh.triangle_count; t++) {
		double from[3] = { 0 }, flat[3] = { 0 }, to[3];
		bool is_far = true;

		for (int v = 0; v < 3; v++) {
			const float *p = mesh.positions[mesh.triangles[t][v]];
			const double corner[3] = { (double)p[0], (double)p[1], (double)p[2] };
			const double share = v == 0 ? 0.6 : v == 1 ? 0.3 : 0.1;

			warp.place(warp.data, corner, to, NULL);
			is_far = is_far && p[2] < 2.5f;
			for (int k = 0; k < 3; k++) {
				from[k] += share * corner[k];
				flat[k] += share * to[k];
			}
		}
		far += is_far;
		warp.place(warp.data, from, to, NULL);
		worst = fmax(worst, fabs(to[2] - flat[2]));
	}
	print_message("%u triangles, %u of them far from the bend; %.4f off at most\n",
		      mesh.triangle_count, far, worst);
	CHECK(worst < 0.02);
	CHECK(far < 150); /* the move reaches z = 3; below, edges are halved for neighbours only */
	CHECK(bend_split(&mesh, &warp, 1e-5, 20000, JOBS) == -EFBIG);
	mesh_finish(&mesh);
	control_lattice_finish(&lattice);
}

static void wave(const void *data, const double from[3], double to[3], double jacobian[3][3])
{
	(void)data;
	(void)jacobian;
	to[0] = from[0];
	to[1] = from[1];
	to[2] = from[2] + sin(40 * from[0]);
}

static double no_bound(const void *data, const double low[3], const double high[3], double *grain)
{
	(void)data;
	(void)low;
	(void)high;
	*grain = INFINITY;
	return INFINITY;
}

/* At a million, floats are 1/16 apart. */
static void refuses_to_divide_what_floats_cannot(void **state)
{
	const struct warp warp = { .place = wave, .bound = no_bound };
	struct mesh mesh;
	(void)state;

	shape_room(&mesh, 3, 1);
	shape_vertex(&mesh, 1e6f, 0, 0);
	shape_vertex(&mesh, 1e6f + 1, 0, 0);
	shape_vertex(&mesh, 1e6f, 1, 0);
	shape_triangle(&mesh, 0, 1, 2);
	CHECK(bend_split(&mesh, &warp, 1e-3, 100000, JOBS) == -EDOM);
	mesh_finish(&mesh);
}

static void moves_places_the_same_when_it_is_refined(void **state)
{
	static const double low[3] = { -1, 2, 0 }, high[3] = { 1, 3, 5 };
	static const uint32_t cells[3] = { 2, 1, 3 };
	struct control_lattice coarse, fine;
	(void)state;

	CHECK(control_lattice_init(&coarse, low, high, cells) == 0);
	CHECK(control_lattice_init(&fine, low, high, cells) == 0);
	srand(3);
	for (int p = 0; p < 5 * 4 * 6; p++) {
		const int at[3] = { p % 5 - 1, p / 5 % 4 - 1, p / 20 - 1 };

		for (int k = 0; k < 3; k++)
			control_lattice_move(&coarse, at)[k] = control_lattice_move(&fine, at)[k] =
				(double)rand() / RAND_MAX;
	}
	CHECK(control_lattice_refine(&fine) == 0 && fine.cells[2] == 6);
	for (int i = 0; i < 500; i++) {
		double place[3], a[3], b[3], slope_a[3][3], slope_b[3][3], near_a[3];

		for (int k = 0; k < 3; k++) /* some places lie beyond the box */
			place[k] = low[k] + (1.2 * rand() / RAND_MAX - 0.1) * (high[k] - low[k]);
		control_lattice_displace(&coarse, place, a, slope_a);
		control_lattice_displace(&fine, place, b, slope_b);
		for (int k = 0; k < 3; k++) {
			const double kept = place[k];

			place[k] += 1e-6;
			control_lattice_displace(&coarse, place, near_a, NULL);
			place[k] = kept;
			for (int c = 0; c < 3; c++) {
				CHECK(fabs(a[c] - b[c]) < 1e-12);
				CHECK(fabs(slope_a[c][k] - slope_b[c][k]) < 1e-10);
				CHECK(fabs((near_a[c] - a[c]) / 1e-6 - slope_a[c][k]) < 1e-4);
			}
		}
	}
	for (int refined = 0; refined < 5; refined++)
		CHECK(control_lattice_refine(&fine) == (refined < 3 ? 0 : -EFBIG));
	control_lattice_finish(&coarse);
	control_lattice_finish(&fine);
}

/* Fine moves before coarse ones, or after them; and a turn that is undone. */
static void takes_levels_in_any_order(void **state)
{
	static const char *const orders[2] = {
		"{\"steps\": [{\"lattice\": [1, 1, 2], \"moves\": ["
		"{\"points\": [0, 0, 1], \"by\": [0.1, 0, 0.2]},"
		"{\"points\": [[1, 2], 1, 3], \"level\": 1, \"by\": [0, 0.05, 0]}]}]}",
		"{\"steps\": [{\"lattice\": [1, 1, 2], \"moves\": ["
		"{\"points\": [[1, 2], 1, 3], \"level\": 1, \"by\": [0, 0.05, 0]},"
		"{\"points\": [0, 0, 1], \"by\": [0.1, 0, 0.2]}]}]}",
	};
	static const char turned[] =
		"{\"steps\": ["
		"{\"lattice\": [1, 1, 1], \"moves\": [{\"points\": [\"all\", \"all\", \"all\"],"
		"\"turn\": {\"degrees\": 30, \"axis\": [0, 2, 0], \"about\": [1, 0, 0]}}]},"
		"{\"lattice\": [1, 1, 1], \"moves\": [{\"points\": [\"all\", \"all\", \"all\"],"
		"\"turn\": {\"degrees\": -30, \"axis\": [0, 2, 0], \"about\": [1, 0, 0]}}]}]}";
	struct mesh a = pillar(leans), b = pillar(leans), c = pillar(leans);
	(void)state;

	deformed(&a, orders[0]);
	deformed(&b, orders[1]);
	CHECK(a.vertex_count == b.vertex_count &&
	      memcmp(a.positions, b.positions, a.vertex_count * sizeof(*a.positions)) == 0);
	mesh_finish(&b);
	b = pillar(leans);
	deformed(&c, turned);
	for (uint32_t v = 0; v < b.vertex_count; v++)
		CHECK(hypot((double)(c.positions[v][0] - b.positions[v][0]),
			    (double)(c.positions[v][2] - b.positions[v][2])) < 1e-5);
	mesh_finish(&a);
	mesh_finish(&b);
	mesh_finish(&c);
}

#define ARC                                                                                        \
	"\"points\": [[[-1.41421356, -1.2, 1.41421356], [0, -1.2, 2.82842712],"                    \
	" [1.41421356, -1.2, 1.41421356]], [[-1.41421356, 1.2, 1.41421356],"                       \
	" [0, 1.2, 2.82842712], [1.41421356, 1.2, 1.41421356]]],"                                  \
	" \"weights\": [[1, 0.70710678, 1], [1, 0.70710678, 1]], \"order\": [3, 2]"

/* A relief on a quarter of a cylinder of radius 2 about the y axis. */
static struct mesh warped_relief(uint32_t n)
{
	struct mesh mesh = shape_relief(n);

	for (uint32_t v = 0; v < mesh.vertex_count; v++) {
		float *p = mesh.positions[v];
		const float turn = 0.7f * (p[0] - 1), r = 2 + p[2];

		p[0] = r * sinf(turn);
		p[1] = p[1] - 1;
		p[2] = r * cosf(turn);
	}
	return mesh;
}

/* Lengths along the arc stay, and heights over it become heights over its tangent plane. */
static void lays_a_warped_capture_flat_and_back(void **state)
{
	struct mesh relief = shape_relief(40), mesh = warped_relief(40), same = warped_relief(40);
	const uint32_t vertices = mesh.vertex_count;
	struct deform_report report;
	double worst[2] = { 0, 0 };
	(void)state;

	report = deformed(&mesh, "{\"tolerance\": 0.01, \"steps\": [{\"surface\": {" ARC
				 ", \"way\": \"flat\"}}]}");
	for (uint32_t v = 0; v < vertices; v++) {
		const float *p = mesh.positions[v], *q = relief.positions[v];
		const float wanted[3] = { 1.4f * (q[0] - 1), q[1] - 1, 2 + q[2] };

		for (int k = 0; k < 3; k++)
			worst[0] = fmax(worst[0], fabs((double)(p[k] - wanted[k])));
	}
	CHECK(report.least_growth > 0.9 && report.most_growth < 1.1);
	deformed(&mesh,
		 "{\"tolerance\": 0.01, \"steps\": [{\"surface\": {" ARC ", \"way\": \"onto\"}}]}");
	for (uint32_t v = 0; v < vertices; v++)
		for (int k = 0; k < 3; k++)
			worst[1] =
				fmax(worst[1],
				     fabs((double)(mesh.positions[v][k] - same.positions[v][k])));
	print_message("flat within %.5f, and back within %.5f\n", worst[0], worst[1]);
	CHECK(worst[0] < 1e-3 && worst[1] < 1e-3);
	mesh_finish(&relief);
	mesh_finish(&mesh);
	mesh_finish(&same);
}

/* What lies beyond its rim, or beyond its axis, has no place over the surface. */
static void refuses_a_surface_that_ends_too_early(void **state)
{
	struct mesh mesh = warped_relief(10);
	char message[DIAGNOSTIC_BYTES];
	struct deform_report report;
	(void)state;

	for (uint32_t v = 0; v < mesh.vertex_count; v++)
		mesh.positions[v][1] += 1;
	CHECK(run(&mesh, "{\"steps\": [\n{\"surface\": {" ARC ", \"way\": \"flat\"}}]}", &report,
		  message) == -EDOM);
	CHECK(strstr(message, "bend.json:2: the scan would fold over at ") &&
	      strstr(message, " of row 1: the surface ends"));
	mesh_finish(&mesh);
}

/* A dome cannot be flattened without stretching something, a cylinder can. */
static void stretches_a_dome_as_little_as_it_can(void **state)
{
	static const float flat_knots[] = { 0, 0, 0, 1, 1, 1 };
	float points[27];
	const struct nurbs_surface surface = { { { 3, 3, flat_knots }, { 3, 3, flat_knots } },
					       points,
					       NULL };
	struct surface_warp *warp;
	double least, most;
	(void)state;

	for (int i = 0; i < 9; i++) {
		points[3 * i] = (float)(i % 3);
		points[3 * i + 1] = (float)(i / 3);
		points[3 * i + 2] = i == 4 ? 1.2f : 0;
	}
	CHECK(surface_warp_create(&warp, &surface, true) == 0);
	surface_warp_stretch(warp, &least, &most);
	print_message("dome: %.3f to %.3f\n", least, most);
	CHECK(least > 0.9 && most < 1.1 && most > 1.005);
	surface_warp_destroy(warp);
	for (int i = 0; i < 9; i++)
		points[3 * i + 2] = i % 3 == 1 ? 1.2f : 0;
	CHECK(surface_warp_create(&warp, &surface, true) == 0);
	surface_warp_stretch(warp, &least, &most);
	CHECK(least > 0.9999 && most < 1.0001);
	surface_warp_destroy(warp);
	memset(points, 0, sizeof(points));
	CHECK(surface_warp_create(&warp, &surface, true) == -EDOM && !warp);
}

/* The head goes below the foot. */
static void refuses_to_fold_over_and_names_the_point(void **state)
{
	struct mesh mesh = pillar(leans);
	char message[DIAGNOSTIC_BYTES];
	struct deform_report report;
	int rc;
	(void)state;

	rc = run(&mesh,
		 "{\"steps\": [{\"lattice\": [1, 1, 4], \"moves\": [\n"
		 "{\"points\": [0, 0, 0], \"by\": [0.01, 0, 0]},\n"
		 "{\"points\": [\"all\", \"all\", 4], \"by\": [0, 0, -3.5]}]}]}",
		 &report, message);
	print_message("%s\n", message);
	CHECK(rc == -EDOM);
	CHECK(strstr(message, "bend.json:3: the scan would fold over at "));
	CHECK(strstr(message, "4 of level 0 less"));
	mesh_finish(&mesh);
}

/* A square of two triangles, whose corners stay: its middle is pushed over its side. The tolerance
 * lets it be as it is, so no vertex is where it folds. */
static void refuses_a_fold_between_vertices(void **state)
{
	static const char *const pushes[] = { "-8", "-0.5" };
	char message[DIAGNOSTIC_BYTES], json[300];
	(void)state;

	for (int i = 0; i < 2; i++) {
		struct deform_report report;
		struct mesh mesh;
		int rc;

		shape_room(&mesh, 4, 2);
		for (int corner = 0; corner < 4; corner++)
			shape_vertex(&mesh, corner % 2 ? 4 : 0, corner / 2 ? 4 : 0, 0);
		shape_triangle(&mesh, 0, 1, 3);
		shape_triangle(&mesh, 0, 3, 2);
		snprintf(json, sizeof(json),
			 "{\"tolerance\": 1000, \"steps\": [{\"lattice\": [4, 4, 1],\n"
			 "\"box\": {\"low\": [0, 0, -1], \"high\": [4, 4, 1]}, \"moves\": [\n"
			 "{\"points\": [2, 2, \"all\"], \"by\": [%s, 0, 0]}]}]}",
			 pushes[i]);
		rc = run(&mesh, json, &report, message);
		print_message("%s\n", message);
		CHECK(mesh.vertex_count == 4 && rc == (i == 0 ? -EDOM : 0));
		CHECK(i == 1 || strstr(message, "bend.json:3: the scan would fold over at "));
		mesh_finish(&mesh);
	}
}

/* A square over a plane goes over a surface with a valley, between all of its corners, middles and
 * the middles of its edges. Up to a metre over the valley there is room for it, higher it folds. */
static void refuses_a_fold_over_a_valley_between_vertices(void **state)
{
	enum { POINTS = 109 };
	static const float heights[] = { 0.5f, 0.9f, 1.1f, 2 };
	char message[DIAGNOSTIC_BYTES], json[8192];
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(heights); i++) {
		size_t used = (size_t)snprintf(json, sizeof(json),
					       "{\"tolerance\": 1000, \"steps\": [\n{\"surface\": "
					       "{\"way\": \"onto\", \"order\": [3, 2], "
					       "\"points\": [");
		struct deform_report report;
		struct mesh mesh;
		int rc;

		for (int n = 0; n < 2 * POINTS; n++)
			used += (size_t)snprintf(json + used, sizeof(json) - used,
						 "%s[%g, %d, %g]%s", n % POINTS ? "" : "[",
						 n % POINTS * 0.3 - 16.265, n < POINTS ? -6 : 6,
						 n % POINTS == 37 ? -0.045 : 0,
						 n % POINTS < POINTS - 1 ? ", "
						 : n < POINTS            ? "], "
									 : "]");
		snprintf(json + used, sizeof(json) - used, "]}}]}");
		shape_room(&mesh, 4, 2);
		for (int corner = 0; corner < 4; corner++)
			shape_vertex(&mesh, corner % 2 ? 8 : -8, corner / 2 ? 4 : -4, heights[i]);
		shape_triangle(&mesh, 0, 1, 3);
		shape_triangle(&mesh, 0, 3, 2);
		rc = run(&mesh, json, &report, message);
		if (rc != (heights[i] > 1 ? -EDOM : 0))
			fail_msg("at %.1f: %d, %s", (double)heights[i], rc, message);
		if (rc != 0) {
			const char *at = strstr(message, "fold over at ");
			float x;

			CHECK(strstr(message, "bend.json:2:") && at);
			CHECK(sscanf(at, "fold over at %f", &x) == 1 && fabsf(x + 5.165f) < 0.16f);
		}
		mesh_finish(&mesh);
	}
}

/* A textured square with a plain one beside it comes back from its files as it was bent. */
static void textures_go_along(void **state)
{
	static const char obj[] = "mtllib skin.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\n"
				  "v 2 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl skin\n"
				  "f 1/1 2/2 3/3 4/4\nusemtl plain\nf 2/2 5/2 6/3 3/3\n";
	static const char mtl[] = "newmtl skin\nKd 1 1 1\nmap_Kd skin.png\n"
				  "newmtl plain\nKd 0.2 0.4 0.6\n";
	static uint8_t pixels[] = { 255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 9, 9, 9, 255 };
	const struct picture picture = { 2, 2, pixels };
	const struct import_options options = { .jobs = 1 };
	struct diagnostics diagnostics = { 0 };
	struct import_report imported;
	char path[256], out[300], beside[300];
	struct deform_report report;
	struct mesh mesh, back;
	struct buffer png;
	(void)state;

	buffer_init(&png, 1 << 16);
	CHECK(picture_encode_png(&png, &picture) == 0);
	scan_write(path, "square.obj", obj, strlen(obj));
	scan_write_beside(path, "skin.mtl", mtl, strlen(mtl));
	scan_write_beside(path, "skin.png", png.data, png.size);
	CHECK(import_scan(&mesh, path, &options, &imported, &diagnostics) == 0);
	CHECK(imported.textures == 1 && mesh.uvs && mesh.materials);
	report = deformed(&mesh, "{\"tolerance\": 0.01, \"steps\": [{\"lattice\": [2, 1, 1],\n"
				 "\"box\": {\"low\": [0, 0, -1], \"high\": [2, 1, 1]}, "
				 "\"moves\": [{\"points\": [1, \"all\", \"all\"], "
				 "\"by\": [0, 0, 0.6]}]}]}");
	CHECK(report.after.triangles > 4);
	snprintf(out, sizeof(out), "%.*s/bent.obj", (int)(strrchr(path, '/') - path), path);
	CHECK(mesh_obj_write(&mesh, out) == 0);
	CHECK(import_scan(&back, out, &options, &imported, &diagnostics) == 0);
	CHECK(back.triangle_count == mesh.triangle_count && imported.textures == 1);
	for (uint32_t t = 0; t < mesh.triangle_count; t++)
		for (int k = 0; k < 3; k++) {
			const uint32_t a = mesh.triangles[t][k], b = back.triangles[t][k];
			uint8_t was[3], is[3];

			CHECK(memcmp(mesh.positions[a], back.positions[b], 12) == 0);
			mesh_texel(&mesh.textures[mesh.materials[t]], mesh.uvs[a], was);
			mesh_texel(&back.textures[back.materials[t]], back.uvs[b], is);
			CHECK(memcmp(was, is, 3) == 0);
		}
	CHECK(mesh_obj_write(&mesh, "bent.stl") == -EINVAL);
	snprintf(beside, sizeof(beside), "%.*s/gone/bent.obj", (int)(strrchr(path, '/') - path),
		 path);
	CHECK(mesh_obj_write(&mesh, beside) < 0);
	mesh_finish(&mesh);
	mesh_finish(&back);
	buffer_finish(&png);
	scan_remove(path);
}

static void colours_of_vertices_go_along(void **state)
{
	const struct import_options options = { .jobs = 1 };
	struct diagnostics diagnostics = { 0 };
	struct import_report imported;
	char path[256], out[300];
	struct mesh mesh, back;
	(void)state;

	shape_room(&mesh, 3, 1);
	for (int corner = 0; corner < 3; corner++)
		shape_vertex(&mesh, (float)(corner % 2), (float)(corner / 2), 0.5f);
	shape_triangle(&mesh, 0, 1, 2);
	scan_write(path, "other.txt", "", 0); /* for its folder */
	snprintf(out, sizeof(out), "%.*s/bent.obj", (int)(strrchr(path, '/') - path), path);
	CHECK(mesh_obj_write(&mesh, out) == 0);
	CHECK(import_scan(&back, out, &options, &imported, &diagnostics) == 0);
	CHECK(imported.had_colours && back.vertex_count == 3);
	for (int k = 0; k < 3; k++)
		CHECK(memcmp(back.colours[back.triangles[0][k]], mesh.colours[mesh.triangles[0][k]],
			     3) == 0);
	mesh_finish(&mesh);
	mesh_finish(&back);
	scan_remove(path);
}

static void refuses_what_makes_no_sense(void **state)
{
#define STEP(inner)  "{\"steps\": [{" inner "}]}"
#define MOVES(inner) STEP("\"lattice\": [1, 1, 2], \"moves\": [" inner "]")
	static const struct {
		const char *json, *words;
	} cases[] = {
		{ "{\"steps\": [", "JSON" },
		{ "[]", "\"steps\" are missing" },
		{ "{\"steps\": []}", "1 to 64 steps" },
		{ "{\"stops\": []}", "\"stops\" is not one of the keys" },
		{ "{\"tolerance\": 0, \"steps\": [{}]}", "\"tolerance\" must be a length" },
		{ "{\"steps\": [3]}", "\"steps\" must be a list" },
		{ STEP("\"lattice\": [1, 1]"), "\"lattice\" must be the cells" },
		{ STEP("\"lattice\": [1, 0, 1]"), "\"lattice\" must be whole numbers" },
		{ STEP("\"lattice\": [1, 65, 1]"), "\"lattice\" must be whole numbers" },
		{ STEP("\"lattice\": [1, 1, 1]"), "\"moves\" must be a list" },
		{ STEP("\"lattice\": [1, 1, 1], \"box\": {\"low\": [0, 0, 0], \"high\": [1, 0, 1]}"),
		  "\"box\" must be" },
		{ STEP("\"surface\": 1"), "\"surface\" must be" },
		{ STEP("\"surface\": {}, \"moves\": []"), "\"moves\" is not one of the keys" },
		{ STEP("\"surface\": {}"), "\"way\" must be" },
		{ STEP("\"surface\": {\"way\": \"flat\"}"), "\"points\" must be 2 to 256 rows" },
		{ STEP("\"surface\": {\"way\": \"flat\", \"points\": [[[0, 0, 0], [1, 0, 0]], "
		       "[[0, 1, 0]]]}"),
		  "\"points\" must be rows" },
		{ STEP("\"surface\": {\"way\": \"flat\", \"points\": [[[0, 0, 0], [1, 0, 0]], "
		       "[[0, 1, 0], [1, 1, 0]]]}"),
		  "as many along each axis as the order" },
		{ STEP("\"surface\": {\"way\": \"flat\", \"order\": [2, 1], \"points\": "
		       "[[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]]]}"),
		  "\"order\" must be" },
		{ STEP("\"surface\": {\"way\": \"flat\", \"order\": [2, 2], \"points\": "
		       "[[[0, 0, 0], [1, 0, 1], [2, 0, 0]], [[0, 1, 0], [1, 1, 1], [2, 1, 0]]]}"),
		  "straight pieces meet in creases" },
		{ STEP("\"surface\": {\"way\": \"flat\", \"weights\": [[1, 1], [1, 0]], "
		       "\"points\": [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]]]}"),
		  "\"weights\" must be" },
		{ MOVES("1"), "\"moves\" must be a list" },
		{ MOVES("{\"points\": [0, 0, 0]}"), "exactly one" },
		{ MOVES("{\"points\": [0, 0, 0], \"by\": [0, 0, 0], \"to\": [0, 0, 0]}"),
		  "exactly one" },
		{ MOVES("{\"points\": [0, 0, 4], \"by\": [0, 0, 0]}"), "points -1 to 2, 2 and 3" },
		{ MOVES("{\"points\": [0, 0.5, 1], \"by\": [0, 0, 0]}"), "\"points\" must be" },
		{ MOVES("{\"points\": [0, [1, 0], 1], \"by\": [0, 0, 0]}"), "\"points\" must be" },
		{ MOVES("{\"points\": [0, 0, \"some\"], \"by\": [0, 0, 0]}"),
		  "\"points\" must be" },
		{ MOVES("{\"points\": [0, 0, 0], \"level\": 6, \"by\": [0, 0, 0]}"), "too high" },
		{ MOVES("{\"points\": [0, 0, 0], \"level\": 7, \"by\": [0, 0, 0]}"), "0 to 6" },
		{ MOVES("{\"points\": [0, 0, 0], \"by\": [1e10, 0, 0]}"), "\"by\" must be three" },
		{ MOVES("{\"points\": [0, 0, 0], \"turn\": {\"degrees\": 1, \"about\": [0, 0, 0], "
			"\"axis\": [0, 0, 0]}}"),
		  "\"axis\" has no length" },
		{ MOVES("{\"points\": [0, 0, 0], \"turn\": {\"degrees\": 1, \"axis\": [0, 0, 1]}}"),
		  "\"about\" must be" },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct mesh mesh = { 0 };
		char message[DIAGNOSTIC_BYTES];
		struct deform_report report;

		CHECK(run(&mesh, cases[i].json, &report, message) < 0);
		if (!strstr(message, cases[i].words) || !strstr(message, "bend.json:"))
			fail_msg("case %zu: %s", i, message);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(keeps_every_bit_if_no_point_moves),
		cmocka_unit_test(makes_a_leaning_pillar_upright_without_new_triangles),
		cmocka_unit_test(makes_a_bent_pillar_straight_within_the_tolerance),
		cmocka_unit_test(divides_only_where_it_bends_and_without_cracks),
		cmocka_unit_test(refuses_to_divide_what_floats_cannot),
		cmocka_unit_test(moves_places_the_same_when_it_is_refined),
		cmocka_unit_test(takes_levels_in_any_order),
		cmocka_unit_test(lays_a_warped_capture_flat_and_back),
		cmocka_unit_test(refuses_a_surface_that_ends_too_early),
		cmocka_unit_test(stretches_a_dome_as_little_as_it_can),
		cmocka_unit_test(refuses_to_fold_over_and_names_the_point),
		cmocka_unit_test(refuses_a_fold_between_vertices),
		cmocka_unit_test(refuses_a_fold_over_a_valley_between_vertices),
		cmocka_unit_test(textures_go_along),
		cmocka_unit_test(colours_of_vertices_go_along),
		cmocka_unit_test(refuses_what_makes_no_sense),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
