/* Checks lists of faces as regions of parts, and finds their triangles and place on the imported
 * mesh. */
#include "pipeline/content/part_faces.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "geometry/vec.h"
#include "pipeline/import/ply.h"

enum { PLACE_VERSION = 1, PLACE_NUMBERS = 7, KEPT_BYTES_MAX = 16 << 20 };

void part_faces_init(struct part_faces_all *all, struct scans *scans)
{
	*all = (struct part_faces_all){ .scans = scans };
	buffer_init(&all->kept, KEPT_BYTES_MAX);
}

void part_faces_finish(struct part_faces_all *all)
{
	for (uint32_t i = 0; i < all->part_count; i++) {
		free(all->parts[i].id);
		free(all->parts[i].triangles);
		face_list_finish(&all->parts[i].list);
	}
	free(all->parts);
	buffer_finish(&all->kept);
	*all = (struct part_faces_all){ 0 };
}

static struct part_faces *find(const struct part_faces_all *all, const char *id)
{
	for (uint32_t i = 0; i < all->part_count; i++)
		if (strcmp(all->parts[i].id, id) == 0)
			return &all->parts[i];
	return NULL;
}

const struct part_faces *part_faces_of(const struct part_faces_all *all, const char *id)
{
	return find(all, id);
}

/* ---- checking */

/* Returns the scan's name as in temple.ini. */
static const char *scan_name(const struct content *content, uint32_t scan)
{
	return content->scans[scan] + strlen(content->folder) + 1;
}

static int find_scan(const struct content *content, const struct info_faces *faces, uint32_t *out,
		     struct diagnostics *diagnostics)
{
	*out = 0;
	if (!faces->scan && content->scan_count > 1)
		return diagnostics_add(diagnostics, -EINVAL, NULL, 0,
				       "there are %u scans: say of which the faces are, such as "
				       "\"scan\": \"%s\"",
				       content->scan_count, scan_name(content, 0));
	for (uint32_t i = 0; faces->scan && i < content->scan_count; i++) {
		*out = i;
		if (strcmp(scan_name(content, i), faces->scan) == 0)
			return 0;
	}
	return faces->scan ? diagnostics_add(
				     diagnostics, -EINVAL, NULL, 0,
				     "\"%.60s\" is none of the scans of temple.ini; the first of "
				     "them is \"%s\"",
				     faces->scan, scan_name(content, 0))
			   : 0;
}

/* Counts the faces of a scan. Only PLY has face numbers that mean the same to every program. A
 * surface that is made of scans has the numbers of its own file, so it is made first. */
static int count_faces(const struct part_faces_all *all, uint32_t scan, uint32_t *out,
		       struct diagnostics *diagnostics)
{
	const struct scans_shape *shape = scans_known_shape(all->scans);
	const struct content *content = scans_content(all->scans);
	struct ply *ply = NULL;
	struct scans_surface surface;

	*out = 0;
	scans_surface(all->scans, &surface);
	if (!shape && surface.scan_count > 0) {
		const int rc = scans_get_shape(all->scans, &shape, diagnostics);

		if (rc < 0)
			return rc;
	}
	if (shape)
		*out = shape->face_counts[scan];
	else if (ply_open(&ply, content->scans[scan], NULL) == 0)
		*out = (uint32_t)ply_summary(ply)->face_count;
	ply_close(ply);
	return *out > 0 ? 0
			: diagnostics_add(
				  diagnostics, -EINVAL, NULL, 0,
				  "the faces of %s have no numbers: save it as PLY, or mark the "
				  "part by a sphere, box or prism",
				  scan_name(content, scan));
}

static int read_list(struct face_list *list, const struct part_faces_all *all,
		     const struct info_faces *faces, uint32_t scan, struct diagnostics *diagnostics)
{
	char path[CONTENT_PATH_BYTES];
	uint32_t face_count;
	int rc = 0;

	/* A build checks only this folder for changes. */
	if (strncmp(faces->file, "regions/", 8) != 0)
		return diagnostics_add(diagnostics, -EINVAL, NULL, 0,
				       "\"%.60s\": lists of faces lie in regions/, such as "
				       "\"regions/lintel.faces\"",
				       faces->file);
	if (content_file_path(scans_content(all->scans), faces->file, path) < 0)
		return diagnostics_add(diagnostics, -EINVAL, NULL, 0,
				       "\"%.60s\" is not a file within the folder", faces->file);
	rc = count_faces(all, scan, &face_count, diagnostics);
	if (rc == 0)
		rc = face_list_read(list, path, faces->file, face_count, diagnostics);
	return rc == -ENOENT ? -EINVAL : rc; /* which the diagnostic already says */
}

