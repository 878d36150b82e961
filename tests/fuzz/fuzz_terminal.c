#include <stdlib.h>
#include <string.h>

#include "system/terminal.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct terminal terminal;
	static struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	char host[TERMINAL_NAME_BYTES];

	diagnostics_finish(&diagnostics);
	terminal_parse(&terminal, (struct bytes){ data, size }, &diagnostics);
	terminal_host_name(&terminal, host);
	if (diagnostics.count > SETTINGS_DIAGNOSTICS_MAX || strchr(terminal.trust, '/') ||
	    strlen(host) < 1)
		abort();
	for (unsigned i = 0; i < diagnostics.count; i++)
		if (strlen(diagnostics_get(&diagnostics, i)->text) < 10 ||
		    (i > 0 && diagnostics_get(&diagnostics, i)->line &&
		     diagnostics_get(&diagnostics, i)->line <
			     diagnostics_get(&diagnostics, i - 1)->line))
			abort();
	return 0;
}
