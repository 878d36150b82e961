/* Reads VRML97 files as scenery. */
#include "pipeline/import/import_scenery.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/import/import_files.h"
#include "pipeline/scene/vrml_scenery.h"
#include "pipeline/scene/vrml_text.h"

static int open_file(void *data, const char *name)
{
	return import_files_open(data, name);
}

static int read_scene(struct vrml **out, const char *path, struct diagnostics *diagnostics,
		      struct diagnostics *warnings)
{
	struct import_files files = { .scan_path = path };
	const struct vrml_options options = { .open_file = open_file, .data = &files };
	struct buffer file;
	int rc;

	files.folder_fd = import_files_open_folder(path);
	if (files.folder_fd < 0)
		return diagnostics_add(diagnostics, files.folder_fd, path, 0, "%s",
				       strerror(-files.folder_fd));
	buffer_init(&file, VRML_TEXT_BYTES_MAX);
	rc = buffer_read_file(&file, path);
	if (rc < 0)
		rc = diagnostics_add(diagnostics, rc, path, 0, "%s",
				     rc == -EFBIG ? "too large; split it into several files"
						  : strerror(-rc));
	else
		rc = vrml_read(out, buffer_bytes(&file), path, &options, diagnostics, warnings);
	buffer_finish(&file);
	close(files.folder_fd);
	return rc;
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

	scenery_turn(node.place.turn, axes[options->up], degrees[options->up] * 0.017453293f);
	for (int k = 0; k < 3; k++)
		node.place.scale[k] = unit;
	return node;
}

int import_scenery(struct scenery_maker *maker, const char *path, uint32_t layer,
		   const struct import_options *options, struct diagnostics *diagnostics,
		   struct diagnostics *warnings)
{
	const struct scenery_node node = node_of(layer, options);
	enum scan_format format;
	struct vrml *scene = NULL;
	uint64_t bytes;
	uint32_t number;
	int rc = import_detect(&format, &bytes, path, diagnostics);

	if (rc == 0 && format != SCAN_VRML)
		rc = diagnostics_add(diagnostics, -EINVAL, path, 0,
				     "scenes are VRML97 (.wrl, .wrz); export it as that");
	if (rc == 0)
		rc = read_scene(&scene, path, diagnostics, warnings);
	if (rc == 0 && scenery_add_node(maker, &node, &number) < 0)
		rc = diagnostics_add(diagnostics, -EFBIG, path, 0, "over %d nodes in all scenes",
				     SCENERY_NODES_MAX);
	if (rc == 0)
		rc = vrml_scenery_add(maker, scene, number, diagnostics, warnings);
	vrml_destroy(scene);
	return rc;
}
