/* gopura-kiosk --safe-page: the page that the service manager starts when the kiosk keeps failing.
 * It uses no GPU, release, cache or state, so none of them can break it. */
#ifndef GOPURA_APP_MODES_SAFE_MODE_H
#define GOPURA_APP_MODES_SAFE_MODE_H

#include "app/settings/options.h"

/* Completes *options from gopura.conf, and takes the panel's rotation from it or the board profile.
 * Shows the page until SIGTERM or SIGINT. With options->capture_dir, writes safe-0.png and
 * safe-1.png, the animation at 0 and 5 seconds, and returns. Returns 0 or a negative errno
 * (logged); -ESTALE: another panel was connected; restart the program. */
must_check int safe_mode_run(struct options *options);

#endif
