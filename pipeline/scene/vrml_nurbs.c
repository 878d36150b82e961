/* Divides triangles of the parameters until the surface lies along them. */
#include "pipeline/scene/vrml_nurbs.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "geometry/nurbs.h"
#include "pipeline/scene/vrml_graph.h"
#include "pipeline/scene/vrml_trim.h"

/* DEPTH_MAX: an edge is halved at most 16 times until it is too short (64 spans, each in 1024), a
 * triangle has three, and INNER_MAX are added in its middle. */
enum { SPAN_STEPS = 16, INNER_MAX = 8, SPANS_MAX = 64, DEPTH_MAX = 3 * 16 + INNER_MAX };

/* How far a surface may be from an edge, as a share of its length. */
#define ERROR_OF_LENGTH 0.02
/* Edges that are this share of a span, or of the box of the control points, are never divided. */
#define SHORTEST_OF_SPAN (1 / 1024.0)
#define SHORTEST_OF_BOX  (1 / 512.0)

struct filling {
	struct nurbs_surface surface;
	struct soup *soup;
	const uint8_t *rgb;
	double low[2], high[2];
	double shortest; /* length of an edge that is not divided */
	double span[2];  /* the shortest one between knots, or a 64th of the range */
	int depth;       /* of the triangle that is divided, in those that it is a part of */
};

struct corner {
	double at[2]; /* u, v */
	double place[3];
};

/* ---- reading */

static int refuse(struct diagnostics *diagnostics, const struct vrml_node *node, const char *what,
		  const char *cure)
{
	return diagnostics_add(diagnostics, -EBADMSG, node->file, node->line, "%s %s; %s",
			       node->type->name, what, cure);
}

/* *own gets knots that are made, to be freed; NULL: the node's are used. */
static int read_axis(struct nurbs_axis *axis, float **own, const struct vrml_node *node,
		     const char *knot_field, const char *order_field, uint32_t count,
		     struct diagnostics *diagnostics)
{
	const struct vrml_value *knots = vrml_get(node, knot_field);
	const int32_t order = vrml_get_integer(node, order_field, 3);
	const char *fault;

	*own = NULL;
	*axis = (struct nurbs_axis){ order > 0 ? (uint32_t)order : 0, count, NULL };
	if (order < 2 || order > NURBS_ORDER_MAX || count < (uint32_t)order)
		return refuse(diagnostics, node, "has a wrong order or too few control points",
			      "an order is 2 to 12, and there are at least as many points");
	if (!knots || knots->count == 0) {
		*own = malloc((size_t)(count + axis->order) * sizeof(**own));
		if (!*own)
			return -ENOMEM;
		nurbs_even_knots(*own, axis->order, count);
	} else if (knots->count != count + axis->order) {
		return refuse(diagnostics, node, "has a wrong number of knots",
			      "there are as many as control points and the order together");
	}
	axis->knots = *own ? *own : knots->floats;
	fault = nurbs_axis_fault(axis);
	return fault ? refuse(diagnostics, node, fault, "export it again") : 0;
}

static int check_weights(const struct vrml_node *node, const struct vrml_value *weights,
			 uint64_t points, struct diagnostics *diagnostics)
{
	if (weights->count != points)
		return refuse(diagnostics, node, "has a wrong number of weights",
			      "give one for each control point, or none");
	for (uint32_t i = 0; i < weights->count; i++)
		if (!(weights->floats[i] > 0))
			return refuse(diagnostics, node, "has a weight that is not above 0",
				      "export it again");
	return 0;
}

/* The length of the diagonal of the box around points. */
static double diagonal(const float *points, uint64_t count)
{
	double sum = 0;

	for (int k = 0; k < 3; k++) {
		float low = points[k], high = points[k];

		for (uint64_t i = 0; i < count; i++) {
			low = fminf(low, points[3 * i + (uint64_t)k]);
			high = fmaxf(high, points[3 * i + (uint64_t)k]);
		}
		sum += ((double)high - (double)low) * ((double)high - (double)low);
	}
	return sqrt(sum);
}

