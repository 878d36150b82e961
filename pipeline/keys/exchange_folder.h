/* The folder `exchange` in a keys' folder: the new keys of an exchange that is going on
 * (keys_exchange.h). It has all of them, or is not there. */
#ifndef GOPURA_PIPELINE_KEYS_EXCHANGE_FOLDER_H
#define GOPURA_PIPELINE_KEYS_EXCHANGE_FOLDER_H

#include "base/compiler.h"

enum exchange_key {
	EXCHANGE_ROOT,
	EXCHANGE_RELEASE,
	EXCHANGE_SNAPSHOT,
	EXCHANGE_TIMESTAMP,
	EXCHANGE_KEYS
};

/* "root", "release", "snapshot", "timestamp": the names of the files without .key. */
extern const char *const exchange_key_names[EXCHANGE_KEYS];

/* Returns which keys are being exchanged, 1 << key of each; 0: none. */
unsigned exchange_going_on(const char *folder);
/* Returns -EBUSY and logs what to do if an exchange was not finished, otherwise 0. */
must_check int exchange_check(const char *folder);

#endif
