/* The speaker with ALSA's own file device, which writes what would be heard. */
#include "sound/speaker.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/check.h"

static char folder[64];

static const char recording[] = "demo/content/pages/central-tower.en.opus";

static void use_device(const char *text)
{
	char path[100];

	snprintf(path, sizeof(path), "%s/asound.conf", folder);
	CHECK(bytes_write_file((struct bytes){ (const uint8_t *)text, strlen(text) }, path) == 0);
	CHECK(setenv("ALSA_CONFIG_PATH", path, 1) == 0);
}

static void use_file_device(const char *file)
{
	char text[400];

	snprintf(text, sizeof(text),
		 "pcm.nothing { type null }\n"
		 "pcm.!default { type file slave.pcm \"nothing\" file \"%s/%s\" format \"raw\" }\n",
		 folder, file);
	use_device(text);
}

static void read_recorded(struct buffer *out, const char *file)
{
	char path[100];

	snprintf(path, sizeof(path), "%s/%s", folder, file);
	buffer_init(out, 64 << 20);
	CHECK(buffer_read_file(out, path) == 0);
}

static void start(struct speaker *speaker, const char *file)
{
	struct buffer opus;

	buffer_init(&opus, 1 << 20);
	CHECK(buffer_read_file(&opus, file) == 0);
	CHECK(speaker_start(speaker, buffer_bytes(&opus)) == 0);
	buffer_finish(&opus);
}

static void wait_ms(int ms)
{
	const struct timespec pause = { ms / 1000, ms % 1000 * 1000000L };

	nanosleep(&pause, NULL);
}

/* Waits up to 20 s until it has come so far, or no longer speaks. */
static struct speaker_state wait_for(struct speaker *speaker, uint32_t at_ms)
{
	struct speaker_state state = speaker_state(speaker);

	for (int n = 0; n < 1000 && state.speaks && state.at_ms < at_ms; n++) {
		wait_ms(20);
		state = speaker_state(speaker);
	}
	return state;
}

static uint64_t loudness_of(const struct buffer *sound)
{
	uint64_t sum = 0;

	for (size_t at = 0; at + 1 < sound->size; at += 2) {
		int16_t sample;

		memcpy(&sample, sound->data + at, 2);
		sum += (uint64_t)abs(sample);
	}
	return sum / (sound->size / 2 + 1);
}

static void plays_in_its_own_time_and_stops(void **state)
{
	struct speaker *speaker;
	struct buffer sound;

	(void)state;
	use_file_device("heard");
	CHECK(speaker_create(&speaker, 100) == 0);
	CHECK(!speaker_state(speaker).speaks);
	start(speaker, recording);
	CHECK(wait_for(speaker, 600).at_ms >= 600);
	CHECK(speaker_state(speaker).speaks);
	speaker_stop(speaker);
	CHECK(!speaker_state(speaker).speaks && !speaker_state(speaker).failed);
	speaker_destroy(speaker);
	read_recorded(&sound, "heard");
	/* 48 000 x 2 x 2 bytes a second: all of 22 s would be 4.3 MB. */
	CHECK(sound.size > 48 * 4 * 600 && sound.size < 2 << 20);
	CHECK(loudness_of(&sound) > 100);
	buffer_finish(&sound);
}

static void another_text_takes_its_place(void **state)
{
	struct speaker *speaker;

	(void)state;
	use_file_device("two");
	CHECK(speaker_create(&speaker, 50) == 0);
	start(speaker, recording);
	CHECK(wait_for(speaker, 800).at_ms >= 800);
	start(speaker, "demo/content/pages/central-tower.fr.opus");
	CHECK(speaker_state(speaker).at_ms == 0 && speaker_state(speaker).speaks);
	CHECK(wait_for(speaker, 100).speaks);
	speaker_stop(speaker);
	start(speaker, recording); /* at once after a stop */
	CHECK(wait_for(speaker, 100).speaks);
	speaker_destroy(speaker); /* while it speaks */
}

static void half_the_number_is_a_quarter_of_the_samples(void **state)
{
	uint64_t loud[2];

	(void)state;
	for (int n = 0; n < 2; n++) {
		struct speaker *speaker;
		struct buffer sound;

		use_file_device("loud");
		CHECK(speaker_create(&speaker, n == 0 ? 100 : 50) == 0);
		start(speaker, recording);
		CHECK(wait_for(speaker, 1000).at_ms >= 1000);
		speaker_destroy(speaker);
		read_recorded(&sound, "loud");
		sound.size = 48 * 4 * 1000;
		loud[n] = loudness_of(&sound);
		buffer_finish(&sound);
	}
	CHECK(loud[0] > 3 * loud[1] && loud[0] < 5 * loud[1]);
}

static void tells_of_a_device_that_is_not_there(void **state)
{
	struct speaker *speaker;

	(void)state;
	use_device("pcm.!default { type hw card 31 }\n");
	CHECK(speaker_create(&speaker, 100) == 0);
	start(speaker, recording);
	CHECK(wait_for(speaker, UINT32_MAX).failed);
	CHECK(!speaker_state(speaker).speaks);
	use_file_device("later");
	start(speaker, recording); /* it was plugged in */
	CHECK(!speaker_state(speaker).failed);
	CHECK(wait_for(speaker, 100).speaks);
	speaker_destroy(speaker);
}

static void ends_by_itself(void **state)
{
	struct speaker *speaker;
	struct buffer opus, sound;

	(void)state;
	use_file_device("end");
	CHECK(speaker_create(&speaker, 100) == 0);
	buffer_init(&opus, 1 << 20);
	CHECK(buffer_read_file(&opus, recording) == 0);
	CHECK(speaker_start(speaker, (struct bytes){ opus.data, 6000 }) == 0); /* two seconds */
	buffer_finish(&opus);
	CHECK(!wait_for(speaker, UINT32_MAX).speaks);
	CHECK(!speaker_state(speaker).failed);
	speaker_destroy(speaker);
	read_recorded(&sound, "end");
	CHECK(sound.size > 48 * 4 * 1000 && sound.size < 48 * 4 * 4000);
	buffer_finish(&sound);
}

static void tells_of_a_text_that_is_none(void **state)
{
	struct speaker *speaker;

	(void)state;
	use_file_device("none");
	CHECK(speaker_create(&speaker, 100) == 0);
	CHECK(speaker_start(speaker, (struct bytes){ (const uint8_t *)"OggS", 4 }) == 0);
	CHECK(wait_for(speaker, UINT32_MAX).failed);
	speaker_destroy(speaker);
}

static int set_up(void **state)
{
	(void)state;
	snprintf(folder, sizeof(folder), "/tmp/gopura-sound-XXXXXX");
	return mkdtemp(folder) ? 0 : -1;
}

static int tear_down(void **state)
{
	char command[100];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	return system(command);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(plays_in_its_own_time_and_stops),
		cmocka_unit_test(another_text_takes_its_place),
		cmocka_unit_test(half_the_number_is_a_quarter_of_the_samples),
		cmocka_unit_test(tells_of_a_device_that_is_not_there),
		cmocka_unit_test(ends_by_itself),
		cmocka_unit_test(tells_of_a_text_that_is_none),
	};

	return cmocka_run_group_tests(tests, set_up, tear_down);
}
