/* Turns the state of a device into contacts on the panel: applies calibration and rotation, ignores
 * palms and fingers at the edge, and numbers the fingers that are down across all devices. Private
 * to touch.c. */
#ifndef GOPURA_INPUT_CONTACTS_H
#define GOPURA_INPUT_CONTACTS_H

#include "input/touch_device.h"
#include "input/touch_event.h"

/* No finger stays on the glass for so long: what does is a coin, a drop, or dirt on the frame. */
enum { CONTACT_LONGEST_S = 180 };

struct contacts {
	int width_px, height_px, rotation_deg; /* as in struct touch_options */
	float edge_px, palm_px;
	void (*event)(void *data, const struct touch_event *event); /* NULL is fine */
	void *data;
	bool used[TOUCH_CONTACTS_MAX];
};

/* The state of a slot of a device, on the panel. */
struct contact_slot {
	int id;          /* the device's id of the finger, while down */
	bool down;       /* down, whether reported or ignored */
	int contact;     /* number it is reported as; -1: ignored until it lifts */
	int64_t down_us; /* when it came down */
	float x_px, y_px;
};

/* Compares a frame of a device with the known state of its slots, updates them and calls event for
 * each change. matrix is the calibration. A changed id means that the lift of the previous finger
 * was lost. What has been down for CONTACT_LONGEST_S is cancelled, and ignored until it lifts. */
void contacts_take(struct contacts *contacts, struct contact_slot slots[TOUCH_SLOTS_MAX],
		   const struct touch_raw raws[TOUCH_SLOTS_MAX], const float matrix[6],
		   int64_t time_us);
/* Returns whether any finger is down, reported or ignored. */
bool contacts_any_down(const struct contact_slot slots[TOUCH_SLOTS_MAX]);
/* The device went away: reports TOUCH_CANCEL for all its fingers. */
void contacts_cancel(struct contacts *contacts, struct contact_slot slots[TOUCH_SLOTS_MAX],
		     int64_t time_us);

#endif
