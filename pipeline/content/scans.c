/* Imports the scans of a content folder into one mesh, and keeps it and its shape in .work. */
#include "pipeline/content/scans.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/log.h"
#include "pipeline/content/scan_key.h"
#include "pipeline/content/scan_reports.h"
#include "pipeline/content/scan_surface.h"
#include "pipeline/import/mesh_file.h"
#include "pipeline/octree/closed_surface.h"
#include "pipeline/octree/reconstruct.h"

/* IMPORT_VERSION must be raised whenever the import gives another mesh for the same files,
 * CLOSING_VERSION whenever surface = octree makes another of it. */
enum {
	IMPORT_VERSION = 3,
	CLOSING_VERSION = 3,
	SHAPE_VERSION = 2,
	KEY_TEXT_MAX = 1 << 26,
	SHAPE_BYTES_MAX = 4096
};

struct scans {
	const struct content *content;
	struct hash key;
	struct surface_plan plan; /* valid with the key */
	struct hash surface;      /* key of the surface, if there is one */
	struct mesh mesh;
	struct scans_shape shape;
	bool has_key, has_mesh, has_shape;
};

int scans_create(struct scans **out, const struct content *content)
{
	*out = calloc(1, sizeof(**out));
	if (!*out) {
		log_error("pipeline", "%s: no memory", content->folder);
		return -ENOMEM;
	}
	(*out)->content = content;
	return 0;
}

void scans_destroy(struct scans *scans)
{
	if (!scans)
		return;
	scans_drop_mesh(scans);
	free(scans);
}

const struct content *scans_content(const struct scans *scans)
{
	return scans->content;
}

/* ---- the key */

static int make_key(struct scans *scans)
{
	const struct content *content = scans->content;
	const struct import_options *import = &content->import;
	struct buffer text;
	int rc;

	surface_plan(&scans->plan, content);
	rc = surface_key(&scans->surface, &scans->plan, content);
	buffer_init(&text, KEY_TEXT_MAX);
	buffer_put_u32(&text, IMPORT_VERSION);
	buffer_put_u32(&text, import->up);
	buffer_put_f64(&text, import->metres_per_unit);
	buffer_put(&text, import->default_colour, sizeof(import->default_colour));
	buffer_put_u8(&text, import->override_colour);
	if (content->surface == CONTENT_SURFACE_OCTREE) {
		buffer_put_u32(&text, CLOSING_VERSION);
		buffer_put_f64(&text, content->cell_mm);
	}
	if (scans->plan.count > 0)
		buffer_put(&text, scans->surface.bytes, HASH_BYTES);
	for (uint32_t i = 0; i < content->scan_count && rc == 0; i++)
		rc = scan_key_put(&text, content, i);
	if (rc == 0)
		rc = text.error;
	if (rc == 0)
		scans->key = hash_of(buffer_bytes(&text));
	buffer_finish(&text);
	return rc;
}

int scans_key(struct scans *scans, struct hash *out, struct diagnostics *diagnostics)
{
	int rc = scans->has_key ? 0 : make_key(scans);

	if (rc < 0)
		return diagnostics_add(diagnostics, rc, scans->content->folder, 0,
				       "its files cannot be listed: %s", strerror(-rc));
	scans->has_key = true;
	*out = scans->key;
	return 0;
}

/* ---- the mesh */

/* Refuses to join a scan with vertex colours to one with pictures, because faces of the joint mesh
 * take their colours from pictures. */
static int judge_mix(const struct content *content, const struct mesh *mesh,
		     const struct import_report *reports, uint32_t count,
		     struct diagnostics *diagnostics)
{
	if (!mesh->textures)
		return 0;
	for (uint32_t i = 0; i < count; i++)
		if (reports[i].textures == 0 && reports[i].had_colours)
			return diagnostics_add(
				diagnostics, -EINVAL, NULL, 0,
				"%s has colours of its own, another scan of the folder has "
				"pictures: bake its colours into a picture too, or set "
				"'colours = #rrggbb'",
				content->scans[i]);
	return 0;
}

/* Tells what is wrong with any scan before the first is imported, which may take long. */
static int check_all(const struct scans *scans, struct diagnostics *diagnostics)
{
	const struct content *content = scans->content;
	int rc = 0;

	for (uint32_t i = 0; i < content->scan_count; i++) {
		int failed = scans->plan.is_points[i]
				     ? range_scan_check(content->scans[i], diagnostics)
				     : import_check(content->scans[i], diagnostics);

		rc = rc == 0 ? failed : rc;
	}
	return rc;
}

