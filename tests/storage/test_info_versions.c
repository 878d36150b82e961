/* Images of every schema version that was ever published: a terminal shows the release that it
 * holds until the museum publishes another, whichever program it has. */
#include <errno.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

#include "format/article.h"
#include "storage/info.h"
#include "storage/info_ask.h"
#include "storage/info_schema.h"
#include "storage/info_tour.h"
#include "tests/check.h"

/* ---- the schemas as they were written */

#define FIRST_TABLES                                                                               \
	"CREATE TABLE language(position INTEGER PRIMARY KEY, code TEXT NOT NULL UNIQUE);"          \
	"CREATE TABLE identified_part(part_id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE,"     \
	" region_kind TEXT NOT NULL CHECK(region_kind IN ('point','sphere','box','prism')),"       \
	" centre_x REAL NOT NULL, centre_y REAL NOT NULL, centre_z REAL NOT NULL,"                 \
	" anchor_x REAL NOT NULL, anchor_y REAL NOT NULL, anchor_z REAL NOT NULL,"                 \
	" radius REAL, half_x REAL, half_y REAL, half_z REAL, turn_deg REAL, floor REAL,"          \
	" roof REAL);"                                                                             \
	"CREATE TABLE part_corner(part_id INTEGER NOT NULL REFERENCES identified_part,"            \
	" position INTEGER NOT NULL, x REAL NOT NULL, y REAL NOT NULL,"                            \
	" PRIMARY KEY(part_id, position)) WITHOUT ROWID;"                                          \
	"CREATE TABLE information(information_id INTEGER PRIMARY KEY,"                             \
	" kind TEXT NOT NULL CHECK(kind IN ('card','page')),"                                      \
	" thumbnail INTEGER REFERENCES picture);"                                                  \
	"CREATE TABLE assigned_information(part_id INTEGER NOT NULL REFERENCES identified_part,"   \
	" information_id INTEGER NOT NULL REFERENCES information, position INTEGER NOT NULL,"      \
	" PRIMARY KEY(part_id, information_id)) WITHOUT ROWID;"                                    \
	"CREATE TABLE content_picture(content_id INTEGER NOT NULL REFERENCES"                      \
	" information_contents, position INTEGER NOT NULL, picture_id INTEGER NOT NULL"            \
	" REFERENCES picture, PRIMARY KEY(content_id, position)) WITHOUT ROWID;"

#define FIRST_ROWS                                                                                 \
	"INSERT INTO language VALUES(0, 'en'), (1, 'ja');"                                         \
	"INSERT INTO identified_part VALUES(0, 'gate', 'prism', 1,1,2, 1,1,2, 0, 0,0,0, 0, 0,4),"  \
	" (1, 'naga', 'point', 5,6,7, 5,6,7, 0, 0,0,0, 0, 0,0);"                                   \
	"INSERT INTO part_corner VALUES(0,0, 0,0), (0,1, 2,0), (0,2, 2,2);"                        \
	"INSERT INTO information VALUES(0, 'page', 0), (1, 'card', NULL);"                         \
	"INSERT INTO assigned_information VALUES(0, 0, 0), (1, 1, 0);"                             \
	"INSERT INTO content_picture VALUES(0, 0, 0);"

static const char version_1[] = FIRST_TABLES
	"CREATE TABLE picture(picture_id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE,"
	" hash BLOB NOT NULL CHECK(length(hash) = 16), bytes INTEGER NOT NULL,"
	" width_px INTEGER NOT NULL, height_px INTEGER NOT NULL);"
	"CREATE TABLE information_contents(content_id INTEGER PRIMARY KEY,"
	" information_id INTEGER NOT NULL REFERENCES information,"
	" language INTEGER NOT NULL REFERENCES language, title TEXT, caption TEXT, body TEXT,"
	" UNIQUE(information_id, language));"
	"PRAGMA application_id = 1198541158; PRAGMA user_version = 1;" FIRST_ROWS
	"INSERT INTO picture VALUES(0, 'pictures/a.png', zeroblob(16), 99, 8, 6);"
	"INSERT INTO information_contents VALUES"
	" (0, 0, 0, 'Gate', 'One enters.', '<h1>Gate</h1><p>Two <em>lions</em> guard it.</p>"
	"<figure><img src=\"pictures/a.png\"><figcaption>East</figcaption></figure>'),"
	" (1, 0, 1, '塔門', NULL, NULL), (8, 1, 0, 'Naga', NULL, NULL);";