static int read_surface(struct filling *filling, float *own[2], const struct vrml_node *node,
			struct diagnostics *diagnostics)
{
	const struct vrml_value *points = vrml_get(node, "controlPoint");
	const struct vrml_value *weights = vrml_get(node, "weight");
	const int32_t columns = vrml_get_integer(node, "uDimension", 0);
	const int32_t rows = vrml_get_integer(node, "vDimension", 0);
	const uint64_t count = points ? points->count / 3 : 0;
	int rc;

	if (columns < 2 || rows < 2 || (uint64_t)columns * (uint64_t)rows != count)
		return refuse(diagnostics, node, "has a wrong number of control points",
			      "correct uDimension and vDimension");
	rc = read_axis(&filling->surface.axes[0], &own[0], node, "uKnot", "uOrder",
		       (uint32_t)columns, diagnostics);
	if (rc == 0)
		rc = read_axis(&filling->surface.axes[1], &own[1], node, "vKnot", "vOrder",
			       (uint32_t)rows, diagnostics);
	if (rc == 0 && weights && weights->count > 0)
		rc = check_weights(node, weights, count, diagnostics);
	filling->surface.points = points->floats;
	filling->shortest = SHORTEST_OF_BOX * diagonal(points->floats, count);
	filling->surface.weights = weights && weights->count > 0 ? weights->floats : NULL;
	for (int k = 0; k < 2 && rc == 0; k++) {
		const struct nurbs_axis *axis = &filling->surface.axes[k];

		nurbs_axis_range(axis, &filling->low[k], &filling->high[k]);
		filling->span[k] = filling->high[k] - filling->low[k];
		for (uint32_t i = axis->order; i <= axis->count; i++)
			if (axis->knots[i] > axis->knots[i - 1])
				filling->span[k] =
					fmin(filling->span[k],
					     (double)axis->knots[i] - (double)axis->knots[i - 1]);
		filling->span[k] =
			fmax(filling->span[k], (filling->high[k] - filling->low[k]) / SPANS_MAX);
	}
	return rc;
}

/* ---- dividing */

static double distance(const double a[3], const double b[3])
{
	const double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };

	return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static void set_corner(const struct filling *f, struct corner *corner, double u, double v)
{
	corner->at[0] = u;
	corner->at[1] = v;
	nurbs_surface_place(&f->surface, u, v, corner->place);
}

/* Judges an edge by what both of its triangles see alike. */
static bool edge_bends(const struct filling *f, const struct corner *a, const struct corner *b)
{
	const double length = distance(a->place, b->place);
	double spans = 0, farthest = 0;

	for (int k = 0; k < 2; k++)
		spans = fmax(spans, fabs(a->at[k] - b->at[k]) / f->span[k]);
	if (spans > 1.001 || spans < SHORTEST_OF_SPAN)
		return spans > 1;
	for (int quarter = 1; quarter < 4; quarter++) {
		const double t = quarter * 0.25;
		double place[3], flat[3];

		nurbs_surface_place(&f->surface, (1 - t) * a->at[0] + t * b->at[0],
				    (1 - t) * a->at[1] + t * b->at[1], place);
		for (int k = 0; k < 3; k++)
			flat[k] = (1 - t) * a->place[k] + t * b->place[k];
		farthest = fmax(farthest, distance(place, flat));
	}
	return farthest + length > f->shortest && farthest > ERROR_OF_LENGTH * length;
}

static int add_triangle(const struct filling *f, const struct corner *const corners[3])
{
	struct soup_corner out[3] = { 0 };

	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3; k++)
			out[i].position[k] = (float)corners[i]->place[k];
		for (int k = 0; k < 2; k++)
			out[i].uv[k] =
				(float)((corners[i]->at[k] - f->low[k]) / (f->high[k] - f->low[k]));
		memcpy(out[i].rgb, f->rgb, sizeof(out[i].rgb));
	}
	for (int i = 0; i < 3; i++) /* a pole, where a side of the parameters is one place */
		if (memcmp(out[i].position, out[(i + 1) % 3].position, sizeof(out[i].position)) ==
		    0)
			return 0;
	return soup_add(f->soup, out, 3);
}

