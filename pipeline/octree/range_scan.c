/* Collects the points of a PLY and finds their normals: from the grid, the file or the faces. */
#include "pipeline/octree/range_scan.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/spill.h"
#include "geometry/vec.h"
#include "pipeline/import/ply.h"
#include "pipeline/octree/range_cloud.h"
#include "pipeline/octree/range_grid.h"

struct collector {
	const struct ply_summary *summary;
	struct range_point *points; /* owned; in the axes of the file */
	struct range_grid grid;
	double (*face_normals)[3]; /* of each vertex, summed; owned; NULL: no faces */
	uint32_t (*triangles)[3];  /* owned; NULL: no faces */
	uint32_t triangle_count, triangle_room;
};

/* Beyond these, sums lose their meaning. */
static const double place_most = 1e12;
static const float weight_most = 1e6f;

/* ---- reading */

static int take_vertex(void *data, uint32_t index, const struct ply_vertex *vertex)
{
	struct collector *collector = data;
	struct range_point *point = &collector->points[index];

	*point = (struct range_point){ .weight = vertex->confidence };
	memcpy(point->at, vertex->position, sizeof(point->at));
	memcpy(point->normal, vertex->normal, sizeof(point->normal));
	memcpy(point->colour, vertex->colour, 3);
	point->colour[3] = collector->summary->has_colour ? 255 : 0;
	for (int k = 0; k < 3; k++)
		if (!(fabs(point->at[k]) <= place_most))
			point->weight = 0;
	point->weight = point->weight > 0 ? fminf(point->weight, weight_most) : 0;
	spill_pass(index);
	return 0;
}

static int take_cell(void *data, uint64_t index, int64_t vertex)
{
	struct collector *collector = data;

	collector->grid.cells[index] = vertex < 0 ? RANGE_NO_POINT : (uint32_t)vertex;
	spill_pass(index);
	return 0;
}

static int take_triangle(void *data, uint64_t index, const struct ply_triangle *triangle)
{
	struct collector *collector = data;
	int rc;

	(void)index;
	if (!collector->face_normals)
		return 0;
	rc = ARRAY_RESERVE(collector->triangles, collector->triangle_room,
			   collector->triangle_count + 1ull, UINT32_MAX - 1);
	if (rc < 0)
		return rc;
	memcpy(collector->triangles[collector->triangle_count++], triangle->corner,
	       sizeof(collector->triangles[0]));
	return 0;
}

/* Says whether the file is a range image: 1, 0, or -EBADMSG. */
static int judge_grid(const struct ply_summary *summary, const char *path,
		      struct diagnostics *diagnostics)
{
	const uint64_t cells = (uint64_t)summary->grid_columns * summary->grid_rows;

	if (summary->grid_cells > 0 && cells != summary->grid_cells)
		return diagnostics_add(diagnostics, -EBADMSG, path, 0,
				       "its range_grid has %" PRIu64
				       " cells, but obj_info num_cols and num_rows say %u times "
				       "%u; correct these lines of its header",
				       summary->grid_cells, summary->grid_columns,
				       summary->grid_rows);
	return summary->grid_cells > 0 ||
	       (cells > 0 && cells == summary->vertex_count && summary->face_count == 0);
}

static int judge(const struct ply_summary *summary, int is_grid, const char *path,
		 struct diagnostics *diagnostics)
{
	if (summary->vertex_count == 0)
		return diagnostics_add(diagnostics, -EBADMSG, path, 0,
				       "it holds no points; export it again");
	if (!is_grid && !summary->has_normal && summary->face_count == 0)
		return diagnostics_add(
			diagnostics, -EBADMSG, path, 0,
			"its points have neither a range_grid nor normals (nx ny nz): "
			"which side is outside is unknown; export the range image, or "
			"compute normals that look outwards (MeshLab: Compute normals for point "
			"sets, with Flip normals w.r.t. viewpoint; CloudCompare: Normals, Compute "
			"and Orient)");
	return 0;
}

/* The header's counts were checked against the file's length, so they are safe to allocate. */
static int allocate(struct collector *collector, bool is_grid)
{
	const struct ply_summary *summary = collector->summary;
	const uint64_t cells = (uint64_t)summary->grid_columns * summary->grid_rows;

	collector->points = spill_alloc(summary->vertex_count * sizeof(*collector->points));
	if (!collector->points)
		return -errno;
	if (is_grid) {
		collector->grid.columns = summary->grid_columns;
		collector->grid.rows = summary->grid_rows;
		collector->grid.cells = spill_alloc(cells * sizeof(*collector->grid.cells));
		if (!collector->grid.cells)
			return -errno;
	} else if (summary->face_count > 0) {
		collector->face_normals =
			spill_alloc(summary->vertex_count * sizeof(*collector->face_normals));
		if (!collector->face_normals)
			return -errno;
	}
	/* Without a range_grid, the vertices themselves are the cells. */
	for (uint64_t i = 0; is_grid && i < cells; i++) {
		collector->grid.cells[i] = (uint32_t)i;
		spill_pass(i);
	}
	return 0;
}

