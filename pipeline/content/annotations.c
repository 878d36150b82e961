/* Tables that export and import of annotations share: selectors, Dublin Core elements, and purposes
 * of texts. */
#include "pipeline/content/annotations.h"

#include <stdlib.h>
#include <string.h>

#include "pipeline/content/annotations_private.h"

const struct annotation_selector annotation_selectors[ANNOTATION_SELECTORS] = {
	{ "sphere", "SphereSelector", { "centre", "radius" } },
	{ "box", "BoxSelector", { "centre", "half", "turn" } },
	{ "prism", "PrismSelector", { "floor", "roof", "corners" } },
	{ "faces", "FaceListSelector", { "file", "scan" } },
};

const char *const annotation_elements[ANNOTATION_ELEMENTS] = {
	"creator", "contributor", "publisher", "date",    "source",
	"rights",  "subject",     "coverage",  "relation"
};

const struct annotation_text annotation_texts[ANNOTATION_TEXTS] = {
	{ "title", "identifying" },
	{ "reading", "reading" },
	{ "caption", "describing" },
};

uint32_t annotation_languages(const cJSON *json, const char *languages[INFO_LANGUAGES_MAX])
{
	const cJSON *part;
	uint32_t count = 0;

	cJSON_ArrayForEach(part, cJSON_GetObjectItemCaseSensitive(json, "parts"))
	{
		const cJSON *titles = cJSON_GetObjectItemCaseSensitive(part, "title");

		for (const cJSON *t = titles ? titles->child : NULL; t && t->string; t = t->next) {
			uint32_t i = 0;

			while (i < count && i < INFO_LANGUAGES_MAX &&
			       strcmp(languages[i], t->string) != 0)
				i++;
			if (i < count)
				continue;
			if (count < INFO_LANGUAGES_MAX)
				languages[count] = t->string;
			count++;
		}
	}
	return count;
}

void annotations_finish(struct annotations *annotations)
{
	if (!annotations)
		return;
	buffer_finish(&annotations->json);
	for (uint32_t i = 0; i < annotations->picture_count; i++)
		free(annotations->pictures[i]);
	free(annotations->pictures);
	*annotations = (struct annotations){ 0 };
}
