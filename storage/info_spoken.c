/* Reads spoken texts when they are asked for. They have their own tables, which exist only if there
 * are any, as tools have (storage/info_tools.c): programs without sound never read them, and the
 * schema version stays the same for them. */
#include "storage/info_spoken.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "storage/info_languages.h"
#include "storage/info_rows.h"

static int note_table(struct info *info, sqlite3_stmt *row)
{
	(void)row;
	info->has_spoken = true;
	return 0;
}

int info_load_spoken(struct info *info)
{
	return info_each_row(info,
			     "SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = 'spoken'",
			     note_table);
}

void info_drop_spoken(struct info *info)
{
	for (uint32_t n = 0; n < info->cue_count; n++)
		free(info->cues[n].text);
	free(info->cues);
	info->cues = NULL;
	info->cue_count = 0;
	info->spoken = (struct info_spoken){ 0 };
}

static int read_spoken(sqlite3_stmt *row, struct info_spoken *out)
{
	const sqlite3_int64 bytes = sqlite3_column_int64(row, 1),
			    duration_ms = sqlite3_column_int64(row, 2);

	if (sqlite3_column_bytes(row, 0) != HASH_BYTES || bytes < 1 ||
	    bytes > INFO_SPOKEN_BYTES_MAX || duration_ms < 1 || duration_ms > INFO_SPOKEN_MS_MAX)
		return -EBADMSG;
	memcpy(out->hash.bytes, sqlite3_column_blob(row, 0), HASH_BYTES);
	out->bytes = (uint32_t)bytes;
	out->duration_ms = (uint32_t)duration_ms;
	return 0;
}

static int read_cue(struct info *info, sqlite3_stmt *row)
{
	struct info_cue *cue = &info->cues[info->cue_count];
	const sqlite3_int64 begin_ms = sqlite3_column_int64(row, 0),
			    end_ms = sqlite3_column_int64(row, 1);
	char *text = NULL;
	int rc;

	if (info->cue_count == INFO_CUES_MAX || begin_ms < 0 || end_ms <= begin_ms ||
	    end_ms > INFO_SPOKEN_MS_MAX ||
	    (info->cue_count > 0 && begin_ms < (sqlite3_int64)cue[-1].begin_ms))
		return -EBADMSG;
	rc = info_copy_text(row, 2, &text);
	if (rc < 0 || !text || strlen(text) > INFO_CUE_BYTES_MAX) {
		free(text);
		return rc < 0 ? rc : -EBADMSG;
	}
	*cue = (struct info_cue){ (uint32_t)begin_ms, (uint32_t)end_ms, text };
	info->cue_count++;
	return 0;
}

static int prepare(struct info *info, const char *sql, int64_t content_id, sqlite3_stmt **out)
{
	int code = sqlite3_prepare_v2(info->db, sql, -1, out, NULL);

	if (code == SQLITE_OK)
		code = sqlite3_bind_int64(*out, 1, content_id);
	return info_from_sqlite(info->db, code, sql);
}

static int find_spoken(struct info *info, int64_t content_id, struct info_spoken *out)
{
	sqlite3_stmt *row = NULL;
	int code, rc = prepare(info,
			       "SELECT hash, bytes, duration_ms FROM spoken WHERE content_id = ?1",
			       content_id, &row);

	if (rc == 0) {
		code = sqlite3_step(row);
		if (code == SQLITE_ROW)
			rc = read_spoken(row, out);
		else
			rc = code == SQLITE_DONE ? -ENOENT
						 : info_from_sqlite(info->db, code, "spoken");
	}
	sqlite3_finalize(row);
	return rc;
}

static int find_cues(struct info *info, int64_t content_id)
{
	sqlite3_stmt *row = NULL;
	int code = SQLITE_DONE, rc = prepare(info,
					     "SELECT begin_ms, end_ms, text FROM spoken_cue WHERE"
					     " content_id = ?1 ORDER BY position",
					     content_id, &row);

	info->cues = calloc(INFO_CUES_MAX, sizeof(*info->cues));
	if (rc == 0 && !info->cues)
		rc = -ENOMEM;
	while (rc == 0 && (code = sqlite3_step(row)) == SQLITE_ROW)
		rc = read_cue(info, row);
	if (rc == 0)
		rc = info_from_sqlite(info->db, code, "cues");
	sqlite3_finalize(row);
	return rc;
}

static int load(struct info *info, int64_t content_id)
{
	struct info_spoken found = { 0 };
	int rc;

	info_drop_spoken(info);
	info->calls = 0;
	rc = find_spoken(info, content_id, &found);
	if (rc == 0)
		rc = find_cues(info, content_id);
	if (rc < 0) {
		info_drop_spoken(info);
		return rc;
	}
	found.cues = info->cues;
	found.cue_count = info->cue_count;
	info->spoken = found;
	info->spoken_of = content_id;
	return 0;
}

int info_spoken(struct info *info, uint32_t part, const char *language, struct info_spoken *out)
{
	const struct part *its = &info->parts[part];
	const uint32_t found = info_page_language(info, its, language);
	int rc;

	*out = (struct info_spoken){ 0 };
	if (!info->has_spoken || found == info->language_count)
		return -ENOENT;
	/* Whoever follows what is spoken asks many times a second. */
	if (info->spoken.bytes == 0 || info->spoken_of != its->texts[found].content_id) {
		rc = load(info, its->texts[found].content_id);
		if (rc < 0)
			return rc;
	}
	*out = info->spoken;
	return 0;
}
