/* gopura-kiosk --safe-page: what the service manager starts when the kiosk does not stay up. It
 * uses neither GPU nor release, cache or state, so that none of them can be what is wrong with it.
 */
#ifndef GOPURA_APP_MODES_SAFE_MODE_H
#define GOPURA_APP_MODES_SAFE_MODE_H

#include "app/options.h"

/* Fills in options by gopura.conf, of which it takes how the panel hangs. Until SIGTERM or SIGINT;
 * with options->capture_dir, writes safe-0.png and safe-1.png, five seconds apart, and ends.
 * Negative errno (logged); -ESTALE: another panel, begin anew. */
must_check int safe_mode_run(struct options *options);

#endif
