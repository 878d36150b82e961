/* gopura-kiosk --self-test: tests whether this machine can work as a terminal. It is for the
 * engineer who sets one up, and for an update that checks the new system. */
#ifndef GOPURA_APP_MODES_SELF_TEST_H
#define GOPURA_APP_MODES_SELF_TEST_H

#include <stdbool.h>

#include "app/settings/options.h"

/* Completes *options from gopura.conf and prints one line per check to standard output: "ok" or
 * "fail", what was checked, what was found and, if it failed, what to do. Returns whether all
 * checks passed. Do not run it beside a running kiosk: only one program can use the panel. */
must_check bool self_test_run(struct options *options);

#endif
