/* The files in which the web process and the publisher talk. The first byte chooses which. */
#include <stdlib.h>
#include <string.h>

#include "curator/publish/publish_files.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_request(const struct publish_request *request)
{
	if (!publish_comment_is_valid(request->comment) || strpbrk(request->by, " \n/"))
		abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const struct bytes text = { data + 1, size - 1 };
	struct publish_releases releases;
	struct publish_request request;
	struct publish_state state;

	if (size == 0)
		return 0;
	switch (data[0] % 3) {
	case 0:
		if (publish_request_parse(&request, text) == 0)
			check_request(&request);
		break;
	case 1:
		if (publish_state_parse(&state, text) == 0)
			check_request(&state.request);
		break;
	default:
		if (publish_releases_parse(&releases, text) == 0)
			publish_releases_finish(&releases);
		else if (releases.list)
			abort();
	}
	return 0;
}
