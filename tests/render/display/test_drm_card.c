/* Opening cards that another program has, and looking at what is plugged into them, on a kernel
 * that is played: its nodes, libdrm's answers, the log and a clock that only sleeping moves. */
#include "render/display/drm_card.h"

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
#include "tests/check.h"

enum { NEVER_MS = 1000000, CARDS = 2, FDS_MAX = 1024 };

static int64_t now_ms, free_ms; /* the card is free from free_ms on */
static int opens, waits, errors;
static char said[1024]; /* warnings and errors */

/* /dev/dri/card0 and card1 */
static struct played_card {
	bool is_there, has_panel, is_gone, cannot_tell;
	bool only_renders;
	int64_t from_ms; /* its driver has loaded */
	int width_mm;
} cards[CARDS], *card_of[FDS_MAX];

/* Of each card. What a CRTC can do is asked for atomically alone. */
enum { CRTCS = 2, FIRST_CRTC = 30, FIRST_PLANE = 40, CONNECTOR = 7, ENCODER = 9 };
static struct {
	bool are_atomic;
	uint32_t too_small;        /* bit mask of those that cannot do the mode */
	uint32_t asked, with_blob; /* of the last request: CRTC, and its mode */
	uint32_t blobs;
} crtcs;

int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);

int __wrap_open(const char *path, int flags, ...)
{
	int fd, number;

	if (sscanf(path, "/dev/dri/card%d", &number) != 1)
		return __real_open(path, flags, 0);
	if (number >= CARDS || !cards[number].is_there || now_ms < cards[number].from_ms) {
		errno = ENOENT;
		return -1;
	}
	fd = __real_open("/dev/null", flags);
	CHECK(fd >= 0 && fd < FDS_MAX);
	card_of[fd] = &cards[number];
	return fd;
}

int64_t clock_now_ms(void)
{
	return now_ms;
}

int64_t clock_now_us(void)
{
	return now_ms * 1000;
}

int nanosleep(const struct timespec *pause, struct timespec *left)
{
	(void)left;
	waits++;
	now_ms += pause->tv_sec * 1000 + pause->tv_nsec / 1000000;
	return 0;
}

void log_line(enum log_level level, const char *module, const char *text, ...)
{
	const size_t length = strlen(said);
	va_list args;

	(void)module;
	errors += level == LOG_LEVEL_ERROR;
	if (level > LOG_LEVEL_WARN)
		return;
	va_start(args, text);
	vsnprintf(said + length, sizeof(said) - length, text, args);
	va_end(args);
}

int drmSetClientCap(int fd, uint64_t capability, uint64_t value)
{
	(void)fd, (void)value;
	opens += capability == DRM_CLIENT_CAP_UNIVERSAL_PLANES;
	/* the old way needs no properties */
	return capability == DRM_CLIENT_CAP_ATOMIC && !crtcs.are_atomic ? -EINVAL : 0;
}

int drmIsKMS(int fd)
{
	return !card_of[fd]->only_renders;
}

/* Whoever opens a card that nobody has is its master; nobody else becomes it. */
int drmIsMaster(int fd)
{
	(void)fd;
	return now_ms >= free_ms;
}

int drmSetMaster(int fd)
{
	(void)fd;
	errno = EACCES;
	return -1;
}

static uint32_t connector_id = CONNECTOR, encoder_id = ENCODER;
static uint32_t crtc_ids[CRTCS] = { FIRST_CRTC, FIRST_CRTC + 1 };
static uint32_t plane_ids[CRTCS] = { FIRST_PLANE, FIRST_PLANE + 1 };

drmModeResPtr drmModeGetResources(int fd)
{
	static drmModeRes resources;

	if (card_of[fd]->is_gone || card_of[fd]->only_renders) {
		errno = card_of[fd]->is_gone ? ENODEV : EOPNOTSUPP;
		return NULL;
	}
	resources = (drmModeRes){ .count_connectors = 1,
				  .connectors = &connector_id,
				  .count_crtcs = CRTCS,
				  .crtcs = crtc_ids };
	return &resources;
}

