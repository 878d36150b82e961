/* Maps raw positions to panel pixels, decides what counts as a finger, and reports downs, moves and
 * lifts. */
#include "input/contacts.h"

#include "base/log.h"

static void to_panel(const struct contacts *contacts, const float m[6], const struct touch_raw *raw,
		     float *x_px, float *y_px)
{
	float u = m[0] * raw->x + m[1] * raw->y + m[2];
	float v = m[3] * raw->x + m[4] * raw->y + m[5];
	float x = u, y = v;

	switch (contacts->rotation_deg) {
	case 90: /* the left edge of the framebuffer is at the top */
		x = 1 - v;
		y = u;
		break;
	case 180:
		x = 1 - u;
		y = 1 - v;
		break;
	case 270:
		x = v;
		y = 1 - u;
		break;
	}
	x = x < 0 ? 0 : x > 1 ? 1 : x;
	y = y < 0 ? 0 : y > 1 ? 1 : y;
	*x_px = x * (float)contacts->width_px;
	*y_px = y * (float)contacts->height_px;
}

static bool is_at_edge(const struct contacts *contacts, float x_px, float y_px)
{
	const float edge_px = contacts->edge_px;

	return edge_px > 0 &&
	       (x_px < edge_px || y_px < edge_px || x_px > (float)contacts->width_px - edge_px ||
		y_px > (float)contacts->height_px - edge_px);
}

static bool is_palm(const struct contacts *contacts, const struct touch_raw *raw)
{
	bool sideways = contacts->rotation_deg % 180 != 0;
	float width_px = (float)(sideways ? contacts->height_px : contacts->width_px);

	return contacts->palm_px > 0 && raw->major * width_px > contacts->palm_px;
}

/* Returns a free contact number; -1: all are in use. */
static int take_contact(struct contacts *contacts)
{
	for (int i = 0; i < TOUCH_CONTACTS_MAX; i++) {
		if (!contacts->used[i]) {
			contacts->used[i] = true;
			return i;
		}
	}
	return -1;
}

static void report(struct contacts *contacts, enum touch_phase phase,
		   const struct contact_slot *slot, int64_t time_us)
{
	const struct touch_event event = { .phase = phase,
					   .contact = (uint32_t)slot->contact,
					   .x_px = slot->x_px,
					   .y_px = slot->y_px,
					   .time_us = time_us };

	if (slot->contact >= 0 && contacts->event)
		contacts->event(contacts->data, &event);
}

static void lift(struct contacts *contacts, struct contact_slot *slot, enum touch_phase phase,
		 int64_t time_us)
{
	report(contacts, phase, slot, time_us);
	if (slot->contact >= 0)
		contacts->used[slot->contact] = false;
	slot->contact = -1;
}

static void put_down(struct contacts *contacts, const float matrix[6], struct contact_slot *slot,
		     const struct touch_raw *raw, int64_t time_us)
{
	*slot = (struct contact_slot){
		.id = raw->id, .down = true, .contact = -1, .down_us = time_us
	};
	to_panel(contacts, matrix, raw, &slot->x_px, &slot->y_px);
	if (is_at_edge(contacts, slot->x_px, slot->y_px) || is_palm(contacts, raw))
		return;
	slot->contact = take_contact(contacts);
	report(contacts, TOUCH_DOWN, slot, time_us);
}

static bool lies_there(const struct contact_slot *slot, int64_t time_us)
{
	const bool lies = slot->contact >= 0 &&
			  time_us - slot->down_us > (int64_t)CONTACT_LONGEST_S * 1000000;

	if (lies)
		log_info("input", "what lies on the glass for %d s is ignored until it lifts",
			 CONTACT_LONGEST_S);
	return lies;
}

static void move(struct contacts *contacts, const float matrix[6], struct contact_slot *slot,
		 const struct touch_raw *raw, int64_t time_us)
{
	float x_px, y_px;

	to_panel(contacts, matrix, raw, &x_px, &y_px);
	if (is_palm(contacts, raw) || lies_there(slot, time_us)) {
		lift(contacts, slot, TOUCH_CANCEL, time_us);
		return;
	}
	if (x_px == slot->x_px && y_px == slot->y_px)
		return;
	slot->x_px = x_px;
	slot->y_px = y_px;
	report(contacts, TOUCH_MOVE, slot, time_us);
}

bool contacts_any_down(const struct contact_slot slots[TOUCH_SLOTS_MAX])
{
	for (int i = 0; i < TOUCH_SLOTS_MAX; i++)
		if (slots[i].down)
			return true;
	return false;
}

void contacts_take(struct contacts *contacts, struct contact_slot slots[TOUCH_SLOTS_MAX],
		   const struct touch_raw raws[TOUCH_SLOTS_MAX], const float matrix[6],
		   int64_t time_us)
{
	for (int i = 0; i < TOUCH_SLOTS_MAX; i++) {
		struct contact_slot *slot = &slots[i];
		const struct touch_raw *raw = &raws[i];

		if (slot->down && (!raw->down || raw->id != slot->id)) {
			lift(contacts, slot, TOUCH_UP, time_us);
			slot->down = false;
		}
		if (raw->down && !slot->down)
			put_down(contacts, matrix, slot, raw, time_us);
		else if (raw->down)
			move(contacts, matrix, slot, raw, time_us);
	}
}

void contacts_cancel(struct contacts *contacts, struct contact_slot slots[TOUCH_SLOTS_MAX],
		     int64_t time_us)
{
	for (int i = 0; i < TOUCH_SLOTS_MAX; i++)
		if (slots[i].down)
			lift(contacts, &slots[i], TOUCH_CANCEL, time_us);
}
