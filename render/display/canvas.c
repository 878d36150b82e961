/* Implements the canvas: copies each picture into one of two dumb buffers and shows it through
 * drm_panel. */
#include "render/display/canvas.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include <drm_fourcc.h>
#include <xf86drm.h>

#include "base/log.h"
#include "render/display/drm_panel.h"

/* A dumb buffer: memory of the card that every KMS driver offers and the CPU can write. */
struct dumb {
	uint32_t handle, fb, stride_bytes;
	uint64_t bytes;
	uint8_t *pixels; /* mapped */
};

struct canvas {
	enum display_kind kind;
	int width_px, height_px;
	struct drm_panel panel;
	struct dumb buffers[2];
	int next; /* index of the buffer to draw into */
};

static int create_dumb(struct canvas *canvas, struct dumb *dumb)
{
	const int fd = canvas->panel.card.fd;
	struct drm_mode_create_dumb create = { .width = (uint32_t)canvas->width_px,
					       .height = (uint32_t)canvas->height_px,
					       .bpp = 32 };
	struct drm_mode_map_dumb map = { 0 };
	uint32_t handles[4] = { 0 }, strides[4] = { 0 }, offsets[4] = { 0 };
	void *pixels;

	if (drmIoctl(fd, DRM_IOCTL_MODE_CREATE_DUMB, &create) < 0)
		return -errno;
	dumb->handle = map.handle = handles[0] = create.handle;
	dumb->stride_bytes = strides[0] = create.pitch;
	dumb->bytes = create.size;
	if (drmModeAddFB2(fd, create.width, create.height, DRM_FORMAT_XRGB8888, handles, strides,
			  offsets, &dumb->fb, 0) < 0 ||
	    drmIoctl(fd, DRM_IOCTL_MODE_MAP_DUMB, &map) < 0)
		return -errno;
	pixels = mmap(NULL, dumb->bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, (off_t)map.offset);
	if (pixels == MAP_FAILED)
		return -errno;
	dumb->pixels = pixels;
	return 0;
}

static void destroy_dumb(int fd, struct dumb *dumb)
{
	struct drm_mode_destroy_dumb destroy = { .handle = dumb->handle };

	if (dumb->pixels)
		munmap(dumb->pixels, dumb->bytes);
	if (dumb->fb)
		drmModeRmFB(fd, dumb->fb);
	if (dumb->handle)
		drmIoctl(fd, DRM_IOCTL_MODE_DESTROY_DUMB, &destroy);
}

static int open_panel(struct canvas *canvas, const struct display_options *options)
{
	int rc = drm_panel_open(&canvas->panel, &(struct drm_card_options){
							.device = options->device,
							.connector = options->connector,
							.mode = { options->width_px,
								  options->height_px, options->hz },
							.may_wait = options->kind == DISPLAY_DRM,
						});

	if (rc < 0)
		return rc;
	canvas->kind = DISPLAY_DRM;
	canvas->width_px = canvas->panel.card.mode.hdisplay;
	canvas->height_px = canvas->panel.card.mode.vdisplay;
	for (size_t i = 0; rc == 0 && i < ARRAY_COUNT(canvas->buffers); i++)
		rc = create_dumb(canvas, &canvas->buffers[i]);
	if (rc < 0)
		log_error("render", "board bug: the graphics card allocates no framebuffer: %s",
			  strerror(-rc));
	return rc;
}

int canvas_create(struct canvas **out, const struct display_options *options)
{
	struct canvas *canvas = calloc(1, sizeof(*canvas));
	int rc = -ENODEV;

	*out = NULL;
	if (!canvas)
		return -ENOMEM;
	canvas->kind = DISPLAY_HEADLESS;
	canvas->panel = (struct drm_panel){ .card.fd = -1, .epoll_fd = -1, .uevent_fd = -1 };
	if (options->kind != DISPLAY_HEADLESS)
		rc = open_panel(canvas, options);
	if (rc < 0 && options->kind != DISPLAY_DRM) {
		canvas->kind = DISPLAY_HEADLESS;
		canvas->width_px = options->width_px ? options->width_px : 1280;
		canvas->height_px = options->height_px ? options->height_px : 720;
		rc = 0;
	}
	if (rc < 0) {
		canvas_destroy(canvas);
		return rc;
	}
	log_info("render", "%s canvas, %d x %d", canvas->kind == DISPLAY_DRM ? "KMS" : "headless",
		 canvas->width_px, canvas->height_px);
	*out = canvas;
	return 0;
}

void canvas_destroy(struct canvas *canvas)
{
	if (!canvas)
		return;
	for (size_t i = 0; i < ARRAY_COUNT(canvas->buffers); i++)
		destroy_dumb(canvas->panel.card.fd, &canvas->buffers[i]);
	drm_panel_close(&canvas->panel);
	free(canvas);
}

enum display_kind canvas_kind(const struct canvas *canvas)
{
	return canvas->kind;
}

int canvas_width_px(const struct canvas *canvas)
{
	return canvas->width_px;
}

int canvas_height_px(const struct canvas *canvas)
{
	return canvas->height_px;
}

int canvas_fd(const struct canvas *canvas)
{
	return canvas->kind == DISPLAY_DRM ? drm_panel_fd(&canvas->panel) : -1;
}

int canvas_wait_ms(const struct canvas *canvas)
{
	return canvas->kind == DISPLAY_DRM ? drm_panel_wait_ms(&canvas->panel) : -1;
}

int canvas_dispatch(struct canvas *canvas)
{
	bool flipped;

	return canvas->kind == DISPLAY_DRM ? drm_panel_dispatch(&canvas->panel, &flipped) : 0;
}

bool canvas_ready(const struct canvas *canvas)
{
	return canvas->kind != DISPLAY_DRM || drm_panel_ready(&canvas->panel);
}

bool canvas_is_dark(const struct canvas *canvas)
{
	return canvas->kind == DISPLAY_DRM && drm_panel_dark(&canvas->panel);
}

int canvas_show(struct canvas *canvas, const uint8_t *pixels, int stride_bytes)
{
	struct dumb *dumb = &canvas->buffers[canvas->next];
	bool shown;
	int rc;

	if (canvas->kind != DISPLAY_DRM)
		return 0;
	for (int y = 0; y < canvas->height_px; y++)
		memcpy(dumb->pixels + (size_t)y * dumb->stride_bytes,
		       pixels + (size_t)y * (size_t)stride_bytes, (size_t)canvas->width_px * 4);
	rc = drm_panel_show(&canvas->panel, dumb->fb, &shown);
	if (shown)
		canvas->next = !canvas->next;
	return rc;
}
