/* A recording that a curator's browser sends, as the sandboxed child decodes it, and as a check
 * skims it, and as it is copied. */
#include <stdlib.h>
#include <string.h>

#include "curator/pages/sound_import.h"
#include "pipeline/content/spoken_sound.h"
#include "storage/info_spoken.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A copy of a copy is the copy. */
static void check_copy(struct bytes file)
{
	struct buffer once, twice;

	buffer_init(&once, INFO_SPOKEN_BYTES_MAX);
	buffer_init(&twice, INFO_SPOKEN_BYTES_MAX);
	if (sound_import_copy(&once, file) == 0 &&
	    (sound_import_copy(&twice, buffer_bytes(&once)) < 0 || twice.size != once.size ||
	     memcmp(twice.data, once.data, once.size) != 0))
		abort();
	buffer_finish(&once);
	buffer_finish(&twice);
}

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
	check_copy((struct bytes){ data, size });
	return 0;
}
