/* Asks the terminal's programs for their figures (base/metrics_socket.h) and the machine for its
 * own. */
#ifndef GOPURA_HEALTH_GATHER_H
#define GOPURA_HEALTH_GATHER_H

#include "base/metrics.h"
#include "health/machine.h"

enum program { PROGRAM_KIOSK, PROGRAM_FETCH, PROGRAM_COUNT };

/* What a program answered. text is valid by metrics_valid, and empty unless rc is 0. */
struct answer {
	/* -ENOENT, -ECONNREFUSED: it does not run   -ETIMEDOUT: it hangs
	 * -EBADMSG: it answers nonsense             others: as connect */
	int rc;
	struct buffer text; /* owned */
};

struct snapshot {
	struct answer answers[PROGRAM_COUNT];
	struct machine machine;
	int64_t taken_ms;     /* clock_now_ms; 0: never */
	int64_t taken_wall_s; /* since 1970 */
};

struct gather_options {
	const char *sockets[PROGRAM_COUNT];
	int64_t patience_ms; /* with all of them together; then they hang */
	struct machine_options machine;
};

void snapshot_init(struct snapshot *snapshot);
void snapshot_finish(struct snapshot *snapshot);
/* Waits for the programs, patience_ms at most. */
void snapshot_take(struct snapshot *snapshot, const struct gather_options *options);

#endif
