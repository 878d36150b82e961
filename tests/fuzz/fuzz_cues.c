/* The words of a spoken text, as anybody's WebVTT file. What is read keeps the rules of the
 * database. */
#include <stdlib.h>
#include <string.h>

#include "pipeline/content/cues.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct diagnostics told = { 0 };
	struct cues cues;

	if (cues_read(&cues, (struct bytes){ data, size }, "fuzz.vtt", &told) < 0) {
		if (told.error_count == 0)
			abort();
		return 0;
	}
	for (uint32_t n = 0; n < cues.count; n++)
		if (cues.all[n].end_ms <= cues.all[n].begin_ms || !*cues.all[n].text ||
		    strlen(cues.all[n].text) > INFO_CUE_BYTES_MAX ||
		    (n > 0 && cues.all[n].begin_ms < cues.all[n - 1].begin_ms))
			abort();
	cues_finish(&cues);
	return 0;
}
