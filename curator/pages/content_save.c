/* Judges the folder before and after a change, and compares. */
#include "curator/pages/content_save.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <string.h>

#include "base/json_tree.h"

int content_check(const struct site *site, const struct info_text_instead *instead, uint32_t count,
		  struct diagnostics *out)
{
	const struct content *content = &site->content;
	const char *languages[CONTENT_LANGUAGES_MAX];
	const struct info_build_options options = { .folder = content->folder,
						    .languages = languages,
						    .language_count = content->language_count,
						    .tools = content->tools,
						    .instead = instead,
						    .instead_count = count,
						    .skims_pictures = true,
						    .diagnostics = out };
	struct draft *draft;
	int rc;

	*out = (struct diagnostics){ .max = CONTENT_PROBLEMS_MAX };
	for (uint32_t n = 0; n < content->language_count; n++)
		languages[n] = content->languages[n];
	rc = info_read(&draft, &options);
	info_draft_destroy(draft);
	return rc == -EINVAL ? 0 : rc;
}

/* The file and the sentence, without the line between them, which moves as texts change. */
static bool is_same(const struct diagnostic *a, const struct diagnostic *b)
{
	const size_t file = strcspn(a->text, ":");

	return a->error == b->error && strncmp(a->text, b->text, file + 1) == 0 &&
	       strcmp(a->text + a->place_bytes, b->text + b->place_bytes) == 0;
}

static bool has(const struct diagnostics *list, const struct diagnostic *one)
{
	for (uint32_t n = 0; n < list->count; n++)
		if (is_same(diagnostics_get(list, n), one))
			return true;
	return false;
}

/* Copies the faults that only `after` has. Returns how many. */
static uint32_t list_new(const struct diagnostics *before, const struct diagnostics *after,
			 struct diagnostics *out)
{
	uint32_t count = 0;

	for (uint32_t n = 0; n < after->count; n++) {
		const struct diagnostic *one = diagnostics_get(after, n);
		const size_t file = strcspn(one->text, ":");
		char name[DIAGNOSTIC_BYTES];

		if (one->error == 0 || has(before, one))
			continue;
		memcpy(name, one->text, file);
		name[one->place_bytes > 0 ? file : 0] = '\0';
		diagnostics_add(out, -EINVAL, *name ? name : NULL, one->line, "%s",
				one->text + one->place_bytes);
		count++;
	}
	return count;
}

static int judge(const struct site *site, const struct document_change *changes, uint32_t count,
		 struct diagnostics *problems)
{
	struct info_text_instead instead[DOCUMENTS_CHANGES_MAX];
	struct diagnostics before = { 0 }, after;
	int rc;

	for (uint32_t n = 0; n < count; n++) {
		instead[n] = (struct info_text_instead){ changes[n].name, changes[n].text };
		if (changes[n].removes)
			instead[n].text = (struct bytes){ 0 };
	}
	rc = content_check(site, instead, count, &after);
	if (rc == 0 && after.error_count > 0)
		rc = content_check(site, NULL, 0, &before);
	if (rc < 0)
		diagnostics_add(problems, rc, site->content.folder, 0, "%s", strerror(-rc));
	else if (list_new(&before, &after, problems) > 0)
		rc = -EINVAL;
	diagnostics_finish(&before);
	diagnostics_finish(&after);
	return rc;
}

int content_save(struct site *site, struct document_change *changes, uint32_t count,
		 const char *author, const char *what, struct diagnostics *problems)
{
	int rc;

	documents_lock(site->documents);
	rc = judge(site, changes, count, problems);
	if (rc == 0)
		rc = documents_save(site->documents, changes, count, author, what, problems);
	documents_unlock(site->documents);
	return rc;
}

cJSON *content_problems(const struct diagnostics *problems, const char *file)
{
	cJSON *list = cJSON_CreateArray();
	const size_t wanted = strlen(file);

	for (uint32_t n = 0; list && n < problems->count; n++) {
		const struct diagnostic *one = diagnostics_get(problems, n);
		const size_t named = one->place_bytes > 0 ? strcspn(one->text, ":") : 0;
		char name[DIAGNOSTIC_BYTES];
		cJSON *row;

		if (wanted > 0 && (named != wanted || memcmp(one->text, file, named) != 0))
			continue;
		memcpy(name, one->text, named);
		name[named] = '\0';
		row = cJSON_CreateObject();
		cJSON_AddStringToObject(row, "file", name);
		cJSON_AddNumberToObject(row, "line", one->line);
		cJSON_AddStringToObject(row, "text", one->text + one->place_bytes);
		cJSON_AddBoolToObject(row, "error", one->error < 0);
		json_append(list, row);
	}
	return list;
}
