/* Random touches as a replay file (docs/input.md), the same for the same seed:
 *
 *   random_touches EVENTS SEED WIDTH HEIGHT >FILE
 *
 * It generates what a device reports, a table of slots per frame; input/contacts.c turns this into
 * fingers, as in the kiosk. So frames may be lost (SYN_DROPPED: the table jumps), a slot may become
 * another finger without a lift, contacts may grow to palms, a device may be unplugged, and ten or
 * more fingers may be down at once. Between bursts there are taps on controls, drags off the panel,
 * rests and, now and then, a visitor who leaves. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "input/contacts.h"

enum { LEAVES_MS = 40000, LEAVES_EVERY = 300, FIRST_MS = 3000 };

static struct contacts contacts = { .palm_px = 120 };
static struct contact_slot slots[TOUCH_SLOTS_MAX];
static struct touch_raw raws[TOUCH_SLOTS_MAX];
static uint64_t state;
static int64_t now_ms = FIRST_MS;
static long left, leaves_at; /* events */
static int next_id;

static uint32_t random_below(uint32_t most)
{
	state = state * 6364136223846793005u + 1442695040888963407u;
	return most ? (uint32_t)(state >> 33) % most : 0;
}

static float random_share(void)
{
	return (float)random_below(10001) / 10000;
}

static void on_event(void *data, const struct touch_event *event)
{
	static const char *const words[] = { "down", "move", "up", "cancel" };

	(void)data;
	printf("%lld %s %u %.1f %.1f\n", (long long)(event->time_us / 1000), words[event->phase],
	       event->contact, (double)event->x_px, (double)event->y_px);
	left--;
}

static void frame(uint32_t later_ms)
{
	static const float matrix[6] = { 1, 0, 0, 0, 1, 0 };

	contacts_take(&contacts, slots, raws, matrix, now_ms * 1000);
	now_ms += later_ms;
}

static void put(int slot, float x, float y)
{
	raws[slot] = (struct touch_raw){ .down = true, .id = ++next_id, .x = x, .y = y };
}

static void lift_all(void)
{
	memset(raws, 0, sizeof(raws));
	frame(5 + random_below(60));
}

/* Where controls are: the bar, what closes, cards and their ends, rows and keys at the right. */
static void aim(float *x, float *y)
{
	*x = random_share();
	*y = random_share();
	switch (random_below(7)) {
	case 0:
	case 4:
		*x *= 0.5f;
		*y = 0.96f;
		break;
	case 1:
		*x = 0.9f + *x / 10;
		*y /= 12;
		break;
	case 2:
		*x = 0.3f + *x * 0.4f;
		*y = 0.7f + *y * 0.2f;
		break;
	case 3:
		*x = 0.5f + *x / 2;
		*y = 0.65f + *y * 0.33f;
		break;
	}
}

static void tap(void)
{
	const uint32_t times = random_below(4) == 0 ? 2 + random_below(2) : 1;
	float x, y;

	aim(&x, &y);
	for (uint32_t i = 0; i < times && left > 0; i++) {
		put(0, x, y);
		frame(20 + random_below(80));
		lift_all();
	}
	now_ms += random_below(3) == 0 ? 1200 : random_below(200);
}

static void drag(void)
{
	const uint32_t steps = 2 + random_below(7);
	const float dx = random_share() * 0.2f - 0.1f, dy = random_share() * 0.2f - 0.1f;
	float x, y;

	aim(&x, &y);
	put(0, x, y);
	for (uint32_t i = 0; i < steps && left > 0; i++) { /* past the panel's end too */
		frame(8 + random_below(10));
		raws[0].x += dx;
		raws[0].y += dy;
	}
	lift_all();
}

static void pinch(void)
{
	const uint32_t steps = 2 + random_below(6);
	const float dx = random_share() * 0.06f - 0.03f, dy = random_share() * 0.06f - 0.03f;
	float x, y;

	aim(&x, &y);
	put(0, x - 0.05f, y);
	put(1, x + 0.05f, y);
	for (uint32_t i = 0; i < steps && left > 0; i++) {
		frame(8 + random_below(10));
		raws[0].x -= dx;
		raws[1].x += dx;
		raws[0].y += dy;
	}
	raws[random_below(2)].down = false; /* one stays a moment */
	frame(random_below(100));
	lift_all();
}

/* Anything in any slot, and frames that nobody saw. */
static void mash(void)
{
	const uint32_t frames = 3 + random_below(8);

	for (uint32_t i = 0; i < frames && left > 0; i++) {
		const uint32_t changes = 1 + random_below(random_below(8) == 0 ? 24 : 3);

		for (uint32_t c = 0; c < changes; c++) {
			struct touch_raw *raw = &raws[random_below(TOUCH_SLOTS_MAX)];
			const uint32_t what = random_below(8);

			if (!raw->down || what == 0)
				*raw = (struct touch_raw){ true, ++next_id, random_share(),
							   random_share(), 0 };
			else if (what < 5)
				raw->x += random_share() * 0.1f - 0.05f;
			else if (what == 5)
				raw->major = random_share();
			else
				raw->down = false;
		}
		frame(random_below(25));
	}
	if (random_below(6) == 0) {
		contacts_cancel(&contacts, slots, now_ms * 1000);
		memset(slots, 0, sizeof(slots));
	}
	if (random_below(8) != 0) /* else they lie there */
		lift_all();
}

int main(int argc, char **argv)
{
	if (argc == 5) {
		left = strtol(argv[1], NULL, 10);
		contacts.width_px = (int)strtol(argv[3], NULL, 10);
		contacts.height_px = (int)strtol(argv[4], NULL, 10);
	}
	if (left < 1 || contacts.width_px < 1 || contacts.height_px < 1) {
		fputs("usage: random_touches EVENTS SEED WIDTH HEIGHT\n", stderr);
		return 2;
	}
	contacts.event = on_event;
	state = strtoull(argv[2], NULL, 10) * 2654435761u + 1;
	for (int i = 0; i < 8; i++)
		random_below(2);
	leaves_at = left - LEAVES_EVERY;
	while (left > 0) {
		const uint32_t what = random_below(100);

		if (left < leaves_at) {
			now_ms += LEAVES_MS;
			leaves_at = left - LEAVES_EVERY;
		} else if (what < 62)
			tap();
		else if (what < 74)
			drag();
		else if (what < 82)
			pinch();
		else if (what < 97)
			mash();
		else
			now_ms += 4000 + random_below(18000);
	}
	lift_all();
	return 0;
}
