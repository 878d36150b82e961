/* Private to storage: which language stands in where a text is missing. */
#ifndef GOPURA_STORAGE_INFO_LANGUAGES_H
#define GOPURA_STORAGE_INFO_LANGUAGES_H

#include "storage/info_private.h"

/* All languages, in the order in which they replace a missing text: the requested one, related ones
 * ("pt" for "pt-BR", and the reverse), then those of the release in its order. */
struct info_order {
	uint32_t languages[INFO_LANGUAGES_MAX], count;
};
/* language may be NULL: the release's order. */
struct info_order info_order_of(const struct info *info, const char *language);
/* Returns the first text in that order, or NULL. *found (may be NULL) is set to its language. */
const char *info_first_of(const struct info_order *order, char *const *texts, uint32_t *found);
/* Returns the index of the best match for a language. */
uint32_t info_language_index(const struct info *info, const char *language);
/* Returns the best language in which a part has a page, or language_count if none has. */
uint32_t info_page_language(const struct info *info, const struct part *part, const char *language);

#endif
