/* Finds and sets the texts of a part. */
#include "curator/pages/part_change.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_tree.h"

static const char *const by_language[] = { "title", "caption", "reading" };
static const char documents[] = "documents"; /* names, each on a line */
static const char *const credits[] = { "creator", "contributor", "publisher", "date",    "source",
				       "rights",  "subject",     "coverage",  "relation" };

static bool is_one_of(const char *field, const char *const *names, size_t count)
{
	for (size_t n = 0; n < count; n++)
		if (strcmp(field, names[n]) == 0)
			return true;
	return false;
}

/* Several texts of a credit are lines. */
static void put_value(struct buffer *out, const cJSON *value)
{
	const cJSON *item;

	if (cJSON_IsString(value))
		buffer_put_text(out, value->valuestring);
	if (!cJSON_IsArray(value))
		return;
	cJSON_ArrayForEach(item, value)
	{
		if (!cJSON_IsString(item))
			continue;
		if (out->size > 0)
			buffer_put_u8(out, '\n');
		buffer_put_text(out, item->valuestring);
	}
}

/* Returns what a text of no language becomes, owned; several lines, and the names of documents, are
 * a list. NULL: no memory. */
static cJSON *make_value(const char *key, const char *text)
{
	cJSON *list, *item;

	if (!strchr(text, '\n') && strcmp(key, documents) != 0)
		return cJSON_CreateString(text);
	list = cJSON_CreateArray();
	while (list && *text) {
		const size_t bytes = strcspn(text, "\n");
		char *line = strndup(text, bytes);

		item = line ? cJSON_CreateString(line) : NULL;
		free(line);
		if (!item || (bytes > 0 && !json_append(list, item))) {
			cJSON_Delete(list);
			return NULL;
		}
		if (bytes == 0)
			cJSON_Delete(item);
		text += bytes + (text[bytes] == '\n');
	}
	return list;
}

/* Where a text is: a member of an object that may be missing. */
struct place {
	cJSON *holder;     /* the part, or its credits; NULL: they are missing too */
	const char *outer; /* member of the part that holds the credits; NULL: none */
	const char *key;
	const char *language; /* member of the member; "": none */
};

static int find_place(cJSON *part, const struct part_change *change, struct place *out,
		      struct diagnostics *diagnostics)
{
	const char *field = change->field;
	const bool has_language = change->language[0];
	const cJSON *now;

	*out = (struct place){ part, NULL, field, change->language };
	if (is_one_of(field, by_language, ARRAY_COUNT(by_language)) && has_language)
		return 0;
	if ((strcmp(field, "thumbnail") == 0 || strcmp(field, documents) == 0) && !has_language)
		return 0;
	if (is_one_of(field, credits, ARRAY_COUNT(credits))) {
		out->outer = "credits";
		out->holder = cJSON_GetObjectItemCaseSensitive(part, "credits");
		now = cJSON_GetObjectItemCaseSensitive(out->holder, field);
		if (!now || cJSON_IsObject(now) == has_language)
			return 0;
	}
	return diagnostics_add(diagnostics, -EINVAL, NULL, 0,
			       "a part has no text \"%.40s\", or not by language", field);
}

static void read_place(const struct place *place, struct buffer *out)
{
	const cJSON *value = cJSON_GetObjectItemCaseSensitive(place->holder, place->key);

	if (place->language[0])
		value = cJSON_IsObject(value)
				? cJSON_GetObjectItemCaseSensitive(value, place->language)
				: NULL;
	put_value(out, value);
}

/* A text in a language is one text, with its lines: a list would be none to whoever reads it. */
static int set(cJSON *object, const char *key, const char *text, bool has_language)
{
	cJSON *value;

	if (!*text) {
		cJSON_DeleteItemFromObjectCaseSensitive(object, key);
		return 0;
	}
	value = has_language ? cJSON_CreateString(text) : make_value(key, text);
	return json_set(object, key, value) ? 0 : -ENOMEM;
}

static int write_place(cJSON *part, struct place *place, const char *text)
{
	cJSON *texts;

	if (!cJSON_IsObject(place->holder)) {
		place->holder = cJSON_CreateObject();
		if (!json_set(part, place->outer, place->holder))
			return -ENOMEM;
	}
	if (!place->language[0])
		return set(place->holder, place->key, text, false);
	texts = cJSON_GetObjectItemCaseSensitive(place->holder, place->key);
	if (!cJSON_IsObject(texts)) {
		texts = cJSON_CreateObject();
		if (!json_set(place->holder, place->key, texts))
			return -ENOMEM;
	}
	return set(texts, place->language, text, true);
}

/* Objects that a change has left empty go with it. */
static void tidy(cJSON *part, const struct place *place)
{
	const cJSON *texts = cJSON_GetObjectItemCaseSensitive(place->holder, place->key);

	if (cJSON_IsObject(texts) && !texts->child)
		cJSON_DeleteItemFromObjectCaseSensitive(place->holder, place->key);
	if (place->outer && !place->holder->child)
		cJSON_DeleteItemFromObjectCaseSensitive(part, place->outer);
}

int part_change_make(cJSON *part, const struct part_change *change, struct buffer *theirs,
		     struct diagnostics *diagnostics)
{
	struct place place;
	int rc = find_place(part, change, &place, diagnostics);

	if (rc < 0)
		return rc;
	buffer_clear(theirs);
	read_place(&place, theirs);
	buffer_put_u8(theirs, 0);
	if (theirs->error)
		return theirs->error;
	if (strcmp((const char *)theirs->data, change->to) == 0)
		return 0;
	if (strcmp((const char *)theirs->data, change->from) != 0)
		return -ESTALE;
	rc = write_place(part, &place, change->to);
	if (rc == 0)
		tidy(part, &place);
	return rc;
}

static int index_of(const cJSON *list, const char *id)
{
	const cJSON *part;
	int n = 0;

	cJSON_ArrayForEach(part, list)
	{
		const cJSON *its = cJSON_GetObjectItemCaseSensitive(part, "id");

		if (cJSON_IsString(its) && strcmp(its->valuestring, id) == 0)
			return n;
		n++;
	}
	return -ENOENT;
}

/* The list is made anew, because cJSON 1.7.15 may lose an item that is inserted after another was
 * detached. */
int part_change_place(const struct parts_file *parts, const char *id, const char *before)
{
	cJSON *list = parts_file_list(parts), *ordered, *part, *next;
	const int from = index_of(list, id);

	if (from < 0 || (*before && index_of(list, before) < 0))
		return -ENOENT;
	if (strcmp(id, before) == 0)
		return 0;
	ordered = cJSON_CreateArray();
	if (!ordered)
		return -ENOMEM;
	part = cJSON_DetachItemFromArray(list, from);
	while ((next = cJSON_DetachItemFromArray(list, 0))) {
		const char *its =
			cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(next, "id"));

		if (part && *before && its && strcmp(its, before) == 0) {
			json_append(ordered, part);
			part = NULL;
		}
		json_append(ordered, next);
	}
	if (part)
		json_append(ordered, part);
	return json_set(parts->root, "parts", ordered) ? 0 : -ENOMEM;
}

int part_change_remove(const struct parts_file *parts, const char *id)
{
	cJSON *list = parts_file_list(parts);
	const int at = index_of(list, id);

	if (at < 0)
		return at;
	cJSON_DeleteItemFromArray(list, at);
	return 0;
}
