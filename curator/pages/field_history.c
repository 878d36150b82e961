/* Reads one version after another, and compares each with the one before it. */
#include "curator/pages/field_history.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_tree.h"
#include "curator/store/documents_versions.h"
#include "curator/store/parts_file.h"

struct comparison {
	const struct content *content;
	const struct history_version *version; /* the newer one */
	const cJSON *before, *after;           /* the part; NULL: it is not there */
	cJSON *out;
};

static const char *text_of(const cJSON *part, const char *field, const char *language)
{
	const cJSON *value = cJSON_GetObjectItemCaseSensitive(part, field);
	const char *text;

	if (*language)
		value = cJSON_GetObjectItemCaseSensitive(value, language);
	text = cJSON_GetStringValue(value);
	return text ? text : "";
}

static void compare(const struct comparison *comparison, const char *field, const char *language)
{
	const struct history_version *version = comparison->version;
	const bool is_outside = strcmp(version->author, DOCUMENTS_OUTSIDE) == 0;
	const char *from = text_of(comparison->before, field, language),
		   *to = text_of(comparison->after, field, language);
	cJSON *row;

	if (strcmp(from, to) == 0 || cJSON_GetArraySize(comparison->out) >= FIELD_HISTORY_ROWS_MAX)
		return;
	row = cJSON_CreateObject();
	cJSON_AddStringToObject(row, "version", version->id);
	cJSON_AddStringToObject(row, "author", is_outside ? "" : version->author);
	cJSON_AddNumberToObject(row, "time", (double)version->time_s);
	cJSON_AddStringToObject(row, "field", field);
	cJSON_AddStringToObject(row, "language", language);
	cJSON_AddStringToObject(row, "from", from);
	cJSON_AddStringToObject(row, "to", to);
	json_append(comparison->out, row);
}

static void compare_part(const struct comparison *comparison)
{
	static const char *const fields[] = { "title", "caption", "reading" };

	for (size_t n = 0; n < ARRAY_COUNT(fields); n++)
		for (uint32_t i = 0; i < comparison->content->language_count; i++)
			compare(comparison, fields[n], comparison->content->languages[i]);
	compare(comparison, "thumbnail", "");
}

/* *out: NULL where the version has no valid file. Owned by the caller (cJSON_Delete). */
static int read_version(cJSON **out, struct site *site, const struct history_version *version,
			struct diagnostics *diagnostics)
{
	struct buffer text;
	int rc = 0;

	*out = NULL;
	if (!version->text_id[0]) /* removed */
		return 0;
	buffer_init(&text, PARTS_FILE_BYTES_MAX);
	rc = documents_read_version(site->documents, PARTS_FILE, version->id, &text, diagnostics);
	if (rc == 0)
		rc = json_parse(out, buffer_bytes(&text));
	buffer_finish(&text);
	return rc == -EBADMSG ? 0 : rc;
}

static int walk(cJSON *out, struct site *site, const char *id,
		const struct history_version *versions, uint32_t count,
		struct diagnostics *diagnostics)
{
	struct parts_file newer = { 0 }, older = { 0 };
	int rc = count > 0 ? read_version(&newer.root, site, &versions[0], diagnostics) : 0;

	for (uint32_t n = 0; rc == 0 && n < count; n++) {
		const bool is_first = n + 1 == count;
		struct comparison comparison = { &site->content, &versions[n], NULL, NULL, out };

		if (is_first && count == FIELD_HISTORY_VERSIONS_MAX)
			break; /* what was before is not known */
		if (!is_first)
			rc = read_version(&older.root, site, &versions[n + 1], diagnostics);
		comparison.before = parts_file_find(&older, id);
		comparison.after = parts_file_find(&newer, id);
		if (rc == 0)
			compare_part(&comparison);
		parts_file_finish(&newer);
		newer = older;
		older = (struct parts_file){ 0 };
	}
	parts_file_finish(&newer);
	return rc;
}

int field_history(cJSON *out, struct site *site, const char *id, struct diagnostics *diagnostics)
{
	struct history_version *versions = calloc(FIELD_HISTORY_VERSIONS_MAX, sizeof(*versions));
	uint32_t count = 0;
	int rc = versions ? documents_versions(site->documents, PARTS_FILE, versions,
					       FIELD_HISTORY_VERSIONS_MAX, &count, diagnostics)
			  : -ENOMEM;

	if (rc == 0)
		rc = walk(out, site, id, versions, count, diagnostics);
	free(versions);
	return rc;
}
