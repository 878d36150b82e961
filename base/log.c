/* Formats log lines and writes each to standard error with one call. */
#include "base/log.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

static atomic_int max_level = LOG_LEVEL_INFO;

void log_set_level(enum log_level level)
{
	max_level = level;
}

void log_line(enum log_level level, const char *module, const char *text, ...)
{
	/* Prefixes are syslog priorities, which journald reads from the stream; names are for
	 * people. */
	static const char *const journal_prefix[] = { "<3>", "<4>", "<6>", "<7>" };
	static const char *const name[] = { "error", "warn", "info", "debug" };
	char line[1024];
	va_list args;

	if ((int)level > max_level)
		return;
	va_start(args, text);
	vsnprintf(line, sizeof(line), text, args);
	va_end(args);
	/* One call for each line, so that lines of several threads do not mix. */
	if (getenv("JOURNAL_STREAM"))
		fprintf(stderr, "%s%s: %s\n", journal_prefix[level], module, line);
	else
		fprintf(stderr, "%s: %s: %s\n", name[level], module, line);
}
