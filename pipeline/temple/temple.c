/* Writes the demo temple. First it searches for the density at which the rows and columns of all
 * sheets give the wanted number of triangles; then it writes all vertices, then all triangles, a
 * row at a time. */
#include "pipeline/temple/temple.h"

#include "base/progress.h"
#include "pipeline/material/material.h"
#include "pipeline/temple/temple_carve.h"
#include "pipeline/temple/temple_compose.h"
#include "pipeline/temple/temple_plan.h"
#include "pipeline/temple/temple_sky.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STATIONS_MAX = 1 << 17, ROWS_KEPT = 3 };
enum { VERTEX_BYTES = 16, QUAD_BYTES = 2 * 13, OUT_BYTES = 1 << 16 };

struct row {
	float (*positions)[3];
	float *hollow;
};

struct writer {
	FILE *file;
	const struct temple_options *options;
	struct plan plan;
	struct sky *sky;
	float density;
	uint64_t vertices, triangles; /* of the whole temple */
	struct station *across, *up;  /* STATIONS_MAX each */
	struct row rows[ROWS_KEPT];
	uint8_t out[OUT_BYTES]; /* what is to be written */
	size_t out_bytes;
};

/* Equal sheets would all gain a row at the same density, and the sum would jump; so each sheet has
 * a slightly different density. */
static float density_of(const struct writer *w, uint32_t sheet)
{
	return w->density * (0.92f + 0.16f * temple_chance(77, sheet, 0));
}

static void count_all(struct writer *w, float density)
{
	uint32_t columns, rows;

	w->density = density;
	w->vertices = w->triangles = 0;
	for (uint32_t i = 0; i < w->plan.count; i++) {
		const struct sheet *sheet = &w->plan.sheets[i];
		sheet_stations(sheet, density_of(w, i), NULL, &columns, NULL, &rows, 0);
		w->vertices += sheet_vertices(sheet, columns, rows);
		w->triangles += sheet_triangles(sheet, columns, rows);
	}
}

static void choose_density(struct writer *w)
{
	float low = 0.01f, high = 1024, best = 1;
	uint64_t wanted = w->options->triangles, miss = UINT64_MAX;

	for (int i = 0; i < 48; i++) {
		float middle = sqrtf(low * high);
		count_all(w, middle);
		uint64_t off =
			w->triangles > wanted ? w->triangles - wanted : wanted - w->triangles;
		if (off < miss) {
			miss = off;
			best = middle;
		}
		if (w->triangles > wanted)
			high = middle;
		else
			low = middle;
	}
	count_all(w, best);
}

static void put_u32(uint8_t *out, uint32_t value)
{
	for (int k = 0; k < 4; k++)
		out[k] = (uint8_t)(value >> (8 * k));
}

static void put_f32(uint8_t *out, float value)
{
	uint32_t bits;

	memcpy(&bits, &value, sizeof(bits));
	put_u32(out, bits);
}

static void fill_row(const struct writer *w, const struct sheet *sheet, uint32_t columns,
		     uint32_t row)
{
	const struct row *out = &w->rows[row % ROWS_KEPT];

	for (uint32_t i = 0; i < columns; i++)
		sheet_at(sheet, &w->across[i], &w->up[row], out->positions[i], &out->hollow[i]);
}

/* Computes the normal from the neighbours in the grid, and *spacing_m, about the distance of
 * vertices. */
