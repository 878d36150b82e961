/* Finds and creates the state folder, keeps the file touch.seen in it, which records that a
 * touchscreen was once connected, and finds what lies beside the program. */
#include "app/settings/folder.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/log.h"
#include "ui/translate.h"

int folder_of_state(const char *dir, char out[PATH_MAX])
{
	const char *home = getenv("HOME"), *state = getenv("XDG_STATE_HOME");

	if (dir)
		snprintf(out, PATH_MAX, "%s", dir);
	else if (state && *state)
		snprintf(out, PATH_MAX, "%s/gopura", state);
	else
		snprintf(out, PATH_MAX, "%s/.local/state/gopura", home ? home : "/var/lib");
	for (char *slash = out + 1; *slash; slash++) {
		if (*slash != '/')
			continue;
		*slash = '\0';
		mkdir(out, 0700); /* a failure shows when the last folder is created */
		*slash = '/';
	}
	if (mkdir(out, 0700) < 0 && errno != EEXIST) {
		const int rc = -errno;

		log_error("app", "%s: %s (choose another with --state)", out, strerror(-rc));
		return rc;
	}
	return 0;
}

static void touch_path(const char *folder, char out[PATH_MAX + 16])
{
	snprintf(out, PATH_MAX + 16, "%s/touch.seen", folder);
}

void folder_remember_touch(const char *folder, const char *name)
{
	char path[PATH_MAX + 16];
	FILE *file;

	touch_path(folder, path);
	if (access(path, F_OK) == 0)
		return; /* written once, to spare the flash memory */
	file = fopen(path, "we");
	if (!file)
		return;
	fprintf(file, "%s\n", name);
	fclose(file);
}

bool folder_had_touch(const char *folder, char name[128])
{
	char path[PATH_MAX + 16];
	FILE *file;

	touch_path(folder, path);
	file = fopen(path, "re");
	name[0] = '\0';
	if (!file)
		return false;
	if (!fgets(name, 128, file))
		name[0] = '\0';
	fclose(file);
	name[strcspn(name, "\n")] = '\0';
	return true;
}

void folder_beside_program(const char *name, char out[PATH_MAX])
{
	ssize_t length = readlink("/proc/self/exe", out, PATH_MAX - 1);
	char *slash;

	out[length > 0 ? length : 0] = '\0';
	slash = strrchr(out, '/');
	slash = slash ? slash + 1 : out;
	snprintf(slash, (size_t)(out + PATH_MAX - slash), "%s", name);
}

void folder_open_catalogues(const char *dir)
{
	char beside[PATH_MAX];
	int rc;

	folder_beside_program("locale", beside);
	if (!dir)
		dir = access(beside, R_OK | X_OK) == 0 ? beside : "/usr/share/locale";
	rc = translate_open(dir);
	if (rc < 0)
		log_warn("app", "the kiosk's own texts are in English only: %s",
			 rc == -ENOENT ? "the system has no locale C.UTF-8 (package libc-bin)"
				       : strerror(-rc));
}
