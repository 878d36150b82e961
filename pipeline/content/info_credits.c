/* Reads "credits" of parts.json: Dublin Core statements about one part or all parts. */
#include "pipeline/content/info_credits.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* In the order in which a page shows them. Title, description, language, format and identifier are
 * already known from the part itself. */
static const char *const elements[] = { "creator", "contributor", "publisher", "date",    "source",
					"rights",  "subject",     "coverage",  "relation" };

static bool is_element(const char *key)
{
	for (size_t i = 0; i < ARRAY_COUNT(elements); i++)
		if (strcmp(key, elements[i]) == 0)
			return true;
	return false;
}

static void report(struct draft *draft, const struct draft_part *part, const char *key)
{
	diagnostics_add(draft->diagnostics, -EINVAL, "parts.json", part->line,
			"part \"%s\": credits: \"%.40s\" must be a text, a list of texts, or "
			"texts by language: {\"en\": \"...\"}",
			part->id, key);
}

/* Returns the language's index, or -1 if the release does not have it. */
static int find_language(const struct draft *draft, const char *code)
{
	for (uint32_t i = 0; i < draft->options->language_count; i++)
		if (strcmp(draft->options->languages[i], code) == 0)
			return (int)i;
	return -1;
}

static int add(struct draft *draft, struct draft_part *part, const char *element, int language,
	       const cJSON *json)
{
	const char *text = cJSON_GetStringValue(json);
	struct draft_credit *credit = &part->credits[part->credit_count];

	if (!text || strspn(text, " \t\r\n") == strlen(text)) {
		report(draft, part, element);
		return 0;
	}
	if (part->credit_count == DRAFT_CREDITS_MAX) {
		diagnostics_add(draft->diagnostics, -EINVAL, "parts.json", part->line,
				"part \"%s\": more than %d statements in its credits: shorten them",
				part->id, DRAFT_CREDITS_MAX);
		return 0;
	}
	*credit = (struct draft_credit){ element, language, strdup(text) };
	if (!credit->value)
		return -ENOMEM;
	part->credit_count++;
	return 0;
}

static int add_by_language(struct draft *draft, struct draft_part *part, const char *element,
			   const cJSON *json)
{
	int rc = 0;

	for (int i = 0; rc == 0 && i < (int)draft->options->language_count; i++) {
		const cJSON *text =
			cJSON_GetObjectItemCaseSensitive(json, draft->options->languages[i]);

		if (text)
			rc = add(draft, part, element, i, text);
	}
	if (!json->child)
		report(draft, part, element);
	/* Texts in other languages must be strings too, although this release does not use them. */
	for (const cJSON *text = json->child; text; text = text->next)
		if (find_language(draft, text->string) < 0 && !cJSON_IsString(text))
			report(draft, part, element);
	return rc;
}

static void check_elements(struct draft *draft, const struct draft_part *part, const cJSON *json)
{
	for (const cJSON *item = json ? json->child : NULL; item; item = item->next)
		if (item->string && !is_element(item->string))
			diagnostics_add(draft->diagnostics, -EINVAL, "parts.json", part->line,
					"part \"%s\": credits: \"%.40s\" is none of creator, "
					"contributor, publisher, date, source, rights, subject, "
					"coverage, relation",
					part->id, item->string);
}

int draft_read_credits(struct draft *draft, struct draft_part *part, const cJSON *json,
		       const cJSON *all)
{
	int rc = 0;

	if ((json && !cJSON_IsObject(json)) || (all && !cJSON_IsObject(all)))
		report(draft, part, "credits");
	check_elements(draft, part, json);
	if (draft->part_count == 1) /* reported only once, with the first part */
		check_elements(draft, part, all);
	for (size_t i = 0; rc == 0 && i < ARRAY_COUNT(elements); i++) {
		const cJSON *said = cJSON_GetObjectItemCaseSensitive(json, elements[i]);

		if (!said)
			said = cJSON_GetObjectItemCaseSensitive(all, elements[i]);
		if (cJSON_IsObject(said)) {
			rc = add_by_language(draft, part, elements[i], said);
		} else if (cJSON_IsArray(said)) {
			for (const cJSON *one = said->child; one && rc == 0; one = one->next)
				rc = add(draft, part, elements[i], -1, one);
		} else if (said) {
			rc = add(draft, part, elements[i], -1, said);
		}
	}
	return rc;
}
