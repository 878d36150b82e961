/* gopura-kiosk --self-test: tests whether this machine can work as a terminal. It is for the
 * engineer who sets one up, and for an update that checks the new system. */
#ifndef GOPURA_APP_MODES_SELF_TEST_H
#define GOPURA_APP_MODES_SELF_TEST_H

#include "app/settings/options.h"

/* Only settings or the trust root failed: another system would have the same faults. */
enum { SELF_TEST_STATUS_SETTINGS = 3 };

/* Completes *options from gopura.conf and prints one line per check to standard output: "ok" or
 * "fail", what was checked, what was found and, if it failed, what to do. Returns the program's
 * exit status: EXIT_SUCCESS if all checks passed, SELF_TEST_STATUS_SETTINGS, or EXIT_FAILURE. Do
 * not run it beside a running kiosk: only one program can use the panel. */
must_check int self_test_run(struct options *options);

#endif
