/* Adaptive solid texturing against its alternatives, as Tables 4-3 and 4-4 of paper 003 have them:
 * bench_solid_texture [PICTURES]. A cube of 1 m turns once about itself in the first loop, and
 * again in the rest; it is drawn on one core. JSON to standard output: frames a second, seconds to
 * fill, megabytes, and how near the pictures are to evaluation on the fly. With a folder PICTURES,
 * draws docs/pictures/substance.jpg's four substances, a corner cut off, into
 * PICTURES/substance.jpg instead.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/compiler.h"
#include "format/picture.h"
#include "geometry/vec.h"
#include "tests/bench/cache_cube.h"

enum { SIDE_PX = 400, FRAMES = 12, LOOPS = 3, GRID_BITS = 7, PLACES = 1 << 14 };

#define DISTANCE_M 2.4f
#define PX_RADIANS (0.68f / SIDE_PX)

enum way { FLAT, ON_THE_FLY, GRID, CACHE };

/* How a frame is coloured. */
struct painter {
	enum way way;
	enum substance_kind kind;
	struct cache_cube *cache; /* of GRID too, to fill its voxels with */
	uint32_t *grid;
	bool is_cut;
};

static void need(bool good, const char *what)
{
	if (!good) {
		fprintf(stderr, "%s\n", what);
		exit(EXIT_FAILURE);
	}
}

/* ---- the cube */

/* Clips a ray against a box around the middle; which face it enters by. */
static bool enter_box(const float eye[3], const float ray[3], const float low[3],
		      const float high[3], float *near, float *far, int *face)
{
	*near = 0;
	*far = 1e9f;
	for (int k = 0; k < 3; k++) {
		const float a = (low[k] - eye[k]) / ray[k], b = (high[k] - eye[k]) / ray[k];

		if (fminf(a, b) > *near) {
			*near = fminf(a, b);
			*face = k;
		}
		*far = fminf(*far, fmaxf(a, b));
	}
	return *near < *far;
}

/* Where a ray meets the cube, or the cut. */
static bool meet_cube(const struct painter *p, const float eye[3], const float ray[3], float at[3],
		      float *distance, int *face)
{
	static const float low[3] = { -0.5f, -0.5f, -0.5f }, high[3] = { 0.5f, 0.5f, 0.5f };
	static const float cut_low[3] = { 0.0f, -9.0f, 0.0f }, cut_high[3] = { 9.0f, 0.05f, 9.0f };
	float far, cut_near, cut_far;
	int cut_face = 0;

	if (!enter_box(eye, ray, low, high, distance, &far, face))
		return false;
	vec_add_scaled(at, eye, *distance, ray);
	if (!p->is_cut || !enter_box(eye, ray, cut_low, cut_high, &cut_near, &cut_far, &cut_face) ||
	    cut_near > *distance + 1e-4f)
		return true;
	if (cut_far <= *distance)
		return true;
	if (cut_far >= far)
		return false;
	*distance = cut_far;
	vec_add_scaled(at, eye, *distance, ray);
	for (int k = 0; k < 3; k++) /* by which side the ray leaves what is cut off */
		if (fabsf(at[k] - cut_low[k]) < 1e-4f || fabsf(at[k] - cut_high[k]) < 1e-4f)
			*face = k;
	return true;
}

static void read_grid(const struct painter *p, const float at[3], float rgb[3])
{
	uint32_t voxel[3], packed;

	for (int k = 0; k < 3; k++)
		voxel[k] = (uint32_t)fminf(fmaxf((at[k] + 0.5f) * (1 << GRID_BITS), 0),
					   (1 << GRID_BITS) - 1);
	packed = p->grid[(voxel[2] << 2 * GRID_BITS) | (voxel[1] << GRID_BITS) | voxel[0]];
	for (int k = 0; k < 3; k++)
		rgb[k] = (float)(packed >> 8 * k & 255) * (1 / 255.0f);
}

static void colour(const struct painter *p, const float at[3], float footprint_m, float rgb[3])
{
	switch (p->way) {
	case FLAT:
		rgb[0] = rgb[1] = rgb[2] = 0.5f;
		break;
	case ON_THE_FLY:
		substance_colour(rgb, p->kind, at, footprint_m);
		break;
	case GRID:
		read_grid(p, at, rgb);
		break;
	case CACHE:
		cache_cube_colour(p->cache, rgb, at, footprint_m);
		break;
	}
}

