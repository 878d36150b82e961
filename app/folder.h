/* The state folder: where it is, and the little that lies in it beside the databases. */
#ifndef GOPURA_APP_FOLDER_H
#define GOPURA_APP_FOLDER_H

#include <limits.h>
#include <stdbool.h>

#include "base/compiler.h"

/* Of state.db and cache.db: dir, else what the environment says; made where it is not there.
 * Negative errno (logged). */
must_check int folder_of_state(const char *dir, char out[PATH_MAX]);

/* A touchscreen of that name was there: a terminal that had one is ill without. Kept once, and no
 * failure where it cannot be kept. */
void folder_remember_touch(const char *folder, const char *name);
/* Was there ever one? name: which. */
bool folder_had_touch(const char *folder, char name[128]);

#endif
