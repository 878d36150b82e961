/* gopura-kiosk as a whole: all its modules, started in order, connected to each other, run by one
 * loop and stopped in reverse. Only app/kiosk.c and the main program see this struct; a module gets
 * what it needs from its own header. One thread; worker threads of the modules answer through
 * descriptors. */
#ifndef GOPURA_APP_KIOSK_H
#define GOPURA_APP_KIOSK_H

#include "app/fingers.h"
#include "app/frame.h"
#include "app/loop.h"
#include "app/modes/capture.h"
#include "app/modes/setup_page.h"
#include "app/panel.h"
#include "app/release/releases.h"
#include "app/settings/options.h"
#include "app/settings/provision.h"
#include "app/view/anchors.h"
#include "app/view/eye.h"
#include "app/view/redraw.h"
#include "app/view/viewport.h"
#include "app/visit/actions.h"
#include "app/visit/visitor.h"
#include "app/vitals.h"
#include "input/touch.h"
#include "render/display/display.h"
#include "render/display/quads.h"

/* Exit statuses beside success and failure: the program works, but must restart with what it has
 * cached, because another panel was connected (ANEW) or the GPU lost its context (LOST_GPU). The
 * service manager restarts it at once. ANEW is not counted as a crash; LOST_GPU only if it repeats.
 */
enum { KIOSK_STATUS_ANEW = 75, KIOSK_STATUS_LOST_GPU = 76 };

struct kiosk {
	struct options options; /* from the command line, completed from gopura.conf */
	struct provision provision;
	struct profile profile;
	int64_t started_ms;

	/* what is seen */
	struct display *display;
	struct quads *quads;
	struct viewport viewport;
	struct redraw redraw;
	struct eye eye;
	struct anchors anchors;
	struct frame frame;
	struct panel panel;

	struct releases releases;

	/* the visit */
	struct touch *touch; /* NULL: the pointer of a window acts as the finger */
	struct fingers fingers;
	struct actions actions;
	struct visitor visitor;
	struct tour_player tours;
	struct tools tools;
	struct back back;
	struct counting counting;
	struct listening listening;

	struct setup_page setup_page;
	struct capture *capture; /* NULL: normal operation */
	struct vitals vitals;
	struct metrics_socket *metrics; /* NULL: not requested */
	int signal_fd;                  /* 0: not created */
	struct loop loop;
};

/* Starts all modules of a kiosk that is zero but for its options. Returns 0 or a negative errno;
 * kiosk_stop is to be called in either case. */
must_check int kiosk_start(struct kiosk *kiosk);
/* Runs the loop until loop_quit. Returns 0, or a negative errno (logged) if it cannot continue;
 * -ENOTRECOVERABLE (the GPU lost its context) and -ESTALE (another panel): a new process can. */
must_check int kiosk_run(struct kiosk *kiosk);
/* Stops and frees all modules in reverse order; any of them may be missing. */
void kiosk_stop(struct kiosk *kiosk);

#endif