static int import_surface(struct mesh *out, struct scans *scans, struct import_report *report,
			  struct diagnostics *diagnostics)
{
	const struct import_options *content = &scans->content->import;
	struct import_options options = { .override_colour = content->override_colour,
					  .jobs = content->jobs };
	char path[CONTENT_PATH_BYTES];
	bool made;
	int rc = surface_make(path, &made, &scans->plan, scans->surface, scans->content,
			      diagnostics);

	memcpy(options.default_colour, content->default_colour, sizeof(options.default_colour));
	return rc < 0 ? rc : import_scan(out, path, &options, report, diagnostics);
}

/* Imports scan i. Of the scans that became the surface, the first is the whole surface, and the
 * others are empty. */
static int import_one(struct mesh *out, struct scans *scans, uint32_t i,
		      struct import_report *report, struct diagnostics *diagnostics)
{
	const struct content *content = scans->content;
	struct import_options options = content->import;
	const bool is_points = scans->plan.is_points[i];
	int rc = 0;

	options.transform = content->transforms[i];
	*out = (struct mesh){ .scan_count = 1 };
	*report = (struct import_report){ 0 };
	if (!is_points)
		rc = import_scan(out, content->scans[i], &options, report, diagnostics);
	else if (i == scans->plan.first)
		rc = import_surface(out, scans, report, diagnostics);
	if (is_points)
		snprintf(report->format, sizeof(report->format), "points");
	if (rc == 0 && report->warning.first.text[0])
		log_warn("pipeline", "%s", report->warning.first.text);
	return rc;
}

static int import_all(struct mesh *out, struct scans *scans,
		      struct import_report reports[CONTENT_SCANS_MAX],
		      struct diagnostics *diagnostics)
{
	const struct content *content = scans->content;
	uint32_t count = 0;
	int rc = check_all(scans, diagnostics);

	for (; count < content->scan_count && rc == 0; count++) {
		struct mesh mesh;

		rc = import_one(&mesh, scans, count, &reports[count], diagnostics);
		if (rc < 0)
			break;
		if (count == 0) {
			*out = mesh;
			continue;
		}
		if (mesh.triangle_count > 0)
			rc = mesh_append(out, &mesh);
		else
			out->scans[out->scan_count++] = mesh.scans[0];
		mesh_finish(&mesh);
		if (rc < 0)
			diagnostics_add(diagnostics, rc, content->scans[count], 0,
					"too large together with the scans before it");
	}
	return rc < 0 ? rc : judge_mix(content, out, reports, count, diagnostics);
}

/* Replaces the joint mesh by the closed surface that is asked for. */
static int close_surface(struct mesh *mesh, const struct content *content,
			 struct diagnostics *diagnostics)
{
	struct closed_surface_report report;
	int rc;

	if (content->surface != CONTENT_SURFACE_OCTREE)
		return 0;
	rc = closed_surface_make(mesh, content->cell_mm / 1000, &report, diagnostics);
	if (rc < 0)
		return rc;
	log_info("pipeline",
		 "surface: %u triangles in %u closed parts of %u in %u shells (%u inside out, %u "
		 "triangles twice), cubes of %.4g mm%s",
		 mesh->triangle_count, report.parts, report.triangles, report.shells,
		 report.turned_shells, report.copies, 1000 * report.cell_m,
		 content->cell_mm > 0 ? "" : " (cell_mm sets others)");
	log_info(
		"pipeline",
		"surface: %.1f %% of the scans' area lies inside of matter and is left out, %.1f %% "
		"encloses nothing and becomes sheets; left out are %u small parts or cavities",
		100 * report.inner_share, 100 * report.sheet_share, report.dropped_parts);
	return 0;
}

int scans_make_surface(struct scans *scans, bool *made, struct diagnostics *diagnostics)
{
	char path[CONTENT_PATH_BYTES];
	struct hash key;
	int rc = scans_key(scans, &key, diagnostics);

	*made = false;
	if (rc < 0 || scans->plan.count == 0 || surface_is_made(scans->surface, scans->content))
		return rc;
	rc = check_all(scans, diagnostics);
	return rc < 0 ? rc
		      : surface_make(path, made, &scans->plan, scans->surface, scans->content,
				     diagnostics);
}

void scans_surface(struct scans *scans, struct scans_surface *out)
{
	struct hash key;

	*out = (struct scans_surface){ 0 };
	if (scans_key(scans, &key, NULL) < 0 || scans->plan.count == 0)
		return;
	out->scan_count = scans->plan.count;
	out->point_count = scans->plan.points;
	memcpy(out->is_points, scans->plan.is_points, sizeof(out->is_points));
	out->is_made = surface_is_made(scans->surface, scans->content);
}

