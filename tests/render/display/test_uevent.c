#include "render/display/uevent.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/check.h"

#define HOTPLUG                                                                                    \
	"change@/devices/pci0/drm/card0\0ACTION=change\0DEVPATH=/devices/pci0/drm/card0\0"         \
	"SUBSYSTEM=drm\0HOTPLUG=1\0SEQNUM=4711"

static void knows_a_panel_that_is_plugged(void **state)
{
	(void)state;
	CHECK(uevent_is_hotplug(HOTPLUG, sizeof(HOTPLUG)));
}

static void hears_nothing_in_other_words(void **state)
{
	static const char usb[] = "add@/devices/usb1\0ACTION=add\0SUBSYSTEM=usb\0HOTPLUG=1";
	static const char lease[] = "change@/devices/card0\0SUBSYSTEM=drm\0LEASE=1";

	(void)state;
	CHECK(!uevent_is_hotplug(usb, sizeof(usb)));
	CHECK(!uevent_is_hotplug(lease, sizeof(lease)));
	CHECK(!uevent_is_hotplug("", 0));
}

/* Whatever was cut off is not read past its end, nor believed. */
static void believes_no_message_that_is_cut_off(void **state)
{
	const size_t whole = sizeof(HOTPLUG);

	(void)state;
	for (size_t size = 0; size < whole; size++) {
		char *exact = malloc(size ? size : 1);

		CHECK(exact);
		memcpy(exact, HOTPLUG, size);
		CHECK(uevent_is_hotplug(exact, size) == (size >= sizeof(HOTPLUG) - 12));
		free(exact);
	}
}

static void opens_or_says_why_not(void **state)
{
	const int fd = uevent_open();

	(void)state;
	CHECK(fd >= 0 || fd == -EPERM || fd == -EACCES || fd == -EAFNOSUPPORT);
	if (fd >= 0) {
		CHECK(!uevent_take(fd)); /* nothing was plugged meanwhile */
		close(fd);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(knows_a_panel_that_is_plugged),
		cmocka_unit_test(hears_nothing_in_other_words),
		cmocka_unit_test(believes_no_message_that_is_cut_off),
		cmocka_unit_test(opens_or_says_why_not),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
