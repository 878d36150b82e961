/* Imports one scan: detects the format, calls the reader, converts to metres with z up, repairs the
 * mesh, and gives every vertex a colour. */
#include "pipeline/import/import.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/parallel.h"
#include "base/spill.h"
#include "base/transient.h"
#include "pipeline/import/gltf_check.h"
#include "pipeline/import/import_files.h"
#include "pipeline/import/import_foreign.h"
#include "pipeline/import/import_limits.h"
#include "pipeline/import/import_ply.h"
#include "pipeline/import/import_vrml.h"
#include "pipeline/import/mesh_colour.h"

enum { GLB_JSON_AT = 20 /* behind its head and that of the chunk */ };

static const uint8_t sandstone[3] = { 186, 166, 136 };

/* ---- detecting the format */

const char *import_format_name(enum scan_format format)
{
	static const char *const names[] = { "PLY", "STL", "OFF", "OBJ", "glTF", "GLB", "VRML" };

	return format < SCAN_UNKNOWN ? names[format] : "";
}

/* Detects the format by the first bytes if they are distinctive, otherwise by the file name: OBJ
 * and binary STL have no signature. */
static enum scan_format sniff(const char *path, const char *head, size_t size)
{
	static const struct {
		const char *extension;
		enum scan_format format;
	} names[] = {
		{ ".ply", SCAN_PLY },  { ".stl", SCAN_STL },   { ".off", SCAN_OFF },
		{ ".obj", SCAN_OBJ },  { ".gltf", SCAN_GLTF }, { ".glb", SCAN_GLB },
		{ ".wrl", SCAN_VRML }, { ".wrz", SCAN_VRML },
	};

	if (size >= 4 && memcmp(head, "ply", 3) == 0 && isspace((unsigned char)head[3]))
		return SCAN_PLY;
	if (size >= 4 && memcmp(head, "glTF", 4) == 0)
		return SCAN_GLB;
	if (size >= 3 && memcmp(head, "OFF", 3) == 0)
		return SCAN_OFF;
	if (size >= 6 && memcmp(head, "#VRML ", 6) == 0)
		return SCAN_VRML;
	for (size_t i = 0; i < ARRAY_COUNT(names); i++)
		if (import_has_extension(path, names[i].extension))
			return names[i].format;
	return size >= 6 && memcmp(head, "solid ", 6) == 0 ? SCAN_STL : SCAN_UNKNOWN;
}

int import_detect(enum scan_format *format, uint64_t *file_bytes, const char *path,
		  struct diagnostics *diagnostics)
{
	char head[64];
	struct stat status;
	ssize_t got = -1;
	/* O_NONBLOCK: do not wait if it is a FIFO */
	int fd = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);

	if (fd < 0)
		return diagnostics_add(diagnostics, -errno, path, 0, "%s", strerror(errno));
	if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode))
		got = read(fd, head, sizeof(head));
	close(fd);
	if (got < 0)
		return diagnostics_add(diagnostics, -EINVAL, path, 0,
				       "not a regular file that can be read");
	if (got == 0)
		return diagnostics_add(diagnostics, -EBADMSG, path, 0,
				       "the file is empty; copy it again from the source");
	*file_bytes = (uint64_t)status.st_size;
	*format = sniff(path, head, (size_t)got);
	if (*format == SCAN_UNKNOWN)
		return diagnostics_add(
			diagnostics, -EINVAL, path, 0,
			"not a supported scan format; give PLY, OBJ, STL, OFF, glTF, "
			"GLB or VRML97");
	return 0;
}

/* ---- placing the scan, and converting axes, unit and colours */

enum { RANGE_ITEMS = 1 << 16 /* that one thread converts at a time */ };

struct conversion {
	struct mesh *mesh;
	const struct transform *transform; /* NULL: the scan is in its place */
	enum import_axis up;
	double metres_per_unit;
};

/* Which axis of the file becomes x, y and z. */
static const int turned_axes[3][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 2, 0 } };

/* Rotates the file's up axis to z. Only rotations are used, so right-handed stays right-handed. */
static void turn_up(const float from[3], enum import_axis up, double to[3])
{
	for (int k = 0; k < 3; k++)
		to[k] = from[turned_axes[up][k]];
	if (up == IMPORT_Y_UP)
		to[1] = -to[1];
}