/* rgba: SIDE_PX rows. */
static void draw(const struct painter *p, int frame, uint8_t (*rgba)[4])
{
	const float turn = 6.2831853f * (float)frame / FRAMES, c = cosf(turn), s = sinf(turn);
	const float eye[3] = { DISTANCE_M * c, DISTANCE_M * s, 1.3f };
	float ahead[3] = { -eye[0], -eye[1], -eye[2] };
	const float right[3] = { -s, c, 0 };
	float up[3];

	vec_normalise(ahead);
	vec_cross(up, right, ahead);
	for (int y = 0; y < SIDE_PX; y++)
		for (int x = 0; x < SIDE_PX; x++) {
			float ray[3], at[3], rgb[3] = { 0.1f, 0.1f, 0.12f }, distance, shade = 1;
			int face = 0;

			vec_copy(ray, ahead);
			vec_add_scaled(ray, ray, ((float)x - SIDE_PX / 2) * PX_RADIANS, right);
			vec_add_scaled(ray, ray, (SIDE_PX / 2 - (float)y) * PX_RADIANS, up);
			if (meet_cube(p, eye, ray, at, &distance, &face)) {
				colour(p, at, distance * PX_RADIANS, rgb);
				shade = face == 2 ? 1.0f : face == 1 ? 0.86f : 0.7f;
			}
			for (int k = 0; k < 3; k++)
				rgba[y * SIDE_PX + x][k] =
					(uint8_t)(fminf(rgb[k] * shade, 1) * 255 + 0.5f);
			rgba[y * SIDE_PX + x][3] = 255;
		}
}

/* ---- the tables */

/* Draws a loop; returns frames a second. */
static double loop(const struct painter *p, uint8_t (*rgba)[4])
{
	const int64_t began_us = clock_now_us();

	for (int frame = 0; frame < FRAMES; frame++)
		draw(p, frame, rgba);
	return FRAMES * 1e6 / (double)(clock_now_us() - began_us);
}

static double likeness_db(const struct painter *p)
{
	const struct painter truth = { .way = ON_THE_FLY, .kind = p->kind };
	uint8_t(*a)[4] = malloc(SIDE_PX * SIDE_PX * 4), (*b)[4] = malloc(SIDE_PX * SIDE_PX * 4);
	double sum = 0;

	need(a && b, "no memory");
	draw(p, 3, a);
	draw(&truth, 3, b);
	for (int i = 0; i < SIDE_PX * SIDE_PX; i++)
		for (int k = 0; k < 3; k++)
			sum += (a[i][k] - b[i][k]) * (a[i][k] - b[i][k]);
	free(a);
	free(b);
	return sum > 0 ? 10 * log10(255.0 * 255 * 3 * SIDE_PX * SIDE_PX / sum) : 99;
}

static void print_row(const char *name, const struct painter *p, double fill_s, double mb,
		      const char *end)
{
	uint8_t(*rgba)[4] = malloc(SIDE_PX * SIDE_PX * 4);
	double first, rest = 0;

	need(rgba != NULL, "no memory");
	first = loop(p, rgba);
	for (int i = 1; i < LOOPS; i++)
		rest = fmax(rest, loop(p, rgba));
	if (p->way == CACHE)
		mb = (double)cache_cube_counts(p->cache).cell_bytes / 1e6;
	printf(" \"%s\": {\"fill_s\": %.2f, \"first_fps\": %.2f, \"rest_fps\": %.2f, \"mb\": %.1f, "
	       "\"db\": %.1f}%s\n",
	       name, fill_s, first, rest, mb, likeness_db(p), end);
	free(rgba);
}

static struct cache_cube_options cube_options(enum substance_kind kind, uint32_t least,
					      uint32_t most)
{
	return (struct cache_cube_options){ .kind = kind,
					    .low_m = { -0.5f, -0.5f, -0.5f },
					    .side_m = 1,
					    .level_least = least,
					    .level_most = most,
					    .budget_bytes = 1ull << 30 };
}

static void print_cached(const char *name, enum substance_kind kind, uint32_t least, uint32_t most,
			 bool nearest, const char *end)
{
	struct cache_cube_options options = cube_options(kind, least, most);
	struct painter p = { .way = CACHE, .kind = kind };

	options.nearest = nearest;
	need(cache_cube_create(&p.cache, &options) == 0, "no memory");
	print_row(name, &p, 0, 0, end);
	cache_cube_destroy(p.cache);
}

