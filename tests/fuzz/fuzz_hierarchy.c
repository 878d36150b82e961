/* Any bytes as the payload of a hierarchy page: refused, or a structure that keeps every rule. */
#include "format/hierarchy.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct hierarchy hierarchy;

	if (hierarchy_decode(&hierarchy, (struct bytes){ data, size }) < 0)
		return 0;
	if (hierarchy_check(&hierarchy) < 0)
		abort();
	hierarchy_finish(&hierarchy);
	return 0;
}
