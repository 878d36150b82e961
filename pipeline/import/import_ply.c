/* Reads a PLY scan: collects the vertices and triangles of the streaming reader into a mesh, and
 * loads its textures. */
#include "pipeline/import/import_ply.h"

#include <errno.h>
#include <inttypes.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/progress.h"
#include "base/spill.h"
#include "base/transient.h"
#include "pipeline/import/import_files.h"
#include "pipeline/import/import_limits.h"
#include "pipeline/import/import_texture.h"
#include "pipeline/import/ply.h"

/* Collects what the PLY reader delivers. */
struct collector {
	const struct ply_summary *summary;
	const struct transform *transform; /* borrowed; NULL: none */
	struct mesh mesh;
	float (*corner_uvs)[3][2]; /* of each triangle's corners, if the file has them; owned */
	size_t triangle_capacity;
	struct progress *progress; /* counts KiB of the file */
	atomic_ullong bytes_read;
};

static void show_progress(void *data, uint64_t bytes)
{
	struct collector *collector = data;
	uint64_t before = atomic_fetch_add(&collector->bytes_read, bytes);

	spill_breathe();
	progress_add(collector->progress, ((before + bytes) >> 10) - (before >> 10));
}

static int take_vertex(void *data, uint32_t index, const struct ply_vertex *vertex)
{
	struct collector *collector = data;
	struct mesh *mesh = &collector->mesh;
	double place[3];

	memcpy(place, vertex->position, sizeof(place));
	if (collector->transform)
		transform_point(collector->transform, place, place);
	for (int k = 0; k < 3; k++)
		mesh->positions[index][k] = (float)place[k];
	if (mesh->colours)
		memcpy(mesh->colours[index], vertex->colour, sizeof(mesh->colours[index]));
	if (mesh->uvs)
		memcpy(mesh->uvs[index], vertex->uv, sizeof(mesh->uvs[index]));
	return 0;
}

/* Polygons become fans, so there may be more triangles than faces in the header. These come one
 * after the other. */
static int grow_triangles(struct collector *collector)
{
	struct mesh *mesh = &collector->mesh;
	size_t old = collector->triangle_capacity, capacity = old + old / 2 + 64;
	int rc = old >= UINT32_MAX - 1 ? -EFBIG : 0;

	if (rc == 0)
		rc = SPILL_RESIZE(mesh->triangles, old, capacity);
	if (rc == 0)
		rc = SPILL_RESIZE(mesh->faces, old, capacity);
	if (rc == 0 && mesh->materials)
		rc = SPILL_RESIZE(mesh->materials, old, capacity);
	if (rc == 0 && collector->corner_uvs)
		rc = SPILL_RESIZE(collector->corner_uvs, old, capacity);
	if (rc == 0)
		collector->triangle_capacity = capacity;
	return rc;
}

static int take_triangle(void *data, uint64_t index, const struct ply_triangle *triangle)
{
	struct collector *collector = data;
	struct mesh *mesh = &collector->mesh;

	if (index == collector->triangle_capacity) {
		int rc = grow_triangles(collector);

		if (rc < 0)
			return rc;
	}
	memcpy(mesh->triangles[index], triangle->corner, sizeof(mesh->triangles[index]));
	mesh->faces[index] = triangle->face;
	if (mesh->materials)
		mesh->materials[index] =
			(uint16_t)(triangle->texture < collector->summary->texture_count
					   ? triangle->texture
					   : 0);
	if (collector->corner_uvs)
		memcpy(collector->corner_uvs[index], triangle->uv, sizeof(triangle->uv));
	return 0;
}

