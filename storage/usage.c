/* Keeps the hourly counts of visitors' actions in a CSV file: reads and tidies it at the start,
 * then appends, and tidies it again when it has grown. */
#include "storage/usage.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/bytes.h"
#include "base/log.h"
#include "base/safe_open.h"

enum {
	HOUR_BYTES = 16,
	WHAT_BYTES = 72,
	LANGUAGE_BYTES = 20,
	PENDING_MAX = 256,
	DAY_S = 86400,
	GROWTH_BYTES = 1 << 20, /* beyond twice its tidy size the file is tidied again */
};

static const char header[] = "hour,kind,what,language,count\n";
static const char *const kind_names[] = { "visit", "part", "page", "language", "search", "tour" };
/* The hour of a terminal whose clock was never set. It sorts after every date, so it is never too
 * old. */
static const char unset_hour[] = "unset";

struct entry {
	char hour[HOUR_BYTES]; /* 2026-11-23T10, local time */
	enum usage_kind kind;
	char what[WHAT_BYTES], language[LANGUAGE_BYTES];
	uint64_t count;
};

struct usage {
	char *path, *copy_path;
	struct entry pending[PENDING_MAX];
	size_t pending_count;
	size_t file_bytes, tidy_bytes; /* of the file: now, and when it was tidy */
	int64_t now_s;                 /* wall clock of the last event; 0: may not be set */
	bool complained;
};

static void hour_of(int64_t now_s, char out[HOUR_BYTES])
{
	const time_t time = (time_t)now_s;
	struct tm local;

	if (now_s == 0 || !localtime_r(&time, &local) ||
	    strftime(out, HOUR_BYTES, "%Y-%m-%dT%H", &local) == 0)
		snprintf(out, HOUR_BYTES, "%s", unset_hour);
}

/* ---- lines */

static void put_line(struct buffer *out, const struct entry *entry)
{
	buffer_print(out, "%s,%s,%s,%s,%llu\n", entry->hour, kind_names[entry->kind], entry->what,
		     entry->language, (unsigned long long)entry->count);
}

static bool is_word(const char *text)
{
	for (; *text; text++)
		if (!isalnum((unsigned char)*text) && *text != '-' && *text != '_')
			return false;
	return true;
}

static bool is_hour(const char *text)
{
	static const char shape[] = "dddd-dd-ddTdd";

	if (strcmp(text, unset_hour) == 0)
		return true;
	for (size_t i = 0; i < sizeof(shape); i++)
		if (shape[i] == 'd' ? !isdigit((unsigned char)text[i]) : text[i] != shape[i])
			return false;
	return true;
}

/* Returns the next field, ended at its comma; NULL if it is too long or missing. */
static const char *take_field(char **rest, size_t bytes_most)
{
	char *field = *rest, *end = field ? strchr(field, ',') : NULL;

	*rest = end ? end + 1 : NULL;
	if (end)
		*end = '\0';
	return field && strlen(field) < bytes_most ? field : NULL;
}

static bool parse_line(char *line, struct entry *out)
{
	const char *hour = take_field(&line, HOUR_BYTES), *kind = take_field(&line, 16);
	const char *what = take_field(&line, WHAT_BYTES);
	const char *language = take_field(&line, LANGUAGE_BYTES), *count = take_field(&line, 20);
	char *end;
	size_t k = 0;

	if (!hour || !kind || !what || !language || !count || line || !is_hour(hour) ||
	    !is_word(what) || !is_word(language) || !isdigit((unsigned char)count[0]))
		return false;
	while (k < ARRAY_COUNT(kind_names) && strcmp(kind_names[k], kind) != 0)
		k++;
	if (k == ARRAY_COUNT(kind_names))
		return false;
	*out = (struct entry){ .kind = (enum usage_kind)k, .count = strtoull(count, &end, 10) };
	snprintf(out->hour, sizeof(out->hour), "%s", hour);
	snprintf(out->what, sizeof(out->what), "%s", what);
	snprintf(out->language, sizeof(out->language), "%s", language);
	return *end == '\0';
}

