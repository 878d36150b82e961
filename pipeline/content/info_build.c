/* Writes content in memory into an SQLite image. Everything is inserted in a fixed order into a new
 * database that contains nothing of the clock, the machine or the folder's path, and the result is
 * vacuumed. So the same content gives the same bytes. */
#include <errno.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "format/page.h"
#include "pipeline/content/draft.h"
#include "pipeline/content/info_pages.h"
#include "pipeline/content/info_parts.h"
#include "pipeline/content/info_tours.h"
#include "storage/info_index.h"
#include "storage/info_schema.h"
#include "storage/info_tools.h"

/* The paper's three tables, extended for a proper relational design: the identity of an information
 * (it may be assigned to several parts and exists in several languages), corners, pictures and
 * languages. docs/information.md explains each table. */
static const char schema[] =
	"PRAGMA page_size = 4096;"
	"PRAGMA foreign_keys = ON;"
	"CREATE TABLE language(position INTEGER PRIMARY KEY, code TEXT NOT NULL UNIQUE);"
	"CREATE TABLE picture(picture_id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE,"
	" hash BLOB NOT NULL CHECK(length(hash) = 16), bytes INTEGER NOT NULL,"
	" media_type TEXT NOT NULL CHECK(media_type IN ('image/jpeg','image/png')),"
	" width_px INTEGER NOT NULL, height_px INTEGER NOT NULL);"
	"CREATE TABLE identified_part(part_id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE,"
	" region_kind TEXT NOT NULL CHECK(region_kind IN ('point','sphere','box','prism')),"
	" centre_x REAL NOT NULL, centre_y REAL NOT NULL, centre_z REAL NOT NULL,"
	" anchor_x REAL NOT NULL, anchor_y REAL NOT NULL, anchor_z REAL NOT NULL,"
	" radius REAL, half_x REAL, half_y REAL, half_z REAL, turn_deg REAL, floor REAL, roof REAL);"
	"CREATE TABLE part_corner(part_id INTEGER NOT NULL REFERENCES identified_part,"
	" position INTEGER NOT NULL, x REAL NOT NULL, y REAL NOT NULL,"
	" PRIMARY KEY(part_id, position)) WITHOUT ROWID;"
	"CREATE TABLE information(information_id INTEGER PRIMARY KEY,"
	" kind TEXT NOT NULL CHECK(kind IN ('card','page')),"
	" thumbnail INTEGER REFERENCES picture);"
	"CREATE TABLE assigned_information(part_id INTEGER NOT NULL REFERENCES identified_part,"
	" information_id INTEGER NOT NULL REFERENCES information, position INTEGER NOT NULL,"
	" PRIMARY KEY(part_id, information_id)) WITHOUT ROWID;"
	"CREATE TABLE information_contents(content_id INTEGER PRIMARY KEY,"
	" information_id INTEGER NOT NULL REFERENCES information,"
	" language INTEGER NOT NULL REFERENCES language, title TEXT, reading TEXT, caption TEXT,"
	" body BLOB, UNIQUE(information_id, language));"
	"CREATE TABLE dublin_core(information_id INTEGER NOT NULL REFERENCES information,"
	" position INTEGER NOT NULL, element TEXT NOT NULL, language INTEGER REFERENCES language,"
	" value TEXT NOT NULL, PRIMARY KEY(information_id, position)) WITHOUT ROWID;"
	"CREATE TABLE content_picture(content_id INTEGER NOT NULL REFERENCES information_contents,"
	" position INTEGER NOT NULL, picture_id INTEGER NOT NULL REFERENCES picture,"
	" PRIMARY KEY(content_id, position)) WITHOUT ROWID;"
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
	" caption TEXT NOT NULL, PRIMARY KEY(tour_id, position, language)) WITHOUT ROWID;";

/* After the first failure all further calls do nothing; the code is checked once. */
struct writer {
	sqlite3 *db;
	sqlite3_stmt *statement;
	int bound;
	int code; /* SQLITE_OK or the first failure */
};

static void run(struct writer *w, const char *sql)
{
	if (w->code == SQLITE_OK)
		w->code = sqlite3_exec(w->db, sql, NULL, NULL, NULL);
}

