/* Checks lists of faces as regions of parts, and finds their triangles and place on the imported
 * mesh. */
#include "pipeline/content/part_faces.h"
#include "pipeline/content/info_build.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"
#include "pipeline/import/face_list.h"
#include "pipeline/import/ply.h"

void part_faces_finish(struct part_faces_all *all)
{
	for (uint32_t i = 0; i < all->part_count; i++) {
		free(all->parts[i].id);
		free(all->parts[i].triangles);
	}
	free(all->parts);
	mesh_finish(&all->mesh);
	*all = (struct part_faces_all){ 0 };
}

int part_faces_mesh(struct part_faces_all *all, struct fault *fault)
{
	int rc = all->has_mesh ? 0 : content_import(&all->mesh, all->content, NULL, fault);

	all->has_mesh = all->has_mesh || rc == 0;
	return rc;
}

const struct part_faces *part_faces_find(const struct part_faces_all *all, const char *id)
{
	for (uint32_t i = 0; i < all->part_count; i++)
		if (strcmp(all->parts[i].id, id) == 0)
			return &all->parts[i];
	return NULL;
}

/* Returns the scan's name as in temple.ini. */
static const char *scan_name(const struct content *content, uint32_t scan)
{
	return content->scans[scan] + strlen(content->folder) + 1;
}

static int find_scan(const struct content *content, const struct info_faces *faces, uint32_t *out,
		     struct fault *fault)
{
	*out = 0;
	if (!faces->scan && content->scan_count > 1)
		return fault_set(fault, -EINVAL,
				 "there are %u scans: say of which the faces are, such as "
				 "\"scan\": \"%s\"",
				 content->scan_count, scan_name(content, 0));
	for (uint32_t i = 0; faces->scan && i < content->scan_count; i++) {
		*out = i;
		if (strcmp(scan_name(content, i), faces->scan) == 0)
			return 0;
	}
	return faces->scan ? fault_set(fault, -EINVAL,
				       "\"%.60s\" is none of the scans of temple.ini; the first of "
				       "them is \"%s\"",
				       faces->scan, scan_name(content, 0))
			   : 0;
}

/* Counts the faces of a scan. Only PLY has face numbers that mean the same to every program. */
static int count_faces(const struct part_faces_all *all, uint32_t scan, uint32_t *out,
		       struct fault *fault)
{
	struct ply *ply = NULL;

	*out = 0;
	if (all->has_mesh)
		*out = all->mesh.scans[scan].face_count;
	else if (ply_open(&ply, all->content->scans[scan], NULL) == 0)
		*out = (uint32_t)ply_summary(ply)->face_count;
	ply_close(ply);
	return *out > 0 ? 0
			: fault_set(fault, -EINVAL,
				    "the faces of %s have no numbers: save it as PLY, or mark the "
				    "part by a sphere, box or prism",
				    scan_name(all->content, scan));
}

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
static void place(struct info_faces *faces, const struct mesh *mesh, const struct part_faces *part)
{
	float low[3] = { INFINITY, INFINITY, INFINITY };
	float high[3] = { -INFINITY, -INFINITY, -INFINITY }, at[3], nearest = INFINITY;

	for (uint32_t i = 0; i < part->count; i++) {
		middle_of(mesh, part->triangles[i], at);
		for (int k = 0; k < 3; k++) {
			low[k] = fminf(low[k], at[k]);
			high[k] = fmaxf(high[k], at[k]);
		}
	}
	for (int k = 0; k < 3; k++)
		faces->centre_m[k] = (low[k] + high[k]) / 2;
	faces->radius_m = vec_distance(low, high) / 2 / sqrtf(3);
	for (uint32_t i = 0; i < part->count; i++) {
		middle_of(mesh, part->triangles[i], at);
		if (vec_distance(at, faces->centre_m) >= nearest)
			continue;
		nearest = vec_distance(at, faces->centre_m);
		memcpy(faces->anchor_m, at, sizeof(at));
	}
}

static int find_triangles(struct part_faces_all *all, struct info_faces *faces,
			  const struct face_list *list, uint32_t scan, struct fault *fault)
{
	const struct part_faces *known = part_faces_find(all, faces->part);
	struct part_faces part = { 0 }, *grown;
	int rc;

	if (known) { /* the folder is read more than once */
		place(faces, &all->mesh, known);
		return 0;
	}
	rc = face_list_triangles(&part.triangles, &part.count, list, &all->mesh, scan);

	if (rc == 0 && part.count == 0)
		rc = fault_set(fault, -EINVAL,
			       "%s: none of its faces is a face of the repaired scan: each has no "
			       "area, or lies twice",
			       faces->file);
	grown = rc == 0 ? realloc(all->parts, (all->part_count + 1) * sizeof(*grown)) : NULL;
	if (grown) {
		all->parts = grown;
		part.id = strdup(faces->part);
	}
	if (!part.id) {
		free(part.triangles);
		return rc < 0 ? rc : -ENOMEM;
	}
	place(faces, &all->mesh, &part);
	all->parts[all->part_count++] = part;
	return 0;
}

int part_faces_place(void *data, struct info_faces *faces, struct fault *fault)
{
	struct part_faces_all *all = data;
	char path[CONTENT_PATH_BYTES];
	struct face_list list = { 0 };
	uint32_t scan, face_count;
	int rc = find_scan(all->content, faces, &scan, fault);

	/* A build checks only this folder for changes. */
	if (rc == 0 && strncmp(faces->file, "regions/", 8) != 0)
		rc = fault_set(fault, -EINVAL,
			       "\"%.60s\": lists of faces lie in regions/, such as "
			       "\"regions/lintel.faces\"",
			       faces->file);
	if (rc == 0 && content_file_path(all->content, faces->file, path) < 0)
		rc = fault_set(fault, -EINVAL, "\"%.60s\" is no file within the folder",
			       faces->file);
	if (rc == 0 && !all->only_judge)
		rc = part_faces_mesh(all, fault);
	if (rc == 0)
		rc = count_faces(all, scan, &face_count, fault);
	if (rc == 0)
		rc = face_list_read(&list, path, faces->file, face_count, fault);
	if (rc == -ENOENT)
		rc = -EINVAL; /* fault already says so */
	if (rc == 0 && !all->only_judge)
		rc = find_triangles(all, faces, &list, scan, fault);
	face_list_finish(&list);
	return rc;
}
