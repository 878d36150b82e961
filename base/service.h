/* What the service manager is told (systemd's sd_notify). Where there is none, nothing is said. For
 * the thread of the loop. */
#ifndef GOPURA_BASE_SERVICE_H
#define GOPURA_BASE_SERVICE_H

#include <stdint.h>

/* It does now what it was started for. */
void service_ready(void);
/* When it is next to be told that the program is well, a third of what it waits after the last
 * time; INT64_MAX: it does not wait. On the clock of clock_now_ms. */
int64_t service_due_ms(void);
/* The program is well. */
void service_alive(void);
/* It was asked to end, and does. */
void service_stopping(void);

#endif
