/* Simplifiers compared by what their surfaces look like: feature edges (simplify_features.h),
 * quadrics (simplify.h) and meshoptimizer, at a series of triangle counts.
 *
 *   bench_features furniture|aircraft|FILE [UP_AXIS: z or y] [PICTURE.jpg SHARE VIEW]
 *
 * Appearance is compared as in the paper's Figs. 3-25 to 3-27: pictures from six sides (docs/
 * hierarchy.md defines the difference). Prints JSON; PICTURE shows the scan and the three at a
 * share of its triangles from one of the six sides, side by side. */
#include <errno.h>
#include <math.h>
#include <meshoptimizer.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "format/picture.h"
#include "geometry/vec.h"
#include "pipeline/hierarchy/simplify_features.h"
#include "pipeline/import/import.h"
#include "pipeline/release/nearest.h"
#include "pipeline/samples/raster.h"
#include "tests/bench/built_models.h"
#include "tests/pipeline/on_lattice.h"

enum {
	METHODS = 3,
	VIEWS = 6,
	FINE_PX = 1024, /* two by two of these are a pixel */
	SIDE_PX = FINE_PX / 2,
	CHUNK = 21000, /* triangles that are drawn at once: 16-bit indices */
	ROUNDS = 3     /* of which the fastest counts */
};

static const char *const names[METHODS] = { "features", "quadric", "meshoptimizer" };
static const double shares[] = { 0.5, 0.25, 0.1, 0.05, 0.02, 0.01, 0.005 };
static const double crease_cosine = 0.7; /* of shading: normals are not averaged across more */

static void *need(void *memory)
{
	if (!memory) {
		fputs("out of memory\n", stderr);
		exit(EXIT_FAILURE);
	}
	return memory;
}

static void need_ok(int rc, const char *what)
{
	if (rc < 0) {
		fprintf(stderr, "%s: %s\n", what, strerror(-rc));
		exit(EXIT_FAILURE);
	}
}

/* ---- surfaces: places of the lattice as floats */

struct surface {
	uint32_t vertex_count, triangle_count;
	float (*positions)[3];
	uint8_t (*colours)[4];
	uint32_t (*triangles)[3];
};

static struct surface surface_of(const struct simplify_surface *from)
{
	struct surface to = { from->vertex_count, from->triangle_count, NULL, NULL, NULL };

	to.positions = need(malloc(to.vertex_count * sizeof(*to.positions)));
	to.colours = need(malloc(to.vertex_count * sizeof(*to.colours)));
	to.triangles = need(malloc(to.triangle_count * sizeof(*to.triangles)));
	memcpy(to.triangles, from->triangles, to.triangle_count * sizeof(*to.triangles));
	for (uint32_t v = 0; v < to.vertex_count; v++) {
		memcpy(to.colours[v], from->vertices[v].colour, 4);
		for (int i = 0; i < 3; i++)
			to.positions[v][i] = (float)from->vertices[v].position[i];
	}
	return to;
}

static void surface_finish(struct surface *surface)
{
	free(surface->positions);
	free(surface->colours);
	free(surface->triangles);
}

/* ---- simplifiers */

