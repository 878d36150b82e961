/* The program gopura-kiosk, which owns panel and touch and has no network: parses the options, then
 * runs the self test, the safe page or the kiosk, and maps the result to an exit status. */
#include <errno.h>
#include <stdlib.h>

#include "app/kiosk.h"
#include "app/modes/safe_mode.h"
#include "app/modes/self_test.h"
#include "app/settings/heap.h"
#include "app/settings/options.h"
#include "base/crash.h"

int main(int argc, char **argv)
{
	static struct kiosk kiosk;
	int rc;

	crash_tell("app");
	heap_prepare();
	switch (options_parse(&kiosk.options, argc, argv)) {
	case OPTIONS_DONE:
		return EXIT_SUCCESS;
	case OPTIONS_BAD:
		return 2;
	case OPTIONS_RUN:
		break;
	}
	if (kiosk.options.self_test)
		return self_test_run(&kiosk.options);
	if (kiosk.options.safe_page) {
		rc = safe_mode_run(&kiosk.options);
	} else {
		rc = kiosk_start(&kiosk); /* display, touch, release, loop */
		if (rc == 0)
			rc = kiosk_run(&kiosk);
		kiosk_stop(&kiosk); /* in reverse order; any part may be missing */
	}
	if (rc == -ENOTRECOVERABLE)
		return KIOSK_STATUS_LOST_GPU;
	if (rc == -ESTALE)
		return KIOSK_STATUS_ANEW;
	return rc == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
