/* Any object as a page, and what the payload of a root page says. */
#include <stdlib.h>

#include "format/root_page.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct root_page root;
	struct buffer again;
	struct page page;

	if (page_decode(&page, (struct bytes){ data, size }) < 0)
		return 0;
	/* One page, one encoding: otherwise a hash would not name it. */
	buffer_init(&again, PAGE_BYTES_MAX);
	page_encode(&again, &page);
	if (again.error == 0 && again.size != size)
		abort();
	buffer_finish(&again);
	if (page_child_offset(&page, page.child_count) > (uint64_t)size * OBJECT_BYTES_MAX)
		abort();
	if (page.kind == PAGE_ROOT && root_page_decode(&root, page.payload) == 0 &&
	    !(root.lattice.step_m > 0))
		abort();
	page_finish(&page);
	return 0;
}