void import_place(float out_m[3], const float from[3], const struct import_options *options)
{
	double scale = options->metres_per_unit > 0 ? options->metres_per_unit : 1;
	double place[3] = { (double)from[0], (double)from[1], (double)from[2] }, turned[3];
	float moved[3];

	if (options->transform)
		transform_point(options->transform, place, place);
	for (int k = 0; k < 3; k++)
		moved[k] = (float)place[k];
	turn_up(moved, options->up, turned);
	for (int k = 0; k < 3; k++)
		out_m[k] = (float)(turned[k] * scale);
}

void import_transform(struct transform *out, const struct import_options *options)
{
	const double scale = options->metres_per_unit > 0 ? options->metres_per_unit : 1;
	static const struct transform stays = {
		{ { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } }
	};
	const struct transform *placed = options->transform ? options->transform : &stays;

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 4; k++) {
			const double sign = options->up == IMPORT_Y_UP && i == 1 ? -1 : 1;

			out->rows[i][k] =
				sign * scale * placed->rows[turned_axes[options->up][i]][k];
		}
}

static int convert_vertices(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	const struct conversion *conversion = user;
	struct mesh *mesh = conversion->mesh;
	double place[3];

	(void)worker;
	spill_breathe();
	for (uint32_t i = first; i < after; i++) {
		float *position = mesh->positions[i];

		for (int k = 0; k < 3; k++)
			place[k] = position[k];
		if (conversion->transform)
			transform_point(conversion->transform, place, place);
		for (int k = 0; k < 3; k++)
			position[k] = (float)place[k];
		turn_up(position, conversion->up, place);
		for (int k = 0; k < 3; k++)
			position[k] = (float)(place[k] * conversion->metres_per_unit);
	}
	return 0;
}

/* A mirrored surface would show its inside. */
static int reverse_faces(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	struct mesh *mesh = user;

	(void)worker;
	spill_breathe();
	for (uint32_t i = first; i < after; i++) {
		uint32_t second = mesh->triangles[i][1];

		mesh->triangles[i][1] = mesh->triangles[i][2];
		mesh->triangles[i][2] = second;
	}
	return 0;
}

/* is_placed: the reader has applied the transformation. */
static int convert(struct mesh *mesh, bool is_placed, const struct import_options *options)
{
	const uint32_t jobs = import_jobs(options);
	struct conversion conversion = {
		.mesh = mesh,
		.transform = is_placed ? NULL : options->transform,
		.up = options->up,
		.metres_per_unit = options->metres_per_unit > 0 ? options->metres_per_unit : 1,
	};
	int rc = 0;

	if (options->transform && transform_mirrors(options->transform))
		rc = parallel_ranges(jobs, mesh->triangle_count, RANGE_ITEMS, reverse_faces, mesh);
	if (rc < 0 || (!conversion.transform && conversion.up == IMPORT_Z_UP &&
		       conversion.metres_per_unit == 1))
		return rc;
	return parallel_ranges(jobs, mesh->vertex_count, RANGE_ITEMS, convert_vertices,
			       &conversion);
}

static void drop_textures(struct mesh *mesh)
{
	for (uint32_t i = 0; i < mesh->texture_count; i++)
		spill_free(mesh->textures[i].rgb);
	free(mesh->textures);
	spill_free(mesh->uvs);
	spill_free(mesh->materials);
	mesh->textures = NULL;
	mesh->uvs = NULL;
	mesh->materials = NULL;
	mesh->texture_count = 0;
}

static void default_colour_of(const struct import_options *options, uint8_t rgb[3])
{
	static const uint8_t none[3] = { 0 };
	bool given = memcmp(options->default_colour, none, 3) != 0 || options->override_colour;

	memcpy(rgb, given ? options->default_colour : sandstone, 3);
}

/* Removes colours that will not be shown. This must happen before equal vertices are merged,
 * because such colours would keep vertices apart. */
static void drop_colours(struct mesh *mesh, const struct import_options *options,
			 const struct import_report *report)
{
	/* Colours of vertices are nearer to pictures that cannot be read than one for all. */
	if (options->override_colour ||
	    (report->textures == 0 && report->had_colours && mesh->colours))
		drop_textures(mesh);
	if (!options->override_colour && !mesh->textures)
		return;
	for (uint32_t i = 0; mesh->colours && i < mesh->vertex_count; i++)
		memset(mesh->colours[i], 255, 3);
}

