/* Reads VRML97 and glTF files as scenery, and the views in them. */
#include "pipeline/import/import_scenery.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "geometry/turn.h"
#include "geometry/vec.h"
#include "pipeline/import/gltf_check.h"
#include "pipeline/import/import_files.h"
#include "pipeline/scene/gltf_scenery.h"
#include "pipeline/scene/gltf_views.h"
#include "pipeline/scene/vrml_scenery.h"
#include "pipeline/scene/vrml_text.h"
#include "pipeline/scene/vrml_views.h"

static int open_file(void *data, const char *name)
{
	return import_files_open(data, name);
}

/* A scene's file, whose bytes were read, in the folder of the files that it names. */
struct scene_file {
	const char *path;
	struct import_files files;
	struct buffer bytes;
	enum scan_format format;
};

static int open_scene(struct scene_file *out, const char *path, struct diagnostics *diagnostics)
{
	uint64_t bytes;
	int rc = import_detect(&out->format, &bytes, path, diagnostics);

	*out = (struct scene_file){ .path = path,
				    .files = { .scan_path = path, .folder_fd = -1 },
				    .format = out->format };
	buffer_init(&out->bytes, VRML_TEXT_BYTES_MAX);
	if (rc < 0)
		return rc;
	if (out->format != SCAN_VRML && out->format != SCAN_GLTF && out->format != SCAN_GLB)
		return diagnostics_add(diagnostics, -EINVAL, path, 0,
				       "scenes are VRML97 (.wrl, .wrz) or glTF (.glb, .gltf); "
				       "export it as one of these");
	out->files.folder_fd = import_files_open_folder(path);
	if (out->files.folder_fd < 0)
		return diagnostics_add(diagnostics, out->files.folder_fd, path, 0, "%s",
				       strerror(-out->files.folder_fd));
	rc = buffer_read_file(&out->bytes, path);
	if (rc < 0)
		return diagnostics_add(diagnostics, rc, path, 0, "%s",
				       rc == -EFBIG ? "too large; split it into several files"
						    : strerror(-rc));
	return 0;
}

static void close_scene(struct scene_file *file)
{
	if (file->files.folder_fd >= 0)
		close(file->files.folder_fd);
	buffer_finish(&file->bytes);
}

static int read_vrml(struct vrml **out, struct scene_file *file, struct diagnostics *diagnostics,
		     struct diagnostics *warnings)
{
	const struct vrml_options options = { .open_file = open_file, .data = &file->files };

	return vrml_read(out, buffer_bytes(&file->bytes), file->path, &options, diagnostics,
			 warnings);
}

/* The node that turns the file's axes to z up, and its unit to metres. */
static struct scenery_node node_of(uint32_t layer, const struct import_options *options)
{
	static const float axes[3][3] = { [IMPORT_Z_UP] = { 0, 0, 1 },
					  [IMPORT_Y_UP] = { 1, 0, 0 },
					  [IMPORT_X_UP] = { 1, 1, 1 } };
	static const float degrees[3] = { [IMPORT_Y_UP] = 90, [IMPORT_X_UP] = -120 };
	float unit = options->metres_per_unit > 0 ? (float)options->metres_per_unit : 1;
	struct scenery_node node = { .parent = SCENERY_NONE,
				     .layer = layer,
				     .place = scenery_at_rest };

	turn_about(node.place.turn, axes[options->up], degrees[options->up] * 0.017453293f);
	for (int k = 0; k < 3; k++)
		node.place.scale[k] = unit;
	return node;
}

static int add_vrml(struct scenery_maker *maker, struct scene_file *file, uint32_t node,
		    const struct import_scene *which, struct diagnostics *diagnostics,
		    struct diagnostics *warnings)
{
	const struct vrml_options options = { .open_file = open_file, .data = &file->files };
	struct vrml *scene;
	int rc;

	if (which->name || which->says_how)
		return diagnostics_add(
			diagnostics, -EINVAL, file->path, 0,
			"a VRML97 file has one scene and says itself what moves when; "
			"remove \"scene\" and \"plays\" from scenes.json");
	rc = read_vrml(&scene, file, diagnostics, warnings);
	if (rc == 0)
		rc = vrml_scenery_add(maker, scene, node, &options, diagnostics, warnings);
	vrml_destroy(scene);
	return rc;
}

static int read_gltf(struct gltf *out, struct scene_file *file, struct diagnostics *diagnostics)
{
	const struct gltf_options options = { .open_file = open_file, .data = &file->files };
	int rc = gltf_check_extensions(buffer_bytes(&file->bytes), file->path, diagnostics);

	return rc < 0 ? rc
		      : gltf_read(out, buffer_bytes(&file->bytes), file->path, &options,
				  diagnostics);
}

