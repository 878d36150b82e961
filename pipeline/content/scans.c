/* Imports the scans of a content folder into one mesh, and keeps it and its shape in .work. */
#include "pipeline/content/scans.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/bytes.h"
#include "base/log.h"
#include "pipeline/import/mesh_file.h"

/* IMPORT_VERSION must be raised whenever the import gives another mesh for the same files. */
enum { IMPORT_VERSION = 2, SHAPE_VERSION = 1, KEY_TEXT_MAX = 1 << 26, SHAPE_BYTES_MAX = 4096 };
enum { REPORTS_VERSION = 1, REPORTS_BYTES_MAX = 4 << 20 };

struct scans {
	const struct content *content;
	struct hash key;
	struct mesh mesh;
	struct scans_shape shape;
	bool has_key, has_mesh, has_shape;
};

int scans_create(struct scans **out, const struct content *content)
{
	*out = calloc(1, sizeof(**out));
	if (!*out)
		return -ENOMEM;
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

/* The file is named relative to the folder, because the folder's own path may change. */
static void put_file(struct buffer *text, const struct content *content, const char *path)
{
	const char *name = path + strlen(content->folder);
	struct stat status;

	buffer_put(text, name, strlen(name) + 1);
	if (stat(path, &status) < 0)
		return;
	buffer_put_u64(text, (uint64_t)status.st_size);
	buffer_put_u64(text, (uint64_t)status.st_mtim.tv_sec);
	buffer_put_u64(text, (uint64_t)status.st_mtim.tv_nsec);
}

/* Selects files that a scan may refer to. */
static int is_companion(const struct dirent *entry)
{
	static const char *const extensions[] = { ".mtl", ".jpg", ".jpeg", ".png",
						  ".bin", ".wrl", ".wrz" };
	const char *dot = strrchr(entry->d_name, '.');

	for (size_t i = 0; dot && i < ARRAY_COUNT(extensions); i++)
		if (strcasecmp(dot, extensions[i]) == 0)
			return 1;
	return 0;
}

static int put_companions(struct buffer *text, const struct content *content, const char *scan)
{
	char folder[CONTENT_PATH_BYTES], path[CONTENT_PATH_BYTES + 256];
	const char *slash = strrchr(scan, '/');
	struct dirent **entries;
	int count;

	snprintf(folder, sizeof(folder), "%.*s", (int)(slash - scan), scan);
	count = scandir(folder, &entries, is_companion, alphasort);
	if (count < 0)
		return -errno;
	for (int i = 0; i < count; i++) {
		snprintf(path, sizeof(path), "%s/%s", folder, entries[i]->d_name);
		put_file(text, content, path);
		free(entries[i]);
	}
	free(entries);
	return 0;
}

static void put_transform(struct buffer *text, const struct transform *transform)
{
	for (int k = 0; k < 12; k++)
		buffer_put_f64(text, transform->rows[k / 4][k % 4]);
}

static int make_key(const struct content *content, struct hash *out)
{
	const struct import_options *import = &content->import;
	struct buffer text;
	int rc = 0;

	buffer_init(&text, KEY_TEXT_MAX);
	buffer_put_u32(&text, IMPORT_VERSION);
	buffer_put_u32(&text, import->up);
	buffer_put_f64(&text, import->metres_per_unit);
	buffer_put(&text, import->default_colour, sizeof(import->default_colour));
	buffer_put_u8(&text, import->override_colour);
	for (uint32_t i = 0; i < content->scan_count && rc == 0; i++) {
		put_file(&text, content, content->scans[i]);
		if (content->transforms[i])
			put_transform(&text, content->transforms[i]);
		rc = put_companions(&text, content, content->scans[i]);
	}
	if (rc == 0)
		rc = text.error;
	if (rc == 0)
		*out = hash_of(buffer_bytes(&text));
	buffer_finish(&text);
	return rc;
}

int scans_key(struct scans *scans, struct hash *out, struct diagnostics *diagnostics)
{
	int rc = scans->has_key ? 0 : make_key(scans->content, &scans->key);

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
static int check_all(const struct content *content, struct diagnostics *diagnostics)
{
	int rc = 0;

	for (uint32_t i = 0; i < content->scan_count; i++) {
		int failed = import_check(content->scans[i], diagnostics);

		rc = rc == 0 ? failed : rc;
	}
	return rc;
}

static int import_all(struct mesh *out, const struct content *content,
		      struct import_report reports[CONTENT_SCANS_MAX],
		      struct diagnostics *diagnostics)
{
	uint32_t count = 0;
	int rc = check_all(content, diagnostics);

	for (; count < content->scan_count && rc == 0; count++) {
		struct import_options options = content->import;
		struct mesh mesh;

		options.transform = content->transforms[count];
		rc = import_scan(&mesh, content->scans[count], &options, &reports[count],
				 diagnostics);
		if (rc < 0)
			break;
		if (reports[count].warning.first.text[0])
			log_warn("pipeline", "%s", reports[count].warning.first.text);
		if (count == 0) {
			*out = mesh;
			continue;
		}
		rc = mesh_append(out, &mesh);
		mesh_finish(&mesh);
		if (rc < 0)
			diagnostics_add(diagnostics, rc, content->scans[count], 0,
					"too large together with the scans before it");
	}
	return rc < 0 ? rc : judge_mix(content, out, reports, count, diagnostics);
}

/* ---- what the import reported */

/* What is kept of the counts, in the order of the file. */
static uint32_t *count_of(struct import_report *report, int i)
{
	struct mesh_repairs *repairs = &report->repairs;
	uint32_t *const counts[] = {
		&report->textures,         &report->vertices,          &report->triangles,
		&repairs->lost_faces,      &repairs->degenerate_faces, &repairs->merged_vertices,
		&repairs->unused_vertices, &repairs->border_edges,     &repairs->non_manifold_edges,
		&repairs->turned_faces,    &repairs->turned_edges,     &repairs->place_step,
		&repairs->place_count,
	};

	return i < (int)ARRAY_COUNT(counts) ? counts[i] : NULL;
}

static void encode_report(struct buffer *file, struct import_report *report)
{
	const struct mesh_repairs *repairs = &report->repairs;

	buffer_put_string(file, report->format);
	buffer_put_u8(file, report->had_colours);
	buffer_put_u64(file, report->file_bytes);
	for (int i = 0; count_of(report, i); i++)
		buffer_put_u32(file, *count_of(report, i));
	for (uint32_t i = 0; i < repairs->place_count; i++) {
		buffer_put_u8(file, (uint8_t)repairs->places[i].kind);
		for (int k = 0; k < 3; k++)
			buffer_put_f32(file, repairs->places[i].place_m[k]);
	}
}

static bool decode_report(struct import_report *report, struct reader *reader)
{
	struct mesh_repairs *repairs = &report->repairs;

	reader_string(reader, report->format, sizeof(report->format));
	report->had_colours = reader_u8(reader);
	report->file_bytes = reader_u64(reader);
	for (int i = 0; count_of(report, i); i++)
		*count_of(report, i) = reader_u32(reader);
	if (reader->failed || repairs->place_count > MESH_FAULT_PLACES_MAX)
		return false;
	for (uint32_t i = 0; i < repairs->place_count; i++) {
		uint8_t kind = reader_u8(reader);

		if (kind >= MESH_FAULTS)
			return false;
		repairs->places[i].kind = (enum mesh_fault)kind;
		for (int k = 0; k < 3; k++)
			repairs->places[i].place_m[k] = reader_f32(reader);
	}
	return !reader->failed;
}

/* The file contains: version, the key of the scans, the number of reports, and each. */
static int save_reports(const struct scans *scans, struct import_report *reports)
{
	char path[CONTENT_PATH_BYTES];
	struct buffer file;
	int rc = content_work_path(scans->content, "imported", path);

	buffer_init(&file, REPORTS_BYTES_MAX);
	buffer_put_u32(&file, REPORTS_VERSION);
	buffer_put(&file, scans->key.bytes, HASH_BYTES);
	buffer_put_u32(&file, scans->content->scan_count);
	for (uint32_t i = 0; i < scans->content->scan_count; i++)
		encode_report(&file, &reports[i]);
	if (rc == 0)
		rc = file.error ? file.error : bytes_write_file(buffer_bytes(&file), path);
	buffer_finish(&file);
	return rc;
}

static int decode_reports(struct import_report *reports, struct bytes file, struct hash key)
{
	struct reader reader;
	uint32_t version, count;
	struct bytes of;

	reader_init(&reader, file);
	version = reader_u32(&reader);
	of = reader_bytes(&reader, HASH_BYTES);
	count = reader_u32(&reader);
	if (reader.failed || version != REPORTS_VERSION || count > CONTENT_SCANS_MAX ||
	    memcmp(of.data, key.bytes, HASH_BYTES) != 0)
		return -ENOENT;
	for (uint32_t i = 0; i < count; i++)
		if (!decode_report(&reports[i], &reader))
			return -ENOENT;
	return (int)count;
}

int scans_get_reports(struct scans *scans, struct import_report *reports)
{
	char path[CONTENT_PATH_BYTES];
	struct buffer file;
	struct hash key;
	int rc = scans_key(scans, &key, NULL);

	if (rc == 0)
		rc = content_work_path(scans->content, "imported", path);
	if (rc < 0)
		return rc;
	buffer_init(&file, REPORTS_BYTES_MAX);
	rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = decode_reports(reports, buffer_bytes(&file), key);
	buffer_finish(&file);
	return rc;
}

static int import_and_save(struct scans *scans, const char *path, struct diagnostics *diagnostics)
{
	struct import_report *reports = calloc(CONTENT_SCANS_MAX, sizeof(*reports));
	int rc = reports ? import_all(&scans->mesh, scans->content, reports, diagnostics) : -ENOMEM;

	if (rc == 0) {
		rc = mesh_file_move(&scans->mesh, scans->key, path);
		if (rc < 0)
			diagnostics_add(diagnostics, rc, path, 0, "%s; is the disk full?",
					strerror(-rc));
	}
	if (rc == 0 && save_reports(scans, reports) < 0)
		log_warn("pipeline",
			 "%s/.work/imported cannot be written: the report will lack "
			 "the counts of the import",
			 scans->content->folder);
	free(reports);
	if (rc < 0)
		mesh_finish(&scans->mesh);
	return rc;
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
	if (mesh_file_load(&scans->mesh, key, path) < 0)
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

/* Takes the shape of the mesh in memory and saves it. */
static int take_shape(struct scans *scans, struct diagnostics *diagnostics)
{
	struct scans_shape *shape = &scans->shape;
	char path[CONTENT_PATH_BYTES];
	struct buffer file;
	int rc = content_work_path(scans->content, "shape", path);

	*shape = (struct scans_shape){ .has_textures = scans->mesh.textures != NULL,
				       .scan_count = scans->mesh.scan_count };
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
