/* The program gopura-kiosk, which owns panel and touch and has no network: parses the options, then
 * runs the self test, the safe page or the kiosk, and maps the result to an exit status. */
#include <errno.h>
#include <malloc.h>
#include <stdlib.h>

#include "app/kiosk.h"
#include "app/modes/safe_mode.h"
#include "app/modes/self_test.h"
#include "app/settings/options.h"

enum {
	FREED_BYTES_MAX = 64 << 20,   /* that malloc keeps while the eye moves */
	MAPPED_BYTES_LEAST = 1 << 20, /* of an allocation that is a mapping of its own */
};

int main(int argc, char **argv)
{
	static struct kiosk kiosk;
	int rc;

	/* One malloc arena: those of the worker threads would hold 2 MB unused. */
	mallopt(M_ARENA_MAX, 1);
	/* A driver that draws on the processor frees megabytes in each frame, and would fault them
	 * in again in the next. app/frame.c gives them back when the picture has settled. */
	mallopt(M_TRIM_THRESHOLD, FREED_BYTES_MAX);
	mallopt(M_MMAP_THRESHOLD, MAPPED_BYTES_LEAST);
	switch (options_parse(&kiosk.options, argc, argv)) {
	case OPTIONS_DONE:
		return EXIT_SUCCESS;
	case OPTIONS_BAD:
		return 2;
	case OPTIONS_RUN:
		break;
	}
	if (kiosk.options.self_test)
		return self_test_run(&kiosk.options) ? EXIT_SUCCESS : EXIT_FAILURE;
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
