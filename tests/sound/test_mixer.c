/* Which controls of a card are opened, by the names that drivers give them. */
#include "sound/mixer.h"

#include "base/compiler.h"
#include "tests/check.h"

static void opens_no_microphone(void **state)
{
	static const char *const inputs[] = {
		"Mic", "Front Mic", "Rear Mic Boost", "Internal Mic", "Line",           "Line In",
		"CD",  "Aux",       "Capture",        "Beep",         "Loopback Mixing"
	};
	static const char *const outputs[] = { "Master",   "PCM",          "Headphone", "Speaker",
					       "Line Out", "Bass Speaker", "Front",     "IEC958",
					       "HDMI",     "Lineout",      "DAC",       "" };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(inputs); i++)
		CHECK(mixer_is_input(inputs[i]));
	for (size_t i = 0; i < ARRAY_COUNT(outputs); i++)
		CHECK(!mixer_is_input(outputs[i]));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(opens_no_microphone),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
