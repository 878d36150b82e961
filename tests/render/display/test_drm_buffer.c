/* Buffers of a GBM and a card that are played: which planes and modifiers the card is told of, and
 * which layout a surface gets where another cannot be allocated or shown. */
#include "render/display/drm_buffer.h"

#include <drm_fourcc.h>
#include <string.h>

#include "tests/check.h"

enum { WIDTH = 1920, HEIGHT = 1080, CARD_FD = 5 };

/* as Intel's driver lists them */
static const uint64_t compressed = I915_FORMAT_MOD_Y_TILED_CCS, tiled = I915_FORMAT_MOD_X_TILED;

struct gbm_device {
	int unused;
};

struct gbm_bo {
	uint64_t modifier;
	int planes;
	void *data;
	void (*forget)(struct gbm_bo *bo, void *data);
};

struct gbm_surface {
	uint64_t modifier;
};

static struct gbm_device gbm;
static struct gbm_bo bo;
static struct gbm_surface surface;
static struct {
	uint64_t lacks;   /* modifier that cannot be allocated */
	uint64_t refuses; /* modifier that the card does not show */
	int bos, framebuffers, plain;
	uint32_t handles[4], strides[4], offsets[4];
	uint64_t modifiers[4];
} played;

/* ---- GBM */

struct gbm_device *gbm_bo_get_device(struct gbm_bo *of)
{
	(void)of;
	return &gbm;
}

int gbm_device_get_fd(struct gbm_device *device)
{
	(void)device;
	return CARD_FD;
}

uint32_t gbm_bo_get_width(struct gbm_bo *of)
{
	(void)of;
	return WIDTH;
}

uint32_t gbm_bo_get_height(struct gbm_bo *of)
{
	(void)of;
	return HEIGHT;
}

uint64_t gbm_bo_get_modifier(struct gbm_bo *of)
{
	return of->modifier;
}

int gbm_bo_get_plane_count(struct gbm_bo *of)
{
	return of->planes;
}

union gbm_bo_handle gbm_bo_get_handle_for_plane(struct gbm_bo *of, int plane)
{
	(void)of, (void)plane;
	return (union gbm_bo_handle){ .u32 = 11 };
}

uint32_t gbm_bo_get_stride_for_plane(struct gbm_bo *of, int plane)
{
	(void)of;
	return plane == 0 ? 4 * WIDTH : WIDTH / 8;
}

uint32_t gbm_bo_get_offset(struct gbm_bo *of, int plane)
{
	(void)of;
	return plane == 0 ? 0 : 4 * WIDTH * HEIGHT;
}

void gbm_bo_set_user_data(struct gbm_bo *of, void *data,
			  void (*forget)(struct gbm_bo *bo, void *data))
{
	of->data = data;
	of->forget = forget;
}

void *gbm_bo_get_user_data(struct gbm_bo *of)
{
	return of->data;
}

/* A driver takes the first that it has memory for. */
static uint64_t choose(const uint64_t *modifiers, unsigned count)
{
	for (unsigned i = 0; i < count; i++)
		if (modifiers[i] != played.lacks)
			return modifiers[i];
	return DRM_FORMAT_MOD_INVALID;
}

struct gbm_bo *gbm_bo_create_with_modifiers(struct gbm_device *device, uint32_t width,
					    uint32_t height, uint32_t format,
					    const uint64_t *modifiers, const unsigned count)
{
	(void)device, (void)width, (void)height, (void)format;
	bo = (struct gbm_bo){ .modifier = choose(modifiers, count), .planes = 1 };
	if (bo.modifier == DRM_FORMAT_MOD_INVALID)
		return NULL;
	bo.planes += bo.modifier == compressed;
	played.bos++;
	return &bo;
}

void gbm_bo_destroy(struct gbm_bo *of)
{
	if (of->data)
		of->forget(of, of->data);
	played.bos--;
}

struct gbm_surface *gbm_surface_create_with_modifiers(struct gbm_device *device, uint32_t width,
						      uint32_t height, uint32_t format,
						      const uint64_t *modifiers,
						      const unsigned count)
{
	(void)device, (void)format;
	CHECK(width == WIDTH && height == HEIGHT);
	surface.modifier = choose(modifiers, count); /* nothing is allocated yet */
	return &surface;
}

struct gbm_surface *gbm_surface_create(struct gbm_device *device, uint32_t width, uint32_t height,
				       uint32_t format, uint32_t flags)
{
	(void)device, (void)width, (void)height, (void)format, (void)flags;
	surface.modifier = DRM_FORMAT_MOD_INVALID;
	return &surface;
}

/* ---- the card */

int drmModeAddFB2WithModifiers(int fd, uint32_t width, uint32_t height, uint32_t format,
			       const uint32_t handles[4], const uint32_t strides[4],
			       const uint32_t offsets[4], const uint64_t modifiers[4], uint32_t *fb,
			       uint32_t flags)
{
	CHECK(fd == CARD_FD && width == WIDTH && height == HEIGHT);
	CHECK(format == DRM_FORMAT_XRGB8888 && flags == DRM_MODE_FB_MODIFIERS);
	if (modifiers[0] == played.refuses)
		return -1;
	memcpy(played.handles, handles, sizeof(played.handles));
	memcpy(played.strides, strides, sizeof(played.strides));
	memcpy(played.offsets, offsets, sizeof(played.offsets));
	memcpy(played.modifiers, modifiers, sizeof(played.modifiers));
	*fb = (uint32_t)++played.framebuffers;
	return 0;
}

