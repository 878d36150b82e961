/* Page flips and switching the panel off and on, atomic or legacy. Part of drm_card.h. */
#include "render/display/drm_flip.h"

#include <errno.h>
#include <string.h>
#include <xf86drm.h>

#include "base/log.h"

/* Collects the errors of all additions; they are checked once, before the commit. */
struct atomic {
	drmModeAtomicReq *request;
	bool failed;
};

static void atomic_add(struct atomic *atomic, uint32_t object, uint32_t property, uint64_t value)
{
	if (!atomic->request ||
	    drmModeAtomicAddProperty(atomic->request, object, property, value) < 0)
		atomic->failed = true;
}

static void add_mode(struct atomic *atomic, struct drm_card *card, uint32_t *blob)
{
	const struct drm_card_properties *p = &card->properties;

	if (drmModeCreatePropertyBlob(card->fd, &card->mode, sizeof(card->mode), blob) < 0)
		atomic->failed = true;
	atomic_add(atomic, card->connector, p->connector_crtc, card->crtc);
	atomic_add(atomic, card->crtc, p->crtc_mode, *blob);
	atomic_add(atomic, card->crtc, p->crtc_active, 1);
	if (p->connector_link && card->link_is_bad)
		atomic_add(atomic, card->connector, p->connector_link, DRM_MODE_LINK_STATUS_GOOD);
}

static void add_plane(struct atomic *atomic, const struct drm_card *card, uint32_t fb)
{
	const struct drm_card_properties *p = &card->properties;
	const uint64_t width = card->mode.hdisplay, height = card->mode.vdisplay;

	atomic_add(atomic, card->plane, p->plane_fb, fb);
	atomic_add(atomic, card->plane, p->plane_crtc, card->crtc);
	atomic_add(atomic, card->plane, p->plane_src_x, 0);
	atomic_add(atomic, card->plane, p->plane_src_y, 0);
	atomic_add(atomic, card->plane, p->plane_src_w, width << 16);
	atomic_add(atomic, card->plane, p->plane_src_h, height << 16);
	atomic_add(atomic, card->plane, p->plane_crtc_x, 0);
	atomic_add(atomic, card->plane, p->plane_crtc_y, 0);
	atomic_add(atomic, card->plane, p->plane_crtc_w, width);
	atomic_add(atomic, card->plane, p->plane_crtc_h, height);
}

static int flip_atomic(struct drm_card *card, uint32_t fb, bool set_mode, void *data)
{
	const uint32_t flags = set_mode ? DRM_MODE_ATOMIC_ALLOW_MODESET : 0;
	struct atomic atomic = { .request = drmModeAtomicAlloc() };
	uint32_t mode_blob = 0;
	int rc = -ENOMEM;

	if (set_mode)
		add_mode(&atomic, card, &mode_blob);
	add_plane(&atomic, card, fb);
	if (!atomic.failed)
		rc = drmModeAtomicCommit(card->fd, atomic.request,
					 flags | DRM_MODE_ATOMIC_TEST_ONLY, NULL);
	if (rc == 0)
		rc = drmModeAtomicCommit(
			card->fd, atomic.request,
			flags | DRM_MODE_ATOMIC_NONBLOCK | DRM_MODE_PAGE_FLIP_EVENT, data);
	if (mode_blob)
		drmModeDestroyPropertyBlob(card->fd, mode_blob);
	drmModeAtomicFree(atomic.request);
	return rc;
}

static int flip_legacy(struct drm_card *card, uint32_t fb, bool set_mode, void *data)
{
	int rc = 0;

	if (set_mode)
		rc = drmModeSetCrtc(card->fd, card->crtc, fb, 0, 0, &card->connector, 1,
				    &card->mode);
	if (rc == 0)
		rc = drmModePageFlip(card->fd, card->crtc, fb, DRM_MODE_PAGE_FLIP_EVENT, data);
	return rc < 0 ? -errno : 0;
}

bool drm_card_is_taken(int rc)
{
	return rc == -EACCES || rc == -EPERM || rc == -EBUSY;
}

int drm_card_flip(struct drm_card *card, uint32_t fb, bool set_mode, void *data)
{
	int rc;

	if (!card->atomic)
		return flip_legacy(card, fb, set_mode, data);
	rc = flip_atomic(card, fb, set_mode, data);
	if (rc < 0 && set_mode && !drm_card_is_taken(rc)) {
		log_info("render", "atomic mode set refused (%s), trying the legacy interface",
			 strerror(-rc));
		rc = flip_legacy(card, fb, true, data);
		if (rc == 0)
			card->atomic = false;
	}
	if (rc == 0 && set_mode)
		card->link_is_bad = false;
	return rc;
}

static int sleep_atomic(struct drm_card *card)
{
	struct atomic atomic = { .request = drmModeAtomicAlloc() };
	int rc = -ENOMEM;

	atomic_add(&atomic, card->crtc, card->properties.crtc_active, 0);
	if (!atomic.failed)
		rc = drmModeAtomicCommit(card->fd, atomic.request, DRM_MODE_ATOMIC_ALLOW_MODESET,
					 NULL);
	drmModeAtomicFree(atomic.request);
	return rc;
}

static int set_dpms(struct drm_card *card, uint64_t value)
{
	drmModeConnector *connector = drmModeGetConnectorCurrent(card->fd, card->connector);
	int rc = -EOPNOTSUPP;

	for (int i = 0; connector && rc == -EOPNOTSUPP && i < connector->count_props; i++) {
		drmModePropertyRes *property = drmModeGetProperty(card->fd, connector->props[i]);

		if (property && strcmp(property->name, "DPMS") == 0)
			rc = drmModeConnectorSetProperty(card->fd, card->connector,
							 property->prop_id, value) < 0
				     ? -errno
				     : 0;
		drmModeFreeProperty(property);
	}
	drmModeFreeConnector(connector);
	return rc;
}

int drm_card_sleep(struct drm_card *card)
{
	return card->atomic ? sleep_atomic(card) : set_dpms(card, DRM_MODE_DPMS_OFF);
}

int drm_card_wake(struct drm_card *card)
{
	/* Atomic: the next flip sets the mode and makes the CRTC active. */
	return card->atomic ? 0 : set_dpms(card, DRM_MODE_DPMS_ON);
}