static void prepare(struct writer *w, const char *sql)
{
	if (w->code == SQLITE_OK)
		w->code = sqlite3_prepare_v2(w->db, sql, -1, &w->statement, NULL);
	w->bound = 0;
}

static void bind_int(struct writer *w, int64_t value)
{
	if (w->code == SQLITE_OK)
		w->code = sqlite3_bind_int64(w->statement, ++w->bound, value);
}

static void bind_real(struct writer *w, double value)
{
	if (w->code == SQLITE_OK)
		w->code = sqlite3_bind_double(w->statement, ++w->bound, value);
}

static void bind_text(struct writer *w, const char *text) /* NULL becomes SQL NULL */
{
	if (w->code == SQLITE_OK)
		w->code = sqlite3_bind_text(w->statement, ++w->bound, text, -1, SQLITE_STATIC);
}

static void bind_blob(struct writer *w, struct bytes blob) /* no bytes become SQL NULL */
{
	if (w->code == SQLITE_OK)
		w->code = sqlite3_bind_blob(w->statement, ++w->bound, blob.size ? blob.data : NULL,
					    (int)blob.size, SQLITE_STATIC);
}

static void insert(struct writer *w)
{
	int code;

	if (w->code == SQLITE_OK) {
		code = sqlite3_step(w->statement);
		w->code = code == SQLITE_DONE ? SQLITE_OK : code;
	}
	sqlite3_finalize(w->statement);
	w->statement = NULL;
}

static void write_languages(struct writer *w, const struct info_build_options *options)
{
	for (uint32_t i = 0; i < options->language_count; i++) {
		prepare(w, "INSERT INTO language VALUES(?, ?)");
		bind_int(w, i);
		bind_text(w, options->languages[i]);
		insert(w);
	}
}

static void write_pictures(struct writer *w, const struct draft *draft)
{
	for (uint32_t i = 0; i < draft->picture_count; i++) {
		const struct draft_picture *picture = &draft->pictures[i];

		prepare(w, "INSERT INTO picture VALUES(?, ?, ?, ?, ?, ?, ?)");
		bind_int(w, i);
		bind_text(w, picture->name);
		bind_blob(w, (struct bytes){ picture->hash.bytes, HASH_BYTES });
		bind_int(w, picture->size);
		bind_text(w, picture->media_type);
		bind_int(w, picture->width_px);
		bind_int(w, picture->height_px);
		insert(w);
	}
}

static void bind_vector(struct writer *w, const float v[3])
{
	for (int i = 0; i < 3; i++)
		bind_real(w, v[i]);
}

static void write_part(struct writer *w, int64_t id, const struct draft_part *part)
{
	static const char *const kinds[] = { "point", "sphere", "box", "prism" };
	const struct region *region = &part->region;

	prepare(w, "INSERT INTO identified_part VALUES(?,?,?, ?,?,?, ?,?,?, ?, ?,?,?, ?, ?,?)");
	bind_int(w, id);
	bind_text(w, part->id);
	bind_text(w, kinds[region->kind]);
	bind_vector(w, region->centre_m);
	bind_vector(w, part->anchor_m);
	bind_real(w, region->radius_m);
	bind_vector(w, region->half_m);
	bind_real(w, region->turn_deg);
	bind_real(w, region->floor_m);
	bind_real(w, region->roof_m);
	insert(w);
	for (uint32_t i = 0; i < region->corner_count; i++) {
		prepare(w, "INSERT INTO part_corner VALUES(?,?,?,?)");
		bind_int(w, id);
		bind_int(w, i);
		bind_real(w, region->corners_m[i][0]);
		bind_real(w, region->corners_m[i][1]);
		insert(w);
	}
}

static int64_t content_id_of(int64_t information, uint32_t language)
{
	return information * INFO_LANGUAGES_MAX + language;
}

static void write_content(struct writer *w, int64_t information, uint32_t language,
			  const struct draft_part *part)
{
	const struct draft_page *page = &part->pages[language];
	const int64_t content_id = content_id_of(information, language);

	if (!part->titles[language] && !part->captions[language] && !page->is_there)
		return;
	prepare(w, "INSERT INTO information_contents VALUES(?,?,?, ?,?,?,?)");
	bind_int(w, content_id);
	bind_int(w, information);
	bind_int(w, language);
	bind_text(w, part->titles[language]);
	bind_text(w, part->readings[language]);
	bind_text(w, part->captions[language]);
	bind_blob(w, buffer_bytes(&page->article));
	insert(w);
	for (uint32_t i = 0; i < page->picture_count; i++) {
		prepare(w, "INSERT INTO content_picture VALUES(?,?,?)");
		bind_int(w, content_id);
		bind_int(w, i);
		bind_int(w, page->pictures[i]);
		insert(w);
	}
}

