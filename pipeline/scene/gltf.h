/* Reads a glTF 2.0 file (.gltf or .glb): its JSON with lists by number, its buffers, and the
 * numbers of its accessors (glTF 2.0 specification, chapters 3 and 4). What is refused names file,
 * place and cure. */
#ifndef GOPURA_PIPELINE_SCENE_GLTF_H
#define GOPURA_PIPELINE_SCENE_GLTF_H

#include <stdbool.h>

#include "base/bytes.h"
#include "base/diagnostics.h"
#include "base/json_text.h"
#include "format/picture.h"

struct cJSON;

enum {
	GLTF_BUFFERS_MAX = 64,
	GLTF_ITEMS_MAX = 1 << 16, /* of each list */
};

#define GLTF_BYTES_MAX (256ull << 20) /* of the file, and of each buffer */

enum gltf_list {
	GLTF_SCENES,
	GLTF_NODES,
	GLTF_MESHES,
	GLTF_MATERIALS,
	GLTF_ACCESSORS,
	GLTF_VIEWS, /* bufferViews */
	GLTF_ANIMATIONS,
	GLTF_TEXTURES,
	GLTF_IMAGES,
	GLTF_CAMERAS,
	GLTF_LISTS
};

struct gltf_options {
	/* Opens a file that the document names. Returns a descriptor, owned by the caller, or a
	 * negative errno. NULL: it may name none. */
	int (*open_file)(void *data, const char *name);
	void *data;
};

struct gltf {
	const char *path; /* borrowed; for messages */
	struct diagnostics *diagnostics;
	struct gltf_options options; /* to open pictures */
	struct json_text json;
	struct {
		const struct cJSON **items; /* owned */
		uint32_t count;
	} lists[GLTF_LISTS];
	struct buffer buffers[GLTF_BUFFERS_MAX];
	uint32_t buffer_count;
};

/* The numbers of an accessor. */
struct gltf_numbers {
	const uint8_t *data;   /* borrowed; NULL: all are 0 */
	uint32_t count, width; /* elements, and numbers of each */
	uint32_t stride;
	uint32_t type; /* componentType, as 5126 for floats */
	bool is_normalised;
};

/* Reads the document; path is for messages. *out is for gltf_finish, also on failure, and keeps
 * path and diagnostics. Returns a negative errno with a diagnostic: -EBADMSG: not valid; -EFBIG:
 * past a limit above; -ENOENT and others: a buffer's file; -ENOMEM. */
must_check int gltf_read(struct gltf *out, struct bytes file, const char *path,
			 const struct gltf_options *options, struct diagnostics *diagnostics);
void gltf_finish(struct gltf *gltf); /* zeroed is fine */

/* Returns an item of a list by the number in a field of an object; NULL: there is no such field, or
 * no such item. *number may be NULL. */
const struct cJSON *gltf_item(const struct gltf *gltf, enum gltf_list list,
			      const struct cJSON *object, const char *field, uint32_t *number);
/* Gets the numbers of the accessor in a field. -EBADMSG with a diagnostic: they are not there, not
 * within their buffer, not `width` each, or sparse. */
must_check int gltf_numbers_of(struct gltf_numbers *out, const struct gltf *gltf,
			       const struct cJSON *object, const char *field, uint32_t width);
/* Returns a number of an element as a float; integers that are normalised are -1 to 1. */
float gltf_number(const struct gltf_numbers *numbers, uint32_t element, uint32_t k);
/* The same as an index. */
uint32_t gltf_index(const struct gltf_numbers *numbers, uint32_t element);

/* Reads the picture of a texture. Returns 1; 0, with a diagnostic in warnings: there is none that
 * can be read; -ENOMEM, or the other errors of scenery_image_read. */
must_check int gltf_picture(struct picture *out, const struct gltf *gltf,
			    const struct cJSON *texture, struct diagnostics *warnings);

/* Adds a diagnostic about an object of the document, with its line. Returns error. */
int gltf_say(const struct gltf *gltf, int error, const struct cJSON *object, const char *text, ...)
	printf_like(4, 5);

#endif
