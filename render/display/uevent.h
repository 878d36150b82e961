/* The kernel's word that something was plugged in or out, from its own netlink group: udev's is not
 * heard in a sandbox with a network of its own, the kernel's is. Where a sandbox forbids netlink
 * altogether there is none, and whoever asks looks by the clock. */
#ifndef GOPURA_RENDER_DISPLAY_UEVENT_H
#define GOPURA_RENDER_DISPLAY_UEVENT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/compiler.h"

/* A descriptor to wait on and to close; negative errno where netlink is forbidden. */
must_check int uevent_open(void);
/* Reads what came; true: a panel was plugged in or out. */
bool uevent_take(int fd);
/* Is it such a message? size bytes of words, each ended by a zero. Pure. */
bool uevent_is_hotplug(const char *message, size_t size);

#endif
