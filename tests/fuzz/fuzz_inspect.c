/* Any file at all, as whoever is curious would give it to `gopura-content inspect`. */
#include "pipeline/release/inspect.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static FILE *nowhere;

	if (!nowhere)
		nowhere = fopen("/dev/null", "w");
	if (nowhere && inspect_bytes(nowhere, (struct bytes){ data, size }) < 0)
		return 0;
	return 0;
}