drmModeConnectorPtr drmModeGetConnector(int fd, uint32_t id)
{
	static drmModeConnector connector;

	connector = (drmModeConnector){ .connector_id = id,
					.connection = card_of[fd]->has_panel ? DRM_MODE_CONNECTED
						      : card_of[fd]->cannot_tell
							      ? DRM_MODE_UNKNOWNCONNECTION
							      : DRM_MODE_DISCONNECTED,
					.mmWidth = (uint32_t)card_of[fd]->width_mm,
					.mmHeight = (uint32_t)card_of[fd]->width_mm * 9 / 16,
					.count_encoders = 1,
					.encoders = &encoder_id };
	return &connector;
}

drmModeEncoderPtr drmModeGetEncoder(int fd, uint32_t id)
{
	static drmModeEncoder encoder;

	(void)fd;
	encoder = (drmModeEncoder){ .encoder_id = id, .possible_crtcs = 3 };
	return &encoder;
}

drmModeCrtcPtr drmModeGetCrtc(int fd, uint32_t id)
{
	(void)fd, (void)id;
	return NULL;
}

/* Each object has all of them. */
static const char *const property_names[] = { "MODE_ID", "type",   "ACTIVE", "CRTC_ID", "FB_ID",
					      "SRC_X",   "SRC_Y",  "SRC_W",  "SRC_H",   "CRTC_X",
					      "CRTC_Y",  "CRTC_W", "CRTC_H" };
enum { MODE_ID, TYPE };

drmModeObjectPropertiesPtr drmModeObjectGetProperties(int fd, uint32_t id, uint32_t type)
{
	static uint32_t ids[ARRAY_COUNT(property_names)];
	static uint64_t values[ARRAY_COUNT(property_names)];
	static drmModeObjectProperties all = { .count_props = ARRAY_COUNT(property_names),
					       .props = ids,
					       .prop_values = values };

	(void)fd, (void)id, (void)type;
	for (uint32_t i = 0; i < ARRAY_COUNT(property_names); i++)
		ids[i] = i + 1;
	values[TYPE] = DRM_PLANE_TYPE_PRIMARY;
	return crtcs.are_atomic ? &all : NULL;
}

drmModePropertyPtr drmModeGetProperty(int fd, uint32_t id)
{
	static drmModePropertyRes property;

	(void)fd;
	property.prop_id = id;
	snprintf(property.name, sizeof(property.name), "%s", property_names[id - 1]);
	return &property;
}

void drmModeFreeProperty(drmModePropertyPtr property)
{
	(void)property;
}

void drmModeFreeObjectProperties(drmModeObjectPropertiesPtr all)
{
	(void)all;
}

drmModePlaneResPtr drmModeGetPlaneResources(int fd)
{
	static drmModePlaneRes planes = { .count_planes = CRTCS, .planes = plane_ids };

	(void)fd;
	return &planes;
}

drmModePlanePtr drmModeGetPlane(int fd, uint32_t id)
{
	static drmModePlane plane;

	(void)fd;
	plane = (drmModePlane){ .plane_id = id, .possible_crtcs = 1u << (id - FIRST_PLANE) };
	return &plane;
}

void drmModeFreePlane(drmModePlanePtr plane)
{
	(void)plane;
}

void drmModeFreePlaneResources(drmModePlaneResPtr planes)
{
	(void)planes;
}

drmModeAtomicReqPtr drmModeAtomicAlloc(void)
{
	crtcs.asked = crtcs.with_blob = 0;
	return (drmModeAtomicReqPtr)&crtcs;
}

void drmModeAtomicFree(drmModeAtomicReqPtr request)
{
	CHECK(request == (drmModeAtomicReqPtr)&crtcs);
}

int drmModeCreatePropertyBlob(int fd, const void *data, size_t size, uint32_t *id)
{
	(void)fd, (void)data;
	CHECK(size == sizeof(drmModeModeInfo));
	crtcs.blobs++;
	*id = 99;
	return 0;
}