/* ---- normals and lines of sight */

static void set_sight(struct collector *collector, enum range_sight sight)
{
	float axis[3] = { 0 };

	if (sight == RANGE_SIGHT_AUTO)
		sight = collector->grid.cells
				? range_grid_sight(&collector->grid, collector->points)
				: RANGE_SIGHT_AUTO;
	if (sight >= RANGE_SIGHT_MINUS_X)
		axis[sight - RANGE_SIGHT_MINUS_X] = -1;
	else if (sight >= RANGE_SIGHT_PLUS_X)
		axis[sight - RANGE_SIGHT_PLUS_X] = 1;
	for (uint64_t i = 0; i < collector->summary->vertex_count; i++) {
		struct range_point *point = &collector->points[i];

		for (int k = 0; k < 3; k++)
			point->towards[k] =
				sight == RANGE_SIGHT_ORIGIN ? -(float)point->at[k] : axis[k];
		if (!isfinite(vec_normalise(point->towards)))
			memset(point->towards, 0, sizeof(point->towards));
		spill_pass(i);
	}
}

static void drop_missing(struct collector *collector)
{
	struct range_grid *grid = &collector->grid;

	for (uint64_t i = 0; i < (uint64_t)grid->columns * grid->rows; i++) {
		const struct range_point *point;

		spill_pass(i);
		if (grid->cells[i] == RANGE_NO_POINT)
			continue;
		point = &collector->points[grid->cells[i]];
		/* Without a range_grid, scanners write 0 0 0 where they saw nothing. */
		if (!(point->weight > 0) ||
		    (collector->summary->grid_cells == 0 && point->at[0] == 0 &&
		     point->at[1] == 0 && point->at[2] == 0))
			grid->cells[i] = RANGE_NO_POINT;
	}
}

/* Adds the normal of a face to its corners, of a length that is twice its area. To be called when
 * all is read, because faces may come before vertices. */
static void add_face_normal(struct collector *collector, const uint32_t corners[3])
{
	const double *p[3];
	double n[3];

	for (int k = 0; k < 3; k++)
		p[k] = collector->points[corners[k]].at;
	for (int k = 0; k < 3; k++) {
		const int a = (k + 1) % 3, b = (k + 2) % 3;

		n[k] = (p[1][a] - p[0][a]) * (p[2][b] - p[0][b]) -
		       (p[1][b] - p[0][b]) * (p[2][a] - p[0][a]);
	}
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3 && isfinite(n[i]); i++)
			collector->face_normals[corners[k]][i] += n[i];
}

static int orient(struct collector *collector, enum range_sight sight, double *spacing)
{
	if (collector->grid.cells)
		drop_missing(collector);
	set_sight(collector, sight);
	*spacing = 0;
	if (collector->grid.cells)
		return range_grid_orient(spacing, &collector->grid, collector->points,
					 (uint32_t)collector->summary->vertex_count);
	for (uint32_t t = 0; t < collector->triangle_count; t++) {
		add_face_normal(collector, collector->triangles[t]);
		spill_pass(t);
	}
	for (uint64_t i = 0; i < collector->summary->vertex_count; i++) {
		struct range_point *point = &collector->points[i];
		double length = 0;

		spill_pass(i);
		for (int k = 0; k < 3 && collector->triangles; k++)
			length = fmax(length, fabs(collector->face_normals[i][k]));
		for (int k = 0; k < 3 && collector->triangles; k++)
			point->normal[k] =
				length > 0 ? (float)(collector->face_normals[i][k] / length) : 0;
		length = (double)vec_normalise(point->normal);
		if (!(length > 0) || !isfinite(length))
			point->weight = 0;
	}
	return 0;
}

/* Moves what a direction of the file is to the common axes. */
static void turn(float direction[3], const struct transform *transform)
{
	float turned[3];

	for (int i = 0; i < 3; i++) {
		turned[i] = 0;
		for (int k = 0; k < 3; k++)
			turned[i] += (float)transform->rows[i][k] * direction[k];
	}
	vec_copy(direction, turned);
	vec_normalise(direction);
}

/* Keeps the triangles whose corners were kept. numbers: of each vertex, or RANGE_NO_POINT. A
 * mirrored triangle would show its inside, so its corners change their order. */
