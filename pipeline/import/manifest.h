/* Finds in a IIIF manifest (Presentation 4, a draft) of 3D scenes what a content folder can hold:
 * models, cameras and comments, each with its place in the scene. docs/iiif.md has the format. */
#ifndef GOPURA_PIPELINE_IMPORT_MANIFEST_H
#define GOPURA_PIPELINE_IMPORT_MANIFEST_H

#include "base/diagnostics.h"
#include "base/json_text.h"
#include "pipeline/import/transform.h"

struct cJSON;

enum { MANIFEST_ITEMS_MAX = 4096, MANIFEST_LEFT_OUT_MAX = 64 };

enum manifest_kind { MANIFEST_MODEL, MANIFEST_CAMERA, MANIFEST_COMMENT };

struct manifest_item {
	enum manifest_kind kind;
	const struct cJSON *annotation; /* borrowed from the JSON */
	/* the model or camera, an object or the string of its address; borrowed; NULL: a comment */
	const struct cJSON *resource;
	unsigned line; /* of the annotation; 0: unknown */
	/* From the resource's own axes to the scene's; y is up in both. Of a comment: from the axes
	 * of its target. May hold numbers that are not finite. */
	struct transform place;
};

struct manifest {
	uint32_t count, room;
	struct manifest_item *items; /* owned; in the order of the file */
	/* warnings: what of the file has no place in a content folder, each once */
	struct diagnostics left_out;
};

/* Returns whether the JSON is a manifest: an object whose type is "Manifest". */
bool manifest_is(const struct cJSON *root);

/* Finds the items. *out borrows from json, and is owned by the caller; it is zeroed on failure.
 * path is for messages. -EBADMSG: no manifest, or no scene in it, which diagnostics has with its
 * line. -EFBIG: too many items, likewise. -ENOMEM. */
must_check int manifest_read(struct manifest *out, const struct json_text *json, const char *path,
			     struct diagnostics *diagnostics);
void manifest_finish(struct manifest *manifest); /* NULL and zeroed are fine */

/* Returns the address of a model or camera, or the id of an annotation. NULL: it has none. */
const char *manifest_id(const struct cJSON *resource);

/* Reads x, y and z of a PointSelector; what is missing is 0. Returns false if it is none. */
bool manifest_point(const struct cJSON *selector, double out[3]);

/* Computes where a camera stands and what it looks at, in the scene's axes. Without lookAt it looks
 * along its own -z. */
void manifest_view(const struct manifest *manifest, const struct manifest_item *camera,
		   double eye[3], double target[3]);
/* Turns a place of a scene to the axes of a content folder, where z is up. to may be from. */
void manifest_z_up(const double from[3], double to[3]);

#endif
