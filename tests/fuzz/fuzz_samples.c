/* First byte: which of the three pages the rest is. */
#include "format/samples.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct brick_page brick;
	static struct face_page face;
	struct samples_page samples;
	struct bytes payload = { data + 1, size - 1 };

	if (size == 0)
		return 0;
	switch (data[0]) {
	case 0:
		if (samples_page_decode(&samples, payload) == 0)
			samples_page_finish(&samples);
		break;
	case 1:
		(void)!brick_page_decode(&brick, payload);
		break;
	default:
		(void)!face_page_decode(&face, payload);
	}
	return 0;
}
