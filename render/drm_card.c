#include "render/drm_card.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <drm_fourcc.h>
#include <xf86drm.h>

#include "base/log.h"

enum { CARDS_MOST = 8 };

/* ---- properties */

/* Id of a property of an object, and its value where value is not NULL; 0: there is none. */
static uint32_t property_id(int fd, uint32_t object, uint32_t type, const char *name,
			    uint64_t *value)
{
	drmModeObjectProperties *list = drmModeObjectGetProperties(fd, object, type);
	uint32_t id = 0;

	for (uint32_t i = 0; list && id == 0 && i < list->count_props; i++) {
		drmModePropertyRes *property = drmModeGetProperty(fd, list->props[i]);

		if (property && strcmp(property->name, name) == 0) {
			id = property->prop_id;
			if (value)
				*value = list->prop_values[i];
		}
		drmModeFreeProperty(property);
	}
	drmModeFreeObjectProperties(list);
	return id;
}

static bool find_properties(struct drm_card *card)
{
	const uint32_t crtc = DRM_MODE_OBJECT_CRTC, plane = DRM_MODE_OBJECT_PLANE;
	struct drm_card_properties *p = &card->properties;
	const struct {
		uint32_t *id;
		uint32_t object, type;
		const char *name;
	} wanted[] = {
		{ &p->connector_crtc, card->connector, DRM_MODE_OBJECT_CONNECTOR, "CRTC_ID" },
		{ &p->crtc_mode, card->crtc, crtc, "MODE_ID" },
		{ &p->crtc_active, card->crtc, crtc, "ACTIVE" },
		{ &p->plane_fb, card->plane, plane, "FB_ID" },
		{ &p->plane_crtc, card->plane, plane, "CRTC_ID" },
		{ &p->plane_src_x, card->plane, plane, "SRC_X" },
		{ &p->plane_src_y, card->plane, plane, "SRC_Y" },
		{ &p->plane_src_w, card->plane, plane, "SRC_W" },
		{ &p->plane_src_h, card->plane, plane, "SRC_H" },
		{ &p->plane_crtc_x, card->plane, plane, "CRTC_X" },
		{ &p->plane_crtc_y, card->plane, plane, "CRTC_Y" },
		{ &p->plane_crtc_w, card->plane, plane, "CRTC_W" },
		{ &p->plane_crtc_h, card->plane, plane, "CRTC_H" },
	};

	for (size_t i = 0; i < ARRAY_COUNT(wanted); i++) {
		*wanted[i].id = property_id(card->fd, wanted[i].object, wanted[i].type,
					    wanted[i].name, NULL);
		if (*wanted[i].id == 0)
			return false;
	}
	return true;
}

/* ---- choosing */

static bool connector_fits(const drmModeConnector *connector, const char *name)
{
	char own_name[64];

	if (connector->connection != DRM_MODE_CONNECTED || connector->count_modes == 0)
		return false;
	if (!name)
		return true;
	snprintf(own_name, sizeof(own_name), "%s-%u",
		 drmModeGetConnectorTypeName(connector->connector_type),
		 connector->connector_type_id);
	return strcmp(name, own_name) == 0;
}

static void choose_mode(struct drm_card *card, const drmModeConnector *connector, int width_px,
			int height_px)
{
	card->mode = connector->modes[0];
	for (int i = connector->count_modes - 1; i >= 0; i--) {
		const drmModeModeInfo *mode = &connector->modes[i];

		if (width_px ? mode->hdisplay == width_px && mode->vdisplay == height_px
			     : (mode->type & DRM_MODE_TYPE_PREFERRED) != 0)
			card->mode = *mode;
	}
	if (width_px && (card->mode.hdisplay != width_px || card->mode.vdisplay != height_px))
		log_warn("render", "board bug: the panel has no mode %d x %d, taking %d x %d",
			 width_px, height_px, card->mode.hdisplay, card->mode.vdisplay);
}

/* Bits of the CRTCs that the connector can be driven by. */
static uint32_t possible_crtcs(int fd, const drmModeConnector *connector)
{
	uint32_t bits = 0;

	for (int i = 0; i < connector->count_encoders; i++) {
		drmModeEncoder *encoder = drmModeGetEncoder(fd, connector->encoders[i]);

		if (encoder)
			bits |= encoder->possible_crtcs;
		drmModeFreeEncoder(encoder);
	}
	return bits;
}

static bool choose_connector(struct drm_card *card, const drmModeRes *resources, const char *name,
			     int width_px, int height_px, uint32_t *crtc_bits)
{
	for (int i = 0; i < resources->count_connectors; i++) {
		drmModeConnector *connector =
			drmModeGetConnector(card->fd, resources->connectors[i]);
		bool fits = connector && connector_fits(connector, name);

		if (fits) {
			card->connector = connector->connector_id;
			card->width_mm = (int)connector->mmWidth;
			choose_mode(card, connector, width_px, height_px);
			*crtc_bits = possible_crtcs(card->fd, connector);
		}
		drmModeFreeConnector(connector);
		if (fits)
			return true;
	}
	return false;
}