static int remember(struct part_faces_all *all, const char *id, struct face_list *list,
		    uint32_t scan)
{
	struct part_faces part = { .scan = scan, .list = *list };
	int rc = ARRAY_RESERVE(all->parts, all->part_room, all->part_count + 1, UINT32_MAX);

	if (rc < 0)
		return rc;
	part.id = strdup(id);
	if (!part.id)
		return -ENOMEM;
	all->parts[all->part_count++] = part;
	*list = (struct face_list){ 0 }; /* taken */
	return 0;
}

int part_faces_judge(void *data, struct info_faces *faces, struct diagnostics *diagnostics)
{
	struct part_faces_all *all = data;
	struct face_list list = { 0 };
	uint32_t scan;
	int rc = find_scan(scans_content(all->scans), faces, &scan, diagnostics);

	if (rc == 0)
		rc = read_list(&list, all, faces, scan, diagnostics);
	if (rc == 0)
		rc = remember(all, faces->part, &list, scan);
	face_list_finish(&list);
	return rc;
}

/* ---- the triangles */

static int find_triangles(struct part_faces_all *all, struct part_faces *part,
			  struct diagnostics *diagnostics)
{
	const struct mesh *mesh;
	int rc = part->triangles ? 0 : scans_get_mesh(all->scans, &mesh, diagnostics);

	if (rc == 0 && !part->triangles)
		rc = face_list_triangles(&part->triangles, &part->triangle_count, &part->list, mesh,
					 part->scan);
	return rc;
}

int part_faces_find_all(struct part_faces_all *all, struct diagnostics *diagnostics)
{
	int rc = 0;

	for (uint32_t i = 0; rc == 0 && i < all->part_count; i++)
		rc = find_triangles(all, &all->parts[i], diagnostics);
	return rc;
}

/* ---- the place */

static void middle_of(const struct mesh *mesh, uint32_t triangle, float out[3])
{
	const uint32_t *t = mesh->triangles[triangle];

	for (int i = 0; i < 3; i++)
		out[i] = (mesh->positions[t[0]][i] + mesh->positions[t[1]][i] +
			  mesh->positions[t[2]][i]) /
			 3;
}

/* Places the region at the middle of the bounding box of the faces' centres. The radius is half the
 * box's diagonal divided by the square root of 3: for a cube, half its side. The anchor is the face
 * nearest to the middle. */
static void measure(struct part_faces *part, const struct mesh *mesh)
{
	float low[3] = { INFINITY, INFINITY, INFINITY };
	float high[3] = { -INFINITY, -INFINITY, -INFINITY }, at[3], nearest = INFINITY;
	float *centre_m = part->place_m, *anchor_m = part->place_m + 4;

	for (uint32_t i = 0; i < part->triangle_count; i++) {
		middle_of(mesh, part->triangles[i], at);
		for (int k = 0; k < 3; k++) {
			low[k] = fminf(low[k], at[k]);
			high[k] = fmaxf(high[k], at[k]);
		}
	}
	for (int k = 0; k < 3; k++)
		centre_m[k] = (low[k] + high[k]) / 2;
	part->place_m[3] = vec_distance(low, high) / 2 / sqrtf(3);
	for (uint32_t i = 0; i < part->triangle_count; i++) {
		middle_of(mesh, part->triangles[i], at);
		if (vec_distance(at, centre_m) >= nearest)
			continue;
		nearest = vec_distance(at, centre_m);
		memcpy(anchor_m, at, sizeof(at));
	}
}

static struct hash key_of(const struct part_faces *part, struct hash scans)
{
	const struct hash list =
		hash_of((struct bytes){ (const uint8_t *)part->list.ranges,
					part->list.count * sizeof(*part->list.ranges) });
	uint8_t text[8 + 2 * HASH_BYTES] = { PLACE_VERSION };

	text[4] = (uint8_t)part->scan;
	memcpy(text + 8, scans.bytes, HASH_BYTES);
	memcpy(text + 8 + HASH_BYTES, list.bytes, HASH_BYTES);
	return hash_of((struct bytes){ text, sizeof(text) });
}

