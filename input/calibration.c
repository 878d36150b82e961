/* Reads the property LIBINPUT_CALIBRATION_MATRIX through sd-device and parses it. */
#include "input/calibration.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <systemd/sd-device.h>

#include "base/log.h"

bool calibration_parse(const char *text, float matrix[6])
{
	float m[6];
	char rest;

	if (sscanf(text, "%f %f %f %f %f %f %c", &m[0], &m[1], &m[2], &m[3], &m[4], &m[5], &rest) !=
	    6)
		return false;
	for (int i = 0; i < 6; i++)
		if (!isfinite(m[i]))
			return false;
	if (m[0] * m[4] - m[1] * m[3] == 0)
		return false; /* singular: it maps all fingers onto a line */
	memcpy(matrix, m, sizeof(m));
	return true;
}

int calibration_read(const char *path, float matrix[6])
{
	static const char property[] = "LIBINPUT_CALIBRATION_MATRIX";
	const char *name = strrchr(path, '/'), *text;
	sd_device *device = NULL;
	int rc = 0;

	if (sd_device_new_from_subsystem_sysname(&device, "input", name ? name + 1 : path) < 0)
		return 0;
	if (sd_device_get_property_value(device, property, &text) >= 0) {
		rc = calibration_parse(text, matrix);
		if (rc == 0)
			log_warn("input", "board bug: %s: %s is '%s' instead of six numbers", path,
				 property, text);
	} else if (sd_device_get_is_initialized(device) == 0) {
		rc = -EAGAIN;
	}
	sd_device_unref(device);
	return rc;
}
