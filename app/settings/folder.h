/* Folders of the kiosk: the state folder with the small files beside its databases, and what lies
 * in the program's own folder. */
#ifndef GOPURA_APP_SETTINGS_FOLDER_H
#define GOPURA_APP_SETTINGS_FOLDER_H

#include <limits.h>
#include <stdbool.h>

#include "base/compiler.h"

/* Writes to out the path of the folder for state.db and cache.db: dir if not NULL, otherwise
 * $XDG_STATE_HOME/gopura or ~/.local/state/gopura. Creates it, with its parents, if it is missing.
 * Returns 0 or a negative errno (logged). */
must_check int folder_of_state(const char *dir, char out[PATH_MAX]);

/* Records that a touchscreen of that name was connected: later, a missing touchscreen counts as a
 * fault. Writes once; a failure to write is ignored. */
void folder_remember_touch(const char *folder, const char *name);
/* Returns whether a touchscreen was ever recorded. name receives its name; "" if not known. */
bool folder_had_touch(const char *folder, char name[128]);

/* Writes to out the path of a file in the folder of this program. */
void folder_beside_program(const char *name, char out[PATH_MAX]);
/* Opens the catalogues of the kiosk's own texts: those in dir if it is not NULL, otherwise in the
 * folder locale beside this program, otherwise the system's. A failure is logged; the texts are
 * then in English. */
void folder_open_catalogues(const char *dir);

#endif
