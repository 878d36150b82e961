/* One thread, one text at a time. The thread looks for orders after every 20 ms of sound, and waits
 * for the device never longer than that. */
#include "sound/speaker.h"

#include <alsa/asoundlib.h>
#include <errno.h>
#include <opusfile.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/log.h"
#include "sound/mixer.h"

enum {
	RATE_HZ = 48000, /* of all Opus */
	CHANNELS = 2,
	PIECE_FRAMES = RATE_HZ / 50,
	WAIT_MS = 20,
	LATENCY_US = 200000,
	AHEAD_MS = 400,  /* at most so much is given to the device before it is due */
	STUCK_MS = 3000, /* a device that takes nothing for so long is broken */
};

struct speaker {
	uint32_t loudness;
	pthread_t thread;
	bool has_thread; /* of the caller's thread alone */

	pthread_mutex_t lock;
	pthread_cond_t changed;
	/* Under the lock. */
	bool ending, stopped;
	struct buffer next; /* a text that waits */
	bool has_next;
	struct speaker_state state;
};

/* A text on its way to the device; of the thread alone. */
struct speech {
	struct speaker *speaker;
	struct buffer text;
	OggOpusFile *opus;
	snd_pcm_t *device;
	int64_t begun_ms, taken_ms; /* when it began; when the device last took something */
	uint64_t written;           /* frames */
	opus_int16 pcm[PIECE_FRAMES * CHANNELS];
};

/* ---- orders */

static bool is_wanted(struct speaker *speaker)
{
	bool wanted;

	pthread_mutex_lock(&speaker->lock);
	wanted = !speaker->ending && !speaker->stopped && !speaker->has_next;
	pthread_mutex_unlock(&speaker->lock);
	return wanted;
}

static void note_place(struct speaker *speaker, uint32_t at_ms)
{
	pthread_mutex_lock(&speaker->lock);
	if (!speaker->stopped && !speaker->has_next)
		speaker->state.at_ms = at_ms;
	pthread_mutex_unlock(&speaker->lock);
}

static void note_end(struct speaker *speaker, int rc)
{
	pthread_mutex_lock(&speaker->lock);
	if (!speaker->has_next) {
		speaker->state.speaks = false;
		speaker->state.failed = rc < 0;
	}
	pthread_mutex_unlock(&speaker->lock);
}

/* ---- the device */

static int device_failed(int code, const char *doing)
{
	log_warn("sound", "board bug: the sound device cannot %s: %s", doing, snd_strerror(code));
	return -EIO;
}

static int open_device(struct speech *speech)
{
	int code =
		snd_pcm_open(&speech->device, "default", SND_PCM_STREAM_PLAYBACK, SND_PCM_NONBLOCK);

	if (code < 0) {
		speech->device = NULL;
		return device_failed(code, "be opened");
	}
	mixer_open_up();
	code = snd_pcm_set_params(speech->device, SND_PCM_FORMAT_S16, SND_PCM_ACCESS_RW_INTERLEAVED,
				  CHANNELS, RATE_HZ, 1, LATENCY_US);
	return code < 0 ? device_failed(code, "be set up") : 0;
}

static void rest(void)
{
	const struct timespec pause = { 0, WAIT_MS * 1000000L };

	nanosleep(&pause, NULL);
}

/* Tells what is heard now: what was written less what waits in the device. */
static void tell_place(struct speech *speech)
{
	snd_pcm_sframes_t waiting = 0;

	if (snd_pcm_delay(speech->device, &waiting) < 0 || waiting < 0 ||
	    (uint64_t)waiting > speech->written)
		waiting = 0;
	note_place(speech->speaker,
		   (uint32_t)((speech->written - (uint64_t)waiting) * 1000 / RATE_HZ));
}

/* A device may take everything at once, as one that writes a file does. */
static bool is_ahead(const struct speech *speech)
{
	return (int64_t)(speech->written * 1000 / RATE_HZ) >
	       clock_now_ms() - speech->begun_ms + AHEAD_MS;
}

/* Writes a piece whole, or until the speech is not wanted any more. */
static int write_piece(struct speech *speech, const opus_int16 *pcm, snd_pcm_uframes_t frames)
{
	while (frames > 0 && is_wanted(speech->speaker)) {
		snd_pcm_sframes_t taken =
			is_ahead(speech) ? 0 : snd_pcm_writei(speech->device, pcm, frames);

		if (taken == -EAGAIN)
			taken = 0;
		if (taken < 0)
			taken = snd_pcm_recover(speech->device, (int)taken, 1); /* 0, or failed */
		if (taken < 0)
			return device_failed((int)taken, "play");
		if (taken > 0)
			speech->taken_ms = clock_now_ms();
		else if (clock_now_ms() - speech->taken_ms > STUCK_MS)
			return device_failed(-ETIMEDOUT, "play");
		else
			rest();
		speech->written += (uint64_t)taken;
		pcm += CHANNELS * taken;
		frames -= (snd_pcm_uframes_t)taken;
		tell_place(speech);
	}
	return 0;
}

/* ---- a speech */

/* Half as loud to the ear is a tenth of the power, so samples go with the square of the number. */
static void set_loudness(const struct speech *speech, opus_int16 *pcm, int count)
{
	const int32_t share = (int32_t)(speech->speaker->loudness * speech->speaker->loudness);

	for (int n = 0; n < count; n++)
		pcm[n] = (opus_int16)(pcm[n] * share /
				      (SPEAKER_LOUDNESS_MAX * SPEAKER_LOUDNESS_MAX));
}