/* ---- the tidy file */

static int compare(const void *a, const void *b)
{
	const struct entry *x = a, *y = b;
	int order = strcmp(x->hour, y->hour);

	if (order == 0)
		order = (int)x->kind - (int)y->kind;
	if (order == 0)
		order = strcmp(x->what, y->what);
	return order ? order : strcmp(x->language, y->language);
}

static size_t count_lines(struct bytes text)
{
	size_t count = 0;

	for (size_t i = 0; i < text.size; i++)
		count += text.data[i] == '\n';
	return count;
}

/* Parses the complete lines of text, which is modified. *bad is the number of invalid lines. */
static size_t parse(struct buffer *text, struct entry *entries, size_t *bad)
{
	char *line = (char *)text->data, *limit = text->size ? line + text->size : line;
	size_t count = 0;

	*bad = 0;
	while (line < limit) {
		char *end = memchr(line, '\n', (size_t)(limit - line));

		if (!end) {
			++*bad; /* cut off by a power failure */
			break;
		}
		*end = '\0';
		if (strncmp(line, header, sizeof(header) - 2) == 0)
			; /* the header */
		else if (parse_line(line, &entries[count]))
			count++;
		else
			++*bad;
		line = end + 1;
	}
	return count;
}

static size_t sum_up(struct entry *entries, size_t count)
{
	size_t kept = 0;

	qsort(entries, count, sizeof(*entries), compare);
	for (size_t i = 0; i < count; i++) {
		if (kept > 0 && compare(&entries[kept - 1], &entries[i]) == 0)
			entries[kept - 1].count += entries[i].count;
		else
			entries[kept++] = entries[i];
	}
	return kept;
}

/* Returns how many of the entries, in their order, are too old. If that were more than half, it is
 * the clock that is wrong: then none is. */
static size_t count_old(const struct entry *entries, size_t count, int64_t now_s)
{
	char oldest[HOUR_BYTES];
	size_t old = 0;

	if (now_s == 0)
		return 0;
	hour_of(now_s - (int64_t)USAGE_KEPT_DAYS * DAY_S, oldest);
	while (old < count && strcmp(entries[old].hour, oldest) < 0)
		old++;
	return old > count / 2 ? 0 : old;
}

static void complain(struct usage *usage, const char *path, int rc)
{
	if (!usage->complained)
		log_warn("storage", "%s: %s; visits are not counted", path, strerror(-rc));
	usage->complained = true;
}

/* Replaces the contents of the file in text with the tidy version. */
static int tidy(struct buffer *text, const char *path, int64_t now_s)
{
	struct entry *entries = calloc(count_lines(buffer_bytes(text)) + 1, sizeof(*entries));
	size_t count, bad;

	if (!entries)
		return -ENOMEM;
	count = sum_up(entries, parse(text, entries, &bad));
	if (bad > 0)
		log_warn("storage", "%s: %zu lines are not valid counts and were skipped", path,
			 bad);
	buffer_clear(text);
	buffer_put(text, header, sizeof(header) - 1);
	for (size_t i = count_old(entries, count, now_s); i < count; i++)
		put_line(text, &entries[i]);
	free(entries);
	return text->error;
}

/* Of a file that is too large, the newest half of what it may have. The line that is cut is not
 * valid, as its hour is not. */
static int read_newest(struct buffer *text, const char *path)
{
	int fd = open_regular(path);

	if (fd >= 0 && lseek(fd, -(USAGE_FILE_MAX / 2), SEEK_END) < 0) {
		close(fd);
		return -EIO;
	}
	return buffer_read_fd(text, fd);
}

