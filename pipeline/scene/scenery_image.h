/* Reads a picture that a scene names. Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_SCENERY_IMAGE_H
#define GOPURA_PIPELINE_SCENE_SCENERY_IMAGE_H

#include "base/diagnostics.h"
#include "format/picture.h"

enum { SCENERY_IMAGE_BYTES_MAX = 64 << 20 };

/* Decodes JPEG or PNG. name is for messages. Returns 1; 0 with a diagnostic of file and line in
 * warnings: it is no such picture, or over PICTURE_PAGE_SIDE_MOST_PX wide or high; -ENOMEM. */
must_check int scenery_image_decode(struct picture *out, struct bytes bytes, const char *name,
				    const char *file, unsigned line, struct diagnostics *warnings);
/* The same for a descriptor, which is closed; negative: why it could not be opened. What may be
 * read at the next try (base/transient.h) is an error in warnings, and is returned. */
must_check int scenery_image_read(struct picture *out, int fd, const char *name, const char *file,
				  unsigned line, struct diagnostics *warnings);

#endif
