/* Parses weekly opening hours into a bitmap with one bit per minute, and finds the next time that
 * they open or close. */
#include "system/hours.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

enum { DAY_MINUTES = 24 * 60, EVERY_DAY = 0x7f };

static const char *skip_space(const char *text)
{
	return text + strspn(text, " \t");
}

static bool read_day(const char **text, int *day)
{
	static const char *const names[] = { "sunday",   "monday", "tuesday", "wednesday",
					     "thursday", "friday", "saturday" };
	size_t length = 0;

	while (isalpha((unsigned char)(*text)[length]))
		length++;
	for (int i = 0; i < 7 && length >= 2; i++)
		if (strncasecmp(*text, names[i], length) == 0) {
			*day = i;
			*text = skip_space(*text + length);
			return true;
		}
	return false;
}

/* Reads "Mo" or "Sa-Mo". Sets one bit per day; Sunday is bit 0. */
static bool read_days(const char **text, unsigned *days)
{
	int first, last;

	if (!read_day(text, &first))
		return false;
	last = first;
	if (**text == '-') {
		*text = skip_space(*text + 1);
		if (!read_day(text, &last))
			return false;
	}
	for (int day = first;; day = (day + 1) % 7) {
		*days |= 1u << day;
		if (day == last)
			return true;
	}
}

/* Reads a time of day as HH:MM or H:MM, 00:00 to 24:00, into minutes. *text moves behind it. */
static bool read_clock(const char **text, int *minutes)
{
	const char *at = *text;
	int parts[2];

	for (int i = 0; i < 2; i++) {
		size_t digits = strspn(at, "0123456789");

		if (digits > 2 || digits < (i == 0 ? 1 : 2))
			return false;
		parts[i] = digits == 1 ? at[0] - '0' : 10 * (at[0] - '0') + at[1] - '0';
		at += digits;
		if (i == 0 && *at++ != ':')
			return false;
	}
	if (parts[1] > 59 || 60 * parts[0] + parts[1] > DAY_MINUTES)
		return false;
	*minutes = 60 * parts[0] + parts[1];
	*text = at;
	return true;
}

/* Sets the minutes from `from` to `to` on each of the days. If `to` is not later, it is on the next
 * day. */
static void open_times(struct hours *hours, unsigned days, int from, int to)
{
	const int length = to > from ? to - from : to - from + DAY_MINUTES;

	for (int day = 0; day < 7; day++)
		for (int i = 0; i < length && days >> day & 1; i++) {
			int minute = (day * DAY_MINUTES + from + i) % HOURS_MINUTES;

			hours->open[minute / 8] |= (uint8_t)(1u << minute % 8);
		}
}

static bool read_times(const char **text, struct hours *hours, unsigned days)
{
	int from, to;

	if (!read_clock(text, &from))
		return false;
	*text = skip_space(*text);
	if (*(*text)++ != '-')
		return false;
	*text = skip_space(*text);
	if (!read_clock(text, &to) || from == to || from == DAY_MINUTES)
		return false;
	*text = skip_space(*text);
	open_times(hours, days, from, to);
	return true;
}

bool hours_parse(struct hours *out, const char *text)
{
	unsigned days = EVERY_DAY;
	bool gathering = false; /* days were read whose times have not come yet */

	memset(out, 0, sizeof(*out));
	for (;;) {
		text = skip_space(text);
		if (isalpha((unsigned char)*text)) {
			if (!gathering)
				days = 0;
			gathering = true;
			if (!read_days(&text, &days))
				return false;
		}
		if (isdigit((unsigned char)*text)) {
			if (!read_times(&text, out, days))
				return false;
			gathering = false;
		} else if (!gathering) {
			return false;
		}
		if (!*text)
			return !gathering;
		if (*text != ',' && *text != ';')
			return false;
		text++;
	}
}

void hours_always(struct hours *out)
{
	memset(out, 0xff, sizeof(*out));
}

bool hours_open_at(const struct hours *hours, const struct tm *local)
{
	const int minute = (local->tm_wday * 24 + local->tm_hour) * 60 + local->tm_min;

	return hours->open[minute / 8] >> minute % 8 & 1;
}

/* Tests every minute in the time zone. This is correct on every day, and a whole week takes less
 * than a millisecond. It tests a week and a day, because opening hours may fall into the hour that
 * is skipped when the clocks change. */
int hours_change_min(const struct hours *hours, time_t now)
{
	struct tm local;
	bool open;

	if (!localtime_r(&now, &local))
		return -1;
	open = hours_open_at(hours, &local);
	for (int i = 1; i <= HOURS_MINUTES + DAY_MINUTES; i++) {
		time_t then = now - local.tm_sec + 60 * (time_t)i;
		struct tm at;

		if (localtime_r(&then, &at) && hours_open_at(hours, &at) != open)
			return i;
	}
	return -1;
}
