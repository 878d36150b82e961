/* gopura-kiosk --self-test: is this machine fit to be a terminal? For the engineer who sets one up,
 * and for an update that wants to know whether the new system still is. */
#ifndef GOPURA_APP_MODES_SELF_TEST_H
#define GOPURA_APP_MODES_SELF_TEST_H

#include <stdbool.h>

#include "app/options.h"

/* Fills in options by gopura.conf. A line a check on standard output: "ok" or "fail", what was
 * checked, what was found, and where it failed what to do. true: all are well. Not beside a running
 * kiosk: the panel is one program's. */
must_check bool self_test_run(struct options *options);

#endif