/* Writes all credits of a part, including those stated for all parts. */
static void write_credits(struct writer *w, int64_t information, const struct draft_part *part)
{
	for (uint32_t i = 0; i < part->credit_count; i++) {
		const struct draft_credit *credit = &part->credits[i];

		prepare(w, "INSERT INTO dublin_core VALUES(?,?,?,?,?)");
		bind_int(w, information);
		bind_int(w, i);
		bind_text(w, credit->element);
		if (credit->language >= 0)
			bind_int(w, credit->language);
		else
			w->bound++; /* NULL */
		bind_text(w, credit->value);
		insert(w);
	}
}

static void write_information(struct writer *w, int64_t id, const struct draft_part *part,
			      uint32_t language_count)
{
	bool has_page = false;

	for (uint32_t i = 0; i < language_count; i++)
		has_page |= part->pages[i].is_there;
	prepare(w, "INSERT INTO information VALUES(?,?,?)");
	bind_int(w, id);
	bind_text(w, has_page ? "page" : "card");
	if (part->thumbnail_picture >= 0)
		bind_int(w, part->thumbnail_picture);
	insert(w);
	prepare(w, "INSERT INTO assigned_information VALUES(?,?,0)");
	bind_int(w, id);
	bind_int(w, id);
	insert(w);
	for (uint32_t i = 0; i < language_count; i++)
		write_content(w, id, i, part);
	write_credits(w, id, part);
}

static void write_stop(struct writer *w, int64_t tour, int64_t position,
		       const struct draft_stop *stop)
{
	prepare(w, "INSERT INTO tour_stop VALUES(?,?, ?,?,?, ?,?,?, ?,?,?)");
	bind_int(w, tour);
	bind_int(w, position);
	bind_vector(w, stop->view.eye_m);
	bind_vector(w, stop->view.target_m);
	bind_real(w, stop->view.stay_s);
	bind_real(w, stop->view.travel_s);
	if (stop->view.part >= 0)
		bind_int(w, stop->view.part);
	insert(w);
	for (uint32_t i = 0; i < INFO_LANGUAGES_MAX; i++) {
		if (!stop->captions[i])
			continue;
		prepare(w, "INSERT INTO tour_stop_contents VALUES(?,?,?,?)");
		bind_int(w, tour);
		bind_int(w, position);
		bind_int(w, i);
		bind_text(w, stop->captions[i]);
		insert(w);
	}
}

static void write_tour(struct writer *w, int64_t id, const struct draft_tour *tour)
{
	prepare(w, "INSERT INTO tour VALUES(?,?,?,?)");
	bind_int(w, id);
	bind_text(w, tour->id);
	bind_int(w, tour->attract);
	if (tour->thumbnail_picture >= 0)
		bind_int(w, tour->thumbnail_picture);
	insert(w);
	for (uint32_t i = 0; i < INFO_LANGUAGES_MAX; i++) {
		if (!tour->titles[i] && !tour->captions[i])
			continue;
		prepare(w, "INSERT INTO tour_contents VALUES(?,?,?,?)");
		bind_int(w, id);
		bind_int(w, i);
		bind_text(w, tour->titles[i]);
		bind_text(w, tour->captions[i]);
		insert(w);
	}
	for (uint32_t i = 0; i < tour->stop_count; i++)
		write_stop(w, id, i, &tour->stops[i]);
}

/* Legs as interpolators fly them. Without any there is no table of them (storage/info_tour.c). */
static void write_even_legs(struct writer *w, const struct draft *draft)
{
	bool has_table = false;

	for (uint32_t t = 0; t < draft->tour_count; t++)
		for (uint32_t i = 0; i < draft->tours[t].stop_count; i++) {
			if (!draft->tours[t].stops[i].view.is_even)
				continue;
			if (!has_table)
				run(w, "CREATE TABLE tour_even(tour_id INTEGER NOT NULL,"
				       " position INTEGER NOT NULL, PRIMARY KEY(tour_id, position),"
				       " FOREIGN KEY(tour_id, position) REFERENCES tour_stop)"
				       " WITHOUT ROWID");
			has_table = true;
			prepare(w, "INSERT INTO tour_even VALUES(?,?)");
			bind_int(w, t);
			bind_int(w, i);
			insert(w);
		}
}

