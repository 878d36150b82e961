/* The headless backend: draws into a texture, for tests, captures and machines without a panel. */
#include "render/display/display_headless.h"

#include <errno.h>
#include <stdlib.h>

#include "render/display/display.h"
#include "render/display/gl.h"
#include "render/display/headless.h"

struct headless_display {
	struct headless *headless;
	struct gl_target target;
};

static int create(struct display *display, const struct display_options *options)
{
	struct headless_display *memory = calloc(1, sizeof(*memory));
	int rc;

	if (!memory)
		return -ENOMEM;
	display->state = memory;
	display->width_px = options->width_px ? options->width_px : 1280;
	display->height_px = options->height_px ? options->height_px : 720;
	rc = headless_create(&memory->headless);
	if (rc == 0)
		rc = headless_panel(memory->headless, &memory->target, display->width_px,
				    display->height_px);
	return rc;
}

static void destroy(struct display *display)
{
	struct headless_display *memory = display->state;

	if (!memory)
		return;
	if (memory->headless)
		gl_target_destroy(&memory->target);
	headless_destroy(memory->headless);
	free(memory);
	display->state = NULL;
}

static void begin(struct display *display)
{
	struct headless_display *memory = display->state;

	gl_target_bind(&memory->target);
}

static int present(struct display *display)
{
	(void)display;
	gl_finish();
	return 0;
}

const struct display_backend display_headless = {
	.name = "headless",
	.create = create,
	.destroy = destroy,
	.begin = begin,
	.present = present,
};
