/* What a program and its service manager tell each other: messages to it (systemd's sd_notify;
 * without a manager nothing is sent), and its signals to stop. For the thread of the loop. */
#ifndef GOPURA_BASE_SERVICE_H
#define GOPURA_BASE_SERVICE_H

#include <stdint.h>

#include "base/compiler.h"

/* Opens a descriptor that becomes readable when the program is to stop: at SIGTERM or SIGINT, which
 * are blocked from now on, in later threads too. Owned by the caller. Negative errno. */
must_check int service_stop_fd(void);
/* Tells it that the program is ready and does its work. */
void service_ready(void);
/* Returns when service_alive is due next, in milliseconds of clock_now_ms: a third of the watchdog
 * period after the last message; INT64_MAX if there is no watchdog. */
int64_t service_due_ms(void);
/* Tells the watchdog that the program works. */
void service_alive(void);
/* Tells it that the program is ending. */
void service_stopping(void);

#endif
