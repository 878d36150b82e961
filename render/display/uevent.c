/* Reads kernel uevents from a netlink socket and looks for SUBSYSTEM=drm with HOTPLUG=1. */
#include "render/display/uevent.h"

#include <errno.h>
#include <linux/netlink.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { KERNELS_GROUP = 1 }; /* group 2 is udev's */

int uevent_open(void)
{
	const struct sockaddr_nl address = { .nl_family = AF_NETLINK, .nl_groups = KERNELS_GROUP };
	const int fd =
		socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_KOBJECT_UEVENT);

	if (fd < 0)
		return -errno;
	if (bind(fd, (const struct sockaddr *)&address, sizeof(address)) < 0) {
		const int rc = -errno;

		close(fd);
		return rc;
	}
	return fd;
}

bool uevent_is_hotplug(const char *message, size_t size)
{
	bool drm = false, hotplug = false;

	for (size_t at = 0; at < size;) {
		const char *word = message + at;
		const size_t length = strnlen(word, size - at);

		if (length == size - at)
			break; /* truncated: its meaning is unknown */
		drm |= strcmp(word, "SUBSYSTEM=drm") == 0;
		hotplug |= strcmp(word, "HOTPLUG=1") == 0;
		at += length + 1;
	}
	return drm && hotplug;
}

bool uevent_take(int fd)
{
	struct sockaddr_nl from;
	char message[8192];
	bool hotplug = false;

	for (;;) {
		socklen_t from_size = sizeof(from);
		const ssize_t size = recvfrom(fd, message, sizeof(message), 0,
					      (struct sockaddr *)&from, &from_size);

		if (size < 0 && errno == ENOBUFS)
			hotplug = true; /* messages were lost: check the connector */
		else if (size < 0 && errno != EINTR)
			return hotplug;
		else if (size > 0 && from.nl_pid == 0) /* sent by the kernel */
			hotplug |= uevent_is_hotplug(message, (size_t)size);
	}
}
