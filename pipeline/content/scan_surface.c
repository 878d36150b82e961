/* Collects the scans that become one surface, in metres with z up, and has it made by
 * pipeline/octree. */
#include "pipeline/content/scan_surface.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/bytes.h"
#include "base/log.h"
#include "pipeline/content/scan_key.h"
#include "pipeline/octree/mesh_ply.h"
#include "pipeline/octree/reconstruct.h"

/* SURFACE_VERSION must be raised whenever the same scans give another surface. */
enum { SURFACE_VERSION = 3, KEY_TEXT_MAX = 1 << 26 };

static const char surface_name[] = "surface.ply", key_name[] = "surface";

void surface_plan(struct surface_plan *out, const struct content *content)
{
	*out = (struct surface_plan){ 0 };
	for (uint32_t i = 0; i < content->scan_count; i++) {
		uint64_t points;

		out->is_points[i] = import_is_points(content->scans[i], &points);
		out->points += points;
		if (out->is_points[i] && out->count++ == 0)
			out->first = i;
	}
}

int surface_key(struct hash *out, const struct surface_plan *plan, const struct content *content)
{
	struct buffer text;
	int rc = 0;

	buffer_init(&text, KEY_TEXT_MAX);
	buffer_put_u32(&text, SURFACE_VERSION);
	buffer_put_f64(&text, content->cell_mm);
	buffer_put_u32(&text, content->import.up);
	buffer_put_f64(&text, content->import.metres_per_unit);
	for (uint32_t i = 0; i < content->scan_count && rc == 0; i++)
		if (plan->is_points[i])
			rc = scan_key_put(&text, content, i);
	if (rc == 0)
		rc = text.error;
	*out = hash_of(buffer_bytes(&text));
	buffer_finish(&text);
	return rc;
}

/* ---- the file of the key, which is written after the surface and removed before it */

static void key_text(char out[HASH_HEX_BYTES + 1], struct hash key)
{
	hash_to_hex(key, out);
	memcpy(out + HASH_HEX_BYTES - 1, "\n", 2);
}

bool surface_is_made(struct hash key, const struct content *content)
{
	char path[CONTENT_PATH_BYTES], expected[HASH_HEX_BYTES + 1];
	struct buffer file;
	bool same;

	key_text(expected, key);
	/* A file that a fault of the disk cut off is made again. */
	if (content_work_path(content, surface_name, path) < 0 || import_check(path, NULL) < 0 ||
	    content_work_path(content, key_name, path) < 0)
		return false;
	buffer_init(&file, sizeof(expected));
	same = buffer_read_file(&file, path) == 0 && file.size == strlen(expected) &&
	       memcmp(file.data, expected, file.size) == 0;
	buffer_finish(&file);
	return same;
}

static int save(const struct mesh *mesh, struct hash key, const char *path, const char *key_path)
{
	char text[HASH_HEX_BYTES + 1];
	int rc;

	key_text(text, key);
	if (unlink(key_path) < 0 && errno != ENOENT)
		return -errno;
	rc = mesh_ply_write(mesh, path);
	if (rc == 0)
		rc = bytes_write_file((struct bytes){ (uint8_t *)text, strlen(text) }, key_path);
	return rc;
}

/* ---- making it */

/* What the surface is made of. */
struct parts {
	struct reconstruct_scan scans[CONTENT_SCANS_MAX];
	struct transform transforms[CONTENT_SCANS_MAX];
	uint32_t count;
};

static void add_points(struct parts *parts, const struct content *content, uint32_t scan)
{
	struct import_options options = content->import;
	struct transform *transform = &parts->transforms[parts->count];

	options.transform = content->transforms[scan];
	import_transform(transform, &options);
	parts->scans[parts->count++] = (struct reconstruct_scan){ content->scans[scan], transform };
}

static int make(const struct surface_plan *plan, struct hash key, const char *path,
		const char *key_path, const struct content *content,
		struct diagnostics *diagnostics)
{
	const struct reconstruct_options options = { .cell = content->cell_mm / 1000 };
	struct parts *parts = calloc(1, sizeof(*parts));
	struct reconstruct_report report;
	struct mesh mesh = { 0 };
	int rc = parts ? 0 : -ENOMEM;

	for (uint32_t i = 0; rc == 0 && i < content->scan_count; i++)
		if (plan->is_points[i])
			add_points(parts, content, i);
	if (rc == 0)
		rc = reconstruct(&mesh, parts->scans, parts->count, &options, &report, diagnostics);
	if (rc == 0) {
		log_info("pipeline",
			 "surface: %u triangles in %u parts of %" PRIu64 " points (%" PRIu64
			 " left out), cubes of %.4g mm%s",
			 mesh.triangle_count, report.parts, report.points, report.dropped,
			 1000 * report.cell, content->cell_mm > 0 ? "" : " (cell_mm sets others)");
		rc = save(&mesh, key, path, key_path);
		if (rc < 0)
			diagnostics_add(diagnostics, rc, path, 0, "%s; is the disk full?",
					strerror(-rc));
	}
	mesh_finish(&mesh);
	free(parts);
	return rc;
}

int surface_make(char path[CONTENT_PATH_BYTES], bool *made, const struct surface_plan *plan,
		 struct hash key, const struct content *content, struct diagnostics *diagnostics)
{
	char key_path[CONTENT_PATH_BYTES];
	int rc = content_work_path(content, surface_name, path);

	*made = false;
	if (rc == 0)
		rc = content_work_path(content, key_name, key_path);
	if (rc < 0)
		return diagnostics_add(diagnostics, rc, NULL, 0, "%s/.work: %s", content->folder,
				       strerror(-rc));
	*made = !surface_is_made(key, content);
	return *made ? make(plan, key, path, key_path, content, diagnostics) : 0;
}
