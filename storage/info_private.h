/* Private to storage: what the sources of an open information database share. */
#ifndef GOPURA_STORAGE_INFO_PRIVATE_H
#define GOPURA_STORAGE_INFO_PRIVATE_H

#include <sqlite3.h>

#include "storage/info.h"

enum {
	INFO_CALLS_MAX = 100000, /* 10^8 steps of SQLite's machine while opening */
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

struct tour {
	struct info_tour public;                                         /* id owned */
	uint32_t thumbnail;                                              /* as a part's */
	char *titles[INFO_LANGUAGES_MAX], *captions[INFO_LANGUAGES_MAX]; /* owned or NULL */
	char *stop_captions[INFO_STOPS_MAX][INFO_LANGUAGES_MAX];         /* the same */
};

struct info {
	sqlite3 *db;
	sqlite3_stmt *page;    /* steps on the row that the last info_page gave */
	struct buffer credits; /* what the last info_credits gave */
	uint32_t calls, calls_most;
	struct info_hit *contents; /* by id; made by the first search */
	uint32_t content_count;
	char *languages[INFO_LANGUAGES_MAX];
	uint32_t language_count;
	struct part *parts;
	uint32_t part_count;
	struct tour *tours;
	uint32_t tour_count;
	unsigned tools;
	bool has_tools;
	struct info_picture *pictures; /* names owned */
	uint32_t picture_count;
};

/* 0, -ENOMEM or -EBADMSG, logged. */
must_check int info_from_sqlite(sqlite3 *db, int code, const char *doing);
/* Of an image that is not trusted. */
typedef int info_row_reader(struct info *info, sqlite3_stmt *row);
must_check int info_each_row(struct info *info, const char *sql, info_row_reader *read);
/* A copy of a text column; NULL stays NULL. Zero bytes inside and what is not UTF-8 are refused. */
must_check int info_copy_text(sqlite3_stmt *row, int column, char **out);
must_check int info_read_floats(sqlite3_stmt *row, int column, float *out, int count);
/* info_tools.c: an image has such a table or not, of any version. */
must_check int info_load_tools(struct info *info);
/* info_tour.c: after parts and pictures. */
must_check int info_load_tours(struct info *info);
void info_drop_tours(struct info *info);
/* All languages, in the order in which they stand in for one another: the one asked for, those of
 * its kind ("pt" for "pt-BR", and the other way round), then as the release has them. */
struct info_order {
	uint32_t languages[INFO_LANGUAGES_MAX], count;
};
struct info_order info_order_of(const struct info *info, const char *language);
/* The first that has a text; NULL: none has. found may be NULL. */
const char *info_first_of(const struct info_order *order, char *const *texts, uint32_t *found);
/* The one asked for, or what stands in for it. */
uint32_t info_language_index(const struct info *info, const char *language);

#endif
