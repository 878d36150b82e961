/* Opening a card that another program has, on a kernel that is played: libdrm's answers, the log
 * and a clock that only sleeping moves. The card is any node that opens. */
#include "render/display/drm_card.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <xf86drm.h>

#include "base/clock.h"
#include "base/log.h"
#include "tests/check.h"

enum { NEVER_MS = 1000000 };

static int64_t now_ms, free_ms; /* the card is free from free_ms on */
static int opens, waits, errors;
static bool has_panel;
static char said[1024]; /* warnings and errors */

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
	return capability == DRM_CLIENT_CAP_ATOMIC ? -EINVAL
						   : 0; /* the old way needs no properties */
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

static uint32_t connector_id = 7, crtc_id = 8, encoder_id = 9;

drmModeResPtr drmModeGetResources(int fd)
{
	static drmModeRes resources;

	(void)fd;
	resources = (drmModeRes){ .count_connectors = 1,
				  .connectors = &connector_id,
				  .count_crtcs = 1,
				  .crtcs = &crtc_id };
	return &resources;
}

drmModeConnectorPtr drmModeGetConnector(int fd, uint32_t id)
{
	static drmModeConnector connector;

	(void)fd;
	connector = (drmModeConnector){ .connector_id = id,
					.connection = has_panel ? DRM_MODE_CONNECTED
								: DRM_MODE_DISCONNECTED,
					.count_encoders = 1,
					.encoders = &encoder_id };
	return &connector;
}

drmModeEncoderPtr drmModeGetEncoder(int fd, uint32_t id)
{
	static drmModeEncoder encoder;

	(void)fd;
	encoder = (drmModeEncoder){ .encoder_id = id, .possible_crtcs = 1 };
	return &encoder;
}

drmModeCrtcPtr drmModeGetCrtc(int fd, uint32_t id)
{
	(void)fd, (void)id;
	return NULL;
}

drmModeObjectPropertiesPtr drmModeObjectGetProperties(int fd, uint32_t id, uint32_t type)
{
	(void)fd, (void)id, (void)type;
	return NULL;
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
	const struct drm_card_options options = { .device = "/dev/null", .may_wait = may_wait };
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
	has_panel = true;
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
	CHECK(errors == 0 && strstr(said, "another program uses /dev/null"));
	CHECK(!strstr(strstr(said, "waiting") + 1, "waiting")); /* said once */
}

static void ends_with_the_cure_after_half_a_minute(void **state)
{
	(void)state;
	free_ms = NEVER_MS;
	CHECK(open_card(true) == -ENODEV);
	CHECK(now_ms == 130000 && errors == 1);
	CHECK(strstr(said, "still uses /dev/null: end it") && strstr(said, "--device"));
}

static void waits_for_a_card_without_a_panel_too(void **state)
{
	(void)state;
	has_panel = false;
	free_ms = now_ms + 1000;
	CHECK(open_card(true) == 0);
	CHECK(waits == 2 && errors == 0);
}

static void where_a_window_will_do_nobody_waits(void **state)
{
	(void)state;
	free_ms = NEVER_MS;
	CHECK(open_card(false) == -ENODEV);
	CHECK(waits == 0 && errors == 1 && strstr(said, "/dev/null: another program uses it"));
	has_panel = false;
	CHECK(open_card(false) == -ENODEV && waits == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(takes_a_free_card_at_once, begin),
		cmocka_unit_test_setup(waits_for_a_card_that_another_program_has, begin),
		cmocka_unit_test_setup(ends_with_the_cure_after_half_a_minute, begin),
		cmocka_unit_test_setup(waits_for_a_card_without_a_panel_too, begin),
		cmocka_unit_test_setup(where_a_window_will_do_nobody_waits, begin),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
