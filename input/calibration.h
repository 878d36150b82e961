/* Private to input: reads the calibration that udev knows for a device
 * (LIBINPUT_CALIBRATION_MATRIX, set by a rule in /etc/udev or by the hardware database). Desktops
 * use the same property.
 *
 * sd-device reads it from /sys and from udev's database below /run/udev, which a sandbox leaves
 * readable. The udev daemon is not asked, so neither a socket nor a network namespace matters. */
#ifndef GOPURA_INPUT_CALIBRATION_H
#define GOPURA_INPUT_CALIBRATION_H

#include <stdbool.h>

#include "base/compiler.h"

/* Reads the calibration of the device at path. Returns 1: matrix is set; 0: there is none, or the
 * device is unknown; -EAGAIN: udev has not finished with the device, which takes some milliseconds
 * after the node can be opened: ask again. */
must_check int calibration_read(const char *path, float matrix[6]);
/* Parses six numbers, the two rows of the matrix. Returns false, and leaves matrix unchanged, where
 * they are malformed or singular. Pure. */
bool calibration_parse(const char *text, float matrix[6]);

#endif
