/* Private to input: the calibration that udev knows for a device (LIBINPUT_CALIBRATION_MATRIX, set
 * by a rule in /etc/udev or by the hardware database), as desktops use it too.
 *
 * Read by sd-device from /sys and from udev's database below /run/udev, which a sandbox leaves
 * readable; udev itself is not asked, so neither a socket nor a network namespace matters. */
#ifndef GOPURA_INPUT_CALIBRATION_H
#define GOPURA_INPUT_CALIBRATION_H

#include <stdbool.h>

#include "base/compiler.h"

/* 1: matrix is set. 0: there is none, or nothing is known of such a device. -EAGAIN: udev has not
 * finished with the device, which it does some milliseconds after the node may be opened: ask
 * again. */
must_check int calibration_read(const char *path, float matrix[6]);
/* Six numbers, the two rows of the matrix. Pure. */
bool calibration_parse(const char *text, float matrix[6]);

#endif
