#include <stdlib.h>
#include <string.h>

#include "system/terminal.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct terminal terminal;
	static struct faults faults;
	char host[TERMINAL_NAME_BYTES];

	memset(&faults, 0, sizeof(faults));
	terminal_parse(&terminal, (struct bytes){ data, size }, &faults);
	terminal_host_name(&terminal, host);
	if (faults.count > FAULTS_MAX || strchr(terminal.trust, '/') || strlen(host) < 1)
		abort();
	for (unsigned i = 0; i < faults.count; i++)
		if (strlen(faults.list[i].text) < 10 ||
		    (i > 0 && faults.list[i].line && faults.list[i].line < faults.list[i - 1].line))
			abort();
	return 0;
}