/* The whole texture before the first frame, in an array. */
static void print_grid(enum substance_kind kind)
{
	const uint32_t side = 1 << GRID_BITS;
	struct painter p = { .way = GRID, .kind = kind, .grid = malloc(4u << 3 * GRID_BITS) };
	const int64_t began_us = clock_now_us();
	double fill_s;

	need(p.grid != NULL, "no memory");
	for (uint32_t i = 0; i < side * side * side; i++) {
		const uint32_t voxel[3] = { i % side, i / side % side, i / side / side };
		float at[3], rgb[3];

		for (int k = 0; k < 3; k++)
			at[k] = ((float)voxel[k] + 0.5f) / (float)side - 0.5f;
		substance_colour(rgb, kind, at, 1.0f / (float)side);
		p.grid[i] = 0;
		for (int k = 0; k < 3; k++)
			p.grid[i] |= (uint32_t)(fminf(rgb[k], 1) * 255 + 0.5f) << 8 * k;
	}
	fill_s = (double)(clock_now_us() - began_us) / 1e6;
	print_row("whole 128", &p, fill_s, (4 << 3 * GRID_BITS) / 1e6, ",");
	free(p.grid);
}

/* Millions of places a second that a substance computes. */
static double places_a_second(enum substance_kind kind, uint32_t batch)
{
	static float at[3][PLACES], size[PLACES], rgb[3][PLACES];
	double best = 0;

	for (int i = 0; i < PLACES; i++) {
		at[0][i] = (float)(i % 64) * 0.004f;
		at[1][i] = (float)(i / 64) * 0.004f;
		at[2][i] = 0.3f;
		size[i] = 0.004f;
	}
	for (int round = 0; round < 20; round++) {
		const int64_t began_us = clock_now_us();

		for (uint32_t i = 0; i < PLACES; i += batch) {
			float *const out[3] = { rgb[0] + i, rgb[1] + i, rgb[2] + i };
			const float *const from[3] = { at[0] + i, at[1] + i, at[2] + i };

			substance_colours(out, kind, from, size + i, batch);
		}
		best = fmax(best, PLACES / (double)(clock_now_us() - began_us));
	}
	return best;
}

static void print_tables(enum substance_kind kind, const char *end)
{
	const struct painter flat = { .way = FLAT, .kind = kind };
	const struct painter fly = { .way = ON_THE_FLY, .kind = kind };

	printf("\"%s\": {\n \"Mplaces_s\": {\"one by one\": %.2f, \"128 at once\": %.2f},\n",
	       substance_names[kind], places_a_second(kind, 1), places_a_second(kind, 128));
	print_row("no texture", &flat, 0, 0, ",");
	print_row("on the fly", &fly, 0, 0, ",");
	print_grid(kind);
	print_cached("one cube 128", kind, 7, 7, true, ",");
	print_cached("several cubes to 128", kind, CACHE_CUBE_CELL_BITS, 7, true, ",");
	print_cached("several cubes to 1024", kind, CACHE_CUBE_CELL_BITS, 10, true, ",");
	print_cached("several cubes, means", kind, CACHE_CUBE_CELL_BITS, 11, false, "");
	printf("}%s\n", end);
}

/* ---- the picture */

static void draw_pictures(const char *folder)
{
	struct picture picture = { 2 * SIDE_PX, 2 * SIDE_PX, calloc(4, 4 * SIDE_PX * SIDE_PX) };
	uint8_t(*rgba)[4] = malloc(SIDE_PX * SIDE_PX * 4);
	struct buffer file;
	char path[4096];

	need(picture.rgba && rgba, "no memory");
	for (int i = 0; i < 4; i++) {
		const struct painter p = { .way = ON_THE_FLY,
					   .kind = (enum substance_kind)(SUBSTANCE_MARBLE + i),
					   .is_cut = true };

		draw(&p, 11, rgba);
		for (int y = 0; y < SIDE_PX; y++)
			memcpy(picture.rgba + 4 * ((size_t)(i / 2 * SIDE_PX + y) * 2 * SIDE_PX +
						   (size_t)(i % 2) * SIDE_PX),
			       rgba[y * SIDE_PX], 4 * SIDE_PX);
	}
	buffer_init(&file, 16 << 20);
	need(picture_encode_jpeg(&file, &picture, 85) == 0, "no JPEG");
	snprintf(path, sizeof(path), "%s/substance.jpg", folder);
	need(bytes_write_file(buffer_bytes(&file), path) == 0, "the folder cannot be written to");
	buffer_finish(&file);
	picture_finish(&picture);
	free(rgba);
}

int main(int argc, char **argv)
{
	if (argc > 1) {
		draw_pictures(argv[1]);
		return EXIT_SUCCESS;
	}
	puts("{");
	for (int kind = SUBSTANCE_MARBLE; kind < SUBSTANCE_KINDS; kind++)
		print_tables((enum substance_kind)kind, kind + 1 < SUBSTANCE_KINDS ? "," : "");
	puts("}");
	return EXIT_SUCCESS;
}
