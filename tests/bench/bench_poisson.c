/* What the comparison with Poisson reconstruction needs (poisson.sh):
 *
 *   bench_poisson views TEMPLE FOLDER NOISE_M
 *       range images of a part of the demo temple, as FOLDER/view-N.ply and site.aln
 *   bench_poisson points ALIGNMENT OUT EVERY
 *       every EVERY-th of the oriented points of aligned scans, six doubles each; prints how many
 *       and about how far apart they are
 *   bench_poisson compare MESH POINTS METRES REACH_M
 *       how far such points lie from a mesh whose unit is METRES long, and which share of the mesh
 *       lies farther than REACH_M from all of them; the inside of a JSON object */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "pipeline/import/alignment.h"
#include "pipeline/import/import.h"
#include "pipeline/octree/range_scan.h"
#include "pipeline/octree/reconstruct.h"
#include "tests/bench/surface_error.h"
#include "tests/pipeline/octree/bumpy_ball.h"

/* ---- views */

enum { GRID = 170, VIEWS = 9 };

/* The top of the middle tower; what is farther from it in any direction is left away. */
static const double centre[3] = { 0, 0, 15.5 }, half_m = 4.2, step_m = 0.05;
/* Views of bumpy_ball.h that do not look from below. */
static const int views[VIEWS] = { 0, 1, 2, 3, 4, 6, 8, 10, 12 };

struct image {
	struct transform view; /* from the file's axes to the common ones */
	double depths[GRID * GRID];
	bool is_back[GRID * GRID]; /* the nearest face shows its back */
};

static double pixel_at(int i)
{
	return (i + 0.5) * step_m - GRID * step_m / 2;
}

/* Keeps what is nearest to the scanner, which is at +z. */
static void draw_triangle(struct image *image, const double corners[3][3])
{
	const double *a = corners[0], *b = corners[1], *c = corners[2];
	const double twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
	int low[2], high[2];

	for (int k = 0; k < 2; k++) {
		const double least = fmin(a[k], fmin(b[k], c[k]));
		const double most = fmax(a[k], fmax(b[k], c[k]));

		low[k] = (int)fmax(0, floor((least + GRID * step_m / 2) / step_m - 0.5));
		high[k] = (int)fmin(GRID - 1, ceil((most + GRID * step_m / 2) / step_m - 0.5));
	}
	for (int y = low[1]; y <= high[1] && twice != 0; y++)
		for (int x = low[0]; x <= high[0]; x++) {
			const double p[2] = { pixel_at(x), pixel_at(y) };
			const double u =
				((p[0] - a[0]) * (c[1] - a[1]) - (p[1] - a[1]) * (c[0] - a[0])) /
				twice;
			const double v =
				((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])) /
				twice;
			const double depth = a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]);

			if (u < 0 || v < 0 || u + v > 1 || depth < image->depths[y * GRID + x])
				continue;
			image->depths[y * GRID + x] = depth;
			image->is_back[y * GRID + x] = twice < 0;
		}
}

static void draw_image(struct image *image, const struct mesh *mesh)
{
	for (int i = 0; i < GRID * GRID; i++)
		image->depths[i] = -INFINITY;
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		double corners[3][3];
		bool is_in = true;

		for (int i = 0; i < 3; i++) {
			double from[3];

			for (int k = 0; k < 3; k++) {
				from[k] = (double)mesh->positions[mesh->triangles[t][i]][k] -
					  centre[k];
				is_in &= fabs(from[k]) < half_m;
			}
			for (int k = 0; k < 3; k++) {
				corners[i][k] = 0;
				for (int j = 0; j < 3; j++)
					corners[i][k] += image->view.rows[j][k] * from[j];
			}
		}
		if (is_in)
			draw_triangle(image, (const double(*)[3])corners);
	}
}

static void write_image(const struct image *image, const char *path, double noise_m)
{
	FILE *file = need(fopen(path, "wb"));

	fprintf(file,
		"ply\nformat binary_little_endian 1.0\nobj_info num_cols %d\nobj_info num_rows %d\n"
		"element vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
		"end_header\n",
		GRID, GRID, GRID * GRID);
	for (int i = 0; i < GRID * GRID; i++) {
		const bool is_seen = isfinite(image->depths[i]) && !image->is_back[i];
		const float place[3] = {
			(float)pixel_at(i % GRID), (float)pixel_at(i / GRID),
			is_seen ? (float)(image->depths[i] + noise_m * ball_noise()) : NAN
		};

		fwrite(place, sizeof(place), 1, file);
	}
	if (fclose(file) != 0)
		need_ok(-errno, path);
}

static void write_views(const char *temple, const char *folder, double noise_m)
{
	const struct import_options options = { .metres_per_unit = 1 };
	struct image *image = need(calloc(1, sizeof(*image)));
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	char path[4096];
	FILE *site;
	const int rc = import_scan(&mesh, temple, &options, NULL, &diagnostics);

	need_ok(rc, diagnostics_cause(&diagnostics, rc));
	snprintf(path, sizeof(path), "%s/site.aln", folder);
	site = need(fopen(path, "w"));
	fprintf(site, "%d\n", VIEWS);
	srand(1);
	for (int v = 0; v < VIEWS; v++) {
		image->view = ball_view(views[v]);
		draw_image(image, &mesh);
		snprintf(path, sizeof(path), "%s/view-%d.ply", folder, v);
		write_image(image, path, noise_m);
		fprintf(site, "view-%d.ply\n#\n", v);
		for (int i = 0; i < 3; i++)
			fprintf(site, "%.17g %.17g %.17g %.17g\n", image->view.rows[i][0],
				image->view.rows[i][1], image->view.rows[i][2], centre[i]);
		fputs("0 0 0 1\n", site);
	}
	fputs("0\n", site);
	fclose(site);
	mesh_finish(&mesh);
	free(image);
}