/* Gives every vertex its final colour. */
static int settle_colours(struct mesh *mesh, const struct import_options *options,
			  const struct import_report *report)
{
	uint8_t rgb[3];

	if (mesh->textures)
		return mesh_colours_from_textures(mesh, import_jobs(options));
	if (report->had_colours && mesh->colours && !options->override_colour)
		return 0;
	if (!mesh->colours) {
		mesh->colours = spill_alloc((size_t)mesh->vertex_count * 4);
		if (!mesh->colours)
			return -errno;
		memset(mesh->colours, 255, (size_t)mesh->vertex_count * 4);
	}
	default_colour_of(options, rgb);
	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		memcpy(mesh->colours[i], rgb, 3);
		spill_pass(i);
	}
	return 0;
}

/* Warns about lost precision: a float has 24 significant bits, and far from the origin they are
 * used up by the distance. */
static void judge_box(struct mesh *mesh, const char *path, struct import_report *report)
{
	static const float rounding = 6e-8f, seen_m = 0.005f; /* by a visitor beside a wall */
	float far_m = 0, size_m = 0;

	mesh_box(mesh, report->low_m, report->high_m);
	for (int k = 0; k < 3; k++) {
		far_m = fmaxf(far_m, fmaxf(fabsf(report->low_m[k]), fabsf(report->high_m[k])));
		size_m = fmaxf(size_m, report->high_m[k] - report->low_m[k]);
	}
	if (far_m > 1000 * size_m || rounding * far_m > seen_m)
		diagnostics_add(&report->warning, 0, path, 0,
				"it lies %.0f m from the origin and is %.2f m large, so places are "
				"known to %.1f mm; move it to the origin before export",
				far_m, size_m, 1000 * rounding * far_m);
}

static int finish(struct mesh *mesh, const char *path, bool is_indexed,
		  const struct import_options *options, struct import_report *report,
		  struct diagnostics *diagnostics)
{
	int rc;

	rc = convert(mesh, is_indexed, options);
	drop_colours(mesh, options, report);
	if (rc == 0)
		rc = mesh_repair(mesh, import_jobs(options), &report->repairs);
	if (rc == 0)
		rc = settle_colours(mesh, options, report);
	if (rc < 0)
		return diagnostics_add(diagnostics, rc, path, 0, "%s", import_lack(rc));
	if (mesh->triangle_count == 0)
		return diagnostics_add(
			diagnostics, -EBADMSG, path, 0,
			"none of its faces is usable (%" PRIu32 " degenerate, %" PRIu32
			" with a corner that is not a number); export it again",
			report->repairs.degenerate_faces, report->repairs.lost_faces);
	/* assimp gives every face its own vertices, so merging them is no repair of the scan. */
	if (!is_indexed)
		report->repairs.merged_vertices = 0;
	mesh->scan_count = 1;
	mesh->scans[0].triangle_count = mesh->triangle_count;
	report->vertices = mesh->vertex_count;
	report->triangles = mesh->triangle_count;
	judge_box(mesh, path, report);
	return 0;
}

bool import_axis_named(const char *name, enum import_axis *out)
{
	static const char *const names[] = { "z", "y", "x" };

	for (int i = 0; i < 3; i++)
		if (strcmp(name, names[i]) == 0) {
			*out = (enum import_axis)i;
			return true;
		}
	return false;
}

bool import_unit_named(const char *name, double *out_metres)
{
	static const struct {
		const char *name;
		double metres;
	} units[] = { { "m", 1 }, { "cm", 0.01 }, { "mm", 0.001 }, { "in", 0.0254 } };
	char *end;
	double metres;

	for (size_t i = 0; i < ARRAY_COUNT(units); i++)
		if (strcmp(name, units[i].name) == 0) {
			*out_metres = units[i].metres;
			return true;
		}
	metres = strtod(name, &end);
	if (end == name || *end || !(metres > 0) || metres > 1e9)
		return false;
	*out_metres = metres;
	return true;
}

/* Returns how many bytes hold the JSON: all of a glTF, and the first chunk of a GLB. */
static uint64_t gltf_look_bytes(int fd, uint64_t file_bytes)
{
	uint8_t head[16] = { 0 };
	struct reader reader;
	uint64_t bytes;

	if (bytes_read_at(fd, head, sizeof(head), 0) < 0 || memcmp(head, "glTF", 4) != 0)
		return file_bytes;
	reader_init(&reader, (struct bytes){ head + 12, 4 });
	bytes = GLB_JSON_AT + (uint64_t)reader_u32(&reader);
	return bytes < file_bytes ? bytes : file_bytes;
}