static double cpu_ms(void)
{
	struct timespec now;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

static struct surface run_ours(const struct lattice_mesh *mesh, int method, uint32_t target,
			       double *ms)
{
	struct simplify_surface surface = { .vertex_count = mesh->vertex_count,
					    .triangle_count = mesh->triangle_count,
					    .fine_bits = mesh->lattice.fine_bits };
	size_t vertex_bytes = mesh->vertex_count * sizeof(*surface.vertices);
	size_t triangle_bytes = mesh->triangle_count * sizeof(*surface.triangles);
	struct simplify_result result;
	struct surface made;
	double start;

	surface.vertices = need(malloc(vertex_bytes));
	surface.triangles = need(malloc(triangle_bytes));
	surface.locked = need(calloc(mesh->vertex_count, 1));
	memcpy(surface.vertices, mesh->vertices, vertex_bytes);
	memcpy(surface.triangles, mesh->triangles, triangle_bytes);
	start = cpu_ms();
	need_ok(method == 0 ? simplify_features(&surface, target, INFINITY, -1.0, &result)
			    : simplify(&surface, target, INFINITY, &result),
		names[method]);
	*ms = fmin(*ms, cpu_ms() - start);
	made = surface_of(&surface);
	free(surface.vertices);
	free(surface.triangles);
	free(surface.locked);
	return made;
}

static struct surface run_theirs(const struct lattice_mesh *mesh, uint32_t target, double *ms)
{
	struct simplify_surface from = { .vertex_count = mesh->vertex_count,
					 .triangle_count = mesh->triangle_count,
					 .vertices = mesh->vertices,
					 .triangles = mesh->triangles };
	struct surface made = surface_of(&from);
	double start = cpu_ms();

	made.triangle_count =
		(uint32_t)(meshopt_simplify(made.triangles[0], mesh->triangles[0],
					    3 * (size_t)mesh->triangle_count, made.positions[0],
					    mesh->vertex_count, sizeof(*made.positions),
					    3 * (size_t)target, 1e9f, 0, NULL) /
			   3);
	*ms = fmin(*ms, cpu_ms() - start);
	return made;
}

static struct surface simplified(const struct lattice_mesh *mesh, int method, uint32_t target,
				 double *ms)
{
	struct surface made = { 0 };

	*ms = INFINITY;
	for (int round = 0; round < ROUNDS; round++) {
		surface_finish(&made);
		made = method < 2 ? run_ours(mesh, method, target, ms)
				  : run_theirs(mesh, target, ms);
	}
	return made;
}

/* ---- pictures */

/* Corners' normals: the mean of those of the triangles around the vertex that face nearly as the
 * corner's, weighted by area. */
static float (*corner_normals(const struct surface *surface))[3]
{
	const uint32_t corners = 3 * surface->triangle_count;
	float(*faces)[3] = need(malloc((surface->triangle_count + 1) * sizeof(*faces)));
	float(*normals)[3] = need(malloc((corners + 1) * sizeof(*normals)));
	struct incidence incidence;

	need_ok(incidence_create(&incidence, surface->triangles, surface->triangle_count,
				 surface->vertex_count),
		"incidence");
	for (uint32_t t = 0; t < surface->triangle_count; t++) {
		const uint32_t *at = surface->triangles[t];
		float ab[3], ac[3];

		vec_sub(ab, surface->positions[at[1]], surface->positions[at[0]]);
		vec_sub(ac, surface->positions[at[2]], surface->positions[at[0]]);
		vec_cross(faces[t], ab, ac);
	}
	for (uint32_t c = 0; c < corners; c++) {
		uint32_t v = surface->triangles[c / 3][c % 3];
		const float *own = faces[c / 3];
		float sum[3] = { 0, 0, 0 }, length;

		for (uint32_t i = incidence.first[v]; i < incidence.first[v + 1]; i++) {
			const float *other = faces[incidence.items[i]];

			if (vec_dot(own, other) >=
			    (float)crease_cosine * vec_length(own) * vec_length(other))
				for (int k = 0; k < 3; k++)
					sum[k] += other[k];
		}
		length = vec_length(sum);
		for (int k = 0; k < 3; k++)
			normals[c][k] = length > 0 ? sum[k] / length : 0;
	}
	incidence_finish(&incidence);
	free(faces);
	return normals;
}

static void draw_surface(struct raster *raster, const struct surface *surface)
{
	static struct model_vertex vertices[3 * CHUNK];
	static uint16_t indices[3 * CHUNK];
	float(*normals)[3] = corner_normals(surface);

	for (uint32_t first = 0; first < surface->triangle_count; first += CHUNK) {
		struct model_mesh mesh = { .vertices = vertices, .indices = indices };

		for (uint32_t t = first; t < surface->triangle_count && t < first + CHUNK; t++)
			for (int corner = 0; corner < 3; corner++) {
				struct model_vertex *to = &vertices[mesh.vertex_count];
				uint32_t v = surface->triangles[t][corner];

				indices[mesh.vertex_count] = (uint16_t)mesh.vertex_count;
				mesh.vertex_count++;
				memcpy(to->position_m, surface->positions[v],
				       sizeof(to->position_m));
				memcpy(to->colour, surface->colours[v], sizeof(to->colour));
				for (int i = 0; i < 3; i++)
					to->normal[i] = (int8_t)lrintf(
						127 * normals[3 * t + (uint32_t)corner][i]);
			}
		mesh.index_count = mesh.vertex_count;
		raster_draw(raster, &mesh);
	}
	free(normals);
}

/* The six sides, each a little to the side and from above or below, so that no wall is seen from
 * its edge only. */
static const float sides[VIEWS][3] = {
	{ -0.9f, -0.35f, 0.25f }, { 0.9f, 0.35f, 0.25f },   { 0.35f, -0.9f, 0.25f },
	{ -0.35f, 0.9f, 0.25f },  { -0.25f, -0.35f, 0.9f }, { 0.25f, -0.35f, -0.9f },
};

/* Light from the eye and a little from above, both sides alike; rgb of what shows nothing is 0. */
static void shade(uint8_t rgb[3], uint32_t surface, uint32_t colour, const float light[3])
{
	float n[3], bright;

	for (int i = 0; i < 3; i++)
		n[i] = ((float)(surface >> (8 * i) & 255) - 127.5f) / 127.5f;
	bright = 0.2f + 0.8f * fabsf(vec_dot(n, light));
	for (int i = 0; i < 3; i++)
		rgb[i] = (uint8_t)lrintf(bright * (float)(colour >> (8 * i) & 255));
}

/* pixels: SIDE_PX x SIDE_PX, rgba; alpha is coverage. */
static void draw_view(struct raster *raster, uint8_t (*pixels)[4], const struct surface *surface,
		      const float centre[3], float radius, int view)
{
	struct camera camera = { .width_px = FINE_PX,
				 .height_px = FINE_PX,
				 .fov_deg = 20,
				 .near_m = radius / 10,
				 .far_m = 20 * radius,
				 .up = { 0, 0, 1 } };
	float length = vec_length(sides[view]), light[3], up = 0.4f;

	for (int i = 0; i < 3; i++) {
		camera.target_m[i] = centre[i];
		camera.eye_m[i] = centre[i] + 5.9f * radius * sides[view][i] / length;
		light[i] = sides[view][i] / length + (i == 2 ? up : 0);
	}
	length = vec_length(light);
	for (int i = 0; i < 3; i++)
		light[i] /= length;
	raster_begin(raster, &camera);
	draw_surface(raster, surface);
	for (uint32_t p = 0; p < SIDE_PX * SIDE_PX; p++) {
		uint32_t x = 2 * (p % SIDE_PX), y = 2 * (p / SIDE_PX), sum[4] = { 0 };
		struct raster_block block;

		memset(pixels[p], 0, 4);
		if (!raster_get_block(raster, x / RASTER_BLOCK_PX, y / RASTER_BLOCK_PX, &block))
			continue;
		for (uint32_t k = 0; k < 4; k++) {
			uint32_t at = (y + k / 2) % RASTER_BLOCK_PX * RASTER_BLOCK_PX +
				      (x + k % 2) % RASTER_BLOCK_PX;
			uint8_t rgb[3];

			if (!(block.inverse_m[at] > 0))
				continue;
			shade(rgb, block.surface[at], block.colour[at], light);
			for (int i = 0; i < 3; i++)
				sum[i] += rgb[i];
			sum[3] += 255;
		}
		for (int i = 0; i < 4; i++)
			pixels[p][i] = (uint8_t)(sum[i] / 4);
	}
}

typedef uint8_t (*pictures)[SIDE_PX * SIDE_PX][4];

static pictures draw_views(struct raster *raster, const struct surface *surface,
			   const float centre[3], float radius)
{
	pictures made = need(malloc(VIEWS * sizeof(*made)));

	for (int view = 0; view < VIEWS; view++)
		draw_view(raster, made[view], surface, centre, radius, view);
	return made;
}

/* Root of the mean squared difference of grey, 0..255, over the pixels of six pictures where either
 * surface shows. */
static double difference(pictures a, pictures b)
{
	double sum = 0, count = 0;

	for (int view = 0; view < VIEWS; view++)
		for (uint32_t p = 0; p < SIDE_PX * SIDE_PX; p++) {
			const uint8_t *u = a[view][p], *v = b[view][p];
			double d = 0.299 * (u[0] - v[0]) + 0.587 * (u[1] - v[1]) +
				   0.114 * (u[2] - v[2]);

			sum += d * d;
			count += u[3] || v[3];
		}
	return sqrt(sum / count);
}

/* From the scan's vertices to the surface, as in Fig. 3-24: root mean square, in thousandths of the
 * box's diagonal. */
static double distance(const struct surface *scan, const struct surface *surface, float diagonal)
{
	struct nearest *nearest;
	double sum = 0;

	need_ok(nearest_create(&nearest, surface->positions, surface->triangles,
			       surface->triangle_count),
		"tree of boxes");
	for (uint32_t v = 0; v < scan->vertex_count; v++) {
		struct nearest_place place;

		nearest_find(nearest, scan->positions[v], NULL, INFINITY, &place);
		sum += (double)place.distance_m * (double)place.distance_m;
	}
	nearest_destroy(nearest);
	return 1000 * sqrt(sum / scan->vertex_count) / (double)diagonal;
}

/* ---- the whole */

struct bench {
	struct lattice_mesh mesh;
	struct surface scan;
	struct raster *raster;
	float centre[3], radius;
	pictures looks;
};

static struct mesh load(const char *name, bool y_is_up)
{
	const struct import_options options = { .up = y_is_up ? IMPORT_Y_UP : IMPORT_Z_UP };
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;

	if (strcmp(name, "furniture") == 0)
		return built_furniture();
	if (strcmp(name, "aircraft") == 0)
		return built_aircraft();
	if (import_scan(&mesh, name, &options, NULL, &diagnostics) < 0) {
		fprintf(stderr, "bench_features: %s\n", diagnostics_cause(&diagnostics, 0));
		exit(EXIT_FAILURE);
	}
	return mesh;
}

static void bench_init(struct bench *bench, struct mesh mesh)
{
	struct lattice_counts counts;
	float low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { 0, 0, 0 }, box[3];

	need_ok(on_lattice(&bench->mesh, &counts, &mesh), "lattice");
	mesh_finish(&mesh);
	bench->scan =
		surface_of(&(struct simplify_surface){ .vertex_count = bench->mesh.vertex_count,
						       .triangle_count = bench->mesh.triangle_count,
						       .vertices = bench->mesh.vertices,
						       .triangles = bench->mesh.triangles });
	for (uint32_t v = 0; v < bench->scan.vertex_count; v++)
		for (int i = 0; i < 3; i++) {
			low[i] = fminf(low[i], bench->scan.positions[v][i]);
			high[i] = fmaxf(high[i], bench->scan.positions[v][i]);
		}
	for (int i = 0; i < 3; i++)
		bench->centre[i] = (low[i] + high[i]) / 2;
	vec_sub(box, high, low);
	bench->radius = vec_length(box) / 2;
	need_ok(raster_create(&bench->raster, FINE_PX, true), "raster");
	bench->looks = draw_views(bench->raster, &bench->scan, bench->centre, bench->radius);
}

static void print_row(struct bench *bench, double share)
{
	uint32_t target = (uint32_t)(share * bench->mesh.triangle_count);

	printf("{\"target\": %u", target);
	for (int method = 0; method < METHODS; method++) {
		double ms;
		struct surface made = simplified(&bench->mesh, method, target, &ms);
		pictures looks = draw_views(bench->raster, &made, bench->centre, bench->radius);

		printf(", \"%s\": {\"triangles\": %u, \"difference\": %.2f, \"rms_permille\": %.3f, "
		       "\"ms\": %.1f}",
		       names[method], made.triangle_count, difference(bench->looks, looks),
		       distance(&bench->scan, &made, 2 * bench->radius), ms);
		free(looks);
		surface_finish(&made);
	}
	putchar('}');
	fflush(stdout);
}

/* Puts a picture into one of four places, on a grey ground. */
static void paste(struct picture *picture, uint32_t place, const uint8_t (*pixels)[4])
{
	for (uint32_t p = 0; p < SIDE_PX * SIDE_PX; p++) {
		uint8_t *to = picture->rgba + 4 * ((size_t)(p / SIDE_PX) * picture->width +
						   place * SIDE_PX + p % SIDE_PX);

		for (int i = 0; i < 3; i++)
			to[i] = (uint8_t)(pixels[p][i] + (255 - pixels[p][3]) * 0xf0 / 255);
		to[3] = 255;
	}
}

static void write_picture(struct bench *bench, const char *path, double share, int view)
{
	struct picture picture = { (METHODS + 1) * SIDE_PX, SIDE_PX, NULL };
	uint32_t target = (uint32_t)(share * bench->mesh.triangle_count);
	uint8_t(*pixels)[4] = need(malloc(SIDE_PX * SIDE_PX * sizeof(*pixels)));
	struct buffer file;
	FILE *out = fopen(path, "wb");

	picture.rgba = need(calloc((size_t)picture.width * picture.height, 4));
	paste(&picture, 0, (const uint8_t(*)[4])bench->looks[view]);
	for (int method = 0; method < METHODS; method++) {
		double ms;
		struct surface made = simplified(&bench->mesh, method, target, &ms);

		draw_view(bench->raster, pixels, &made, bench->centre, bench->radius, view);
		paste(&picture, (uint32_t)method + 1, (const uint8_t(*)[4])pixels);
		surface_finish(&made);
	}
	buffer_init(&file, 64 << 20);
	need_ok(picture_encode_jpeg(&file, &picture, 80), path);
	if (!out || fwrite(file.data, 1, file.size, out) != file.size || fclose(out) != 0)
		need_ok(-errno, path);
	buffer_finish(&file);
	free(pixels);
	picture_finish(&picture);
}

int main(int argc, char **argv)
{
	struct bench bench;

	if (argc < 2 || (argc > 3 && argc != 6)) {
		fputs("usage: bench_features furniture|aircraft|FILE [z|y [PICTURE SHARE VIEW]]\n",
		      stderr);
		return 2;
	}
	bench_init(&bench, load(argv[1], argc > 2 && argv[2][0] == 'y'));
	if (argc == 6) {
		write_picture(&bench, argv[3], strtod(argv[4], NULL),
			      (int)(strtoul(argv[5], NULL, 10) % VIEWS));
		return EXIT_SUCCESS;
	}
	printf("{\"triangles\": %u, \"rows\": [", bench.mesh.triangle_count);
	for (size_t i = 0; i < ARRAY_COUNT(shares); i++) {
		fputs(i ? ",\n  " : "\n  ", stdout);
		print_row(&bench, shares[i]);
	}
	puts("]}");
	free(bench.looks);
	raster_destroy(bench.raster);
	surface_finish(&bench.scan);
	lattice_mesh_finish(&bench.mesh);
	return EXIT_SUCCESS;
}
