/* Reads a file as scenery: what stands beside the scans and may move (format/scenery.h). */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_SCENERY_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_SCENERY_H

#include "pipeline/import/import.h"
#include "pipeline/scene/scenery_maker.h"

/* What is taken of a glTF file. Zeroed is the scene that it shows first, moving when touched. */
struct import_scene {
	const char *name;  /* of one of its scenes; NULL: the first shown */
	bool plays_always; /* its animations run always; else when what they move is touched */
	bool says_how;     /* it was said which; a VRML97 file says so itself */
};

/* Adds the file at path below a new node of the layer, or of none (SCENERY_NONE). Axes and unit are
 * those of options. What is left out is a diagnostic in warnings. Returns a negative errno with a
 * diagnostic that names file, place and cure. */
must_check int import_scenery(struct scenery_maker *maker, const char *path, uint32_t layer,
			      const struct import_options *options,
			      const struct import_scene *scene, struct diagnostics *diagnostics,
			      struct diagnostics *warnings);

/* A view of a scene, in metres with z up. */
struct import_view {
	float eye_m[3], target_m[3]; /* a metre apart */
	float time_s; /* of a way: since it began; ascends, and stays where it jumps */
};

struct import_views {
	struct import_view *items; /* owned; free() it */
	uint32_t count;
	bool is_way; /* one moving camera at the times of its keys; else several that stand */
};

/* Gets the views of the scene at path: the way of its moving Viewpoint or camera of that name, or
 * NULL, as vrml_views_read and gltf_views_read choose. scene: as import_scene's name. Errors as
 * import_scenery, also where a view is farther away than SCENERY_PLACE_MAX metres. */
must_check int import_scenery_views(struct import_views *out, const char *path, const char *name,
				    const struct import_options *options, const char *scene,
				    struct diagnostics *diagnostics);

#endif