/* The header's counts were checked against the file's length, so they are safe to allocate. */
static int allocate(struct collector *collector)
{
	const struct ply_summary *summary = collector->summary;
	struct mesh *mesh = &collector->mesh;
	size_t vertices = summary->vertex_count + 1, triangles = summary->face_count + 1;
	bool has_picture =
		summary->texture_count > 0 && (summary->has_uv || summary->has_corner_uv);

	mesh->positions = spill_alloc(vertices * sizeof(*mesh->positions));
	mesh->triangles = spill_alloc(triangles * sizeof(*mesh->triangles));
	mesh->faces = spill_alloc(triangles * sizeof(*mesh->faces));
	if (summary->has_colour || summary->has_open_sky)
		mesh->colours = spill_alloc(vertices * sizeof(*mesh->colours));
	if (has_picture && !summary->has_corner_uv)
		mesh->uvs = spill_alloc(vertices * sizeof(*mesh->uvs));
	if (has_picture)
		mesh->materials = spill_alloc(triangles * sizeof(*mesh->materials));
	if (has_picture && summary->has_corner_uv)
		collector->corner_uvs = spill_alloc(triangles * sizeof(*collector->corner_uvs));
	collector->triangle_capacity = triangles;
	if (!mesh->positions || !mesh->triangles || !mesh->faces ||
	    ((summary->has_colour || summary->has_open_sky) && !mesh->colours) ||
	    (has_picture && (!mesh->materials || (!mesh->uvs && !collector->corner_uvs))))
		return -errno;
	return 0;
}

struct corners {
	struct mesh *mesh;
	float (*const corner_uvs)[3][2];
	/* of each corner; owned */
	float (*positions)[3], (*uvs)[2];
	uint8_t (*colours)[4]; /* NULL: the scan has none */
};

static int copy_corners(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	const struct corners *corners = user;
	struct mesh *mesh = corners->mesh;

	(void)worker;
	spill_breathe();
	for (size_t i = 3 * (size_t)first; i < 3 * (size_t)after; i++) {
		uint32_t *corner = &mesh->triangles[i / 3][i % 3];

		memcpy(corners->positions[i], mesh->positions[*corner],
		       sizeof(corners->positions[i]));
		memcpy(corners->uvs[i], corners->corner_uvs[i / 3][i % 3], sizeof(corners->uvs[i]));
		if (corners->colours)
			memcpy(corners->colours[i], mesh->colours[*corner],
			       sizeof(corners->colours[i]));
		*corner = (uint32_t)i;
	}
	return 0;
}

enum { RANGE_TRIANGLES = 1 << 16 /* that one thread does at a time */ };

/* Gives every corner its own vertex; the repair merges equal ones again. */
static int split_corners(struct collector *collector, uint32_t jobs)
{
	struct mesh *mesh = &collector->mesh;
	size_t count = (size_t)mesh->triangle_count * 3;
	struct corners corners = {
		.mesh = mesh,
		.corner_uvs = collector->corner_uvs,
		.positions = spill_alloc((count + 1) * sizeof(*corners.positions)),
		.uvs = spill_alloc((count + 1) * sizeof(*corners.uvs)),
		.colours =
			mesh->colours ? spill_alloc((count + 1) * sizeof(*corners.colours)) : NULL,
	};
	int rc = corners.positions && corners.uvs && (!mesh->colours || corners.colours) ? 0
											 : -errno;

	if (count >= UINT32_MAX)
		rc = -EFBIG;
	if (rc == 0)
		rc = parallel_ranges(jobs, mesh->triangle_count, RANGE_TRIANGLES, copy_corners,
				     &corners);
	if (rc < 0) {
		spill_free(corners.positions);
		spill_free(corners.uvs);
		spill_free(corners.colours);
		return rc;
	}
	spill_free(mesh->positions);
	spill_free(mesh->colours);
	mesh->positions = corners.positions;
	mesh->colours = corners.colours;
	mesh->uvs = corners.uvs;
	mesh->vertex_count = (uint32_t)count;
	return 0;
}

static int load_textures(struct collector *collector, const char *path,
			 const struct import_options *options, struct import_report *report,
			 struct diagnostics *diagnostics)
{
	static const uint8_t plain[3] = { 255, 255, 255 };
	struct import_files files = {
		.scan_path = path,
		.picture_bytes_left = import_memory_bytes(options, report->file_bytes),
		.picture_bytes_per_byte = import_bytes_per_byte(options),
	};
	struct mesh *mesh = &collector->mesh;
	uint32_t count = collector->summary->texture_count;
	int rc = 0;

	if (!mesh->materials)
		return 0;
	mesh->textures = calloc(count, sizeof(*mesh->textures));
	if (!mesh->textures)
		return -ENOMEM;
	mesh->texture_count = count;
	files.folder_fd = import_files_open_folder(path);
	if (files.folder_fd < 0)
		return files.folder_fd;
	for (uint32_t i = 0; i < count && rc == 0; i++)
		rc = import_texture(&mesh->textures[i], &files, collector->summary->textures[i],
				    plain, report);
	close(files.folder_fd);
	if (files.failure.rc < 0)
		rc = import_files_judge(&files.failure, 0, path, diagnostics);
	return rc;
}

