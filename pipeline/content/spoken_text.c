/* libopusfile decides what is Ogg Opus: the file is decoded to its end, so that a terminal finds no
 * fault in it. */
#include "pipeline/content/spoken_text.h"

#include <errno.h>
#include <limits.h>
#include <opusfile.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { RATE_HZ = 48000, CHANNELS_MAX = 2, PCM_SAMPLES = 5760 * CHANNELS_MAX };

static void name_file(const struct draft *draft, const struct draft_part *part, uint32_t language,
		      const char *ending, char file[DRAFT_SPOKEN_NAME_BYTES])
{
	snprintf(file, DRAFT_SPOKEN_NAME_BYTES, "pages/%.64s.%.16s.%s", part->id,
		 draft->options->languages[language], ending);
}

/* Returns 0 with the bytes; -ENOENT: no such file; -EINVAL after a diagnostic; -ENOMEM. */
static int read_file(struct draft *draft, const char *file, uint32_t bytes_max,
		     struct buffer *bytes)
{
	struct stat status;
	char path[PATH_MAX];
	int rc = -ENAMETOOLONG;

	buffer_init(bytes, bytes_max);
	if (draft_path(draft, path, sizeof(path), file)) {
		if (lstat(path, &status) < 0)
			rc = -errno;
		else
			rc = S_ISREG(status.st_mode) ? buffer_read_file(bytes, path) : -ELOOP;
	}
	if (rc == 0 || rc == -ENOENT || rc == -ENOMEM)
		return rc;
	if (rc == -ELOOP)
		diagnostics_add(draft->diagnostics, -EINVAL, file, 0,
				"is a link or not a regular file: put the file itself there");
	else if (rc == -EFBIG)
		diagnostics_add(draft->diagnostics, -EINVAL, file, 0,
				"is larger than %u KB: make it shorter, or encode it with less",
				bytes_max >> 10);
	else
		diagnostics_add(draft->diagnostics, -EINVAL, file, 0, "cannot be read: %s",
				strerror(-rc));
	return -EINVAL;
}

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

/* Returns the length in milliseconds, 0: the file is not good. */
static uint32_t measure(struct draft *draft, const char *file, struct bytes bytes)
{
	int error;
	OggOpusFile *opus = op_open_memory(bytes.data, bytes.size, &error);
	const int64_t samples = opus ? decode(opus) : -1, ms = samples * 1000 / RATE_HZ;
	/* Every sample of a complete file is there: the last page says how many it has. */
	const bool is_whole = opus && op_pcm_total(opus, -1) == samples && has_end(bytes);

	op_free(opus);
	if (ms > INFO_SPOKEN_MS_MAX) {
		diagnostics_add(draft->diagnostics, -EINVAL, file, 0,
				"is longer than ten minutes: divide the text");
		return 0;
	}
	if (!is_whole || ms == 0) {
		diagnostics_add(draft->diagnostics, -EINVAL, file, 0,
				"is not a complete Ogg Opus file with one or two channels: encode "
				"it with 'opusenc --bitrate 24'");
		return 0;
	}
	return (uint32_t)ms;
}

static int read_sound(struct draft *draft, struct draft_spoken *spoken)
{
	struct buffer bytes;
	int rc = read_file(draft, spoken->name, INFO_SPOKEN_BYTES_MAX, &bytes);

	if (rc == 0) {
		spoken->duration_ms = measure(draft, spoken->name, buffer_bytes(&bytes));
		spoken->hash = hash_of(buffer_bytes(&bytes));
		spoken->size = (uint32_t)bytes.size;
		rc = spoken->duration_ms > 0 ? 0 : -EINVAL;
	}
	buffer_finish(&bytes);
	return rc;
}

/* The words, if there are any. */
static int read_words(struct draft *draft, struct draft_spoken *spoken, const char *file)
{
	struct buffer text;
	int rc = read_file(draft, file, CUES_FILE_BYTES_MAX, &text);

	if (rc == 0)
		rc = cues_read(&spoken->cues, buffer_bytes(&text), file, draft->diagnostics);
	buffer_finish(&text);
	if (rc == 0 && spoken->cues.count > 0 &&
	    spoken->cues.all[spoken->cues.count - 1].begin_ms >= spoken->duration_ms)
		diagnostics_add(draft->diagnostics, -EINVAL, file, 0,
				"its last words begin after the end of %s: is it of another "
				"recording?",
				spoken->name);
	return rc;
}

int spoken_text_read(struct draft *draft, struct draft_part *part, uint32_t language)
{
	struct draft_spoken *spoken = &part->pages[language].spoken;
	char words[DRAFT_SPOKEN_NAME_BYTES], page[DRAFT_SPOKEN_NAME_BYTES];
	int rc;

	name_file(draft, part, language, "opus", spoken->name);
	name_file(draft, part, language, "vtt", words);
	name_file(draft, part, language, "html", page);
	rc = read_sound(draft, spoken);
	if (rc == 0 && !part->pages[language].html)
		diagnostics_add(draft->diagnostics, -EINVAL, spoken->name, 0,
				"is the spoken text of a page that is not there: write %s", page);
	if (rc == 0)
		rc = read_words(draft, spoken, words);
	if (rc == -ENOMEM)
		return rc;
	return 0; /* missing, or told */
}
