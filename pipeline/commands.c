/* Helpers shared by the commands of gopura-content. */
#include "pipeline/commands.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int command_wrong(const char *command, const char *what, const char *value)
{
	fprintf(stderr, "gopura-content %s: %s%s; see gopura-content %s --help\n", command, what,
		value, command);
	return 2;
}

bool command_number(const char *text, uint64_t least, uint64_t most, uint64_t *out)
{
	char *end;

	errno = 0;
	*out = strtoull(text, &end, 10);
	return text[0] >= '0' && text[0] <= '9' && *end == '\0' && errno == 0 && *out >= least &&
	       *out <= most;
}

int command_check_out(const char *command, const char *out, const char *input)
{
	const char *slash = strrchr(out, '/');
	struct stat of_out, of_input;
	char folder[PATH_MAX];
	int rc;

	if (stat(out, &of_out) == 0 && stat(input, &of_input) == 0 &&
	    of_out.st_dev == of_input.st_dev && of_out.st_ino == of_input.st_ino) {
		fprintf(stderr,
			"gopura-content %s: %s is read, and would be lost; give another --out\n",
			command, input);
		return -EEXIST;
	}
	snprintf(folder, sizeof(folder), "%.*s", slash ? (int)(slash - out) + 1 : 1,
		 slash ? out : ".");
	if (access(folder, W_OK) == 0)
		return 0;
	rc = -errno;
	fprintf(stderr, "gopura-content %s: %s: %s; make the folder, or give another --out\n",
		command, folder, strerror(-rc));
	return rc;
}

bool command_size(const char *text, uint64_t *out)
{
	static const struct {
		const char *name;
		double bytes;
	} units[] = { { "B", 1 }, { "kB", 1e3 }, { "MB", 1e6 }, { "GB", 1e9 } };
	size_t whole = strspn(text, "0123456789"), part = 0;
	double number;

	if (whole == 0 || whole > 15)
		return false;
	if (text[whole] == '.') {
		part = strspn(text + whole + 1, "0123456789");
		if (part == 0)
			return false;
		part++;
	}
	number = strtod(text, NULL);
	text += whole + part;
	text += *text == ' ';
	for (size_t i = 0; i < ARRAY_COUNT(units); i++)
		if (strcmp(text, units[i].name) == 0) {
			number *= units[i].bytes;
			*out = (uint64_t)number;
			return number >= 1 && number < 1e18;
		}
	return false;
}

bool command_shard(const char *text, struct shard *out)
{
	char rest;

	return sscanf(text, "%u/%u%c", &out->number, &out->count, &rest) == 2 &&
	       out->number < out->count;
}

int command_read_content(struct content *out, const char *folder)
{
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	char before[PATH_MAX + 32];
	int rc = content_read(out, folder, &diagnostics);

	snprintf(before, sizeof(before), "%s/temple.ini, ", folder);
	diagnostics_print(&diagnostics, stderr, before);
	if (rc < 0 && diagnostics.count == 0)
		fprintf(stderr, "%s: %s\n", folder, strerror(-rc));
	diagnostics_finish(&diagnostics);
	return rc;
}
