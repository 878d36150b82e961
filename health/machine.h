/* The machine's values from /proc and /sys. A value that is not available is NAN, "" or false. */
#ifndef GOPURA_HEALTH_MACHINE_H
#define GOPURA_HEALTH_MACHINE_H

#include "base/bytes.h"

enum { MACHINE_FAULTS_BYTES_MAX = 4096 };

struct machine_options {
	const char *root;   /* put before all other paths; "" except in tests */
	const char *faults; /* file with the faults of gopura.conf, one per line */
	const char *data;   /* a folder of the data partition */
};

struct machine {
	char name[65]; /* name of the host */
	char slot[32]; /* slot of the running firmware, as the boot loader said */
	/* version of a newer system than the running one, if one was found good here */
	char newer[64];
	double uptime_s;
	double temperature_c; /* of the hottest thermal zone */
	double memory_bytes, memory_free_bytes;
	double data_bytes, data_free_bytes; /* of the data partition, as available to users */
	double written_bytes;               /* written to all disks since boot */
	char data_plain[128]; /* why data is plain though the image encrypts it, or "" */
	char data_lost[128];  /* why memory takes the data partition's place, or "" */
	bool is_set_up;       /* gopura-setup has written the faults, if only that there are none */
	char faults[MACHINE_FAULTS_BYTES_MAX];
};

/* Reads all values into *out. Never fails: see above. */
void machine_read(struct machine *out, const struct machine_options *options);

#endif