static int divide(struct filling *f, const struct corner *a, const struct corner *b,
		  const struct corner *c, int inner);

/* No edge bends; does the middle? Then its corners are joined with the middle. */
static int divide_middle(struct filling *f, const struct corner *const v[3], int inner)
{
	struct corner middle;
	double flat[3], longest = 0;
	int rc = 0;

	set_corner(f, &middle, (v[0]->at[0] + v[1]->at[0] + v[2]->at[0]) / 3,
		   (v[0]->at[1] + v[1]->at[1] + v[2]->at[1]) / 3);
	for (int k = 0; k < 3; k++) {
		flat[k] = (v[0]->place[k] + v[1]->place[k] + v[2]->place[k]) / 3;
		longest = fmax(longest, distance(v[k]->place, v[(k + 1) % 3]->place));
	}
	if (inner >= INNER_MAX || longest < f->shortest ||
	    !(distance(middle.place, flat) > ERROR_OF_LENGTH * longest))
		return add_triangle(f, v);
	for (int k = 0; k < 3 && rc == 0; k++)
		rc = divide(f, v[k], v[(k + 1) % 3], &middle, inner + 1);
	return rc;
}

static int divide_edges(struct filling *f, const struct corner *a, const struct corner *b,
			const struct corner *c, int inner)
{
	const struct corner *v[3] = { a, b, c };
	struct corner m[3];
	bool bends[3];
	int count = 0, first = 0, rc;

	for (int k = 0; k < 3; k++) {
		const struct corner *next = v[(k + 1) % 3];

		bends[k] = edge_bends(f, v[k], next);
		count += bends[k];
		if (bends[k])
			set_corner(f, &m[k], (v[k]->at[0] + next->at[0]) / 2,
				   (v[k]->at[1] + next->at[1]) / 2);
	}
	if (count == 0)
		return divide_middle(f, v, inner);
	if (count == 3) {
		rc = divide(f, a, &m[0], &m[2], inner);
		if (rc == 0)
			rc = divide(f, &m[0], b, &m[1], inner);
		if (rc == 0)
			rc = divide(f, &m[2], &m[1], c, inner);
		return rc == 0 ? divide(f, &m[0], &m[1], &m[2], inner) : rc;
	}
	/* Turn it so that the first edge bends, and the last does not. */
	while (!bends[first] || bends[(first + 2) % 3])
		first++;
	a = v[first];
	b = v[(first + 1) % 3];
	c = v[(first + 2) % 3];
	if (count == 1) {
		rc = divide(f, a, &m[first], c, inner);
		return rc == 0 ? divide(f, &m[first], b, c, inner) : rc;
	}
	rc = divide(f, &m[first], b, &m[(first + 1) % 3], inner);
	if (rc == 0)
		rc = divide(f, a, &m[first], &m[(first + 1) % 3], inner);
	return rc == 0 ? divide(f, a, &m[(first + 1) % 3], c, inner) : rc;
}

/* ---- corners in one line of the parameters */

struct outline {
	struct corner *corners; /* owned */
	uint32_t count, room;
};

/* Adds the first corner of an edge, and those between that its neighbours divide it at. */
static int add_edge(struct outline *out, const struct filling *f, const struct corner *a,
		    const struct corner *b)
{
	struct corner middle;
	int rc;

	if (edge_bends(f, a, b)) {
		set_corner(f, &middle, (a->at[0] + b->at[0]) / 2, (a->at[1] + b->at[1]) / 2);
		rc = add_edge(out, f, a, &middle);
		return rc == 0 ? add_edge(out, f, &middle, b) : rc;
	}
	rc = ARRAY_RESERVE(out->corners, out->room, out->count + 1, SOUP_TRIANGLES_MAX);
	if (rc == 0)
		out->corners[out->count++] = *a;
	return rc;
}

