/* Messages to the service manager (systemd's sd_notify). Without one nothing is sent. For the
 * thread of the loop. */
#ifndef GOPURA_BASE_SERVICE_H
#define GOPURA_BASE_SERVICE_H

#include <stdint.h>

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
