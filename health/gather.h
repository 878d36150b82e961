/* Collects the metrics of the terminal's programs (base/metrics_socket.h) and the values of the
 * machine. */
#ifndef GOPURA_HEALTH_GATHER_H
#define GOPURA_HEALTH_GATHER_H

#include "base/metrics.h"
#include "health/machine.h"

enum program { PROGRAM_KIOSK, PROGRAM_FETCH, PROGRAM_COUNT };

/* What a program answered. text passes metrics_valid; it is empty unless rc is 0. */
struct answer {
	/* -ENOENT, -ECONNREFUSED: it does not run   -ETIMEDOUT: it hangs
	 * -EBADMSG: its answer is not valid         others: as connect */
	int rc;
	struct buffer text; /* owned */
};

struct snapshot {
	struct answer answers[PROGRAM_COUNT];
	struct machine machine;
	int64_t taken_ms;     /* by clock_now_ms; 0: never */
	int64_t taken_wall_s; /* seconds since 1970 */
};

struct gather_options {
	const char *sockets[PROGRAM_COUNT];
	int64_t patience_ms; /* for all programs together; then they count as hung */
	struct machine_options machine;
};

/* Sets *snapshot to empty. */
void snapshot_init(struct snapshot *snapshot);
/* Frees the answers. */
void snapshot_finish(struct snapshot *snapshot);
/* Fills the snapshot anew. Waits for the programs, patience_ms at most. */
void snapshot_take(struct snapshot *snapshot, const struct gather_options *options);

#endif