#define VERSION_2                                                                                   \
	FIRST_TABLES                                                                                \
	"CREATE TABLE picture(picture_id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE,"           \
	" hash BLOB NOT NULL CHECK(length(hash) = 16), bytes INTEGER NOT NULL,"                     \
	" media_type TEXT NOT NULL CHECK(media_type IN ('image/jpeg','image/png')),"                \
	" width_px INTEGER NOT NULL, height_px INTEGER NOT NULL);"                                  \
	"CREATE TABLE information_contents(content_id INTEGER PRIMARY KEY,"                         \
	" information_id INTEGER NOT NULL REFERENCES information,"                                  \
	" language INTEGER NOT NULL REFERENCES language, title TEXT, reading TEXT, caption TEXT,"   \
	" body TEXT, UNIQUE(information_id, language));"                                            \
	"CREATE TABLE dublin_core(information_id INTEGER NOT NULL REFERENCES information,"          \
	" position INTEGER NOT NULL, element TEXT NOT NULL, language INTEGER REFERENCES language,"  \
	" value TEXT NOT NULL, PRIMARY KEY(information_id, position)) WITHOUT ROWID;"               \
	"CREATE VIRTUAL TABLE search USING fts5(title, caption, body, content = '',"                \
	" tokenize = 'ascii');"                                                                     \
	"PRAGMA application_id = 1198541158; PRAGMA user_version = 2;" FIRST_ROWS                   \
	"INSERT INTO picture VALUES(0, 'pictures/a.png', zeroblob(16), 99, 'image/png', 8, 6);"     \
	"INSERT INTO information_contents VALUES"                                                   \
	" (0, 0, 0, 'Gate', NULL, 'One enters.', '<h1>Gate</h1><p>Two <em>lions</em> guard it.</p>" \
	"<figure><img src=\"pictures/a.png\"><figcaption>East</figcaption></figure>'),"             \
	" (1, 0, 1, '塔門', 'とうもん', NULL, NULL), (8, 1, 0, 'Naga', NULL, NULL, NULL);"    \
	"INSERT INTO dublin_core VALUES(0, 0, 'rights', NULL, '© The museum');"                    \
	"INSERT INTO search(rowid, title, caption, body) VALUES"                                    \
	" (0, ' gate', ' one enters', ' gate two lions guard it east'), (1, ' 塔 門', '', ''),"   \
	" (8, ' naga', '', '');"

static const char version_2[] = VERSION_2;

static const char version_3[] = VERSION_2
	"CREATE TABLE tour(tour_id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE,"
	" attract INTEGER NOT NULL, thumbnail INTEGER REFERENCES picture);"
	"CREATE TABLE tour_contents(tour_id INTEGER NOT NULL REFERENCES tour,"
	" language INTEGER NOT NULL REFERENCES language, title TEXT, caption TEXT,"
	" PRIMARY KEY(tour_id, language)) WITHOUT ROWID;"
	"CREATE TABLE tour_stop(tour_id INTEGER NOT NULL REFERENCES tour,"
	" position INTEGER NOT NULL, eye_x REAL NOT NULL, eye_y REAL NOT NULL,"
	" eye_z REAL NOT NULL, target_x REAL NOT NULL, target_y REAL NOT NULL,"
	" target_z REAL NOT NULL, stay_s REAL NOT NULL, travel_s REAL NOT NULL,"
	" part_id INTEGER REFERENCES identified_part, PRIMARY KEY(tour_id, position))"
	" WITHOUT ROWID;"
	"CREATE TABLE tour_stop_contents(tour_id INTEGER NOT NULL REFERENCES tour,"
	" position INTEGER NOT NULL, language INTEGER NOT NULL REFERENCES language,"
	" caption TEXT NOT NULL, PRIMARY KEY(tour_id, position, language)) WITHOUT ROWID;"
	"PRAGMA user_version = 3;"
	"INSERT INTO tour VALUES(0, 'round', 0, NULL);"
	"INSERT INTO tour_contents VALUES(0, 0, 'Around', NULL);"
	"INSERT INTO tour_stop VALUES(0, 0, 9,0,5, 0,0,0, 4, 0, 0), (0, 1, 0,9,5, 0,0,0, 4, 0, 1);";

