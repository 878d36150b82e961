/* From what a device says to fingers on the panel: calibration and rotation, palms and fingers at
 * the edge left out, a number for each finger that is down, whichever device it is on. Private to
 * touch.c. */
#ifndef GOPURA_INPUT_CONTACTS_H
#define GOPURA_INPUT_CONTACTS_H

#include "input/touch_device.h"
#include "input/touch_event.h"

struct contacts {
	int width_px, height_px, rotation_deg; /* these as in struct touch_options */
	float edge_px, palm_px;
	void (*event)(void *data, const struct touch_event *event); /* NULL is fine */
	void *data;
	bool used[TOUCH_CONTACTS_MAX];
};

/* What a slot of a device is on the panel. */
struct contact_slot {
	int id;      /* the finger's, while down */
	bool down;   /* known to be down, reported or ignored */
	int contact; /* reported as; -1: ignored until it lifts */
	float x_px, y_px;
};

/* A frame of a device against what was known of its slots. A finger whose lift was lost shows as a
 * changed id. Calls event. */
void contacts_take(struct contacts *contacts, struct contact_slot slots[TOUCH_SLOTS_MAX],
		   const struct touch_raw raws[TOUCH_SLOTS_MAX], const float matrix[6],
		   int64_t time_us);
bool contacts_any_down(const struct contact_slot slots[TOUCH_SLOTS_MAX]);
/* The device went away: all its fingers are cancelled. */
void contacts_cancel(struct contacts *contacts, struct contact_slot slots[TOUCH_SLOTS_MAX],
		     int64_t time_us);

#endif