static void write_tools(struct writer *w, unsigned tools, double scan_error_m)
{
	if (tools)
		run(w, "CREATE TABLE tool(name TEXT PRIMARY KEY, error_m REAL) WITHOUT ROWID");
	for (unsigned i = 0; i < INFO_TOOL_NAMES; i++) {
		if (!(tools & 1u << i))
			continue;
		prepare(w, "INSERT INTO tool VALUES(?,?)");
		bind_text(w, info_tool_names[i]);
		if (1u << i == INFO_TOOL_MEASURE)
			bind_real(w, scan_error_m);
		insert(w);
	}
}

static bool has_spoken(const struct draft *draft)
{
	for (uint32_t p = 0; p < draft->part_count; p++)
		for (uint32_t i = 0; i < draft->options->language_count; i++)
			if (draft->parts[p].pages[i].spoken.duration_ms > 0)
				return true;
	return false;
}

static void write_spoken_text(struct writer *w, int64_t content_id,
			      const struct draft_spoken *spoken)
{
	prepare(w, "INSERT INTO spoken VALUES(?,?,?,?)");
	bind_int(w, content_id);
	bind_blob(w, (struct bytes){ spoken->hash.bytes, HASH_BYTES });
	bind_int(w, spoken->size);
	bind_int(w, spoken->duration_ms);
	insert(w);
	for (uint32_t i = 0; i < spoken->cues.count; i++) {
		prepare(w, "INSERT INTO spoken_cue VALUES(?,?,?,?,?)");
		bind_int(w, content_id);
		bind_int(w, i);
		bind_int(w, spoken->cues.all[i].begin_ms);
		bind_int(w, spoken->cues.all[i].end_ms);
		bind_text(w, spoken->cues.all[i].text);
		insert(w);
	}
}

/* Without spoken texts there are no tables of them (storage/info_spoken.h). */
static void write_spoken(struct writer *w, const struct draft *draft)
{
	static const char tables[] =
		"CREATE TABLE spoken(content_id INTEGER PRIMARY KEY REFERENCES information_contents,"
		" hash BLOB NOT NULL CHECK(length(hash) = 16), bytes INTEGER NOT NULL,"
		" duration_ms INTEGER NOT NULL);"
		"CREATE TABLE spoken_cue(content_id INTEGER NOT NULL REFERENCES spoken,"
		" position INTEGER NOT NULL, begin_ms INTEGER NOT NULL, end_ms INTEGER NOT NULL,"
		" text TEXT NOT NULL, PRIMARY KEY(content_id, position)) WITHOUT ROWID;";

	if (!has_spoken(draft))
		return;
	run(w, tables);
	for (uint32_t p = 0; p < draft->part_count; p++)
		for (uint32_t i = 0; i < draft->options->language_count; i++)
			if (draft->parts[p].pages[i].spoken.duration_ms > 0)
				write_spoken_text(w, content_id_of(p, i),
						  &draft->parts[p].pages[i].spoken);
}

static void write_database(struct writer *w, const struct draft *draft)
{
	char pragmas[100];

	snprintf(pragmas, sizeof(pragmas), "PRAGMA application_id = %d; PRAGMA user_version = %d;",
		 INFO_APPLICATION_ID, INFO_SCHEMA_VERSION);
	run(w, schema);
	run(w, pragmas);
	run(w, "BEGIN");
	write_languages(w, draft->options);
	write_pictures(w, draft);
	for (uint32_t i = 0; i < draft->part_count; i++) {
		write_part(w, i, &draft->parts[i]);
		write_information(w, i, &draft->parts[i], draft->options->language_count);
	}
	for (uint32_t i = 0; i < draft->tour_count; i++)
		write_tour(w, i, &draft->tours[i]);
	write_even_legs(w, draft);
	write_tools(w, draft->options->tools, draft->options->scan_error_m);
	write_spoken(w, draft);
	if (w->code == SQLITE_OK)
		w->code = info_index_make(w->db, INFO_SCHEMA_VERSION);
	run(w, "COMMIT");
	run(w, "VACUUM");
}

