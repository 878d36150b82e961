/* Helpers shared by the commands of gopura-content. */
#include "pipeline/commands.h"

#include <errno.h>
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

int command_read_content(struct content *out, const char *folder)
{
	struct faults faults = { .count = 0 };
	int rc = content_read(out, folder, &faults);

	for (unsigned i = 0; i < faults.count; i++)
		fprintf(stderr, "%s/temple.ini, %s\n", folder, faults.list[i].text);
	if (rc < 0 && faults.count == 0)
		fprintf(stderr, "%s: %s\n", folder, strerror(-rc));
	return rc;
}