static int keep_path(const struct part_faces_all *all, char path[CONTENT_PATH_BYTES])
{
	return content_work_path(scans_content(all->scans), "faces", path);
}

/* The file contains: a hash of everything after it, then for each list its key and its place. */
static void load_kept(struct part_faces_all *all)
{
	char path[CONTENT_PATH_BYTES];
	struct hash whole;
	bool good;

	all->has_kept = true;
	good = keep_path(all, path) == 0 && buffer_read_file(&all->kept, path) == 0 &&
	       all->kept.size >= HASH_BYTES;
	if (good) {
		whole = hash_of(
			(struct bytes){ all->kept.data + HASH_BYTES, all->kept.size - HASH_BYTES });
		good = memcmp(whole.bytes, all->kept.data, HASH_BYTES) == 0;
	}
	if (!good)
		buffer_clear(&all->kept);
}

static bool find_kept(struct part_faces_all *all, struct part_faces *part)
{
	struct reader reader;

	if (!all->has_kept)
		load_kept(all);
	reader_init(&reader, buffer_bytes(&all->kept));
	reader_bytes(&reader, HASH_BYTES);
	while (!part->placed && reader_left(&reader) > 0) {
		struct bytes key = reader_bytes(&reader, HASH_BYTES);

		for (int i = 0; i < PLACE_NUMBERS; i++)
			part->place_m[i] = reader_f32(&reader);
		part->placed = !reader.failed && memcmp(key.data, part->key.bytes, HASH_BYTES) == 0;
	}
	return part->placed;
}

static int find_place(struct part_faces_all *all, struct part_faces *part,
		      const struct info_faces *faces, struct diagnostics *diagnostics)
{
	const struct mesh *mesh;
	struct hash scans;
	int rc = scans_key(all->scans, &scans, diagnostics);

	if (rc < 0)
		return rc;
	part->key = key_of(part, scans);
	if (find_kept(all, part))
		return 0;
	rc = find_triangles(all, part, diagnostics);
	if (rc == 0 && part->triangle_count == 0)
		rc = diagnostics_add(
			diagnostics, -EINVAL, faces->file, 0,
			"none of its faces is a face of the repaired scan: each has no "
			"area, or lies twice");
	if (rc == 0)
		rc = scans_get_mesh(all->scans, &mesh, diagnostics);
	if (rc < 0)
		return rc;
	measure(part, mesh);
	part->placed = true;
	return 0;
}

int part_faces_place(void *data, struct info_faces *faces, struct diagnostics *diagnostics)
{
	struct part_faces_all *all = data;
	struct part_faces *part = find(all, faces->part);
	int rc = part ? 0 : -EINVAL;

	if (rc == 0 && !part->placed)
		rc = find_place(all, part, faces, diagnostics);
	if (rc < 0)
		return rc;
	memcpy(faces->centre_m, part->place_m, sizeof(faces->centre_m));
	faces->radius_m = part->place_m[3];
	memcpy(faces->anchor_m, part->place_m + 4, sizeof(faces->anchor_m));
	return 0;
}

int part_faces_keep(const struct part_faces_all *all, struct diagnostics *diagnostics)
{
	char path[CONTENT_PATH_BYTES];
	struct hash whole = { 0 };
	struct buffer file;
	int rc = keep_path(all, path);

	buffer_init(&file, KEPT_BYTES_MAX);
	buffer_put(&file, whole.bytes, HASH_BYTES);
	for (uint32_t i = 0; i < all->part_count; i++) {
		buffer_put(&file, all->parts[i].key.bytes, HASH_BYTES);
		for (int k = 0; k < PLACE_NUMBERS; k++)
			buffer_put_f32(&file, all->parts[i].place_m[k]);
	}
	if (rc == 0)
		rc = file.error;
	if (rc == 0) {
		whole = hash_of((struct bytes){ file.data + HASH_BYTES, file.size - HASH_BYTES });
		memcpy(file.data, whole.bytes, HASH_BYTES);
		if (file.size != all->kept.size ||
		    memcmp(file.data, all->kept.data, file.size) != 0)
			rc = bytes_write_file(buffer_bytes(&file), path);
	}
	buffer_finish(&file);
	return rc < 0 ? diagnostics_add(diagnostics, rc, path, 0, "%s; is the disk full?",
					strerror(-rc))
		      : 0;
}