/* Modifiers the plane takes for XRGB8888, from its IN_FORMATS blob. */
static void read_modifiers(struct drm_card *card)
{
	uint64_t blob_id = 0;
	drmModePropertyBlobRes *blob;
	drmModeFormatModifierIterator at = { 0 };

	if (!property_id(card->fd, card->plane, DRM_MODE_OBJECT_PLANE, "IN_FORMATS", &blob_id))
		return;
	blob = drmModeGetPropertyBlob(card->fd, (uint32_t)blob_id);
	if (!blob)
		return;
	while (drmModeFormatModifierBlobIterNext(blob, &at))
		if (at.fmt == DRM_FORMAT_XRGB8888 && card->modifier_count < DRM_MODIFIERS_MOST)
			card->modifiers[card->modifier_count++] = at.mod;
	drmModeFreePropertyBlob(blob);
}

/* The primary plane of the CRTC with the given index; 0: none. */
static uint32_t primary_plane(int fd, int crtc_index)
{
	drmModePlaneRes *planes = drmModeGetPlaneResources(fd);
	uint32_t found = 0;

	for (uint32_t i = 0; planes && found == 0 && i < planes->count_planes; i++) {
		drmModePlane *plane = drmModeGetPlane(fd, planes->planes[i]);
		uint64_t type = DRM_PLANE_TYPE_OVERLAY;

		if (plane && (plane->possible_crtcs & 1u << crtc_index) &&
		    property_id(fd, plane->plane_id, DRM_MODE_OBJECT_PLANE, "type", &type) &&
		    type == DRM_PLANE_TYPE_PRIMARY)
			found = plane->plane_id;
		drmModeFreePlane(plane);
	}
	drmModeFreePlaneResources(planes);
	return found;
}

static int choose_crtc(struct drm_card *card, const drmModeRes *resources, uint32_t crtc_bits)
{
	for (int i = 0; i < resources->count_crtcs; i++) {
		if (!(crtc_bits & 1u << i))
			continue;
		card->crtc = resources->crtcs[i];
		card->crtc_before = drmModeGetCrtc(card->fd, card->crtc);
		if (card->atomic) {
			card->plane = primary_plane(card->fd, i);
			card->atomic = card->plane != 0 && find_properties(card);
		}
		if (card->atomic)
			read_modifiers(card);
		return 0;
	}
	return -ENODEV;
}

static int open_card(struct drm_card *card, const char *device, const char *connector, int width_px,
		     int height_px)
{
	drmModeRes *resources;
	uint32_t crtc_bits = 0;
	int rc;

	*card = (struct drm_card){ .fd = open(device, O_RDWR | O_CLOEXEC | O_NONBLOCK) };
	if (card->fd < 0)
		return -errno;
	drmSetClientCap(card->fd, DRM_CLIENT_CAP_UNIVERSAL_PLANES, 1);
	card->atomic = drmSetClientCap(card->fd, DRM_CLIENT_CAP_ATOMIC, 1) == 0 &&
		       !getenv("GOPURA_DRM_LEGACY");
	resources = drmModeGetResources(card->fd);
	if (!resources)
		rc = -ENODEV; /* renders, but shows nothing: another card drives the panel */
	else if (!choose_connector(card, resources, connector, width_px, height_px, &crtc_bits))
		rc = -ENXIO;
	else if (!drmIsMaster(card->fd) && drmSetMaster(card->fd) < 0)
		rc = -EBUSY;
	else
		rc = choose_crtc(card, resources, crtc_bits);
	drmModeFreeResources(resources);
	if (rc < 0)
		drm_card_close(card);
	return rc;
}

static const char *why_not(int rc)
{
	switch (rc) {
	case -ENXIO:
		return "no connected panel that fits";
	case -EBUSY:
		return "another program shows pictures on it";
	case -ENODEV:
		return "it drives no panel";
	default:
		return strerror(-rc);
	}
}

int drm_card_open(struct drm_card *out, const char *device, const char *connector, int width_px,
		  int height_px)
{
	int rc;

	if (device) {
		rc = open_card(out, device, connector, width_px, height_px);
		if (rc < 0)
			log_error("render", "%s: %s", device, why_not(rc));
		return rc < 0 ? -ENODEV : 0;
	}
	for (int i = 0; i < CARDS_MOST; i++) {
		char path[32];

		snprintf(path, sizeof(path), "/dev/dri/card%d", i);
		rc = open_card(out, path, connector, width_px, height_px);
		if (rc == 0)
			return 0;
		if (rc != -ENOENT)
			log_info("render", "%s: %s", path, why_not(rc));
	}
	return -ENODEV;
}

void drm_card_close(struct drm_card *card)
{
	drmModeCrtc *before = card->crtc_before;

	if (before && before->buffer_id)
		drmModeSetCrtc(card->fd, before->crtc_id, before->buffer_id, before->x, before->y,
			       &card->connector, 1, &before->mode);
	drmModeFreeCrtc(before);
	if (card->fd >= 0)
		close(card->fd);
	*card = (struct drm_card){ .fd = -1 };
}

/* ---- flips */

/* Sticky: the first failure stays, and is judged once. */
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

int drm_card_flip(struct drm_card *card, uint32_t fb, bool set_mode, void *data)
{
	int rc;

	if (!card->atomic)
		return flip_legacy(card, fb, set_mode, data);
	rc = flip_atomic(card, fb, set_mode, data);
	if (rc < 0 && set_mode) {
		log_info("render", "atomic mode set refused (%s), trying the legacy interface",
			 strerror(-rc));
		card->atomic = false;
		rc = flip_legacy(card, fb, true, data);
	}
	return rc;
}