static void normal_at(const float *left, const float *right, const float *below, const float *above,
		      float normal[3], float *spacing_m)
{
	float a[3], b[3];

	for (int k = 0; k < 3; k++) {
		a[k] = right[k] - left[k];
		b[k] = above[k] - below[k];
	}
	normal[0] = a[1] * b[2] - a[2] * b[1];
	normal[1] = a[2] * b[0] - a[0] * b[2];
	normal[2] = a[0] * b[1] - a[1] * b[0];
	float length = sqrtf(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
	for (int k = 0; k < 3; k++)
		normal[k] = length > 1e-12f ? normal[k] / length : k == 2;
	*spacing_m = 0.35f * sqrtf(length);
}

static void colour_vertex(const struct writer *w, const float position[3], const float normal[3],
			  float spacing_m, float hollow, uint8_t out[4])
{
	float rgb[3], open = sky_open(w->sky, position, normal);

	/* Stone around reflects light, so nothing is completely dark. */
	open = (0.14f + 0.86f * powf(open, 0.75f)) * (1 - 0.45f * hollow * hollow);
	material_colour(rgb, position, normal, spacing_m);
	for (int k = 0; k < 3; k++)
		out[k] = (uint8_t)(fminf(1, fmaxf(0, rgb[k])) * 255 + 0.5f);
	out[3] = (uint8_t)(fminf(1, fmaxf(0.02f, open)) * 255 + 0.5f);
}

static int write_out(struct writer *w)
{
	size_t bytes = w->out_bytes;

	w->out_bytes = 0;
	return fwrite(w->out, 1, bytes, w->file) == bytes ? 0 : -EIO;
}

/* Where the next bytes of the file are to be put; NULL if those before could not be written. */
static uint8_t *next_out(struct writer *w, size_t bytes)
{
	if (w->out_bytes + bytes > sizeof(w->out) && write_out(w) < 0)
		return NULL;
	w->out_bytes += bytes;
	return w->out + w->out_bytes - bytes;
}

static int write_row(struct writer *w, const struct sheet *sheet, uint32_t columns, uint32_t rows,
		     uint32_t row)
{
	const struct row *here = &w->rows[row % ROWS_KEPT];
	const struct row *below = row ? &w->rows[(row - 1) % ROWS_KEPT] : here;
	const struct row *above = row + 1 < rows ? &w->rows[(row + 1) % ROWS_KEPT] : here;
	bool wraps = sheet_wraps(sheet);

	for (uint32_t i = 0; i < columns; i++) {
		uint8_t *out = next_out(w, VERTEX_BYTES);
		if (!out)
			return -EIO;
		uint32_t left = i ? i - 1 : wraps ? columns - 1 : 0;
		uint32_t right = i + 1 < columns ? i + 1 : wraps ? 0 : i;
		float normal[3], spacing_m;
		normal_at(here->positions[left], here->positions[right], below->positions[i],
			  above->positions[i], normal, &spacing_m);
		for (int k = 0; k < 3; k++)
			put_f32(out + 4 * k, here->positions[i][k]);
		colour_vertex(w, here->positions[i], normal, spacing_m, here->hollow[i], out + 12);
	}
	return 0;
}

static int write_vertices(struct writer *w, const struct sheet *sheet, uint32_t columns,
			  uint32_t rows)
{
	if (columns == 0)
		return 0;
	fill_row(w, sheet, columns, 0);
	for (uint32_t row = 0; row < rows; row++) {
		if (row + 1 < rows)
			fill_row(w, sheet, columns, row + 1);
		int rc = write_row(w, sheet, columns, rows, row);
		if (rc < 0)
			return rc;
	}
	progress_add(w->options->progress, sheet_vertices(sheet, columns, rows));
	return 0;
}

static int write_triangles(struct writer *w, const struct sheet *sheet, uint32_t columns,
			   uint32_t rows, uint64_t first)
{
	uint32_t quads = sheet_wraps(sheet) ? columns : columns ? columns - 1 : 0;

	for (uint32_t row = 0; row + 1 < rows; row++) {
		for (uint32_t i = 0; i < quads; i++) {
			uint8_t *out = next_out(w, QUAD_BYTES);
			if (!out)
				return -EIO;
			uint32_t a = (uint32_t)first + row * columns + i;
			uint32_t b = (uint32_t)first + row * columns + (i + 1) % columns;
			out[0] = 3;
			put_u32(out + 1, a);
			put_u32(out + 5, b);
			put_u32(out + 9, b + columns);
			out[13] = 3;
			put_u32(out + 14, a);
			put_u32(out + 18, b + columns);
			put_u32(out + 22, a + columns);
		}
	}
	progress_add(w->options->progress, sheet_triangles(sheet, columns, rows));
	return 0;
}

static int write_all(struct writer *w)
{
	uint64_t first = 0;
	uint32_t columns, rows;
	int rc = 0;

	fprintf(w->file,
		"ply\nformat binary_little_endian 1.0\ncomment demo temple, seed %u, metres, z up\n"
		"comment gopura open\n"
		"element vertex %llu\nproperty float x\nproperty float y\nproperty float z\n"
		"property uchar red\nproperty uchar green\nproperty uchar blue\n"
		"property uchar alpha\nelement face %llu\n"
		"property list uchar int vertex_indices\nend_header\n",
		w->options->seed, (unsigned long long)w->vertices,
		(unsigned long long)w->triangles);
	for (uint32_t i = 0; rc == 0 && i < w->plan.count; i++) {
		sheet_stations(&w->plan.sheets[i], density_of(w, i), w->across, &columns, w->up,
			       &rows, STATIONS_MAX);
		if (columns > STATIONS_MAX || rows > STATIONS_MAX)
			return -ERANGE;
		rc = write_vertices(w, &w->plan.sheets[i], columns, rows);
	}
	for (uint32_t i = 0; rc == 0 && i < w->plan.count; i++) {
		const struct sheet *sheet = &w->plan.sheets[i];
		sheet_stations(sheet, density_of(w, i), NULL, &columns, NULL, &rows, 0);
		rc = write_triangles(w, sheet, columns, rows, first);
		first += sheet_vertices(sheet, columns, rows);
	}
	if (rc == 0)
		rc = write_out(w);
	if (rc == 0 && (fflush(w->file) != 0 || ferror(w->file)))
		rc = -EIO;
	return rc;
}

static int list_bodies(const struct writer *w, struct temple_bodies *out)
{
	uint64_t face = 0;
	uint32_t columns, rows, sheet = 0;

	out->bodies = calloc(w->plan.body_count, sizeof(*out->bodies));
	if (!out->bodies)
		return -ENOMEM;
	for (uint32_t i = 0; i < w->plan.body_count; i++) {
		const struct body *body = &w->plan.bodies[i];
		struct temple_body *listed = &out->bodies[out->count];
		for (; sheet < body->first + body->count; sheet++) {
			if (sheet == body->first)
				listed->first_face = (uint32_t)face;
			sheet_stations(&w->plan.sheets[sheet], density_of(w, sheet), NULL, &columns,
				       NULL, &rows, 0);
			face += sheet_triangles(&w->plan.sheets[sheet], columns, rows);
		}
		listed->face_count = (uint32_t)face - listed->first_face;
		snprintf(listed->id, sizeof(listed->id), "%.8s-%u", body->kind, body->number);
		out->count += listed->face_count > 0;
	}
	return 0;
}

static int writer_rooms(struct writer *w)
{
	bool whole = true;

	w->across = calloc(STATIONS_MAX, sizeof(*w->across));
	w->up = calloc(STATIONS_MAX, sizeof(*w->up));
	for (int i = 0; i < ROWS_KEPT; i++) {
		w->rows[i].positions = calloc(STATIONS_MAX, sizeof(*w->rows[i].positions));
		w->rows[i].hollow = calloc(STATIONS_MAX, sizeof(*w->rows[i].hollow));
		whole = whole && w->rows[i].positions && w->rows[i].hollow;
	}
	return whole && w->across && w->up ? 0 : -ENOMEM;
}

static void writer_finish(struct writer *w)
{
	for (int i = 0; i < ROWS_KEPT; i++) {
		free(w->rows[i].positions);
		free(w->rows[i].hollow);
	}
	free(w->across);
	free(w->up);
	sky_destroy(w->sky);
	plan_destroy(&w->plan);
}

int temple_write(FILE *file, const struct temple_options *options)
{
	struct writer w = { .file = file, .options = options };
	int rc;

	if (options->bodies)
		*options->bodies = (struct temple_bodies){ 0 };
	if (options->triangles < TEMPLE_TRIANGLES_MIN || options->triangles > TEMPLE_TRIANGLES_MAX)
		return -ERANGE;
	rc = plan_create(&w.plan, options->seed);
	if (rc == 0)
		rc = writer_rooms(&w);
	if (rc == 0)
		rc = sky_create(&w.sky, &w.plan);
	if (rc == 0) {
		choose_density(&w);
		progress_set_total(options->progress, w.vertices + w.triangles);
		rc = write_all(&w);
	}
	if (rc == 0 && options->bodies)
		rc = list_bodies(&w, options->bodies);
	writer_finish(&w);
	return rc;
}
