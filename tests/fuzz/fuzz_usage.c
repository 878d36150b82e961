/* The counts of visitors, as a disk may give them back: read, put in order and written; what comes
 * out is in order already. */
#include "base/bytes.h"
#include "storage/usage.h"
#include "tests/fuzz/scratch.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void put_in_order(struct buffer *out)
{
	struct usage *usage;

	if (usage_create(&usage, scratch_path("visits.csv"), NULL, 1795000000) < 0)
		abort();
	usage_destroy(usage);
	buffer_init(out, USAGE_FILE_MAX);
	if (buffer_read_file(out, scratch_path("visits.csv")) < 0)
		abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct buffer once, twice;

	scratch_begin();
	scratch_write("visits.csv", data, size);
	put_in_order(&once);
	put_in_order(&twice);
	if (once.size != twice.size || memcmp(once.data, twice.data, once.size) != 0)
		abort();
	buffer_finish(&once);
	buffer_finish(&twice);
	return 0;
}
