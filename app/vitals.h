/* The kiosk's metrics, for gopura-health and Prometheus; docs/health.md lists them. They are
 * written on demand by the thread of the loop, from values that are at hand. */
#ifndef GOPURA_APP_VITALS_H
#define GOPURA_APP_VITALS_H

#include "app/frame.h"
#include "app/release/sessions.h"
#include "app/release/updater.h"
#include "app/release/wants.h"
#include "input/touch.h"

struct metrics_socket;

/* What is measured; borrowed. */
struct vitals {
	const struct frame *frame;
	const struct sessions *sessions;
	const struct updater *updater;
	const struct wants *wants;
	const struct touch *touch; /* NULL: no touch device is expected */
};

/* Offers the metrics on a socket at path, which is copied. *out is owned by the caller, to be freed
 * by metrics_socket_destroy; vitals are borrowed for its life. Returns 0 or a negative errno
 * (logged). */
must_check int vitals_offer(struct metrics_socket **out, const struct vitals *vitals,
			    const char *path);

#endif
