/* Registers buffers with all their planes, and finds out which layout of them a card can show. */
#include "render/display/drm_buffer.h"

#include <drm_fourcc.h>

#include "base/log.h"

enum { PLANES_MAX = 4 };

static void forget_framebuffer(struct gbm_bo *bo, void *data)
{
	drmModeRmFB(gbm_device_get_fd(gbm_bo_get_device(bo)), (uint32_t)(uintptr_t)data);
}

/* Registers a buffer. A compressed one has further planes, of which some hold what the first is
 * compressed with. Without its modifier the card would take it for linear. */
static uint32_t add(const struct drm_card *card, struct gbm_bo *bo)
{
	const uint32_t width = gbm_bo_get_width(bo), height = gbm_bo_get_height(bo);
	const uint64_t modifier = gbm_bo_get_modifier(bo);
	const int planes = gbm_bo_get_plane_count(bo);
	uint32_t handles[PLANES_MAX] = { 0 }, strides[PLANES_MAX] = { 0 };
	uint32_t offsets[PLANES_MAX] = { 0 }, fb = 0;
	uint64_t modifiers[PLANES_MAX] = { 0 };
	const bool is_named = card->modifier_count > 0 && modifier != DRM_FORMAT_MOD_INVALID;
	int rc = -1;

	for (int i = 0; i < planes && i < PLANES_MAX; i++) {
		handles[i] = gbm_bo_get_handle_for_plane(bo, i).u32;
		strides[i] = gbm_bo_get_stride_for_plane(bo, i);
		offsets[i] = gbm_bo_get_offset(bo, i);
		modifiers[i] = modifier;
	}
	if (is_named)
		rc = drmModeAddFB2WithModifiers(card->fd, width, height, DRM_FORMAT_XRGB8888,
						handles, strides, offsets, modifiers, &fb,
						DRM_MODE_FB_MODIFIERS);
	if (rc < 0 && (!is_named || modifier == DRM_FORMAT_MOD_LINEAR))
		rc = drmModeAddFB2(card->fd, width, height, DRM_FORMAT_XRGB8888, handles, strides,
				   offsets, &fb, 0);
	return rc < 0 ? 0 : fb;
}

uint32_t drm_buffer_framebuffer(const struct drm_card *card, struct gbm_bo *bo)
{
	uint32_t fb = (uint32_t)(uintptr_t)gbm_bo_get_user_data(bo);

	if (fb)
		return fb;
	fb = add(card, bo);
	if (fb)
		gbm_bo_set_user_data(bo, (void *)(uintptr_t)fb, forget_framebuffer);
	return fb;
}

/* Returns a surface with one of these modifiers, or NULL. A surface allocates its buffers when they
 * are drawn into, so whether there can be any is seen from one that is made for that. */
static struct gbm_surface *with_modifiers(const struct drm_card *card, struct gbm_device *gbm,
					  const uint64_t *modifiers, uint32_t count)
{
	const uint32_t width = card->mode.hdisplay, height = card->mode.vdisplay;
	struct gbm_bo *bo =
		count > 0 ? gbm_bo_create_with_modifiers(gbm, width, height, GBM_FORMAT_XRGB8888,
							 modifiers, count)
			  : NULL;
	const bool is_shown = bo && drm_buffer_framebuffer(card, bo) != 0;

	if (is_shown)
		log_info("render", "pictures for the panel are XRGB8888, modifier 0x%llx",
			 (unsigned long long)gbm_bo_get_modifier(bo));
	if (bo)
		gbm_bo_destroy(bo);
	return is_shown ? gbm_surface_create_with_modifiers(gbm, width, height, GBM_FORMAT_XRGB8888,
							    modifiers, count)
			: NULL;
}

struct gbm_surface *drm_buffer_surface(const struct drm_card *card, struct gbm_device *gbm)
{
	static const uint64_t linear = DRM_FORMAT_MOD_LINEAR;
	struct gbm_surface *surface =
		with_modifiers(card, gbm, card->modifiers, card->modifier_count);

	if (!surface)
		surface = with_modifiers(card, gbm, &linear, 1);
	if (!surface)
		surface = gbm_surface_create(gbm, card->mode.hdisplay, card->mode.vdisplay,
					     GBM_FORMAT_XRGB8888,
					     GBM_BO_USE_SCANOUT | GBM_BO_USE_RENDERING);
	return surface;
}
