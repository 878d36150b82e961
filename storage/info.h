/* The information database of a release: which parts of the model are identified, what is known
 * about each, in which languages. docs/information.md has the tables, which are the three of
 * Okamoto et al. ("identified part", "assigned information", "information contents").
 *
 * This is the reader, in the kiosk; pipeline/content/info_build.h writes the database. Pictures are
 * not inside: the database names them by the hash of their file's bytes, and they travel as objects
 * of their own, so that changing a caption does not send them again. */
#ifndef GOPURA_STORAGE_INFO_H
#define GOPURA_STORAGE_INFO_H

#include "base/bytes.h"
#include "format/hash.h"
#include "geometry/region.h"

enum {
	INFO_LANGUAGES_MAX = 64,
	INFO_PARTS_MAX = 1000,
	INFO_PAGE_BYTES_MAX = 256 << 10, /* one HTML page; what ui/html.h takes */
	INFO_PAGE_PICTURES_MAX = 64,
	INFO_TOURS_MAX = 8,
	INFO_STOPS_MAX = 64, /* of a tour */
};

/* Ways of looking that the content gives visitors, a bit each: docs/tools.md. */
enum info_tool { INFO_TOOL_LIGHT = 1, INFO_TOOL_SECTION = 2 };
/* "light" or "section"; 0: neither. */
unsigned info_tool_named(const char *name, size_t length);

/* One thread. */
struct info;

struct info_part {
	const char *id;
	struct region region; /* a list of faces: a point with their radius; the surface is in the
				 labels */
	float anchor_m[3];    /* where the leader line ends */
	bool has_page;        /* in some language */
};

/* Texts in the language asked for; where that has none in one of its kind ("pt" for "pt-BR"), else
 * in the first of the release's languages that has one. All
 * UTF-8 and borrowed until info_close. caption and thumbnail may be "". */
struct info_text {
	const char *language; /* that was found */
	const char *title, *caption;
	const char *thumbnail; /* a picture's name */
};

struct info_picture {
	const char *name; /* as pages write it: "pictures/gate.jpg" */
	struct hash hash;
	uint32_t width_px, height_px;
};

/* image is copied. *out is owned by the caller; on failure it is NULL. -EBADMSG: not such a
 * database, damaged, or of a version of the schema that this program does not read. Older versions
 * are read as they are; what they lack is made in memory beside them. */
must_check int info_open(struct info **out, struct bytes image);
void info_close(struct info *info); /* NULL is fine */

/* In the order of parts.json, which is the order of importance. Borrowed until info_close. */
uint32_t info_part_count(const struct info *info);
const struct info_part *info_part(const struct info *info, uint32_t part);
/* The part's index, or -ENOENT. */
int info_find(const struct info *info, const char *id);

/* The release's languages, the default first. */
uint32_t info_language_count(const struct info *info);
const char *info_language(const struct info *info, uint32_t index);
/* Of these the one asked for, or what stands in for it. */
const char *info_nearest_language(const struct info *info, const char *language);

struct info_text info_text(const struct info *info, uint32_t part, const char *language);

/* The part's page: *html is borrowed until the next info_page or info_close, *language (may be
 * NULL) says which language was found. -ENOENT: the part has no page. -EBADMSG: damaged. */
must_check int info_page(struct info *info, uint32_t part, const char *language, struct bytes *html,
			 const char **language_found);

/* Who made what is said of the part, when, after what, and whose it is: one line of text, "" where
 * nothing is known. Borrowed until the next info_credits or info_close. */
const char *info_credits(struct info *info, uint32_t part, const char *language);

/* Parts in which every word of query stands, the last letters of each may be missing: first where
 * it stands in that language, of these in titles before captions before pages. How many were
 * written to parts, `most` at most; 0 for a query without words. */
uint32_t info_search(struct info *info, const char *query, const char *language, uint32_t *parts,
		     uint32_t most);

/* What the content switched on, of enum info_tool; what this program does not know is left out. */
unsigned info_tools(const struct info *info);

/* ---- guided tours: docs/tours.md ---- */

struct info_stop {
	float eye_m[3], target_m[3];
	float stay_s, travel_s; /* 0: none, it is only on the way; 0: by the distance */
	int part;               /* that is lit, or -1 */
};

struct info_tour {
	const char *id;
	bool attract; /* flown round while nobody is there; its way is closed */
	uint32_t stop_count;
	struct info_stop stops[INFO_STOPS_MAX];
};

/* None in images before version 3. Borrowed until info_close; texts as info_text gives them. */
uint32_t info_tour_count(const struct info *info);
const struct info_tour *info_tour(const struct info *info, uint32_t tour);
int info_find_tour(const struct info *info, const char *id); /* or -ENOENT */
struct info_text info_tour_text(const struct info *info, uint32_t tour, const char *language);
/* What is said at a stop; "": nothing. */
const char *info_stop_caption(const struct info *info, uint32_t tour, uint32_t stop,
			      const char *language);

/* Every picture of the database, sorted by name. Borrowed until info_close. */
uint32_t info_picture_count(const struct info *info);
const struct info_picture *info_picture(const struct info *info, uint32_t index);
/* NULL: no such picture. */
const struct info_picture *info_find_picture(const struct info *info, const char *name);

#endif
