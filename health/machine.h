/* What the machine tells of itself, from /proc and /sys. What it does not tell is NAN or "". */
#ifndef GOPURA_HEALTH_MACHINE_H
#define GOPURA_HEALTH_MACHINE_H

#include "base/bytes.h"

enum { MACHINE_FAULTS_BYTES_MAX = 4096 };

struct machine_options {
	const char *root;   /* before /proc and /sys: "" but in tests */
	const char *faults; /* file of provisioning's faults, a line each; may be missing */
	const char *data;   /* a folder of the data partition */
};

struct machine {
	char name[65]; /* of the host */
	char slot[32]; /* of the firmware that runs, as the loader said */
	double uptime_s;
	double temperature_c; /* of the hottest zone */
	double memory_bytes, memory_free_bytes;
	double data_bytes, data_free_bytes; /* of the data partition, as a user sees it */
	double written_bytes;               /* to all disks since the machine began */
	char faults[MACHINE_FAULTS_BYTES_MAX];
};

void machine_read(struct machine *out, const struct machine_options *options);

#endif