static int encode(struct buffer *out, struct draft *draft)
{
	struct writer w = { 0 };
	sqlite3_int64 size = 0;
	unsigned char *image = NULL;
	int rc = 0;

	w.code = sqlite3_open(":memory:", &w.db);
	write_database(&w, draft);
	if (w.code == SQLITE_OK) {
		image = sqlite3_serialize(w.db, "main", &size, 0);
		if (image)
			buffer_put(out, image, (size_t)size);
		rc = image ? out->error : -ENOMEM;
	} else {
		rc = w.code == SQLITE_NOMEM ? -ENOMEM : -EIO;
		log_error("storage", "information database: %s", sqlite3_errmsg(w.db));
	}
	sqlite3_free(image);
	sqlite3_close(w.db);
	if (rc != -EFBIG)
		return rc;
	diagnostics_add(draft->diagnostics, -EINVAL, "parts.json", 0,
			"titles and pages together are larger than %d MB: shorten the pages",
			OBJECT_BYTES_MAX >> 20);
	return -EINVAL;
}

static int by_hash(const void *a, const void *b)
{
	const struct info_file *left = a, *right = b;

	return hash_compare(left->hash, right->hash);
}

static int add_file(struct info_built *out, struct hash hash, uint32_t size, const char *name)
{
	struct info_file *file = &out->files[out->file_count];

	*file = (struct info_file){ hash, size, strdup(name) };
	if (!file->name)
		return -ENOMEM;
	out->file_count++;
	return 0;
}

static int add_spoken_files(struct info_built *out, const struct draft *draft)
{
	int rc = 0;

	for (uint32_t p = 0; p < draft->part_count; p++)
		for (uint32_t i = 0; i < draft->options->language_count && rc == 0; i++) {
			const struct draft_spoken *spoken = &draft->parts[p].pages[i].spoken;

			if (spoken->duration_ms > 0)
				rc = add_file(out, spoken->hash, spoken->size, spoken->name);
		}
	return rc;
}

/* Lists pictures and spoken texts by hash. Files with the same bytes become one object. */
static int list_files(struct info_built *out, const struct draft *draft)
{
	const size_t most =
		draft->picture_count + (size_t)draft->part_count * draft->options->language_count;
	uint32_t kept = 0;
	int rc = 0;

	out->files = calloc(most + 1, sizeof(*out->files));
	if (!out->files)
		return -ENOMEM;
	for (uint32_t i = 0; i < draft->picture_count && rc == 0; i++)
		rc = add_file(out, draft->pictures[i].hash, draft->pictures[i].size,
			      draft->pictures[i].name);
	if (rc == 0)
		rc = add_spoken_files(out, draft);
	if (rc < 0)
		return rc;
	qsort(out->files, out->file_count, sizeof(*out->files), by_hash);
	for (uint32_t i = 0; i < out->file_count; i++) {
		if (kept > 0 && hash_equal(out->files[kept - 1].hash, out->files[i].hash))
			free(out->files[i].name);
		else
			out->files[kept++] = out->files[i];
	}
	out->file_count = kept;
	return 0;
}

static void count(struct info_built *out, const struct draft *draft)
{
	out->part_count = draft->part_count;
	out->tour_count = draft->tour_count;
	for (uint32_t t = 0; t < draft->tour_count; t++) {
		out->tour_lines[t].tour = draft->tours[t].line;
		for (uint32_t i = 0; i < draft->tours[t].stop_count; i++)
			out->tour_lines[t].stops[i] = draft->tours[t].stops[i].line;
	}
	for (uint32_t p = 0; p < draft->part_count; p++)
		for (uint32_t i = 0; i < INFO_LANGUAGES_MAX; i++)
			out->page_count += draft->parts[p].pages[i].is_there;
}