/* ---- what the import reported */

int scans_get_reports(struct scans *scans, struct import_report *reports)
{
	char path[CONTENT_PATH_BYTES];
	struct hash key;
	int rc = scans_key(scans, &key, NULL);

	if (rc == 0)
		rc = content_work_path(scans->content, "imported", path);
	return rc < 0 ? rc : scan_reports_load(reports, path, key);
}

static int save_reports(const struct scans *scans, struct import_report *reports)
{
	char path[CONTENT_PATH_BYTES];
	int rc = content_work_path(scans->content, "imported", path);

	return rc < 0 ? rc
		      : scan_reports_save(path, scans->key, reports, scans->content->scan_count);
}

/* A scan that is still being copied would be kept as it was half-way, under the key of the time
 * before. */
static int check_unchanged(struct scans *scans, struct diagnostics *diagnostics)
{
	const struct hash before = scans->key;
	struct hash now;
	int rc;

	scans->has_key = false;
	rc = scans_key(scans, &now, diagnostics);
	if (rc < 0 || hash_equal(now, before))
		return rc;
	scans->has_key = false; /* it may still be growing */
	return diagnostics_add(diagnostics, -ESTALE, scans->content->folder, 0,
			       "a scan or a file beside it was changed while it was read; "
			       "if it is being copied, wait for the end, then do this again");
}

static int import_and_save(struct scans *scans, const char *path, struct diagnostics *diagnostics)
{
	struct import_report *reports = calloc(CONTENT_SCANS_MAX, sizeof(*reports));
	int rc = reports ? import_all(&scans->mesh, scans, reports, diagnostics) : -ENOMEM;

	if (rc == 0)
		rc = close_surface(&scans->mesh, scans->content, diagnostics);
	if (rc == 0)
		rc = check_unchanged(scans, diagnostics);
	if (rc == 0) {
		rc = mesh_file_move(&scans->mesh, scans->key, path);
		if (rc < 0)
			diagnostics_add(diagnostics, rc, path, 0, "%s; is the disk full?",
					strerror(-rc));
	}
	if (rc == 0) {
		rc = save_reports(scans, reports);
		if (rc < 0)
			diagnostics_add(diagnostics, rc, scans->content->folder, 0,
					".work/imported: %s; is the disk full?", strerror(-rc));
	}
	free(reports);
	if (rc < 0)
		mesh_finish(&scans->mesh);
	return rc;
}

/* A mesh without the reports is half an import: whether a scan had pictures is told there alone. */
static bool has_reports(struct scans *scans)
{
	struct import_report *reports = calloc(CONTENT_SCANS_MAX, sizeof(*reports));
	const bool has = reports && scans_get_reports(scans, reports) >= 0;

	free(reports);
	return has;
}

static int load_mesh(struct scans *scans, struct diagnostics *diagnostics)
{
	char path[CONTENT_PATH_BYTES];
	struct hash key;
	int rc = scans_key(scans, &key, diagnostics);

	if (rc < 0)
		return rc;
	rc = content_work_path(scans->content, "mesh", path);
	if (rc < 0)
		return diagnostics_add(diagnostics, rc, NULL, 0, "%s/.work: %s",
				       scans->content->folder, strerror(-rc));
	if (!has_reports(scans) || mesh_file_load(&scans->mesh, key, path) < 0)
		rc = import_and_save(scans, path, diagnostics);
	scans->has_mesh = rc == 0;
	return rc;
}

/* ---- the shape */

/* The file contains: version, the key of the scans, the shape, and a hash of everything before. */
static void encode_shape(struct buffer *file, const struct scans *scans)
{
	const struct scans_shape *shape = &scans->shape;
	struct hash hash;

	buffer_put_u32(file, SHAPE_VERSION);
	buffer_put(file, scans->key.bytes, HASH_BYTES);
	for (int k = 0; k < 3; k++) {
		buffer_put_f32(file, shape->low_m[k]);
		buffer_put_f32(file, shape->high_m[k]);
	}
	buffer_put_u8(file, shape->has_textures);
	buffer_put_u8(file, shape->had_pictures);
	buffer_put_u32(file, shape->scan_count);
	for (uint32_t i = 0; i < shape->scan_count; i++)
		buffer_put_u32(file, shape->face_counts[i]);
	hash = hash_of(buffer_bytes(file));
	buffer_put(file, hash.bytes, HASH_BYTES);
}

