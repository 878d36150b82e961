/* Finds a card under /dev/dri with a connected panel, chooses connector, CRTC, primary plane and
 * mode, and looks again after a hot-plug. */
#include "render/display/drm_card.h"

#include <drm_fourcc.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <xf86drm.h>

#include "base/clock.h"
#include "base/log.h"

enum {
	CARDS_MAX = 8,
	/* a driver may load after the kiosk, a boot splash may end after it */
	CARD_WAIT_MS = 30000,
	CARD_LOOK_MS = 500,
};

/* ---- properties */

/* Returns the id of a property of an object, and its value where value is not NULL; 0: there is
 * none. */
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

	p->connector_link = property_id(card->fd, card->connector, DRM_MODE_OBJECT_CONNECTOR,
					"link-status", NULL);

	for (size_t i = 0; i < ARRAY_COUNT(wanted); i++) {
		*wanted[i].id = property_id(card->fd, wanted[i].object, wanted[i].type,
					    wanted[i].name, NULL);
		if (*wanted[i].id == 0)
			return false;
	}
	return true;
}

/* ---- choosing */

static bool connector_has_name(const drmModeConnector *connector, const char *name)
{
	char own_name[64];

	if (connector->connector_type == DRM_MODE_CONNECTOR_WRITEBACK)
		return false; /* a writeback connector writes into memory */
	if (!name)
		return true;
	snprintf(own_name, sizeof(own_name), "%s-%u",
		 drmModeGetConnectorTypeName(connector->connector_type),
		 connector->connector_type_id);
	return strcmp(name, own_name) == 0;
}

static void choose_mode(struct drm_card *card, const drmModeConnector *connector,
			const struct drm_mode_wish *wish)
{
	uint64_t edid = 0;
	enum drm_mode_reason reason;

	property_id(card->fd, card->connector, DRM_MODE_OBJECT_CONNECTOR, "EDID", &edid);
	reason = drm_mode_choose(&card->mode, connector->modes, connector->count_modes, edid != 0,
				 wish);
	if (!card->connected)
		log_warn("render", "no panel is connected; the kiosk waits for one");
	else if (reason == DRM_MODE_UNKNOWN)
		log_warn("render", "board bug: the panel has no mode %d x %d; using %d x %d",
			 wish->width_px, wish->height_px, card->mode.hdisplay, card->mode.vdisplay);
	else if (reason == DRM_MODE_OTHER_RATE)
		log_warn("render", "board bug: the panel has no mode %d x %d at %d Hz; using %u Hz",
			 wish->width_px, wish->height_px, wish->hz, card->mode.vrefresh);
	else if (reason == DRM_MODE_MADE)
		log_info("render", "the panel reports no modes; using %d x %d at %u Hz",
			 card->mode.hdisplay, card->mode.vdisplay, card->mode.vrefresh);
}

/* Returns a bit mask of the CRTCs that can drive the connector. */
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

/* Returns the width of the panel, 0: not known. Many TVs have an aspect ratio in place of their
 * size, as 16 x 9 mm or cm: none of so many pixels is so small. */
static int find_width_mm(const drmModeConnector *connector, int width_px)
{
	static const uint32_t ratios[][2] = { { 160, 90 }, { 160, 100 }, { 16, 9 }, { 16, 10 } };

	for (size_t i = 0; i < ARRAY_COUNT(ratios); i++)
		if (connector->mmWidth == ratios[i][0] && connector->mmHeight == ratios[i][1] &&
		    width_px >= 1920)
			return 0;
	return (int)connector->mmWidth;
}

/* How sure it must be that a panel is connected. Some connectors cannot tell, such as VGA behind a
 * bridge; they are used where no other one has a panel (drm_mode.h of the kernel). */
enum presence { PRESENT, PERHAPS_PRESENT, PRESENT_OR_NOT };

static bool is_present(const drmModeConnector *connector, enum presence least)
{
	return least == PRESENT_OR_NOT || connector->connection == DRM_MODE_CONNECTED ||
	       (least == PERHAPS_PRESENT && connector->connection != DRM_MODE_DISCONNECTED);
}

/* Chooses the first connector of that name with a panel. */
static bool choose_connector(struct drm_card *card, const drmModeRes *resources,
			     enum presence least, const struct drm_card_options *options,
			     uint32_t *crtc_bits)
{
	for (int i = 0; i < resources->count_connectors; i++) {
		drmModeConnector *connector =
			drmModeGetConnector(card->fd, resources->connectors[i]);
		const bool fits = connector && connector_has_name(connector, options->connector) &&
				  is_present(connector, least);

		if (fits) {
			card->connector = connector->connector_id;
			card->connected = connector->connection != DRM_MODE_DISCONNECTED;
			choose_mode(card, connector, &options->mode);
			card->width_mm = find_width_mm(connector, card->mode.hdisplay);
			*crtc_bits = possible_crtcs(card->fd, connector);
		}
		drmModeFreeConnector(connector);
		if (fits)
			return true;
	}
	return false;
}