static int read_body(struct ply *ply, struct collector *collector, const char *path,
		     const struct import_options *options, struct import_report *report,
		     struct diagnostics *diagnostics)
{
	const struct ply_visitor visitor = { .data = collector,
					     .vertex = take_vertex,
					     .triangle = take_triangle,
					     .advance = show_progress,
					     .jobs = import_jobs(options) };
	int rc = allocate(collector);

	collector->progress = progress_start("reading the scan", "KiB", ply_bytes_total(ply) >> 10);
	if (rc == 0)
		rc = ply_read(ply, &visitor, diagnostics);
	progress_end(collector->progress);
	if (rc == 0 && ply_triangles(ply) >= UINT32_MAX)
		rc = -EFBIG;
	if (rc == 0) {
		collector->mesh.vertex_count = (uint32_t)collector->summary->vertex_count;
		collector->mesh.triangle_count = (uint32_t)ply_triangles(ply);
	}
	if (rc == 0 && collector->corner_uvs)
		rc = split_corners(collector, import_jobs(options));
	if (rc == 0)
		rc = load_textures(collector, path, options, report, diagnostics);
	if (rc < 0)
		return diagnostics_add(diagnostics, rc, path, 0, "%s",
				       rc == -EFBIG
					       ? "too many triangles; split it into several files"
					       : import_lack(rc));
	return 0;
}

/* Refuses what the header says has no surface. */
static int judge(const struct ply *ply, const char *path, struct diagnostics *diagnostics)
{
	const struct ply_summary *summary = ply_summary(ply);

	if (summary->vertex_count == 0)
		return diagnostics_add(diagnostics, -EBADMSG, path, 0,
				       "it holds no vertices; export it again");
	if (summary->points_only)
		return diagnostics_add(diagnostics, -EBADMSG, path, 0, "%s", summary->points_only);
	return 0;
}

int import_ply_check(const char *path, struct diagnostics *diagnostics)
{
	struct ply *ply;
	int rc = ply_open(&ply, path, diagnostics);

	if (rc == 0)
		rc = judge(ply, path, diagnostics);
	ply_close(ply);
	return rc;
}

bool import_ply_is_points(const char *path, uint64_t *points)
{
	struct ply *ply;
	bool is_points;

	if (ply_open(&ply, path, NULL) < 0)
		return false;
	is_points = ply_summary(ply)->face_count == 0 && ply_summary(ply)->vertex_count > 0;
	if (is_points)
		*points = ply_summary(ply)->vertex_count;
	ply_close(ply);
	return is_points;
}

int import_ply_names_files(const char *path)
{
	struct ply *ply;
	int rc = ply_open(&ply, path, NULL);

	if (rc < 0)
		return is_transient(rc) ? rc : 1;
	rc = ply_summary(ply)->texture_count > 0;
	ply_close(ply);
	return rc;
}

int import_ply(struct mesh *out, const char *path, const struct import_options *options,
	       struct import_report *report, struct diagnostics *diagnostics)
{
	struct collector collector = { .transform = options->transform };
	struct ply *ply;
	int rc = ply_open(&ply, path, diagnostics);

	if (rc < 0)
		return rc;
	collector.summary = ply_summary(ply);
	report->had_colours = collector.summary->has_colour;
	report->had_open_sky = collector.summary->has_open_sky;
	report->strange_lines = collector.summary->strange_lines;
	rc = judge(ply, path, diagnostics);
	if (rc == 0)
		rc = read_body(ply, &collector, path, options, report, diagnostics);
	report->trailing_bytes = ply_bytes_trailing(ply);
	if (ply_lines_skipped(ply) > 0)
		diagnostics_add(&report->warning, 0, path, 0,
				"%" PRIu64 " points or lines in it were left out",
				ply_lines_skipped(ply));
	if (rc == 0) {
		*out = collector.mesh;
		out->scans[0].face_count = (uint32_t)collector.summary->face_count;
		collector.mesh = (struct mesh){ 0 };
	}
	mesh_finish(&collector.mesh);
	spill_free(collector.corner_uvs);
	ply_close(ply);
	return rc;
}
