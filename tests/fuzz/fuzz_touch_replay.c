#include <stdlib.h>

#include "input/touch_replay.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct touch_replay replay;

	if (touch_replay_parse(&replay, (struct bytes){ data, size }, 640, 360, NULL) < 0)
		return 0;
	for (size_t i = 1; i < replay.count; i++)
		if (replay.events[i].time_us < replay.events[i - 1].time_us ||
		    replay.events[i].contact >= TOUCH_CONTACTS_MAX)
			abort();
	touch_replay_finish(&replay);
	return 0;
}
