/* Formats and prints the progress of long work: a bar on a terminal, otherwise a log line at
 * intervals. */
#include "base/progress.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"

enum {
	QUIET_MS = 2000,
	BAR_EVERY_MS = 100,
	LOG_EVERY_MS = 15000,
	COLUMNS_DEFAULT = 80,
	COLUMNS_MAX = 160,
	BAR_MAX = 30
};

struct progress {
	pthread_mutex_t lock; /* guards all fields below */
	char what[48], unit[24];
	uint64_t done, total;
	int64_t started_ms, shown_ms;
	bool terminal;
};

struct progress *progress_start(const char *what, const char *unit, uint64_t total)
{
	struct progress *progress = calloc(1, sizeof(*progress));

	if (!progress)
		return NULL;
	pthread_mutex_init(&progress->lock, NULL);
	snprintf(progress->what, sizeof(progress->what), "%s", what);
	snprintf(progress->unit, sizeof(progress->unit), "%s", unit);
	progress->total = total;
	progress->started_ms = clock_now_ms();
	progress->terminal = isatty(STDERR_FILENO);
	return progress;
}

/* Writes a count in at most four digits before the point, with a scale: 1234567 as "1234.6 k". */
static void print_count(char out[16], double count)
{
	static const char *const scale[] = { "", " k", " M", " G" };
	size_t i = 0;

	while (count >= 9999.5 && i + 1 < ARRAY_COUNT(scale)) {
		count /= 1000;
		i++;
	}
	snprintf(out, 16, "%.*f%s", i > 0 || (count < 10 && count != (int)count) ? 1 : 0, count,
		 scale[i]);
}

static void print_time(char out[16], double seconds)
{
	unsigned s = seconds < 1e6 ? (unsigned)(seconds + 0.5) : 1000000;

	if (s < 100)
		snprintf(out, 16, "%u s", s);
	else if (s < 3600)
		snprintf(out, 16, "%u:%02u min", s / 60 % 60, s % 60);
	else
		snprintf(out, 16, "%u:%02u h", s / 3600, s / 60 % 60);
}

static void print_bar(char out[BAR_MAX + 3], double share, int width)
{
	int full = (int)(share * width);

	out[0] = '[';
	for (int i = 0; i < width; i++)
		out[1 + i] = i < full ? '#' : '.';
	out[1 + width] = ']';
	out[2 + width] = '\0';
}

void progress_line(const struct progress *progress, char *out, size_t out_bytes, int columns,
		   int64_t elapsed_ms)
{
	double seconds = (double)elapsed_ms / 1000, done = (double)progress->done;
	double rate = seconds > 0 ? done / seconds : 0, total = (double)progress->total;
	char count[16], of[16], per[16], left[16] = "", bar[BAR_MAX + 3] = "";
	int width = columns - 56 < BAR_MAX ? columns - 56 : BAR_MAX;

	print_count(count, done);
	print_count(per, rate);
	if (total <= 0) {
		snprintf(out, out_bytes, "%s  %s %s  %s/s", progress->what, count, progress->unit,
			 per);
		return;
	}
	print_count(of, total);
	if (width >= 8)
		print_bar(bar, done < total ? done / total : 1, width);
	if (rate > 0)
		print_time(left, done < total ? (total - done) / rate : 0);
	snprintf(out, out_bytes, "%s %s %3.0f %%  %s of %s %s  %s/s  %s%s", progress->what, bar,
		 100 * (done < total ? done / total : 1), count, of, progress->unit, per, left,
		 *left ? " left" : "");
}

static int terminal_columns(void)
{
	struct winsize size;

	if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) < 0 || size.ws_col == 0)
		return COLUMNS_DEFAULT;
	return size.ws_col < COLUMNS_MAX ? size.ws_col : COLUMNS_MAX;
}

/* Prints the progress. The caller holds the lock. */
static void show(struct progress *progress, int64_t elapsed_ms)
{
	char line[COLUMNS_MAX + 1];
	int columns = terminal_columns();

	progress_line(progress, line, sizeof(line), columns, elapsed_ms);
	if (progress->terminal)
		fprintf(stderr, "\r%.*s\033[K", columns - 1, line);
	else
		log_info("progress", "%s", line);
	progress->shown_ms = elapsed_ms;
}

void progress_add(struct progress *progress, uint64_t done)
{
	int64_t elapsed_ms;

	if (!progress)
		return;
	pthread_mutex_lock(&progress->lock);
	progress->done += done;
	elapsed_ms = clock_now_ms() - progress->started_ms;
	if (elapsed_ms >= QUIET_MS &&
	    elapsed_ms - progress->shown_ms >= (progress->terminal ? BAR_EVERY_MS : LOG_EVERY_MS))
		show(progress, elapsed_ms);
	pthread_mutex_unlock(&progress->lock);
}

void progress_set_total(struct progress *progress, uint64_t total)
{
	if (!progress)
		return;
	pthread_mutex_lock(&progress->lock);
	progress->total = total;
	pthread_mutex_unlock(&progress->lock);
}

void progress_end(struct progress *progress)
{
	int64_t elapsed_ms;

	if (!progress)
		return;
	elapsed_ms = clock_now_ms() - progress->started_ms;
	if (progress->shown_ms > 0) {
		char count[16], took[16];

		print_count(count, (double)progress->done);
		print_time(took, (double)elapsed_ms / 1000);
		if (progress->terminal)
			fprintf(stderr, "\r\033[K");
		log_info("progress", "%s: %s %s in %s", progress->what, count, progress->unit,
			 took);
	}
	pthread_mutex_destroy(&progress->lock);
	free(progress);
}