int drmModeDestroyPropertyBlob(int fd, uint32_t id)
{
	(void)fd;
	CHECK(id == 99);
	crtcs.blobs--;
	return 0;
}

int drmModeAtomicAddProperty(drmModeAtomicReqPtr request, uint32_t object, uint32_t property,
			     uint64_t value)
{
	CHECK(request == (drmModeAtomicReqPtr)&crtcs && property > 0);
	if (object == CONNECTOR)
		crtcs.asked = (uint32_t)value;
	else if (object == crtcs.asked && property == MODE_ID + 1)
		crtcs.with_blob = (uint32_t)value;
	return 1;
}

int drmModeAtomicCommit(int fd, drmModeAtomicReqPtr request, uint32_t flags, void *data)
{
	(void)fd, (void)request, (void)data;
	CHECK(flags == (DRM_MODE_ATOMIC_TEST_ONLY | DRM_MODE_ATOMIC_ALLOW_MODESET));
	CHECK(crtcs.with_blob == 99);
	return crtcs.too_small & 1u << (crtcs.asked - FIRST_CRTC) ? -EINVAL : 0;
}

void drmModeFreeResources(drmModeResPtr resources)
{
	(void)resources;
}

void drmModeFreeConnector(drmModeConnectorPtr connector)
{
	(void)connector;
}

void drmModeFreeEncoder(drmModeEncoderPtr encoder)
{
	(void)encoder;
}

/* ---- */

static struct drm_card card;

static int open_card(bool may_wait)
{
	const struct drm_card_options options = { .device = "/dev/dri/card0",
						  .may_wait = may_wait };
	const int rc = drm_card_open(&card, &options);

	if (rc == 0)
		drm_card_close(&card);
	return rc;
}

static int begin(void **state)
{
	(void)state;
	now_ms = 100000;
	free_ms = 0;
	opens = waits = errors = 0;
	memset(cards, 0, sizeof(cards));
	memset(&crtcs, 0, sizeof(crtcs));
	cards[0] = (struct played_card){ .is_there = true, .has_panel = true, .width_mm = 520 };
	said[0] = '\0';
	return 0;
}

static void takes_a_free_card_at_once(void **state)
{
	(void)state;
	CHECK(open_card(true) == 0);
	CHECK(opens == 1 && waits == 0 && !*said);
}

static void waits_for_a_card_that_another_program_has(void **state)
{
	(void)state;
	free_ms = now_ms + 7200;
	CHECK(open_card(true) == 0);
	CHECK(waits == 15 && opens == 16); /* opened anew each time: nothing else makes a master */
	CHECK(errors == 0 && strstr(said, "another program uses /dev/dri/card0"));
	CHECK(!strstr(strstr(said, "waiting") + 1, "waiting")); /* said once */
}

static void ends_with_the_cure_after_half_a_minute(void **state)
{
	(void)state;
	free_ms = NEVER_MS;
	CHECK(open_card(true) == -ENODEV);
	CHECK(now_ms == 130000 && errors == 1);
	CHECK(strstr(said, "still uses /dev/dri/card0: end it") && strstr(said, "--device"));
}

static void waits_for_a_card_without_a_panel_too(void **state)
{
	(void)state;
	cards[0].has_panel = false;
	free_ms = now_ms + 1000;
	CHECK(open_card(true) == 0);
	CHECK(waits == 2 && errors == 0);
}

static void where_a_window_will_do_nobody_waits(void **state)
{
	(void)state;
	free_ms = NEVER_MS;
	CHECK(open_card(false) == -ENODEV);
	CHECK(waits == 0 && errors == 1 && strstr(said, "/dev/dri/card0: another program uses it"));
	cards[0].has_panel = false;
	CHECK(open_card(false) == -ENODEV && waits == 0);
}

/* As on a Raspberry Pi, where the GPU and what drives the panel are two. */
static void waits_for_the_card_that_drives_the_panel(void **state)
{
	const struct drm_card_options any = { .may_wait = true };

	(void)state;
	cards[1] = cards[0];
	cards[1].from_ms = now_ms + 3000;
	cards[0] = (struct played_card){ .is_there = true, .only_renders = true };
	CHECK(drm_card_open(&card, &any) == 0 && card_of[card.fd] == &cards[1]);
	CHECK(waits == 6 && errors == 0 && strstr(said, "no graphics card is found yet"));
	drm_card_close(&card);
}

