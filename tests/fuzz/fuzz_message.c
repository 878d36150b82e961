/* Whatever decodes must encode to the same bytes again. */
#include <stdlib.h>
#include <string.h>

#include "format/message.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct message message;
	struct buffer again;

	if (message_decode(&message, (struct bytes){ data, size }) < 0)
		return 0;
	buffer_init(&again, MESSAGE_BYTES_MAX);
	message_encode(&again, &message);
	if (again.error || again.size != size || memcmp(again.data, data, size) != 0)
		abort();
	buffer_finish(&again);
	return 0;
}