bool draft_languages_are_sane(const struct info_build_options *options)
{
	if (options->language_count < 1 || options->language_count > INFO_LANGUAGES_MAX)
		return false;
	for (uint32_t i = 0; i < options->language_count; i++) {
		const char *code = options->languages[i];
		size_t size = strlen(code);

		if (size < 2 || size > 16 ||
		    strspn(code, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ-") != size)
			return false;
		for (uint32_t k = 0; k < i; k++)
			if (strcmp(code, options->languages[k]) == 0)
				return false;
	}
	return true;
}

/* Reads everything; returns 0 also if there were faults. */
static int read_all(struct draft *draft)
{
	int rc = 0;

	if (!draft_languages_are_sane(draft->options)) {
		diagnostics_add(draft->diagnostics, -EINVAL, "temple.ini", 0,
				"languages: give 1 to %d codes such as \"en fr km\", each once",
				INFO_LANGUAGES_MAX);
		return 0;
	}
	rc = draft_read_parts(draft);
	if (rc == 0)
		rc = draft_read_tours(draft);
	if (rc == 0 && draft->part_count > 0)
		rc = draft_read_pages(draft);
	if (rc == 0 && !draft_has_faces(draft))
		draft_place_stops(draft);
	return rc;
}

int info_read(struct draft **out, const struct info_build_options *options)
{
	const uint32_t errors = options->diagnostics->error_count;
	struct draft *draft = calloc(1, sizeof(*draft));
	int rc;

	*out = NULL;
	if (!draft)
		return -ENOMEM;
	draft->options = options;
	draft->diagnostics = options->diagnostics;
	rc = read_all(draft);
	if (rc == 0 && draft->diagnostics->error_count > errors)
		rc = -EINVAL;
	if (rc == 0)
		*out = draft;
	else
		info_draft_destroy(draft);
	return rc;
}

void info_draft_destroy(struct draft *draft)
{
	if (!draft)
		return;
	draft_finish(draft);
	free(draft);
}

bool info_has_tours(const struct draft *draft)
{
	return draft->tour_count > 0;
}

/* Places the regions that are lists of faces. The leader line of a part without an "anchor" ends on
 * its faces. */
static int place_faces(struct draft *draft)
{
	const struct info_build_options *options = draft->options;
	int rc = 0;

	for (uint32_t i = 0; rc == 0 && options->place_faces && i < draft->part_count; i++) {
		struct draft_part *part = &draft->parts[i];
		struct info_faces faces = { .part = part->id,
					    .file = part->faces_file,
					    .scan = part->faces_scan };
		struct diagnostics diagnostics = { 0 };

		if (!part->faces_file)
			continue;
		rc = options->place_faces(options->faces_data, &faces, &diagnostics);
		if (rc == -EINVAL) {
			diagnostics_add(draft->diagnostics, -EINVAL, "parts.json", part->line,
					"part \"%s\": %s", part->id,
					diagnostics_cause(&diagnostics, rc));
			rc = 0;
		}
		memcpy(part->region.centre_m, faces.centre_m, sizeof(faces.centre_m));
		part->region.radius_m = faces.radius_m;
		if (!part->has_anchor)
			memcpy(part->anchor_m, faces.anchor_m, sizeof(faces.anchor_m));
	}
	return rc;
}

int info_compile(struct info_built *out, struct draft *draft)
{
	const uint32_t errors = draft->diagnostics->error_count;
	int rc = 0;

	*out = (struct info_built){ 0 };
	buffer_init(&out->database, OBJECT_BYTES_MAX);
	if (draft_has_faces(draft)) {
		rc = place_faces(draft);
		if (rc == 0)
			draft_place_stops(draft);
	}
	if (rc == 0 && draft->diagnostics->error_count > errors)
		rc = -EINVAL;
	if (rc == 0)
		rc = encode(&out->database, draft);
	if (rc == 0)
		rc = list_files(out, draft);
	if (rc == 0)
		count(out, draft);
	else
		info_built_finish(out);
	return rc;
}

int info_build(struct info_built *out, const struct info_build_options *options)
{
	struct draft *draft;
	int rc = info_read(&draft, options);

	*out = (struct info_built){ 0 };
	if (rc == 0)
		rc = info_compile(out, draft);
	info_draft_destroy(draft);
	return rc;
}

void info_built_finish(struct info_built *built)
{
	if (!built)
		return;
	buffer_finish(&built->database);
	for (uint32_t i = 0; i < built->file_count; i++)
		free(built->files[i].name);
	free(built->files);
	*built = (struct info_built){ 0 };
}
