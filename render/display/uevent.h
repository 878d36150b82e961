/* Hot-plug events of the kernel, from its own netlink group: udev's group does not reach a sandbox
 * with its own network namespace, the kernel's does. Where a sandbox forbids netlink there are no
 * events, and the caller polls instead. */
#ifndef GOPURA_RENDER_DISPLAY_UEVENT_H
#define GOPURA_RENDER_DISPLAY_UEVENT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/compiler.h"

/* Returns a descriptor to wait on, owned by the caller; negative errno where netlink is
 * forbidden. */
must_check int uevent_open(void);
/* Reads all pending events. Returns whether a panel was, or may have been, plugged in or out. */
bool uevent_take(int fd);
/* Returns whether a message reports a hot-plug of a panel. message has size bytes of strings, each
 * ended by a zero. Pure function. */
bool uevent_is_hotplug(const char *message, size_t size);

#endif