/* Of some boards' CRTCs only one can do 3840 x 2160, and not the first. */
static void takes_a_crtc_that_can_do_the_mode(void **state)
{
	static const uint32_t taken[] = { FIRST_CRTC, FIRST_CRTC + 1, FIRST_CRTC, FIRST_CRTC };
	const struct drm_card_options any = { .may_wait = true };

	(void)state;
	crtcs.are_atomic = true;
	for (uint32_t i = 0; i < ARRAY_COUNT(taken); i++) {
		crtcs.too_small = i; /* the last driver says no to all */
		CHECK(drm_card_open(&card, &any) == 0 && card.atomic && crtcs.blobs == 0);
		CHECK(card.crtc == taken[i] && card.plane == card.crtc - FIRST_CRTC + FIRST_PLANE);
		drm_card_close(&card);
	}
	crtcs.are_atomic = false;
	CHECK(drm_card_open(&card, &any) == 0 && !card.atomic);
	CHECK(card.crtc == FIRST_CRTC && card.plane == 0);
	drm_card_close(&card);
}

/* ---- looking again */

static const struct drm_card_options any_card = { .may_wait = true };

static enum drm_card_news look(void)
{
	const enum drm_card_news news = drm_card_look(&card, &any_card);

	drm_card_close(&card);
	return news;
}

static void a_panel_comes_and_goes(void **state)
{
	(void)state;
	cards[0].has_panel = false;
	CHECK(drm_card_open(&card, &any_card) == 0 && !card.connected);
	CHECK(look() == DRM_CARD_NO_PANEL);
	cards[0].has_panel = true;
	CHECK(drm_card_open(&card, &any_card) == 0 && card.connected);
	CHECK(look() == DRM_CARD_SAME_PANEL);
}

/* The terminal was on before the panel, which hangs on the second card. */
static void a_panel_on_another_card_asks_for_another_process(void **state)
{
	(void)state;
	cards[0].has_panel = false;
	cards[1] = (struct played_card){ .is_there = true };
	CHECK(drm_card_open(&card, &any_card) == 0 && card_of[card.fd] == &cards[0]);
	CHECK(look() == DRM_CARD_NO_PANEL);
	CHECK(drm_card_open(&card, &any_card) == 0);
	cards[1].has_panel = true;
	CHECK(look() == DRM_CARD_OTHER_PANEL);
	CHECK(drm_card_open(&card, &any_card) == 0 && card_of[card.fd] == &cards[1]);
	CHECK(look() == DRM_CARD_SAME_PANEL);
}

/* The panel of the first card was off for a night, in which another one was taken. */
static void a_panel_on_the_first_card_is_gone_back_to(void **state)
{
	(void)state;
	cards[1] = cards[0];
	cards[0].has_panel = false;
	CHECK(drm_card_open(&card, &any_card) == 0 && card_of[card.fd] == &cards[1]);
	CHECK(look() == DRM_CARD_SAME_PANEL);
	CHECK(drm_card_open(&card, &any_card) == 0);
	cards[0].has_panel = true;
	CHECK(look() == DRM_CARD_OTHER_PANEL);
	CHECK(drm_card_open(&card, &any_card) == 0 && card_of[card.fd] == &cards[0]);
	CHECK(look() == DRM_CARD_SAME_PANEL);
}

static void a_card_that_is_gone_asks_for_another_process(void **state)
{
	(void)state;
	CHECK(drm_card_open(&card, &any_card) == 0);
	cards[0].is_gone = true;
	CHECK(look() == DRM_CARD_OTHER_PANEL && strstr(said, "the graphics card is gone"));
}

