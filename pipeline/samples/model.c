/* What all surfaces share: sums over the triangles of a piece, and winding numbers. */
#include "pipeline/samples/model.h"

#include <math.h>

uint32_t model_choose(const struct model *model, const float eye_m[3], float detail_rad,
		      uint32_t *pieces)
{
	return model->methods->choose(model, eye_m, detail_rad, pieces);
}

int model_load(struct model *model, uint32_t piece, struct model_mesh *out)
{
	return model->methods->load(model, piece, out);
}

void model_destroy(struct model *model)
{
	if (model)
		model->methods->destroy(model);
}

static const float *corner(const struct model_mesh *mesh, uint32_t index)
{
	return mesh->vertices[mesh->indices[index]].position_m;
}

static void cross_of(const struct model_mesh *mesh, uint32_t first, double out[3])
{
	const float *p = corner(mesh, first), *q = corner(mesh, first + 1),
		    *r = corner(mesh, first + 2);
	double a[3], b[3];

	for (int i = 0; i < 3; i++) {
		a[i] = (double)q[i] - p[i];
		b[i] = (double)r[i] - p[i];
	}
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void find_box(const struct model_mesh *mesh, float low[3], float high[3])
{
	for (int i = 0; i < 3; i++) {
		low[i] = INFINITY;
		high[i] = -INFINITY;
	}
	for (uint32_t index = 0; index < mesh->index_count; index++)
		for (int i = 0; i < 3; i++) {
			low[i] = fminf(low[i], corner(mesh, index)[i]);
			high[i] = fmaxf(high[i], corner(mesh, index)[i]);
		}
}

void model_bound(struct model_piece *piece, const struct model_mesh *mesh)
{
	find_box(mesh, piece->low_m, piece->high_m);
}

void model_sum(struct model_piece *piece, const struct model_mesh *mesh)
{
	double area[3] = { 0 }, middle[3] = { 0 }, weight = 0, radius = 0;
	float low[3], high[3];

	find_box(mesh, low, high);
	for (uint32_t first = 0; first < mesh->index_count; first += 3) {
		double cross[3], size;

		cross_of(mesh, first, cross);
		size = sqrt(dot(cross, cross)) / 2;
		weight += size;
		for (int i = 0; i < 3; i++) {
			area[i] += cross[i] / 2;
			for (uint32_t k = 0; k < 3; k++)
				middle[i] += size * corner(mesh, first + k)[i] / 3;
		}
	}
	for (int i = 0; i < 3; i++) {
		double at = weight > 0 ? middle[i] / weight : ((double)low[i] + high[i]) / 2;
		double reach = fmax(high[i] - at, at - low[i]);

		piece->area_m2[i] = (float)area[i];
		piece->middle_m[i] = (float)at;
		radius += reach * reach;
	}
	piece->radius_m = (float)sqrt(radius);
}

/* ---- winding numbers */

/* Half the solid angle of a triangle, signed (Van Oosterom and Strackee 1983). */
static double half_angle(double v[3][3])
{
	double size[3], determinant, below;

	for (int k = 0; k < 3; k++)
		size[k] = sqrt(dot(v[k], v[k]));
	determinant = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
		      v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
		      v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
	below = size[0] * size[1] * size[2] + dot(v[0], v[1]) * size[2] +
		dot(v[1], v[2]) * size[0] + dot(v[2], v[0]) * size[1];
	return atan2(determinant, below);
}

static double mesh_angle(const struct model_mesh *mesh, const float point_m[3])
{
	double sum = 0;

	for (uint32_t first = 0; first < mesh->index_count; first += 3) {
		double v[3][3];

		for (uint32_t k = 0; k < 3; k++)
			for (int c = 0; c < 3; c++)
				v[k][c] = (double)corner(mesh, first + k)[c] - point_m[c];
		sum += half_angle(v);
	}
	return 2 * sum;
}

/* Adds the solid angle of a piece to *sum. */
static int add_angle(struct model *model, uint32_t piece, const float point_m[3], double *sum)
{
	const struct model_piece *of = &model->pieces[piece];
	struct model_mesh mesh;
	double away[3], area[3], distance;
	int rc;

	if (of->radius_m < 0) { /* loading sums it */
		rc = model_load(model, piece, &mesh);
		if (rc < 0)
			return rc;
	}
	for (int i = 0; i < 3; i++) {
		away[i] = (double)of->middle_m[i] - point_m[i];
		area[i] = of->area_m2[i];
	}
	distance = sqrt(dot(away, away));
	if (distance > 3.0 * of->radius_m) {
		*sum += dot(area, away) / (distance * distance * distance);
		return 0;
	}
	rc = model_load(model, piece, &mesh);
	if (rc == 0)
		*sum += mesh_angle(&mesh, point_m);
	return rc;
}

int model_winding(struct model *model, const uint32_t *pieces, uint32_t count,
		  const float point_m[3], double *out)
{
	double sum = 0;
	int rc = 0;

	for (uint32_t i = 0; i < count && rc == 0; i++)
		rc = add_angle(model, pieces[i], point_m, &sum);
	*out = sum / (4 * M_PI);
	return rc;
}
