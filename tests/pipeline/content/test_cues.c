/* WebVTT files as people write them, and with every kind of fault. */
#include "pipeline/content/cues.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

static int read_text(struct cues *out, const char *text, struct diagnostics *told)
{
	const size_t size = strlen(text);
	uint8_t *exact = malloc(size ? size : 1); /* no slack for ASan */
	int rc;

	memcpy(exact, text, size);
	*told = (struct diagnostics){ 0 };
	rc = cues_read(out, (struct bytes){ exact, size }, "gate.en.vtt", told);
	free(exact);
	return rc;
}

static void reads_cues_with_their_times(void **state)
{
	static const char text[] = "\xef\xbb\xbfWEBVTT - the gate\r\nKind: captions\r\n\r\n"
				   "NOTE made by hand\r\n00:00.000 -> no cue\r\n\r\n"
				   "STYLE\r\n::cue { color: red }\r\n\r\n"
				   "1\r\n00:00.250 --> 00:02.000 line:90% align:center\r\n"
				   "Two <i>lions</i>\r\n guard   the &amp; gate.\r\n\r\n\r\n"
				   "00:02.000 --> 00:03.000\r\n\r\n"
				   "00:01:00.000 --> 00:01:01.500\r\n<v Guide>塔門";
	struct diagnostics told;
	struct cues cues;

	(void)state;
	CHECK(read_text(&cues, text, &told) == 0 && told.count == 0);
	CHECK(cues.count == 2);
	CHECK(cues.all[0].begin_ms == 250 && cues.all[0].end_ms == 2000);
	CHECK(strcmp(cues.all[0].text, "Two lions guard the & gate.") == 0);
	CHECK(cues.all[1].begin_ms == 60000 && cues.all[1].end_ms == 61500);
	CHECK(strcmp(cues.all[1].text, "塔門") == 0);
	cues_finish(&cues);
}

static void names_the_line_of_every_fault(void **state)
{
	static const struct {
		const char *text, *told;
	} cases[] = {
		{ "", "gate.en.vtt:1: is no WebVTT file" },
		{ "1\n00:01.000 --> 00:02.000\nHello", "gate.en.vtt:1: is no WebVTT file" },
		{ "WEBVTT\n\n00:01 --> 00:02\nHello", "gate.en.vtt:3: is no line of times" },
		{ "WEBVTT\n\n00:01,000 --> 00:02,000\nHello",
		  "gate.en.vtt:3: is no line of times" },
		{ "WEBVTT\n\n00:61.000 --> 00:62.000\nHello",
		  "gate.en.vtt:3: is no line of times" },
		{ "WEBVTT\n\nname\n00:01.000 -->\nHello", "gate.en.vtt:4: is no line of times" },
		{ "WEBVTT\n\n00:02.000 --> 00:02.000\nHello", "gate.en.vtt:3: the cue ends" },
		{ "WEBVTT\n\n00:01.000 --> 11:00.000\nHello", "gate.en.vtt:3: the cue ends" },
		{ "WEBVTT\n\n00:02.000 --> 00:03.000\na\n\n00:01.000 --> 00:03.000\nb",
		  "gate.en.vtt:6: begins before the cue above it" },
		{ "WEBVTT\n\n00:01.000 --> 00:02.000\n\xff", "gate.en.vtt: is not UTF-8" },
	};

	(void)state;
	for (size_t n = 0; n < ARRAY_COUNT(cases); n++) {
		struct diagnostics told;
		struct cues cues;

		CHECK(read_text(&cues, cases[n].text, &told) == -EINVAL);
		CHECK(cues.count == 0 && !cues.all);
		if (strncmp(told.first.text, cases[n].told, strlen(cases[n].told)) != 0)
			fail_msg("\"%s\" instead of \"%s\"", told.first.text, cases[n].told);
	}
}

static void refuses_long_cues_and_too_many(void **state)
{
	struct buffer text;
	struct diagnostics told = { 0 };
	struct cues cues;

	(void)state;
	buffer_init(&text, 1 << 20);
	buffer_put_text(&text, "WEBVTT\n\n00:01.000 --> 00:02.000\n");
	for (int n = 0; n < 51; n++)
		buffer_put_text(&text, "0123456789");
	CHECK(cues_read(&cues, buffer_bytes(&text), "a.vtt", &told) == -EINVAL);
	CHECK(strstr(told.first.text, "a.vtt:3: a cue of more than 500 bytes"));
	buffer_clear(&text);
	buffer_put_text(&text, "WEBVTT\n\n");
	for (int n = 0; n <= INFO_CUES_MAX; n++)
		buffer_put_text(&text, "00:01.000 --> 00:02.000\nagain\n\n");
	told = (struct diagnostics){ 0 };
	CHECK(cues_read(&cues, buffer_bytes(&text), "a.vtt", &told) == -EINVAL);
	CHECK(strstr(told.first.text, "more than 1000 cues"));
	buffer_finish(&text);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(reads_cues_with_their_times),
		cmocka_unit_test(names_the_line_of_every_fault),
		cmocka_unit_test(refuses_long_cues_and_too_many),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