/* Reads the modifiers that the plane accepts for XRGB8888 from its IN_FORMATS blob. */
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
		if (at.fmt == DRM_FORMAT_XRGB8888 && card->modifier_count < DRM_MODIFIERS_MAX)
			card->modifiers[card->modifier_count++] = at.mod;
	drmModeFreePropertyBlob(blob);
}

/* Returns the primary plane of the CRTC with the given index; 0: none. */
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

/* Takes the CRTC of that number, with its primary plane. Returns whether it can be set atomically.
 */
static bool take_crtc(struct drm_card *card, const drmModeRes *resources, int number)
{
	card->crtc = resources->crtcs[number];
	card->plane = card->atomic ? primary_plane(card->fd, number) : 0;
	return card->plane != 0 && find_properties(card);
}

/* Asks the driver whether the CRTC can drive the connector with the mode. Some drivers do not allow
 * one without a picture, and always say no. */
static bool can_set_mode(const struct drm_card *card)
{
	const struct drm_card_properties *p = &card->properties;
	drmModeAtomicReq *request = drmModeAtomicAlloc();
	uint32_t mode = 0;
	bool can = request &&
		   drmModeCreatePropertyBlob(card->fd, &card->mode, sizeof(card->mode), &mode) == 0;
	const uint64_t values[][3] = {
		{ card->connector, p->connector_crtc, card->crtc },
		{ card->crtc, p->crtc_mode, mode },
		{ card->crtc, p->crtc_active, 1 },
		{ card->plane, p->plane_fb, 0 }, /* that of another program may not fit */
		{ card->plane, p->plane_crtc, 0 },
	};

	for (size_t i = 0; can && i < ARRAY_COUNT(values); i++)
		can = drmModeAtomicAddProperty(request, (uint32_t)values[i][0],
					       (uint32_t)values[i][1], values[i][2]) >= 0;
	can = can && drmModeAtomicCommit(card->fd, request,
					 DRM_MODE_ATOMIC_TEST_ONLY | DRM_MODE_ATOMIC_ALLOW_MODESET,
					 NULL) == 0;
	if (mode)
		drmModeDestroyPropertyBlob(card->fd, mode);
	drmModeAtomicFree(request);
	return can;
}

/* Returns the number of the first CRTC that can drive the connector with the mode: on some boards
 * not all can do the largest. If no driver says so, the first that may be connected; -1: none. */
static int find_crtc(struct drm_card *card, const drmModeRes *resources, uint32_t crtc_bits)
{
	int first = -1;

	for (int i = 0; i < resources->count_crtcs; i++) {
		if (!(crtc_bits & 1u << i))
			continue;
		if (take_crtc(card, resources, i) && can_set_mode(card))
			return i;
		if (first < 0)
			first = i;
	}
	return first;
}

static int choose_crtc(struct drm_card *card, const drmModeRes *resources, uint32_t crtc_bits)
{
	const int number = find_crtc(card, resources, crtc_bits);

	if (number < 0)
		return -ENODEV;
	card->atomic = take_crtc(card, resources, number);
	card->crtc_before = drmModeGetCrtc(card->fd, card->crtc);
	if (card->atomic)
		read_modifiers(card);
	return 0;
}

static int open_card(struct drm_card *card, const char *device, enum presence least,
		     const struct drm_card_options *options)
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
		rc = -ENODEV; /* a render-only card; another card drives the panel */
	else if (!choose_connector(card, resources, least, options, &crtc_bits))
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
		return "another program uses it";
	case -ENODEV:
		return "it drives no panel";
	default:
		return strerror(-rc);
	}
}

/* Tries each card. Returns -EBUSY if another program uses one that would do; *taken is then its
 * number. */
static int open_any(struct drm_card *out, enum presence least, bool told, int *taken,
		    const struct drm_card_options *options)
{
	char path[32];
	int result = -ENODEV;

	for (int i = 0; i < CARDS_MAX; i++) {
		int rc;

		snprintf(path, sizeof(path), "/dev/dri/card%d", i);
		rc = open_card(out, options->device ? options->device : path, least, options);
		if (rc == 0) {
			out->number = i;
			return 0;
		}
		if (rc == -EBUSY && result != -EBUSY) {
			result = -EBUSY;
			*taken = i;
		}
		if (options->device) {
			/* Not an error: it is waited for, or tried again without a panel. */
			if (!options->may_wait ||
			    (rc != -EBUSY && (rc != -ENXIO || least == PRESENT_OR_NOT)))
				log_error("render", "%s: %s", options->device, why_not(rc));
			return result;
		}
		if (rc != -ENOENT && least == PRESENT && !told)
			log_info("render", "%s: %s", path, why_not(rc));
	}
	return result;
}

static int open_once(struct drm_card *out, bool told, int *taken,
		     const struct drm_card_options *options)
{
	int rc = open_any(out, PRESENT, told, taken, options);

	/* A panel that another program uses is better than a card without a panel. */
	if (rc == -ENODEV && options->may_wait)
		rc = open_any(out, PERHAPS_PRESENT, told, taken, options);
	if (rc == -ENODEV && options->may_wait)
		rc = open_any(out, PRESENT_OR_NOT, told, taken, options);
	return rc;
}