static const char *const versions[] = { version_1, version_2, version_3 };

static int open_image(struct info **out, const char *sql, const char *more)
{
	sqlite3_int64 size;
	unsigned char *image;
	sqlite3 *db;
	int rc;

	CHECK(sqlite3_open(":memory:", &db) == SQLITE_OK);
	CHECK(sqlite3_exec(db, sql, NULL, NULL, NULL) == SQLITE_OK);
	CHECK(sqlite3_exec(db, more, NULL, NULL, NULL) == SQLITE_OK);
	image = sqlite3_serialize(db, "main", &size, 0);
	rc = info_open(out, (struct bytes){ image, (size_t)size });
	sqlite3_free(image);
	sqlite3_close(db);
	return rc;
}

static bool finds(struct info *info, const char *query, const char *language, uint32_t part)
{
	uint32_t parts[4];

	return info_search(info, query, language, parts, 4) == 1 && parts[0] == part;
}

static void every_version_is_read_and_searched(void **state)
{
	struct info *info;
	(void)state;

	CHECK(ARRAY_COUNT(versions) == INFO_SCHEMA_VERSION - INFO_SCHEMA_OLDEST);
	for (size_t i = 0; i < ARRAY_COUNT(versions); i++) {
		CHECK(open_image(&info, versions[i], "") == 0);
		CHECK(info_part_count(info) == 2);
		CHECK(info_part(info, 0)->region.corner_count == 3);
		CHECK(strcmp(info_text(info, 0, "ja").title, "塔門") == 0);
		CHECK(strcmp(info_text(info, 0, "ja").thumbnail, "pictures/a.png") == 0);
		CHECK(finds(info, "nag", "en", 1) && finds(info, "lions", "en", 0));
		CHECK(finds(info, "門", "ja", 0));
		CHECK(strcmp(info_credits(info, 0, "en"), i ? "© The museum" : "") == 0);
		CHECK(info_tour_count(info) == (i == 2));
		info_close(info);
	}
}

/* Their pages are HTML, of which a plain article is made. */
static void pages_of_every_version_are_shown(void **state)
{
	struct article_blocks article;
	const char *language;
	struct bytes bytes;
	struct info *info;
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(versions); i++) {
		CHECK(open_image(&info, versions[i], "") == 0);
		CHECK(info_page(info, 0, "ja", &bytes, &language) == 0);
		CHECK(strcmp(language, "en") == 0);
		CHECK(article_decode(&article, bytes) == 0 && article.block_count == 4);
		CHECK(article.blocks[0].style == ARTICLE_HEADING_1);
		CHECK(strcmp(article.blocks[1].text, "Two lions guard it.") == 0);
		CHECK(article.blocks[2].kind == ARTICLE_IMAGE);
		CHECK(strcmp(article.blocks[2].text, "pictures/a.png") == 0);
		CHECK(article.blocks[3].style == ARTICLE_FIGURE);
		article_finish(&article);
		CHECK(info_page(info, 1, "en", &bytes, NULL) == -ENOENT);
		info_close(info);
	}
}

static void a_page_that_says_nothing_is_damage(void **state)
{
	struct bytes bytes;
	struct info *info;
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(versions); i++) {
		CHECK(open_image(&info, versions[i],
				 "UPDATE information_contents SET body = x'ff00' WHERE body"
				 " IS NOT NULL") == 0);
		CHECK(info_page(info, 0, "en", &bytes, NULL) == -EBADMSG && bytes.size == 0);
		info_close(info);
	}
}

static void a_version_to_come_is_refused(void **state)
{
	struct info *info;
	char more[60];
	(void)state;

	snprintf(more, sizeof(more), "PRAGMA user_version = %d", INFO_SCHEMA_VERSION + 1);
	CHECK(open_image(&info, version_3, more) == -EBADMSG && !info);
	CHECK(open_image(&info, version_3, "PRAGMA user_version = 0") == -EBADMSG && !info);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_version_is_read_and_searched),
		cmocka_unit_test(pages_of_every_version_are_shown),
		cmocka_unit_test(a_page_that_says_nothing_is_damage),
		cmocka_unit_test(a_version_to_come_is_refused),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
