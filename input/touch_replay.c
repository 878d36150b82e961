/* Parses lines of the form "t_ms down|move|up|cancel slot x y" and checks that they can be
 * played. */
#include "input/touch_replay.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

enum { LINE_BYTES_MAX = 200, EVENTS_MAX = 1000000 };

struct parser {
	struct touch_replay *replay;
	float width_px, height_px, scale_x, scale_y;
	bool down[TOUCH_CONTACTS_MAX];
	struct touch_event last[TOUCH_CONTACTS_MAX];
};

static int add_event(struct parser *p, const struct touch_event *event)
{
	struct touch_replay *replay = p->replay;
	int rc = ARRAY_RESERVE(replay->events, replay->room, replay->count + 1, EVENTS_MAX);

	if (rc < 0)
		return rc == -EFBIG ? -EINVAL : rc;
	replay->events[replay->count++] = *event;
	return 0;
}

static int find_phase(const char *word, enum touch_phase *out)
{
	static const char *const words[] = { "down", "move", "up", "cancel" };

	for (size_t i = 0; i < ARRAY_COUNT(words); i++) {
		if (strcmp(word, words[i]) == 0) {
			*out = (enum touch_phase)i;
			return 0;
		}
	}
	return -EINVAL;
}

/* Parses "t_ms down|move|up|cancel slot [x y]"; only up and cancel may omit x y. */
static int parse_event(struct parser *p, const char *line)
{
	struct touch_event event = { 0 };
	double t_ms;
	char word[16], rest[2];
	int slot, fields;
	float x, y;

	fields = sscanf(line, "%lf %15s %d %f %f %1s", &t_ms, word, &slot, &x, &y, rest);
	if (fields < 3 || fields == 4 || fields > 5 || find_phase(word, &event.phase) < 0)
		return -EINVAL;
	if (slot < 0 || slot >= TOUCH_CONTACTS_MAX || !(t_ms >= 0 && t_ms < 1e11))
		return -EINVAL;
	if (p->down[slot] == (event.phase == TOUCH_DOWN))
		return -EINVAL; /* down twice, or move, up or cancel without down */
	event.contact = (uint32_t)slot;
	event.time_us = (int64_t)(t_ms * 1000);
	if (p->replay->count > 0 && event.time_us < p->replay->events[p->replay->count - 1].time_us)
		return -EINVAL;
	if (fields == 5 && isfinite(x) && isfinite(y)) {
		event.x_px = x * p->scale_x;
		event.y_px = y * p->scale_y;
	} else if (fields == 3 && (event.phase == TOUCH_UP || event.phase == TOUCH_CANCEL)) {
		event.x_px = p->last[slot].x_px;
		event.y_px = p->last[slot].y_px;
	} else {
		return -EINVAL;
	}
	p->down[slot] = event.phase == TOUCH_DOWN || event.phase == TOUCH_MOVE;
	p->last[slot] = event;
	return add_event(p, &event);
}

static int parse_line(struct parser *p, char *line)
{
	float width, height;
	char rest[2];

	line[strcspn(line, "#")] = 0;
	if (line[strspn(line, " \t\r")] == 0)
		return 0;
	if (sscanf(line, " size %f %f %1s", &width, &height, rest) == 2) {
		if (!(width >= 1 && height >= 1) || p->replay->count > 0)
			return -EINVAL;
		p->scale_x = p->width_px / width;
		p->scale_y = p->height_px / height;
		return 0;
	}
	return parse_event(p, line);
}

int touch_replay_parse(struct touch_replay *out, struct bytes text, int width_px, int height_px,
		       unsigned *line)
{
	struct parser parser = { .replay = out,
				 .width_px = (float)width_px,
				 .height_px = (float)height_px,
				 .scale_x = 1,
				 .scale_y = 1 };
	unsigned number = 0;
	size_t at = 0;
	int rc = 0;

	*out = (struct touch_replay){ 0 };
	while (at < text.size && rc == 0) {
		const uint8_t *end = memchr(text.data + at, '\n', text.size - at);
		size_t size = end ? (size_t)(end - text.data) - at : text.size - at;
		char copy[LINE_BYTES_MAX];

		number++;
		if (size >= sizeof(copy)) {
			rc = -EINVAL;
			break;
		}
		memcpy(copy, text.data + at, size);
		copy[size] = 0;
		rc = parse_line(&parser, copy);
		at += size + 1;
	}
	if (line)
		*line = number;
	if (rc < 0)
		touch_replay_finish(out);
	return rc;
}

void touch_replay_finish(struct touch_replay *replay)
{
	if (!replay)
		return;
	free(replay->events);
	*replay = (struct touch_replay){ 0 };
}