/* A failed attempt closes the card, so each attempt opens it again: the first process to open a
 * card without a master becomes its master, and any other way would need privileges. */
static int open_when_free(struct drm_card *out, const struct drm_card_options *options)
{
	const struct timespec pause = { .tv_nsec = CARD_LOOK_MS * 1000000l };
	const int64_t until_ms = clock_now_ms() + CARD_WAIT_MS;
	char path[32];
	const char *name = options->device ? options->device : path;
	int taken, rc = open_once(out, false, &taken, options);

	if (rc != -EBUSY || !options->may_wait)
		return rc < 0 ? -ENODEV : 0;
	snprintf(path, sizeof(path), "/dev/dri/card%d", taken);
	log_warn("render", "another program uses %s; waiting until it ends", name);
	while (rc == -EBUSY && clock_now_ms() < until_ms) {
		nanosleep(&pause, NULL);
		rc = open_once(out, true, &taken, options);
	}
	if (rc == -EBUSY)
		log_error(
			"render",
			"another program still uses %s: end it (a desktop, a boot splash, another "
			"kiosk), or name another card with --device",
			name);
	return rc < 0 ? -ENODEV : 0;
}

static bool drives_panels(const char *device)
{
	const int fd = open(device, O_RDWR | O_CLOEXEC | O_NONBLOCK);
	const bool drives = fd >= 0 && drmIsKMS(fd);

	if (fd >= 0)
		close(fd);
	return drives;
}

/* Returns whether there is no card yet that drives panels, or none that we may open. On some boards
 * the GPU is a card of its own, which may be there first. */
static bool is_late(const struct drm_card_options *options)
{
	char path[32];

	if (options->device)
		return false;
	for (int i = 0; i < CARDS_MAX; i++) {
		snprintf(path, sizeof(path), "/dev/dri/card%d", i);
		if (drives_panels(path))
			return false;
	}
	return true;
}

int drm_card_open(struct drm_card *out, const struct drm_card_options *options)
{
	const struct timespec pause = { .tv_nsec = CARD_LOOK_MS * 1000000l };
	const int64_t until_ms = clock_now_ms() + CARD_WAIT_MS;

	if (options->may_wait && is_late(options)) {
		log_warn("render", "no graphics card is found yet; waiting for one");
		while (is_late(options) && clock_now_ms() < until_ms)
			nanosleep(&pause, NULL);
		if (is_late(options)) {
			log_error(
				"render",
				"no graphics card in /dev/dri that drives a panel can be opened: "
				"check that the system has its driver, and that this user is in the "
				"group video");
			return -ENODEV;
		}
	}
	return open_when_free(out, options);
}

/* Returns whether a new process would take another card: one with a panel that comes before this
 * one, or any where this one has none. So nobody is left in the dark before a panel that was off
 * for a while. */
static bool is_on_another_card(const struct drm_card *card, bool is_here,
			       const struct drm_card_options *options)
{
	char path[32];

	for (int i = 0; !options->device && i < (is_here ? card->number : CARDS_MAX); i++) {
		struct drm_card other;

		snprintf(path, sizeof(path), "/dev/dri/card%d", i);
		if (i == card->number || open_card(&other, path, PRESENT, options) < 0)
			continue;
		drm_card_close(&other);
		return true;
	}
	return false;
}

enum drm_card_news drm_card_look(struct drm_card *card, const struct drm_card_options *options)
{
	drmModeRes *resources = drmModeGetResources(card->fd);
	const bool is_gone = !resources && errno == ENODEV;
	struct drm_card now = *card;
	uint32_t crtc_bits;
	uint64_t link = DRM_MODE_LINK_STATUS_GOOD;
	bool there, elsewhere, same;

	there = resources && choose_connector(&now, resources, PRESENT, options, &crtc_bits);
	elsewhere = is_gone || is_on_another_card(card, there, options);
	there = there || (resources &&
			  choose_connector(&now, resources, PERHAPS_PRESENT, options, &crtc_bits));
	drmModeFreeResources(resources);
	if (is_gone)
		log_warn("render", "the graphics card is gone");
	if (elsewhere)
		return DRM_CARD_OTHER_PANEL;
	if (!there) {
		card->connected = false;
		return DRM_CARD_NO_PANEL;
	}
	/* The width sets the size of letters; an EDID that cannot be read this time has none. */
	same = now.connector == card->connector && now.mode.hdisplay == card->mode.hdisplay &&
	       now.mode.vdisplay == card->mode.vdisplay &&
	       now.mode.vrefresh == card->mode.vrefresh && /* the pace of frames */
	       (now.width_mm == 0 || now.width_mm == card->width_mm);
	if (!same)
		return DRM_CARD_OTHER_PANEL;
	property_id(card->fd, card->connector, DRM_MODE_OBJECT_CONNECTOR, "link-status", &link);
	card->link_is_bad = link == DRM_MODE_LINK_STATUS_BAD;
	card->connected = true;
	card->mode = now.mode;
	return DRM_CARD_SAME_PANEL;
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
