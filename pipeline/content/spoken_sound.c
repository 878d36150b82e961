/* libopusfile decides what is Ogg Opus. */
#include "pipeline/content/spoken_sound.h"

#include <errno.h>
#include <opusfile.h>
#include <string.h>

#include "storage/info_spoken.h"

enum { RATE_HZ = 48000, CHANNELS_MAX = 2, PCM_SAMPLES = 5760 * CHANNELS_MAX };

/* Decodes everything. Returns the number of samples of a channel, or negative. */
static int64_t decode(OggOpusFile *opus)
{
	opus_int16 pcm[PCM_SAMPLES];
	int64_t samples = 0;
	int link = -1, got;

	while ((got = op_read(opus, pcm, PCM_SAMPLES, &link)) > 0) {
		if (op_channel_count(opus, link) > CHANNELS_MAX)
			return -1;
		samples += got;
		if (samples > (int64_t)RATE_HZ / 1000 * INFO_SPOKEN_MS_MAX)
			return samples;
	}
	return got < 0 ? -1 : samples;
}

/* Whether the last page of Ogg ends the file and its stream: decoding does not miss pages that were
 * cut off. */
static bool has_end(struct bytes bytes)
{
	enum { HEAD_BYTES = 27, FLAGS_AT = 5, SEGMENTS_AT = 26, LAST_PAGE = 4 };

	for (size_t at = bytes.size; at-- > 0;) {
		const uint8_t *page = bytes.data + at;
		size_t size = HEAD_BYTES;

		if (bytes.size - at < HEAD_BYTES || memcmp(page, "OggS", 4) != 0)
			continue;
		if (bytes.size - at < size + page[SEGMENTS_AT])
			return false;
		for (unsigned n = 0; n < page[SEGMENTS_AT]; n++)
			size += 1 + page[HEAD_BYTES + n];
		return size == bytes.size - at && page[FLAGS_AT] & LAST_PAGE;
	}
	return false;
}

int spoken_sound_measure(struct bytes file, bool skims, uint32_t *duration_ms)
{
	int error;
	OggOpusFile *opus = op_open_memory(file.data, file.size, &error);
	const int64_t total = opus ? op_pcm_total(opus, -1) : -1;
	const int64_t samples = !opus || skims ? total : decode(opus),
		      ms = samples * 1000 / RATE_HZ;
	/* Every sample of a complete file is there: the last page says how many it has. */
	const bool is_whole = opus && total == samples && has_end(file);

	op_free(opus);
	*duration_ms = 0;
	if (error == OP_EFAULT)
		return -ENOMEM;
	if (ms > INFO_SPOKEN_MS_MAX)
		return -EFBIG;
	if (!is_whole || ms <= 0)
		return -EBADMSG;
	*duration_ms = (uint32_t)ms;
	return 0;
}
