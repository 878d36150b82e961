/* What this process and its children that have ended have used, for reports. */
#ifndef GOPURA_BASE_RESOURCE_USAGE_H
#define GOPURA_BASE_RESOURCE_USAGE_H

#include <stdint.h>

struct resource_usage {
	int64_t processor_us; /* of all threads, in user and kernel mode; of ended children too */
	/* Most memory that was resident at one time: of this process, and of its largest child. */
	uint64_t own_bytes, child_bytes;
};

/* Sets *out to what was used since the process began. */
void resource_usage_now(struct resource_usage *out);
/* Lets own_bytes count from now on, where the system offers it. */
void resource_usage_reset_own(void);

#endif
