/* Finds a page's recording and its words, and judges them. */
#include "pipeline/content/spoken_text.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "pipeline/content/spoken_sound.h"

static void name_file(const struct draft *draft, const struct draft_part *part, uint32_t language,
		      const char *ending, char file[DRAFT_PAGE_NAME_BYTES])
{
	snprintf(file, DRAFT_PAGE_NAME_BYTES, "pages/%.64s.%.16s.%s", part->id,
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
		if (lstat(path, &status) == 0 && !S_ISREG(status.st_mode))
			rc = -ELOOP;
		else
			rc = draft_read_text(draft, file, bytes);
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

/* Returns the length in milliseconds, 0: the file is not good. */
static uint32_t measure(struct draft *draft, const char *file, struct bytes bytes)
{
	uint32_t duration_ms;
	int rc = spoken_sound_measure(bytes, draft->options->skims_pictures, &duration_ms);

	if (rc == -EFBIG)
		diagnostics_add(draft->diagnostics, -EINVAL, file, 0,
				"is longer than ten minutes: divide the text");
	else if (rc == -ENOMEM)
		diagnostics_add(draft->diagnostics, rc, file, 0,
				"cannot be read: no memory is left");
	else if (rc < 0)
		diagnostics_add(draft->diagnostics, -EINVAL, file, 0,
				"is not a complete Ogg Opus file with one or two channels: encode "
				"it with 'opusenc --bitrate 24'");
	return duration_ms;
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
	char words[DRAFT_PAGE_NAME_BYTES], page[DRAFT_PAGE_NAME_BYTES];
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
