/* Page flips on a KMS card, and switching its panel off and on. */
#ifndef GOPURA_RENDER_DISPLAY_DRM_FLIP_H
#define GOPURA_RENDER_DISPLAY_DRM_FLIP_H

#include "render/display/drm_card.h"

/* Returns whether a negative errno means that another program or a suspend has the card for now;
 * then nothing is broken. */
bool drm_card_is_taken(int rc);

/* Shows framebuffer fb on the next vertical blank; a flip event with data follows. set_mode also
 * sets the mode: needed in the first call, after a change of panel and after drm_card_sleep. On
 * failure returns the negative errno of the kernel. */
must_check int drm_card_flip(struct drm_card *card, uint32_t fb, bool set_mode, void *data);

/* Switches the panel off. Negative errno of the kernel; -EOPNOTSUPP: the driver knows no DPMS. */
must_check int drm_card_sleep(struct drm_card *card);
/* Prepares the panel: the next flip that sets the mode switches it on. Errors as drm_card_sleep. */
must_check int drm_card_wake(struct drm_card *card);

#endif
