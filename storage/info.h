/* The information database of a release: which parts of the model are identified, and what is known
 * about each, in which languages. docs/information.md has the tables, which are the three of
 * Okamoto et al. ("identified part", "assigned information", "information contents").
 *
 * This is the reader, used by the kiosk; pipeline/content/info_build.h writes the database.
 * Pictures are not inside: the database names them by the hash of their file's bytes. They are
 * transferred as objects of their own, so that changing a caption does not send them again. */
#ifndef GOPURA_STORAGE_INFO_H
#define GOPURA_STORAGE_INFO_H

#include "base/bytes.h"
#include "format/hash.h"
#include "geometry/region.h"

enum {
	INFO_LANGUAGES_MAX = 64,
	INFO_PARTS_MAX = 1000,
	INFO_PAGE_PICTURES_MAX = 64,
	INFO_TOURS_MAX = 8,
	INFO_STOPS_MAX = 64, /* in a tour */
};

/* An open database. One thread. */
struct info;

struct info_part {
	const char *id;
	/* For a list of faces, a point and a radius; the labels have its surface. */
	struct region region;
	float anchor_m[3]; /* where the leader line ends */
	bool has_page;     /* in at least one language */
};

/* Texts in the requested language. If it has none, the texts are in a related language ("pt" for
 * "pt-BR"), or else in the first of the release's languages that has one. All are UTF-8 and
 * borrowed until info_close. caption and thumbnail may be "". */
struct info_text {
	const char *language; /* the language that was found */
	const char *title, *caption;
	const char *thumbnail; /* a picture's name */
};

struct info_picture {
	const char *name; /* as in pages: "pictures/gate.jpg" */
	struct hash hash;
	uint32_t width_px, height_px;
};

/* Opens a database image, which is copied. *out is owned by the caller; on failure it is NULL.
 * Returns -ENOMEM, or -EBADMSG if it is not such a database, damaged, or of a schema version that
 * this program does not read. Older versions are read; what they lack is created in memory beside
 * them. */
must_check int info_open(struct info **out, struct bytes image);
void info_close(struct info *info); /* NULL is fine */

/* Parts in the order of parts.json, which is the order of importance. Borrowed until info_close. */
uint32_t info_part_count(const struct info *info);
/* part < info_part_count(). */
const struct info_part *info_part(const struct info *info, uint32_t part);
/* Returns the index of the part with that id, or -ENOENT. */
int info_find(const struct info *info, const char *id);

/* The release's languages, the default first. Borrowed until info_close. */
uint32_t info_language_count(const struct info *info);
/* index < info_language_count(). */
const char *info_language(const struct info *info, uint32_t index);
/* Returns the release's language that best matches the requested one. */
const char *info_nearest_language(const struct info *info, const char *language);

/* Returns the texts of a part; see struct info_text. */
struct info_text info_text(const struct info *info, uint32_t part, const char *language);

/* Reads the page of a part, an encoded article (format/article.h) that is not checked yet. *article
 * is borrowed until the next info_page or info_close. Of an image whose pages are HTML it is made
 * now, plainly (storage/plain_page.h). *language_found (may be NULL) is set to the language that
 * was found. Returns -ENOENT if the part has no page, -EBADMSG if the database is damaged, or
 * -ENOMEM.
 */
must_check int info_page(struct info *info, uint32_t part, const char *language,
			 struct bytes *article, const char **language_found);

/* All pictures of the database, sorted by name. Borrowed until info_close. */
uint32_t info_picture_count(const struct info *info);
/* index < info_picture_count(). */
const struct info_picture *info_picture(const struct info *info, uint32_t index);
/* Returns the picture of that name, or NULL. */
const struct info_picture *info_find_picture(const struct info *info, const char *name);

#endif
