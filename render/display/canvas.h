/* A panel drawn by the CPU, for when the GPU or its driver does not work. It uses KMS with two dumb
 * buffers, or no panel at all. One thread. */
#ifndef GOPURA_RENDER_DISPLAY_CANVAS_H
#define GOPURA_RENDER_DISPLAY_CANVAS_H

#include <stdbool.h>
#include <stdint.h>

#include "render/display/display.h"

struct canvas;

/* Uses these options: kind (a window is not possible; DISPLAY_AUTO takes a panel, else headless),
 * size, device and connector. The caller owns *out; it is NULL on failure. -ENODEV: no panel
 * (logged). -ENOMEM, and what KMS reports. */
must_check int canvas_create(struct canvas **out, const struct display_options *options);
/* Stops showing and frees everything. NULL and a half-built canvas are fine. */
void canvas_destroy(struct canvas *canvas);

/* Returns what it is: DISPLAY_DRM or DISPLAY_HEADLESS. */
enum display_kind canvas_kind(const struct canvas *canvas);
/* Its width in pixels. */
int canvas_width_px(const struct canvas *canvas);
/* Its height in pixels. */
int canvas_height_px(const struct canvas *canvas);

/* Like display_fd, display_wait_ms, display_dispatch, display_ready and display_is_dark. */
int canvas_fd(const struct canvas *canvas);
int canvas_wait_ms(const struct canvas *canvas);
must_check int canvas_dispatch(struct canvas *canvas);
bool canvas_ready(const struct canvas *canvas);
bool canvas_is_dark(const struct canvas *canvas);

/* Shows a picture of the canvas' size, 4 bytes a pixel: blue, green, red, unused. Call it only
 * where canvas_ready. *pixels is copied before it returns. A headless canvas discards the
 * picture. */
must_check int canvas_show(struct canvas *canvas, const uint8_t *pixels, int stride_bytes);

#endif