static bool decode_shape(struct scans *scans, struct bytes file)
{
	struct scans_shape *shape = &scans->shape;
	struct reader reader;
	struct bytes key, hash;
	struct hash made;
	size_t body;

	reader_init(&reader, file);
	if (reader_u32(&reader) != SHAPE_VERSION)
		return false;
	key = reader_bytes(&reader, HASH_BYTES);
	for (int k = 0; k < 3; k++) {
		shape->low_m[k] = reader_f32(&reader);
		shape->high_m[k] = reader_f32(&reader);
	}
	shape->has_textures = reader_u8(&reader);
	shape->had_pictures = reader_u8(&reader);
	shape->scan_count = reader_u32(&reader);
	if (shape->scan_count > CONTENT_SCANS_MAX)
		return false;
	for (uint32_t i = 0; i < shape->scan_count; i++)
		shape->face_counts[i] = reader_u32(&reader);
	body = reader.at;
	hash = reader_bytes(&reader, HASH_BYTES);
	if (reader.failed || reader_left(&reader) > 0)
		return false;
	made = hash_of((struct bytes){ file.data, body });
	return memcmp(made.bytes, hash.data, HASH_BYTES) == 0 &&
	       memcmp(scans->key.bytes, key.data, HASH_BYTES) == 0;
}

const struct scans_shape *scans_known_shape(struct scans *scans)
{
	char path[CONTENT_PATH_BYTES];
	struct buffer file;
	struct hash key;

	if (scans->has_shape)
		return &scans->shape;
	if (scans_key(scans, &key, NULL) < 0 ||
	    content_work_path(scans->content, "shape", path) < 0)
		return NULL;
	buffer_init(&file, SHAPE_BYTES_MAX);
	scans->has_shape =
		buffer_read_file(&file, path) == 0 && decode_shape(scans, buffer_bytes(&file));
	buffer_finish(&file);
	return scans->has_shape ? &scans->shape : NULL;
}

/* Sets *found to whether a scan had pictures, by what the import reported. */
static int find_pictures(struct scans *scans, bool *found)
{
	struct import_report *reports = calloc(CONTENT_SCANS_MAX, sizeof(*reports));
	const int count = reports ? scans_get_reports(scans, reports) : -ENOMEM;

	*found = false;
	for (int i = 0; i < count; i++)
		*found |= reports[i].textures > 0;
	free(reports);
	return count < 0 ? count : 0;
}

/* Takes the shape of the mesh in memory and saves it. */
static int take_shape(struct scans *scans, struct diagnostics *diagnostics)
{
	struct scans_shape *shape = &scans->shape;
	char path[CONTENT_PATH_BYTES];
	struct buffer file;
	int rc = content_work_path(scans->content, "shape", path);

	*shape = (struct scans_shape){ .has_textures = scans->mesh.textures != NULL,
				       .scan_count = scans->mesh.scan_count };
	shape->had_pictures = shape->has_textures;
	if (rc == 0 && !shape->has_textures)
		rc = find_pictures(scans, &shape->had_pictures);
	mesh_box(&scans->mesh, shape->low_m, shape->high_m);
	for (uint32_t i = 0; i < shape->scan_count; i++)
		shape->face_counts[i] = scans->mesh.scans[i].face_count;
	buffer_init(&file, SHAPE_BYTES_MAX);
	encode_shape(&file, scans);
	if (rc == 0)
		rc = file.error ? file.error : bytes_write_file(buffer_bytes(&file), path);
	buffer_finish(&file);
	if (rc < 0)
		return diagnostics_add(diagnostics, rc, path, 0, "%s; is the disk full?",
				       strerror(-rc));
	scans->has_shape = true;
	return 0;
}

/* ---- for users */

int scans_get_mesh(struct scans *scans, const struct mesh **out, struct diagnostics *diagnostics)
{
	int rc = scans->has_mesh ? 0 : load_mesh(scans, diagnostics);

	*out = NULL;
	if (rc == 0 && !scans_known_shape(scans))
		rc = take_shape(scans, diagnostics);
	if (rc == 0)
		*out = &scans->mesh;
	return rc;
}

int scans_get_shape(struct scans *scans, const struct scans_shape **out,
		    struct diagnostics *diagnostics)
{
	const struct mesh *mesh;
	int rc = scans_known_shape(scans) ? 0 : scans_get_mesh(scans, &mesh, diagnostics);

	*out = rc == 0 ? &scans->shape : NULL;
	return rc;
}

void scans_drop_mesh(struct scans *scans)
{
	mesh_finish(&scans->mesh);
	scans->has_mesh = false;
}
