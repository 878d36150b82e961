/* What the sources of an open information database share. Private to storage. */
#ifndef GOPURA_STORAGE_INFO_PRIVATE_H
#define GOPURA_STORAGE_INFO_PRIVATE_H

#include <sqlite3.h>

#include "storage/info.h"
#include "storage/info_spoken.h"
#include "storage/info_tour.h"

enum {
	INFO_CALLS_MAX = 100000, /* 10^8 steps of SQLite's virtual machine while opening */
	INFO_CREDITS_BYTES_MAX = 8 << 10,
};

/* A row of information_contents. */
struct info_hit {
	int64_t content_id;
	uint32_t part, language;
};

struct text {
	char *title, *caption; /* owned or NULL */
	bool has_page;
	int64_t content_id;
};

struct part {
	struct info_part public; /* id owned */
	uint32_t thumbnail;      /* picture index + 1; 0: none */
	struct text texts[INFO_LANGUAGES_MAX];
};

struct tour_row {
	struct info_tour public;                                         /* id owned */
	uint32_t thumbnail;                                              /* as in struct part */
	char *titles[INFO_LANGUAGES_MAX], *captions[INFO_LANGUAGES_MAX]; /* owned or NULL */
	char *stop_captions[INFO_STOPS_MAX][INFO_LANGUAGES_MAX];         /* likewise */
};

struct info {
	sqlite3 *db;
	int version;           /* of the image's schema */
	sqlite3_stmt *page;    /* stands on the row that the last info_page returned */
	struct buffer plain;   /* its article, if the image has it as HTML */
	struct buffer credits; /* the result of the last info_credits */
	uint32_t calls, calls_most;
	struct info_hit *contents; /* sorted by id; made by the first search */
	uint32_t content_count;
	char *languages[INFO_LANGUAGES_MAX];
	uint32_t language_count;
	struct part *parts;
	uint32_t part_count, part_room;
	struct tour_row *tours;
	uint32_t tour_count, tour_room;
	unsigned tools;
	float scan_error_m;
	bool has_tools, has_spoken, has_even_legs;
	struct info_spoken spoken; /* what info_spoken found last, of spoken_of; bytes 0: nothing */
	int64_t spoken_of;         /* a content_id */
	struct info_cue *cues;     /* of spoken; owned */
	uint32_t cue_count;
	struct info_picture *pictures; /* names owned */
	uint32_t picture_count, picture_room;
};

#endif
