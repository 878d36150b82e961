/* A content folder's parts, pages, tours and pictures in memory, as info_build reads and checks
 * them before anything is written. Private to pipeline/content. */
#ifndef GOPURA_PIPELINE_CONTENT_DRAFT_H
#define GOPURA_PIPELINE_CONTENT_DRAFT_H

#include "base/json_text.h"
#include "pipeline/content/cues.h"
#include "pipeline/content/info_build.h"
#include "storage/info_tour.h"

struct cJSON;

enum { INFO_ID_BYTES_MAX = 64, INFO_PARTS_FILE_BYTES_MAX = 16 << 20 };

/* Coordinates and lengths beyond are mistakes. What is computed from those within, such as a view
 * of a part, is a finite float, as terminals require. */
#define DRAFT_FAR_M 1e9

enum { DRAFT_PAGE_NAME_BYTES = INFO_ID_BYTES_MAX + 40 }; /* "pages/ID.LANGUAGE.html" and the like */

/* The spoken text of a page. */
struct draft_spoken {
	char name[DRAFT_PAGE_NAME_BYTES]; /* of the file, in the folder */
	struct hash hash;
	uint32_t size, duration_ms; /* 0: there is none */
	struct cues cues;
};

struct draft_page {
	char *html; /* owned, null-terminated; NULL: the part has no page of its own */
	size_t size;
	bool is_there;         /* it has one, or further documents */
	struct buffer article; /* made of html and of these; empty if one has a fault */
	uint32_t *pictures;    /* owned; indices into draft.pictures, in order of use, each once */
	uint32_t picture_count, picture_room;
	struct draft_spoken spoken;
};

/* One Dublin Core statement. */
struct draft_credit {
	const char *element; /* borrowed from a constant table */
	int language;        /* index into the release's languages; -1: no language */
	char *value;         /* owned */
};

enum { DRAFT_CREDITS_MAX = 64, DRAFT_DOCUMENTS_MAX = 16 };

struct draft_part {
	char *id;
	unsigned line;     /* line in parts.json */
	bool without_page; /* in no language, neither of its own nor of further documents */
	bool expects_page; /* of its own, or a further document, in each language */
	/* Names of the documents that follow its own page; owned. */
	char *documents[DRAFT_DOCUMENTS_MAX];
	uint32_t document_count;
	/* Zero until draft_place_faces, if the region is a list of faces. */
	struct region region;
	float anchor_m[3];
	bool has_anchor;               /* anchor_m is given in parts.json */
	char *faces_file, *faces_scan; /* owned; file NULL: its region is no list of faces */
	char *titles[INFO_LANGUAGES_MAX], *captions[INFO_LANGUAGES_MAX]; /* owned or NULL */
	char *readings[INFO_LANGUAGES_MAX];                              /* the same */
	struct draft_credit credits[DRAFT_CREDITS_MAX]; /* in the order of the elements */
	uint32_t credit_count;
	char *thumbnail;       /* owned name; NULL: none */
	int thumbnail_picture; /* index into draft.pictures, or -1 */
	struct draft_page pages[INFO_LANGUAGES_MAX];
};

struct draft_stop {
	struct info_stop view; /* whole after draft_place_stops */
	bool has_eye, has_target;
	unsigned line;                      /* line in tours.json */
	char *captions[INFO_LANGUAGES_MAX]; /* owned or NULL */
};

struct draft_tour {
	char *id;
	unsigned line;
	bool attract;
	char *titles[INFO_LANGUAGES_MAX], *captions[INFO_LANGUAGES_MAX]; /* owned or NULL */
	int thumbnail_picture;    /* index into draft.pictures, or -1 */
	struct draft_stop *stops; /* owned */
	uint32_t stop_count;
};

struct draft_picture {
	char *name;
	const char *media_type;
	struct hash hash;
	uint32_t size, width_px, height_px;
	bool damaged; /* has been reported */
};

struct draft {
	const struct info_build_options *options;
	struct diagnostics *diagnostics; /* of the options */
	struct draft_part *parts;
	uint32_t part_count;
	struct draft_tour *tours;
	uint32_t tour_count;
	struct draft_picture *pictures;
	uint32_t picture_count, picture_room;
};

/* Frees everything that was read. options and diagnostics stay. */
void draft_finish(struct draft *draft);

/* Reads and checks a picture that file:line refers to. Returns its index, -1 after reporting a
 * fault, or -ENOMEM. */
int draft_add_picture(struct draft *draft, const char *name, const char *file, unsigned line);
/* Returns whether there are 1 to INFO_LANGUAGES_MAX valid codes, each once. */
bool draft_languages_are_sane(const struct info_build_options *options);
/* Returns the part's index, or -1. */
int draft_find_part(const struct draft *draft, const char *id);
/* Returns the tour's index, or -1. */
int draft_find_tour(const struct draft *draft, const char *id);
/* Returns whether a part's region is a list of faces. */
bool draft_has_faces(const struct draft *draft);

/* Reads a JSON file of the folder that has {"KEY": [...]} at the top level. *array is NULL if there
 * is no such file, or after a complaint. *out is for json_text_finish, also on failure. Negative
 * errno: reading cannot go on. */
must_check int draft_read_json(struct draft *draft, const char *file, const char *key,
			       struct json_text *out, const struct cJSON **array);

/* Reads a text of the folder into *out, or what the options have instead. A negative errno, as of
 * buffer_read_file. */
must_check int draft_read_text(const struct draft *draft, const char *name, struct buffer *out);

/* Writes the name of a page in a language of the release, such as "pages/gate.en.html". */
void draft_name_page(const struct draft *draft, const char *name, uint32_t language,
		     char file[DRAFT_PAGE_NAME_BYTES]);

/* Builds the path of a file in the folder. Returns false if it does not fit. */
bool draft_path(const struct draft *draft, char *path, size_t path_bytes, const char *name);

#endif
