#include <stdlib.h>
#include <string.h>

#include "base/metrics.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What is read of a text keeps to its ends, and what is written of what was read is valid. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const struct bytes text = { data, size };
	char value[64];
	struct figure_label label = { "why", value };
	struct buffer out;
	double number = 0;

	metrics_valid(text, "gopura_kiosk_");
	metrics_find(text, "gopura_kiosk_frames_total", &number);
	if (!metrics_label(text, "gopura_kiosk_refusal_info", "why", value, sizeof(value)))
		return 0;
	if (strlen(value) >= sizeof(value))
		abort();
	buffer_init(&out, METRICS_BYTES_MAX);
	metrics_info(&out, "gopura_kiosk_refusal_info", "Why.", &label, 1);
	metrics_gauge(&out, "gopura_kiosk_frames", "How many.", number);
	if (out.error || !metrics_valid(buffer_bytes(&out), "gopura_kiosk_"))
		abort();
	buffer_finish(&out);
	return 0;
}
