/* Makes a mesh of the surface of a VRML97 scene. */
#include "pipeline/import/import_vrml.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/map.h"
#include "base/spill.h"
#include "pipeline/import/import_files.h"
#include "pipeline/import/import_limits.h"
#include "pipeline/import/import_texture.h"
#include "pipeline/scene/vrml_surface.h"
#include "pipeline/scene/vrml_text.h"

static int open_file(void *data, const char *name)
{
	return import_files_open(data, name);
}

static int read_file(struct vrml **out, const char *path, struct import_files *files,
		     struct import_report *report, struct diagnostics *diagnostics)
{
	const struct vrml_options options = { .open_file = open_file, .data = files };
	struct buffer file;
	int rc;

	buffer_init(&file, VRML_TEXT_BYTES_MAX);
	rc = buffer_read_file(&file, path);
	if (rc < 0)
		rc = diagnostics_add(diagnostics, rc, path, 0, "%s",
				     rc == -EFBIG ? "too large; split it into several files"
						  : strerror(-rc));
	else
		rc = vrml_read(out, buffer_bytes(&file), path, &options, diagnostics,
			       &report->warning);
	buffer_finish(&file);
	return rc;
}

/* Finds or adds a texture of one pixel. */
static int plain_texture(struct mesh *mesh, struct map *plains, const uint8_t rgb[3],
			 uint16_t *number)
{
	const map_key key = (map_key)rgb[0] << 16 | (map_key)rgb[1] << 8 | rgb[2];
	uint64_t found = map_get(plains, key);
	int rc;

	if (found != MAP_NONE) {
		*number = (uint16_t)found;
		return 0;
	}
	if (mesh->texture_count == MESH_TEXTURES_MAX)
		return -EFBIG;
	*number = (uint16_t)mesh->texture_count;
	rc = import_texture_plain(&mesh->textures[mesh->texture_count], rgb);
	if (rc == 0)
		mesh->texture_count++;
	return rc < 0 ? rc : map_set(plains, key, *number);
}

/* Loads the picture that a node names. */
static int load_texture(struct mesh_texture *out, const struct vrml *scene,
			const struct vrml_node *node, struct import_files *files,
			struct import_report *report)
{
	static const uint8_t white[3] = { 255, 255, 255 };
	const struct vrml_options options = { .open_file = open_file, .data = files };
	const struct vrml_value *urls = vrml_get(node, "url");
	const char *url = urls->count > 0 ? urls->strings[0] : "";
	char name[VRML_NAME_BYTES];
	int fd = vrml_open(scene, node, url, &options, name);

	if (fd >= 0)
		close(fd);
	return import_texture(out, files, fd >= 0 && name[0] ? name : url, white, report);
}

/* Loads the pictures, and makes one of a pixel for each colour of what has none. */
static int load_textures(struct mesh *mesh, const struct vrml *scene,
			 const struct vrml_surface *from, struct import_files *files,
			 struct import_report *report)
{
	struct map plains = { 0 };
	int rc = 0;

	mesh->textures = calloc(MESH_TEXTURES_MAX, sizeof(*mesh->textures));
	mesh->materials = spill_alloc((from->soup.count + 1) * sizeof(*mesh->materials));
	if (!mesh->textures || !mesh->materials)
		return -ENOMEM;
	for (uint32_t i = 0; i < from->texture_count && rc == 0; i++) {
		rc = load_texture(&mesh->textures[i], scene, from->textures[i], files, report);
		mesh->texture_count += rc == 0;
	}
	for (uint32_t i = 0; i < from->soup.count && rc == 0; i++) {
		const struct soup_triangle *triangle = &from->soup.triangles[i];

		mesh->materials[i] = (uint16_t)triangle->texture;
		if (triangle->texture == SOUP_NO_TEXTURE)
			rc = plain_texture(mesh, &plains, triangle->corners[0].rgb,
					   &mesh->materials[i]);
	}
	map_finish(&plains);
	return rc;
}