/* Adds a triangle whose edges are divided, as a fan. */
static int add_outline(const struct filling *f, const struct corner *const v[3])
{
	struct outline outline = { 0 };
	int rc = 0;

	for (int k = 0; k < 3 && rc == 0; k++)
		rc = add_edge(&outline, f, v[k], v[(k + 1) % 3]);
	for (uint32_t i = 2; i < outline.count && rc == 0; i++)
		rc = add_triangle(f, (const struct corner *[]){ &outline.corners[0],
								&outline.corners[i - 1],
								&outline.corners[i] });
	free(outline.corners);
	return rc;
}

/* Whether a triangle has no area in the parameters that could become smaller: to divide it might
 * never end, as an edge can seem straight whose parts do not. */
static bool is_line(const struct filling *f, const struct corner *const v[3])
{
	const double area = (v[1]->at[0] - v[0]->at[0]) * (v[2]->at[1] - v[0]->at[1]) -
			    (v[1]->at[1] - v[0]->at[1]) * (v[2]->at[0] - v[0]->at[0]);

	return !(fabs(area) > 1e-9 * f->span[0] * f->span[1]);
}

static int divide(struct filling *f, const struct corner *a, const struct corner *b,
		  const struct corner *c, int inner)
{
	const struct corner *const corners[3] = { a, b, c };
	int rc;

	if (f->depth == DEPTH_MAX || is_line(f, corners))
		return add_outline(f, corners);
	f->depth++;
	rc = divide_edges(f, a, b, c, inner);
	f->depth--;
	return rc;
}

static int fill_triangle(void *data, const double a[2], const double b[2], const double c[2])
{
	struct filling *f = data;
	struct corner corners[3];

	set_corner(f, &corners[0], a[0], a[1]);
	set_corner(f, &corners[1], b[0], b[1]);
	set_corner(f, &corners[2], c[0], c[1]);
	return divide(f, &corners[0], &corners[1], &corners[2], 0);
}

/* ---- trimming */

struct contours {
	struct trim_edge *edges; /* owned */
	uint32_t count, room;
	double begin[2], last[2]; /* of the contour that is read */
	bool is_begun;
};

static int add_place(struct contours *contours, const double at[2])
{
	int rc;

	if (!contours->is_begun)
		memcpy(contours->begin, at, sizeof(contours->begin));
	else if (memcmp(contours->last, at, sizeof(contours->last)) != 0) {
		rc = ARRAY_RESERVE(contours->edges, contours->room, contours->count + 1,
				   TRIM_EDGES_MAX);
		if (rc < 0)
			return rc;
		memcpy(contours->edges[contours->count].from, contours->last,
		       sizeof(contours->last));
		memcpy(contours->edges[contours->count++].to, at, sizeof(contours->last));
	}
	contours->is_begun = true;
	memcpy(contours->last, at, sizeof(contours->last));
	return 0;
}

static int add_polyline(struct contours *contours, const struct vrml_node *node)
{
	const struct vrml_value *points = vrml_get(node, "point");
	int rc = 0;

	for (uint32_t i = 0; points && i + 1 < points->count && rc == 0; i += 2) {
		const double at[2] = { (double)points->floats[i], (double)points->floats[i + 1] };

		rc = add_place(contours, at);
	}
	return rc;
}

static int add_curve(struct contours *contours, const struct vrml_node *node,
		     struct diagnostics *diagnostics)
{
	const struct vrml_value *points = vrml_get(node, "controlPoint");
	const struct vrml_value *weights = vrml_get(node, "weight");
	const uint32_t count = points ? points->count / 2 : 0;
	struct nurbs_curve curve = { .width = 2, .points = points ? points->floats : NULL };
	double low, high;
	uint32_t steps;
	float *own;
	int rc = read_axis(&curve.axis, &own, node, "knot", "order", count, diagnostics);