/* VGA behind a bridge: used where no other connector has a panel. */
static void a_connector_that_cannot_tell_is_used_at_last(void **state)
{
	(void)state;
	cards[1] = (struct played_card){ .is_there = true, .has_panel = true };
	cards[0] = (struct played_card){ .is_there = true, .cannot_tell = true };
	CHECK(drm_card_open(&card, &any_card) == 0 && card_of[card.fd] == &cards[1]);
	drm_card_close(&card);
	cards[1].has_panel = false;
	CHECK(drm_card_open(&card, &any_card) == 0 && card_of[card.fd] == &cards[0]);
	CHECK(card.connected && look() == DRM_CARD_SAME_PANEL);
	CHECK(!strstr(said, "no panel is connected"));
	CHECK(drm_card_open(&card, &any_card) == 0);
	cards[1].has_panel = true;
	CHECK(look() == DRM_CARD_OTHER_PANEL);
}

static void a_panel_of_another_width_is_another_one(void **state)
{
	(void)state;
	CHECK(drm_card_open(&card, &any_card) == 0 && card.width_mm == 520);
	cards[0].width_mm = 0; /* the EDID could not be read */
	CHECK(look() == DRM_CARD_SAME_PANEL);
	CHECK(drm_card_open(&card, &any_card) == 0 && card.width_mm == 0);
	cards[0].width_mm = 1210;
	CHECK(look() == DRM_CARD_OTHER_PANEL);
}

/* Its letters would be those of a hand's breadth. */
static void the_aspect_ratio_of_a_tv_is_no_width(void **state)
{
	const struct drm_card_options large = { .mode = { 1920, 1080, 0 } };
	const struct drm_card_options little = { .mode = { 1024, 576, 0 } };

	(void)state;
	cards[0].width_mm = 160;
	CHECK(drm_card_open(&card, &large) == 0 && card.width_mm == 0);
	drm_card_close(&card);
	CHECK(drm_card_open(&card, &little) == 0 && card.width_mm == 160);
	drm_card_close(&card);
	cards[0].width_mm = 1600;
	CHECK(drm_card_open(&card, &large) == 0 && card.width_mm == 1600);
	drm_card_close(&card);
}

/* Frames would come at the pace of the last one. */
static void a_panel_of_another_rate_is_another_one(void **state)
{
	const struct drm_card_options fast = { .mode = { 1920, 1080, 60 }, .may_wait = true };
	const struct drm_card_options slow = { .mode = { 1920, 1080, 30 }, .may_wait = true };

	(void)state;
	CHECK(drm_card_open(&card, &fast) == 0 && card.mode.vrefresh == 60);
	CHECK(drm_card_look(&card, &fast) == DRM_CARD_SAME_PANEL);
	CHECK(drm_card_look(&card, &slow) == DRM_CARD_OTHER_PANEL && card.mode.vrefresh == 60);
	drm_card_close(&card);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(takes_a_free_card_at_once, begin),
		cmocka_unit_test_setup(waits_for_a_card_that_another_program_has, begin),
		cmocka_unit_test_setup(ends_with_the_cure_after_half_a_minute, begin),
		cmocka_unit_test_setup(waits_for_a_card_without_a_panel_too, begin),
		cmocka_unit_test_setup(where_a_window_will_do_nobody_waits, begin),
		cmocka_unit_test_setup(waits_for_the_card_that_drives_the_panel, begin),
		cmocka_unit_test_setup(takes_a_crtc_that_can_do_the_mode, begin),
		cmocka_unit_test_setup(a_panel_comes_and_goes, begin),
		cmocka_unit_test_setup(a_panel_on_another_card_asks_for_another_process, begin),
		cmocka_unit_test_setup(a_panel_on_the_first_card_is_gone_back_to, begin),
		cmocka_unit_test_setup(a_card_that_is_gone_asks_for_another_process, begin),
		cmocka_unit_test_setup(a_connector_that_cannot_tell_is_used_at_last, begin),
		cmocka_unit_test_setup(the_aspect_ratio_of_a_tv_is_no_width, begin),
		cmocka_unit_test_setup(a_panel_of_another_rate_is_another_one, begin),
		cmocka_unit_test_setup(a_panel_of_another_width_is_another_one, begin),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
