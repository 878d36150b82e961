/* A panel drawn by the CPU, for when the GPU or its driver is what is ill: KMS with two dumb
 * buffers, or memory. One thread. */
#ifndef GOPURA_RENDER_DISPLAY_CANVAS_H
#define GOPURA_RENDER_DISPLAY_CANVAS_H

#include <stdbool.h>
#include <stdint.h>

#include "render/display/display.h"

struct canvas;

/* Of the options: kind (not a window; auto: a panel, else memory), size, device, connector.
 * *out is owned by the caller; NULL on failure. -ENODEV: no panel (logged). */
must_check int canvas_create(struct canvas **out, const struct display_options *options);
void canvas_destroy(struct canvas *canvas); /* NULL and half-built are fine */

enum display_kind canvas_kind(const struct canvas *canvas);
int canvas_width_px(const struct canvas *canvas);
int canvas_height_px(const struct canvas *canvas);

/* As of display.h. */
int canvas_fd(const struct canvas *canvas);
int canvas_wait_ms(const struct canvas *canvas);
must_check int canvas_dispatch(struct canvas *canvas);
bool canvas_ready(const struct canvas *canvas);
bool canvas_is_dark(const struct canvas *canvas);

/* Shows a picture of the canvas' size, 4 bytes a pixel: blue, green, red, any. Only where
 * canvas_ready; *pixels is free again when this returns. */
must_check int canvas_show(struct canvas *canvas, const uint8_t *pixels, int stride_bytes);

#endif