static int make_mesh(struct mesh *mesh, const struct vrml *scene, const struct vrml_surface *from,
		     struct import_files *files, struct import_report *report)
{
	size_t corners = 3 * (size_t)from->soup.count;
	bool has_pictures = from->texture_count > 0;

	mesh->positions = spill_alloc((corners + 1) * sizeof(*mesh->positions));
	mesh->triangles = spill_alloc((from->soup.count + 1) * sizeof(*mesh->triangles));
	if (has_pictures)
		mesh->uvs = spill_alloc((corners + 1) * sizeof(*mesh->uvs));
	else if (from->has_colours)
		mesh->colours = spill_alloc((corners + 1) * sizeof(*mesh->colours));
	if (!mesh->positions || !mesh->triangles || (has_pictures && !mesh->uvs) ||
	    (!has_pictures && from->has_colours && !mesh->colours))
		return -ENOMEM;
	for (uint32_t i = 0; i < corners; i++) {
		const struct soup_corner *corner = &from->soup.triangles[i / 3].corners[i % 3];

		memcpy(mesh->positions[i], corner->position, sizeof(mesh->positions[i]));
		if (mesh->uvs)
			memcpy(mesh->uvs[i], corner->uv, sizeof(mesh->uvs[i]));
		if (mesh->colours) {
			memcpy(mesh->colours[i], corner->rgb, 3);
			mesh->colours[i][3] = 255;
		}
		mesh->triangles[i / 3][i % 3] = i;
	}
	mesh->vertex_count = (uint32_t)corners;
	mesh->triangle_count = from->soup.count;
	return has_pictures ? load_textures(mesh, scene, from, files, report) : 0;
}

static int make(struct mesh *out, const struct vrml *scene, const char *path,
		struct import_files *files, struct import_report *report,
		struct diagnostics *diagnostics)
{
	struct vrml_surface surface;
	int rc = vrml_surface_make(&surface, scene, diagnostics);

	if (rc < 0)
		return rc;
	report->had_colours = surface.has_colours;
	if (surface.soup.count == 0)
		rc = diagnostics_add(diagnostics, -EBADMSG, path, 0,
				     "the scene has no surface; give one with shapes of faces");
	if (surface.left_out > 0)
		diagnostics_add(&report->warning, 0, path, 0,
				"%u shapes whose geometry is none were left out", surface.left_out);
	else if (scene->route_count > 0)
		diagnostics_add(&report->warning, 0, path, 0,
				"what moves in it (%u ROUTE) was left out: it is shown at rest",
				scene->route_count);
	if (rc == 0) {
		rc = make_mesh(out, scene, &surface, files, report);
		if (rc < 0)
			diagnostics_add(diagnostics, rc, path, 0, "%s",
					rc == -EFBIG ? "too many pictures and colours; split it"
						     : "too large for this machine's memory");
	}
	vrml_surface_finish(&surface);
	return rc;
}

int import_vrml(struct mesh *out, const char *path, const struct import_options *options,
		struct import_report *report, struct diagnostics *diagnostics)
{
	struct import_files files = {
		.scan_path = path,
		.picture_bytes_left = import_memory_bytes(options, report->file_bytes),
		.picture_bytes_per_byte = import_bytes_per_byte(options),
	};
	struct vrml *scene = NULL;
	int rc;

	files.folder_fd = import_files_open_folder(path);
	if (files.folder_fd < 0)
		return diagnostics_add(diagnostics, files.folder_fd, path, 0, "%s",
				       strerror(-files.folder_fd));
	rc = read_file(&scene, path, &files, report, diagnostics);
	if (rc == 0)
		rc = make(out, scene, path, &files, report, diagnostics);
	rc = import_files_judge(&files.failure, rc, path, diagnostics);
	vrml_destroy(scene);
	close(files.folder_fd);
	if (rc < 0)
		mesh_finish(out);
	return rc;
}
