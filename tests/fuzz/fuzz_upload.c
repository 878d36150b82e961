/* A picture that a curator's browser sends, as the sandboxed child reads it. */
#include "curator/pages/picture_import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct buffer out;
	bool is_png;

	buffer_init(&out, 16 << 20);
	(void)!picture_import_here(&out, &is_png, (struct bytes){ data, size });
	buffer_finish(&out);
	return 0;
}