	if (rc == 0 && weights && weights->count > 0) {
		rc = check_weights(node, weights, count, diagnostics);
		curve.weights = weights->floats;
	}
	steps = SPAN_STEPS * (count - curve.axis.order + 1);
	if (rc == 0)
		nurbs_axis_range(&curve.axis, &low, &high);
	for (uint32_t i = 0; rc == 0 && i <= steps; i++) {
		double at[2];

		nurbs_curve_place(&curve, low + (high - low) * i / steps, at);
		rc = add_place(contours, at);
	}
	free(own);
	return rc;
}

static int add_contour(struct contours *contours, const struct vrml_node *contour,
		       struct diagnostics *diagnostics)
{
	uint32_t count;
	struct vrml_node *const *children = vrml_children(contour, &count);
	int rc = 0;

	contours->is_begun = false;
	for (uint32_t i = 0; i < count && rc == 0; i++)
		rc = vrml_is(children[i], "Polyline2D") ? add_polyline(contours, children[i])
		     : vrml_is(children[i], "NurbsCurve2D")
			     ? add_curve(contours, children[i], diagnostics)
			     : refuse(diagnostics, children[i], "is no part of a contour",
				      "Contour2D has Polyline2D and NurbsCurve2D");
	if (rc == 0 && contours->is_begun)
		rc = add_place(contours, contours->begin);
	return rc;
}

static int fill_trimmed(struct filling *f, const struct vrml_node *trimmed,
			struct diagnostics *diagnostics)
{
	const struct vrml_value *list = vrml_get(trimmed, "trimmingContour");
	struct contours contours = { 0 };
	int rc = 0;

	for (uint32_t i = 0; i < list->count && rc == 0; i++)
		rc = add_contour(&contours, list->nodes[i], diagnostics);
	if (rc == -EFBIG)
		rc = refuse(diagnostics, trimmed, "has contours of over 4096 edges",
			    "simplify them");
	for (uint32_t i = 0; i < contours.count && rc == 0; i++)
		for (int k = 0; k < 2; k++)
			if (contours.edges[i].to[k] < f->low[k] ||
			    contours.edges[i].to[k] > f->high[k])
				rc = refuse(diagnostics, trimmed,
					    "has a contour beyond the surface's knots",
					    "export it again");
	if (rc == 0)
		rc = trim_triangles(contours.edges, contours.count, fill_triangle, f);
	free(contours.edges);
	return rc;
}

static int fill_whole(struct filling *f)
{
	const double *low = f->low, *high = f->high;
	const struct trim_edge border[4] = {
		{ { low[0], low[1] }, { high[0], low[1] } },
		{ { high[0], low[1] }, { high[0], high[1] } },
		{ { high[0], high[1] }, { low[0], high[1] } },
		{ { low[0], high[1] }, { low[0], low[1] } },
	};

	return trim_triangles(border, 4, fill_triangle, f);
}

int vrml_nurbs_add(struct soup *soup, const struct vrml_node *geometry, const uint8_t rgb[3],
		   struct diagnostics *diagnostics)
{
	const bool is_trimmed = vrml_is(geometry, "TrimmedSurface");
	const struct vrml_node *node =
		is_trimmed ? vrml_node_of(geometry, "surface", "NurbsSurface") : geometry;
	const struct vrml_value *contours =
		is_trimmed ? vrml_get(geometry, "trimmingContour") : NULL;
	struct filling filling = { .soup = soup, .rgb = rgb };
	float *own[2] = { NULL, NULL };
	int rc;

	if (!node)
		return refuse(diagnostics, geometry, "has no NurbsSurface",
			      "give it one as surface");
	if (is_trimmed && vrml_get_integer(node, "ccw", 1) == 0)
		soup->is_inside_out = !soup->is_inside_out;
	rc = read_surface(&filling, own, node, diagnostics);
	if (rc == 0)
		rc = contours && contours->count > 0 ? fill_trimmed(&filling, geometry, diagnostics)
						     : fill_whole(&filling);
	free(own[0]);
	free(own[1]);
	return rc;
}