int drmModeAddFB2(int fd, uint32_t width, uint32_t height, uint32_t format,
		  const uint32_t handles[4], const uint32_t strides[4], const uint32_t offsets[4],
		  uint32_t *fb, uint32_t flags)
{
	CHECK(fd == CARD_FD && width == WIDTH && height == HEIGHT);
	CHECK(format == DRM_FORMAT_XRGB8888 && flags == 0);
	CHECK(handles[0] == 11 && strides[0] == 4 * WIDTH && offsets[0] == 0);
	played.plain++;
	*fb = (uint32_t)++played.framebuffers;
	return 0;
}

int drmModeRmFB(int fd, uint32_t fb)
{
	CHECK(fd == CARD_FD && fb > 0);
	played.framebuffers--;
	return 0;
}

/* ---- */

static struct drm_card card;

static int begin(void **state)
{
	(void)state;
	memset(&played, 0, sizeof(played));
	played.lacks = played.refuses = DRM_FORMAT_MOD_INVALID;
	card = (struct drm_card){ .fd = CARD_FD,
				  .mode = { .hdisplay = WIDTH, .vdisplay = HEIGHT },
				  .modifiers = { compressed, tiled },
				  .modifier_count = 2 };
	return 0;
}

static void registers_every_plane_of_a_compressed_buffer(void **state)
{
	struct gbm_bo of = { .modifier = compressed, .planes = 2 };
	uint32_t fb;

	(void)state;
	fb = drm_buffer_framebuffer(&card, &of);
	CHECK(fb > 0 && played.plain == 0);
	CHECK(played.handles[0] == 11 && played.handles[1] == 11 && played.handles[2] == 0);
	CHECK(played.strides[0] == 4 * WIDTH && played.strides[1] == WIDTH / 8);
	CHECK(played.offsets[1] == 4 * WIDTH * HEIGHT);
	CHECK(played.modifiers[0] == compressed && played.modifiers[1] == compressed);
	CHECK(played.modifiers[2] == 0); /* the kernel refuses one of a plane that is not there */
	CHECK(drm_buffer_framebuffer(&card, &of) == fb && played.framebuffers == 1);
}

/* It would be shown scrambled. */
static void never_calls_a_tiled_buffer_linear(void **state)
{
	struct gbm_bo of = { .modifier = tiled, .planes = 1 };

	(void)state;
	played.refuses = tiled;
	CHECK(drm_buffer_framebuffer(&card, &of) == 0 && played.plain == 0);
}

static void a_linear_buffer_needs_no_modifier(void **state)
{
	struct gbm_bo of = { .modifier = DRM_FORMAT_MOD_LINEAR, .planes = 1 };

	(void)state;
	played.refuses = DRM_FORMAT_MOD_LINEAR;
	CHECK(drm_buffer_framebuffer(&card, &of) > 0 && played.plain == 1);
	of = (struct gbm_bo){ .modifier = DRM_FORMAT_MOD_INVALID, .planes = 1 };
	CHECK(drm_buffer_framebuffer(&card, &of) > 0 && played.plain == 2);
	card.modifier_count = 0; /* a card that knows none */
	of = (struct gbm_bo){ .modifier = DRM_FORMAT_MOD_LINEAR, .planes = 1 };
	CHECK(drm_buffer_framebuffer(&card, &of) > 0 && played.plain == 3);
}

static uint64_t modifier_of_surface(void)
{
	CHECK(drm_buffer_surface(&card, &gbm) == &surface);
	CHECK(played.bos == 0 && played.framebuffers == 0); /* what was tried is gone */
	return surface.modifier;
}

static void a_surface_has_what_the_plane_accepts(void **state)
{
	(void)state;
	CHECK(modifier_of_surface() == compressed);
	played.lacks = compressed;
	CHECK(modifier_of_surface() == tiled);
}

static void a_surface_is_linear_where_the_card_shows_nothing_else(void **state)
{
	(void)state;
	played.refuses = compressed;
	CHECK(modifier_of_surface() == DRM_FORMAT_MOD_LINEAR);
	card.modifier_count = 0;
	CHECK(modifier_of_surface() == DRM_FORMAT_MOD_LINEAR);
}

static void a_surface_is_as_the_driver_likes_where_nothing_can_be_asked_for(void **state)
{
	(void)state;
	card.modifier_count = 0;
	played.lacks = DRM_FORMAT_MOD_LINEAR;
	CHECK(modifier_of_surface() == DRM_FORMAT_MOD_INVALID);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(registers_every_plane_of_a_compressed_buffer, begin),
		cmocka_unit_test_setup(never_calls_a_tiled_buffer_linear, begin),
		cmocka_unit_test_setup(a_linear_buffer_needs_no_modifier, begin),
		cmocka_unit_test_setup(a_surface_has_what_the_plane_accepts, begin),
		cmocka_unit_test_setup(a_surface_is_linear_where_the_card_shows_nothing_else,
				       begin),
		cmocka_unit_test_setup(
			a_surface_is_as_the_driver_likes_where_nothing_can_be_asked_for, begin),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
