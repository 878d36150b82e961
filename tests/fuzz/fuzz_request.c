#include <stdlib.h>

#include "health/request.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What is decided of a beginning stays so, however the rest comes in. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct request request = { 0 }, again = { 0 };
	const int status = request_parse(&request, (struct bytes){ data, size });

	if (status != 0 && status != 200 && status != 400 && status != 404 && status != 405 &&
	    status != 431 && status != 505)
		abort();
	if (status == 0 && size >= REQUEST_BYTES_MAX)
		abort();
	for (size_t n = size > 64 ? size - 64 : 0; n < size; n++) {
		const int before = request_parse(&again, (struct bytes){ data, n });

		if (before != 0 &&
		    (before != status || again.page != request.page || again.head != request.head))
			abort();
	}
	return 0;
}
