/* The buffers of a GBM surface as framebuffers of a KMS card. */
#ifndef GOPURA_RENDER_DISPLAY_DRM_BUFFER_H
#define GOPURA_RENDER_DISPLAY_DRM_BUFFER_H

#include <gbm.h>

#include "render/display/drm_card.h"

/* Creates a surface of the size of the card's mode, whose buffers the card can show: with one of
 * the modifiers that its plane accepts, else linear, else as the driver likes. The caller owns it.
 * NULL: there is none. */
struct gbm_surface *drm_buffer_surface(const struct drm_card *card, struct gbm_device *gbm);

/* Returns the framebuffer of a buffer, made once and removed with it; 0: the card refuses it. */
uint32_t drm_buffer_framebuffer(const struct drm_card *card, struct gbm_bo *bo);

#endif