static int play(struct speech *speech)
{
	int rc = 0, frames = 1;

	while (rc == 0 && frames != 0 && is_wanted(speech->speaker)) {
		frames = op_read_stereo(speech->opus, speech->pcm, PIECE_FRAMES * CHANNELS);
		if (frames == OP_HOLE)
			continue; /* a part is missing, and it goes on behind that */
		if (frames < 0) {
			log_error("sound", "content bug: a spoken text is damaged");
			return -EBADMSG;
		}
		set_loudness(speech, speech->pcm, frames * CHANNELS);
		rc = write_piece(speech, speech->pcm, (snd_pcm_uframes_t)frames);
	}
	return rc;
}

/* Waits until the device has played all of it. */
static void play_out(struct speech *speech)
{
	const uint64_t whole_ms = speech->written * 1000 / RATE_HZ;
	const int64_t until_ms = clock_now_ms() + 2 * LATENCY_US / 1000 + AHEAD_MS;
	snd_pcm_sframes_t waiting = 0;

	while (is_wanted(speech->speaker) && clock_now_ms() < until_ms &&
	       (clock_now_ms() - speech->begun_ms < (int64_t)whole_ms ||
		(snd_pcm_delay(speech->device, &waiting) == 0 && waiting > 0))) {
		tell_place(speech);
		rest();
	}
}

static int speak(struct speech *speech)
{
	int rc;

	speech->opus = op_open_memory(speech->text.data, speech->text.size, &rc);
	if (!speech->opus) {
		if (rc == OP_EFAULT)
			return -ENOMEM;
		log_error("sound", "content bug: a spoken text is not Opus");
		return -EBADMSG;
	}
	rc = open_device(speech);
	speech->begun_ms = speech->taken_ms = clock_now_ms();
	if (rc == 0)
		rc = play(speech);
	if (rc == 0)
		play_out(speech);
	return rc;
}

static void finish(struct speech *speech)
{
	op_free(speech->opus);
	if (speech->device) {
		snd_pcm_drop(speech->device); /* what is left is not played */
		snd_pcm_close(speech->device);
	}
	buffer_finish(&speech->text);
}

/* ---- the thread */

/* Waits for a text and takes it. Returns false when the speaker ends. */
static bool take(struct speaker *speaker, struct buffer *text)
{
	bool has;

	pthread_mutex_lock(&speaker->lock);
	while (!speaker->ending && !speaker->has_next)
		pthread_cond_wait(&speaker->changed, &speaker->lock);
	has = !speaker->ending;
	if (has) {
		*text = speaker->next;
		speaker->next = (struct buffer){ 0 };
		speaker->has_next = speaker->stopped = false;
	}
	pthread_mutex_unlock(&speaker->lock);
	return has;
}

static void *work(void *user)
{
	struct speaker *speaker = user;
	struct speech speech = { .speaker = speaker };

	while (take(speaker, &speech.text)) {
		note_end(speaker, speak(&speech));
		finish(&speech);
		speech = (struct speech){ .speaker = speaker };
	}
	return NULL;
}

int speaker_create(struct speaker **out, uint32_t loudness)
{
	struct speaker *speaker = calloc(1, sizeof(*speaker));

	*out = speaker;
	if (!speaker)
		return -ENOMEM;
	speaker->loudness = loudness;
	pthread_mutex_init(&speaker->lock, NULL);
	pthread_cond_init(&speaker->changed, NULL);
	return 0;
}

void speaker_destroy(struct speaker *speaker)
{
	if (!speaker)
		return;
	pthread_mutex_lock(&speaker->lock);
	speaker->ending = true;
	pthread_cond_signal(&speaker->changed);
	pthread_mutex_unlock(&speaker->lock);
	if (speaker->has_thread)
		pthread_join(speaker->thread, NULL);
	buffer_finish(&speaker->next);
	pthread_cond_destroy(&speaker->changed);
	pthread_mutex_destroy(&speaker->lock);
	free(speaker);
}

int speaker_start(struct speaker *speaker, struct bytes opus)
{
	struct buffer text;
	int rc = 0;

	buffer_init(&text, opus.size);
	buffer_put(&text, opus.data, opus.size);
	if (text.error)
		return text.error;
	if (!speaker->has_thread) {
		rc = -pthread_create(&speaker->thread, NULL, work, speaker);
		if (rc < 0) {
			buffer_finish(&text);
			return rc;
		}
		speaker->has_thread = true;
	}
	pthread_mutex_lock(&speaker->lock);
	buffer_finish(&speaker->next);
	speaker->next = text;
	speaker->has_next = true;
	speaker->state = (struct speaker_state){ .speaks = true };
	pthread_cond_signal(&speaker->changed);
	pthread_mutex_unlock(&speaker->lock);
	return 0;
}

void speaker_stop(struct speaker *speaker)
{
	pthread_mutex_lock(&speaker->lock);
	speaker->stopped = true;
	speaker->has_next = false;
	buffer_finish(&speaker->next);
	speaker->next = (struct buffer){ 0 };
	speaker->state = (struct speaker_state){ 0 };
	pthread_mutex_unlock(&speaker->lock);
}

struct speaker_state speaker_state(struct speaker *speaker)
{
	struct speaker_state state = { 0 };

	if (!speaker)
		return state;
	pthread_mutex_lock(&speaker->lock);
	state = speaker->state;
	pthread_mutex_unlock(&speaker->lock);
	return state;
}