static int add_gltf(struct scenery_maker *maker, struct scene_file *file, uint32_t node,
		    const struct import_scene *which, struct diagnostics *diagnostics,
		    struct diagnostics *warnings)
{
	const struct gltf_choice choice = { .scene = which->name,
					    .plays_always = which->plays_always };
	struct gltf gltf = { 0 };
	int rc = read_gltf(&gltf, file, diagnostics);

	if (rc == 0)
		rc = gltf_scenery_add(maker, &gltf, node, &choice, warnings);
	gltf_finish(&gltf);
	return rc;
}

int import_scenery(struct scenery_maker *maker, const char *path, uint32_t layer,
		   const struct import_options *options, const struct import_scene *scene,
		   struct diagnostics *diagnostics, struct diagnostics *warnings)
{
	const struct scenery_node node = node_of(layer, options);
	struct scene_file file;
	uint32_t number = 0;
	int rc = open_scene(&file, path, diagnostics);

	if (rc == 0 && scenery_add_node(maker, &node, &number) < 0)
		rc = diagnostics_add(diagnostics, -EFBIG, path, 0, "over %d nodes in all scenes",
				     SCENERY_NODES_MAX);
	if (rc == 0)
		rc = (file.format == SCAN_VRML ? add_vrml : add_gltf)(maker, &file, number, scene,
								      diagnostics, warnings);
	rc = import_files_judge(&file.files.failure, rc, path, diagnostics);
	close_scene(&file);
	return rc;
}

/* ---- views */

/* Turns a place of the file into the site's. */
static void to_site(float out[3], const struct scenery_place *place, const float at[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = place->scale[k] * at[k];
	turn_vector(out, place->turn, out);
}

static bool is_near(const float at_m[3])
{
	for (int k = 0; k < 3; k++)
		if (!(fabsf(at_m[k]) <= SCENERY_PLACE_MAX))
			return false;
	return true;
}

static int take_views(struct import_views *out, const struct scene_views *views, const char *path,
		      const struct import_options *options, struct diagnostics *diagnostics)
{
	const struct scenery_node node = node_of(SCENERY_NONE, options);

	out->items = calloc((size_t)views->count + 1, sizeof(*out->items));
	if (!out->items)
		return -ENOMEM;
	out->is_way = views->moves;
	for (uint32_t i = 0; i < views->count; i++) {
		struct import_view *to = &out->items[out->count++];
		float ahead[3];

		to->time_s = views->items[i].time_s;
		to_site(to->eye_m, &node.place, views->items[i].eye);
		to_site(to->target_m, &node.place, views->items[i].target);
		vec_sub(ahead, to->target_m, to->eye_m);
		vec_normalise(ahead);
		vec_add_scaled(to->target_m, to->eye_m, 1, ahead);
		if (!is_near(to->eye_m) || !is_near(to->target_m))
			return diagnostics_add(diagnostics, -EINVAL, path, 0,
					       "a camera stands over %d m away; correct its "
					       "place, or the scene's unit",
					       SCENERY_PLACE_MAX);
	}
	return 0;
}

static int read_vrml_views(struct scene_views *out, struct scene_file *file,
			   const char *description, struct diagnostics *diagnostics)
{
	struct diagnostics warnings = { 0 }; /* import_scenery gives them */
	struct vrml *scene = NULL;
	int rc = read_vrml(&scene, file, diagnostics, &warnings);

	if (rc == 0)
		rc = vrml_views_read(out, scene, description, diagnostics);
	vrml_destroy(scene);
	diagnostics_finish(&warnings);
	return rc;
}

static int read_gltf_views(struct scene_views *out, struct scene_file *file, const char *scene,
			   const char *name, struct diagnostics *diagnostics)
{
	struct gltf gltf = { 0 };
	int rc = read_gltf(&gltf, file, diagnostics);

	if (rc == 0)
		rc = gltf_views_read(out, &gltf, scene, name);
	gltf_finish(&gltf);
	return rc;
}

int import_scenery_views(struct import_views *out, const char *path, const char *name,
			 const struct import_options *options, const char *scene,
			 struct diagnostics *diagnostics)
{
	struct scene_views views = { 0 };
	struct scene_file file;
	int rc = open_scene(&file, path, diagnostics);

	*out = (struct import_views){ 0 };
	if (rc == 0)
		rc = file.format == SCAN_VRML
			     ? read_vrml_views(&views, &file, name, diagnostics)
			     : read_gltf_views(&views, &file, scene, name, diagnostics);
	if (rc == 0)
		rc = take_views(out, &views, path, options, diagnostics);
	if (rc < 0) {
		free(out->items);
		*out = (struct import_views){ 0 };
	}
	scene_views_finish(&views);
	close_scene(&file);
	return rc;
}
