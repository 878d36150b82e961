/* A recording that a curator's browser sends, as the sandboxed child decodes it, and as a check
 * skims it. */
#include <stdlib.h>

#include "pipeline/content/spoken_sound.h"
#include "storage/info_spoken.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	uint32_t whole_ms, skimmed_ms;
	const bool is_whole =
		spoken_sound_measure((struct bytes){ data, size }, false, &whole_ms) == 0;

	/* What decodes to its end passes the shorter look too, with the same length. */
	if (is_whole &&
	    (spoken_sound_measure((struct bytes){ data, size }, true, &skimmed_ms) < 0 ||
	     skimmed_ms != whole_ms))
		abort();
	if (whole_ms > INFO_SPOKEN_MS_MAX || is_whole != (whole_ms > 0))
		abort();
	return 0;
}
