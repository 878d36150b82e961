/* Log lines on standard error, one for each call. If standard error is the journal, each has the
 * priority prefix that journald understands.
 *
 *   error  someone must come
 *   warn   degraded, but running
 *   info   a state changed (a boot is under twenty lines)
 *   debug  off unless asked for
 *
 * Name the culprit in the text: "content bug:", "board bug:", "kiosk bug:". Any thread. */
#ifndef GOPURA_BASE_LOG_H
#define GOPURA_BASE_LOG_H

#include "base/compiler.h"

enum log_level { LOG_LEVEL_ERROR, LOG_LEVEL_WARN, LOG_LEVEL_INFO, LOG_LEVEL_DEBUG };

/* Lines above this level are dropped. The default is LOG_LEVEL_INFO. */
void log_set_level(enum log_level level);

/* Writes a line. module: the folder it comes from ("storage", "net"). text needs no newline; more
 * than 1023 bytes are cut. */
void log_line(enum log_level level, const char *module, const char *text, ...) printf_like(3, 4);

#define log_error(...) log_line(LOG_LEVEL_ERROR, __VA_ARGS__)
#define log_warn(...)  log_line(LOG_LEVEL_WARN, __VA_ARGS__)
#define log_info(...)  log_line(LOG_LEVEL_INFO, __VA_ARGS__)
#define log_debug(...) log_line(LOG_LEVEL_DEBUG, __VA_ARGS__)

#endif
