/* Small pictures of a model for the report of a build: as it looks, and its patches in colours.
 * Drawn from the master, so nothing of the scan is read. */
#ifndef GOPURA_PIPELINE_SAMPLES_PORTRAIT_H
#define GOPURA_PIPELINE_SAMPLES_PORTRAIT_H

#include "base/bytes.h"
#include "geometry/camera.h"
#include "pipeline/content/content.h"
#include "pipeline/hierarchy/master.h"

enum { PORTRAITS_MAX = 4 };

struct portrait {
	/* The view; near, far and size are set here. */
	struct camera camera;
	bool patches_coloured; /* each patch of the cut in a colour of its own */
};

/* Draws count pictures of width_px x height_px over the content's background and appends each, as a
 * JPEG, to the buffer of the same number. It happens in a process of its own, because a software
 * rasteriser keeps much memory. -ENOMEM, -ENODEV without GLES2, and the errors of GL and the disk.
 */
must_check int portraits_draw(struct buffer *jpegs, const struct portrait *portraits,
			      uint32_t count, int width_px, int height_px,
			      const struct master *master, const struct content *content, bool lit);

#endif