/* Refuses a glTF file that cannot be read right, before anything is read of it. */
static int check_gltf(const char *path, uint64_t file_bytes, struct diagnostics *diagnostics)
{
	int fd = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
	int rc = fd < 0 ? -errno : 0;
	const size_t size = rc == 0 ? gltf_look_bytes(fd, file_bytes) : 0;
	uint8_t *text = malloc(size + 1);

	if (rc == 0)
		rc = text ? bytes_read_at(fd, text, size, 0) : -ENOMEM;
	if (fd >= 0)
		close(fd);
	if (rc < 0)
		diagnostics_add(diagnostics, rc, path, 0, "%s", strerror(-rc));
	else
		rc = gltf_check_extensions((struct bytes){ text, size }, path, diagnostics);
	if (rc == 0)
		rc = gltf_check_coordinates((struct bytes){ text, size }, path, diagnostics);
	free(text);
	return rc;
}

/* Refuses early what its reader would refuse, or read wrong. */
static int check_format(const char *path, enum scan_format format, uint64_t file_bytes,
			struct diagnostics *diagnostics)
{
	if (format == SCAN_PLY)
		return import_ply_check(path, diagnostics);
	if (format == SCAN_GLTF || format == SCAN_GLB)
		return check_gltf(path, file_bytes, diagnostics);
	return 0;
}

int import_check(const char *path, struct diagnostics *diagnostics)
{
	enum scan_format format = SCAN_UNKNOWN;
	uint64_t file_bytes = 0;
	int rc = import_detect(&format, &file_bytes, path, diagnostics);

	return rc < 0 ? rc : check_format(path, format, file_bytes, diagnostics);
}

bool import_is_points(const char *path, uint64_t *points)
{
	enum scan_format format = SCAN_UNKNOWN;
	uint64_t file_bytes;

	*points = 0;
	return import_detect(&format, &file_bytes, path, NULL) == 0 && format == SCAN_PLY &&
	       import_ply_is_points(path, points);
}

int import_names_files(const char *path)
{
	enum scan_format format = SCAN_UNKNOWN;
	uint64_t file_bytes;
	const int rc = import_detect(&format, &file_bytes, path, NULL);

	if (rc < 0)
		return is_transient(rc) ? rc : 1;
	return format == SCAN_PLY ? import_ply_names_files(path)
				  : format != SCAN_STL && format != SCAN_OFF;
}

static int read_scan(struct mesh *out, const char *path, enum scan_format format,
		     const struct import_options *options, struct import_report *report,
		     struct diagnostics *diagnostics)
{
	static const char *const extensions[] = { ".ply",  ".stl", ".off", ".obj",
						  ".gltf", ".glb", ".wrl" };
	const struct import_foreign_format foreign = {
		.extension = extensions[format],
		.is_linear = format == SCAN_GLTF || format == SCAN_GLB,
		.has_materials = format != SCAN_STL && format != SCAN_OFF,
	};

	int rc;

	if (format == SCAN_PLY)
		return import_ply(out, path, options, report, diagnostics);
	if (format == SCAN_VRML)
		return import_vrml(out, path, options, report, diagnostics);
	rc = check_format(path, format, report->file_bytes, diagnostics);
	if (rc < 0)
		return rc;
	return import_foreign(out, path, foreign, options, report, diagnostics);
}

int import_scan(struct mesh *out, const char *path, const struct import_options *options,
		struct import_report *report, struct diagnostics *diagnostics)
{
	struct import_report unwanted;
	int64_t began_ms = clock_now_ms();
	enum scan_format format = SCAN_UNKNOWN;
	int rc;

	*out = (struct mesh){ 0 };
	if (!report)
		report = &unwanted;
	*report = (struct import_report){ 0 };
	rc = import_detect(&format, &report->file_bytes, path, diagnostics);
	snprintf(report->format, sizeof(report->format), "%s", import_format_name(format));
	if (rc == 0)
		rc = read_scan(out, path, format, options, report, diagnostics);
	if (rc == 0)
		rc = finish(out, path, format == SCAN_PLY, options, report, diagnostics);
	if (rc < 0)
		mesh_finish(out);
	report->duration_ms = clock_now_ms() - began_ms;
	return rc;
}
