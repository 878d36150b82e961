/* Spoken texts of the information database: docs/sound.md. */
#ifndef GOPURA_STORAGE_INFO_SPOKEN_H
#define GOPURA_STORAGE_INFO_SPOKEN_H

#include "storage/info.h"

enum {
	INFO_SPOKEN_MS_MAX = 600000, /* the longest text */
	INFO_SPOKEN_BYTES_MAX = 8 << 20,
	INFO_CUES_MAX = 1000,
	INFO_CUE_BYTES_MAX = 500,
};

/* Words that are shown from begin_ms to end_ms. */
struct info_cue {
	uint32_t begin_ms, end_ms;
	char *text; /* UTF-8, one line */
};

struct info_spoken {
	struct hash hash; /* of the file, which is an object of the release: Opus in Ogg */
	uint32_t bytes, duration_ms;
	const struct info_cue *cues; /* in the order of their beginnings */
	uint32_t cue_count;          /* 0: the words are not known */
};

/* Finds the spoken text of the page that info_page shows in that language. *out is borrowed until
 * the next call or info_close. Returns -ENOENT if the page has none, -EBADMSG if the database is
 * damaged, or -ENOMEM. */
must_check int info_spoken(struct info *info, uint32_t part, const char *language,
			   struct info_spoken *out);

/* For opening: notes whether there is a table of spoken texts, which may exist in any version. */
must_check int info_load_spoken(struct info *info);
/* For closing: frees what the last info_spoken returned. */
void info_drop_spoken(struct info *info);

#endif