static void keep_triangles(struct range_scan *scan, struct collector *collector,
			   const uint32_t *numbers, bool is_mirrored)
{
	const int second = is_mirrored ? 2 : 1;

	for (uint32_t t = 0; t < collector->triangle_count; t++) {
		const uint32_t *corners = collector->triangles[t];
		const uint32_t kept[3] = { numbers[corners[0]], numbers[corners[second]],
					   numbers[corners[3 - second]] };

		if (kept[0] == RANGE_NO_POINT || kept[1] == RANGE_NO_POINT ||
		    kept[2] == RANGE_NO_POINT)
			continue;
		memcpy(collector->triangles[scan->triangle_count++], kept, sizeof(kept));
	}
	scan->triangles = collector->triangles;
	collector->triangles = NULL;
}

/* Drops the points without weight and moves the others to the common axes. */
static int keep_good(struct range_scan *scan, struct collector *collector,
		     const struct transform *transform)
{
	const uint32_t all = (uint32_t)collector->summary->vertex_count;
	uint32_t *numbers = spill_alloc((all + (size_t)1) * sizeof(*numbers));
	double scale = 0;

	if (!numbers)
		return -errno;
	for (int k = 0; k < 3 && transform; k++)
		scale += transform->rows[k][0] * transform->rows[k][0];
	scale = transform ? sqrt(scale) : 1;
	scan->spacing *= scale;
	for (uint32_t i = 0; i < all; i++) {
		struct range_point *point = &collector->points[i];

		spill_pass(i);
		numbers[i] = RANGE_NO_POINT;
		if (!(point->weight > 0))
			continue;
		if (transform) {
			transform_point(transform, point->at, point->at);
			turn(point->normal, transform);
			turn(point->towards, transform);
			point->spacing *= (float)scale;
		}
		numbers[i] = scan->count;
		collector->points[scan->count++] = *point;
	}
	scan->dropped = all - scan->count;
	scan->points = collector->points;
	collector->points = NULL;
	if (collector->triangles)
		keep_triangles(scan, collector, numbers, transform && transform_mirrors(transform));
	spill_free(numbers);
	return 0;
}

int range_scan_read(struct range_scan *out, const char *path, const struct transform *transform,
		    enum range_sight sight, struct diagnostics *diagnostics)
{
	struct collector collector = { 0 };
	const struct ply_visitor visitor = { .data = &collector,
					     .vertex = take_vertex,
					     .triangle = take_triangle,
					     .cell = take_cell };
	struct ply *ply;
	int is_grid = 0, rc = ply_open(&ply, path, diagnostics);

	*out = (struct range_scan){ 0 };
	if (rc < 0)
		return rc;
	collector.summary = ply_summary(ply);
	is_grid = judge_grid(collector.summary, path, diagnostics);
	rc = is_grid < 0 ? is_grid : judge(collector.summary, is_grid, path, diagnostics);
	if (rc == 0)
		rc = allocate(&collector, is_grid > 0);
	if (rc == 0)
		rc = ply_read(ply, &visitor, diagnostics);
	if (rc == 0)
		rc = orient(&collector, sight, &out->spacing);
	if (rc == 0) {
		out->has_colour = collector.summary->has_colour;
		out->grid_columns = collector.grid.columns;
		rc = keep_good(out, &collector, transform);
		if (rc == 0 && out->count == 0)
			rc = diagnostics_add(diagnostics, -EBADMSG, path, 0,
					     "none of its points has a place and a normal; export "
					     "it again");
		if (rc == 0 && !collector.grid.cells && !out->triangles)
			rc = range_cloud_spacing(&out->spacing, out->points, out->count);
	}
	if (rc == -ENOMEM)
		diagnostics_add(diagnostics, rc, path, 0, "too large for this machine's memory");
	ply_close(ply);
	spill_free(collector.points);
	spill_free(collector.grid.cells);
	spill_free(collector.face_normals);
	free(collector.triangles);
	if (rc < 0)
		range_scan_finish(out);
	return rc;
}

void range_scan_finish(struct range_scan *scan)
{
	if (!scan)
		return;
	spill_free(scan->points);
	free(scan->triangles);
	*scan = (struct range_scan){ 0 };
}

int range_scan_check(const char *path, struct diagnostics *diagnostics)
{
	struct ply *ply;
	int is_grid, rc = ply_open(&ply, path, diagnostics);

	if (rc < 0)
		return rc;
	is_grid = judge_grid(ply_summary(ply), path, diagnostics);
	rc = is_grid < 0 ? is_grid : judge(ply_summary(ply), is_grid, path, diagnostics);
	ply_close(ply);
	return rc;
}

bool range_sight_named(const char *name, enum range_sight *out)
{
	static const char *const names[] = { "auto", "origin", "+x", "+y", "+z", "-x", "-y", "-z" };

	for (size_t i = 0; i < ARRAY_COUNT(names); i++)
		if (strcmp(name, names[i]) == 0) {
			*out = (enum range_sight)i;
			return true;
		}
	return false;
}
