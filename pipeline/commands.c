/* Helpers shared by the commands of gopura-content. */
#include "pipeline/commands.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