static int tidy_files(struct usage *usage, int64_t now_s)
{
	struct buffer text;
	int rc;

	buffer_init(&text, USAGE_FILE_MAX);
	rc = buffer_read_file(&text, usage->path);
	if (rc == -EFBIG)
		rc = read_newest(&text, usage->path);
	if (rc == -ENOENT)
		rc = 0;
	if (rc == 0)
		rc = tidy(&text, usage->path, now_s);
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&text), usage->path);
	if (rc < 0 && rc != -ENOMEM)
		complain(usage, usage->path, rc);
	if (rc == 0)
		usage->file_bytes = text.size;
	usage->tidy_bytes = usage->file_bytes; /* or it is tried again when it has grown */
	if (rc == 0 && usage->copy_path) {
		int copied = bytes_write_file(buffer_bytes(&text), usage->copy_path);

		if (copied == 0 && chmod(usage->copy_path, 0644) < 0)
			copied = -errno;
		if (copied < 0)
			complain(usage, usage->copy_path, copied);
	}
	buffer_finish(&text);
	return rc == -ENOMEM ? rc : 0;
}

/* ---- creation */

int usage_create(struct usage **out, const char *path, const char *copy_path, int64_t now_s)
{
	struct usage *usage = calloc(1, sizeof(*usage));
	int rc;

	*out = NULL;
	if (!usage)
		return -ENOMEM;
	usage->path = strdup(path);
	usage->copy_path = copy_path ? strdup(copy_path) : NULL;
	rc = usage->path && (usage->copy_path || !copy_path) ? tidy_files(usage, now_s) : -ENOMEM;
	if (rc < 0) {
		usage_destroy(usage);
		return rc;
	}
	*out = usage;
	return 0;
}

void usage_destroy(struct usage *usage)
{
	if (!usage)
		return;
	usage_write(usage);
	free(usage->path);
	free(usage->copy_path);
	free(usage);
}

/* ---- counting */

void usage_add(struct usage *usage, enum usage_kind kind, const char *what, const char *language,
	       int64_t now_s)
{
	struct entry entry = { .kind = kind, .count = 1 };

	usage->now_s = now_s;
	hour_of(now_s, entry.hour);
	snprintf(entry.what, sizeof(entry.what), "%s", is_word(what) ? what : "");
	snprintf(entry.language, sizeof(entry.language), "%s", is_word(language) ? language : "");
	for (size_t i = 0; i < usage->pending_count; i++) {
		if (compare(&usage->pending[i], &entry) == 0) {
			usage->pending[i].count++;
			return;
		}
	}
	if (usage->pending_count == PENDING_MAX)
		usage_write(usage);
	if (usage->pending_count < PENDING_MAX)
		usage->pending[usage->pending_count++] = entry;
}

/* Appends all lines or, on failure, none: they are appended again then. */
static int append(const char *path, struct bytes lines)
{
	int rc, fd = open(path, O_WRONLY | O_APPEND | O_CLOEXEC);
	struct stat before;

	if (fd < 0)
		return -errno;
	if (fstat(fd, &before) < 0) {
		rc = -errno;
	} else {
		rc = bytes_write_to(fd, lines);
		if (rc < 0 && ftruncate(fd, before.st_size) < 0)
			log_debug("storage", "%s: %s; a part of it is counted twice", path,
				  strerror(errno));
	}
	close(fd);
	return rc;
}

void usage_write(struct usage *usage)
{
	struct buffer lines;
	int rc;

	if (usage->pending_count == 0)
		return;
	buffer_init(&lines, USAGE_FILE_MAX);
	for (size_t i = 0; i < usage->pending_count; i++)
		put_line(&lines, &usage->pending[i]);
	rc = lines.error;
	if (rc == 0)
		rc = append(usage->path, buffer_bytes(&lines));
	if (rc == 0) { /* else they stay pending and are tried again */
		usage->pending_count = 0;
		usage->file_bytes += lines.size;
	} else {
		complain(usage, usage->path, rc);
	}
	if (rc == 0 && usage->copy_path) {
		rc = append(usage->copy_path, buffer_bytes(&lines));
		if (rc < 0)
			complain(usage, usage->copy_path, rc);
	}
	buffer_finish(&lines);
	if (usage->file_bytes > 2 * usage->tidy_bytes + GROWTH_BYTES &&
	    tidy_files(usage, usage->now_s) < 0)
		log_debug("storage", "out of memory for the counts of visitors");
}