/* ---- points */

static void write_points(const char *path, const char *out, uint32_t every)
{
	struct diagnostics diagnostics = { 0 };
	struct alignment alignment;
	uint64_t count = 0;
	double spacing = 0;
	FILE *file = need(fopen(out, "wb"));
	int rc = alignment_read(&alignment, path, &diagnostics);

	for (uint32_t i = 0; i < alignment.count && rc == 0; i++) {
		struct range_scan scan;

		rc = range_scan_read(&scan, alignment.scans[i].path, &alignment.scans[i].transform,
				     RANGE_SIGHT_AUTO, &diagnostics);
		if (rc < 0)
			break;
		for (uint32_t p = 0; p < scan.count; p += every) {
			double row[6];

			for (int k = 0; k < 3; k++) {
				row[k] = scan.points[p].at[k];
				row[3 + k] = (double)scan.points[p].normal[k];
			}
			fwrite(row, sizeof(row), 1, file);
			count++;
		}
		spacing += scan.spacing / alignment.count;
		range_scan_finish(&scan);
	}
	need_ok(rc, diagnostics_cause(&diagnostics, rc));
	alignment_finish(&alignment);
	fclose(file);
	printf("%llu %.9g\n", (unsigned long long)count, spacing * sqrt(every));
}

/* ---- comparing */

static uint32_t read_points(float (**out)[3], const char *path)
{
	FILE *file = need(fopen(path, "rb"));
	uint32_t count = 0, room = 1 << 20;
	double row[6];

	*out = need(malloc(room * sizeof(**out)));
	while (fread(row, sizeof(row), 1, file) == 1) {
		if (count == room) {
			room *= 2;
			*out = need(realloc(*out, room * sizeof(**out)));
		}
		for (int k = 0; k < 3; k++)
			(*out)[count][k] = (float)row[k];
		count++;
	}
	fclose(file);
	return count;
}

static int compare_floats(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

/* Prints RMS, the largest and the 99th percentile, in millimetres. */
static void print_distances(const char *name, float *metres, uint32_t count)
{
	double sum = 0;

	for (uint32_t i = 0; i < count; i++)
		sum += (double)metres[i] * (double)metres[i] / count;
	qsort(metres, count, sizeof(*metres), compare_floats);
	printf(", \"%s_rms_mm\": %.3f, \"%s_p99_mm\": %.3f, \"%s_max_mm\": %.1f", name,
	       1000 * sqrt(sum), name, 1000 * (double)metres[(uint64_t)count * 99 / 100], name,
	       1000 * (double)metres[count - 1]);
}

static void compare(const char *mesh_path, const char *points_path, double metres, double reach_m)
{
	const struct import_options options = { .metres_per_unit = metres };
	struct diagnostics diagnostics = { 0 };
	struct reconstruct_report report = { 0 };
	struct surface surface, cloud;
	struct mesh mesh;
	float(*points)[3], (*spread)[3], *away;
	uint32_t count = read_points(&points, points_path), near = 0;
	const int rc = import_scan(&mesh, mesh_path, &options, NULL, &diagnostics);

	need_ok(rc, diagnostics_cause(&diagnostics, rc));
	need_ok(reconstruct_judge(&mesh, &report), "judging");
	surface = (struct surface){ .positions = mesh.positions,
				    .triangles = mesh.triangles,
				    .triangle_count = mesh.triangle_count };
	surface_index(&surface);
	away = need(malloc((count > POINTS ? count : POINTS) * sizeof(*away)));
	cloud = (struct surface){ .positions = points,
				  .triangles = need(malloc(count * 12ul)),
				  .triangle_count = count };
	for (uint32_t i = 0; i < count; i++) {
		struct nearest_place place;

		for (int k = 0; k < 3; k++) {
			points[i][k] *= (float)metres;
			cloud.triangles[i][k] = i;
		}
		nearest_find(surface.nearest, points[i], NULL, INFINITY, &place);
		away[i] = place.distance_m;
	}
	printf("\"triangles\": %u, \"parts\": %u, \"border_edges\": %u, \"crowded_edges\": %u",
	       mesh.triangle_count, report.parts, report.border_edges, report.crowded_edges);
	print_distances("points", away, count);
	/* back: from the mesh to the points, where it is near some */
	surface_index(&cloud);
	spread = spread_points(&surface);
	for (uint32_t i = 0; i < POINTS; i++) {
		struct nearest_place place;

		if (nearest_find(cloud.nearest, spread[i], NULL, reach_m, &place))
			near++;
	}
	printf(", \"guessed_share\": %.4f", 1 - (double)near / POINTS);
	nearest_destroy(cloud.nearest);
	nearest_destroy(surface.nearest);
	free(cloud.triangles);
	free(spread);
	free(points);
	free(away);
	mesh_finish(&mesh);
}

int main(int argc, char **argv)
{
	if (argc == 5 && strcmp(argv[1], "views") == 0) {
		write_views(argv[2], argv[3], strtod(argv[4], NULL));
	} else if (argc == 5 && strcmp(argv[1], "points") == 0) {
		write_points(argv[2], argv[3], (uint32_t)strtoul(argv[4], NULL, 10));
	} else if (argc == 6 && strcmp(argv[1], "compare") == 0) {
		compare(argv[2], argv[3], strtod(argv[4], NULL), strtod(argv[5], NULL));
	} else {
		fputs("bench_poisson views TEMPLE FOLDER NOISE_M | points ALIGNMENT OUT EVERY | compare "
		      "MESH POINTS METRES REACH_M\n",
		      stderr);
		return 2;
	}
	return EXIT_SUCCESS;
}
