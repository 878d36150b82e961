/* The order in which languages stand in for one another. */
#include "storage/info_languages.h"

#include <string.h>

static bool is_of_a_kind(const char *a, const char *b)
{
	const size_t size = strcspn(a, "-");

	return size == strcspn(b, "-") && strncmp(a, b, size) == 0;
}

struct info_order info_order_of(const struct info *info, const char *language)
{
	struct info_order order = { .count = 0 };

	/* Rounds: the same language, related ones, others. Every language is in one of these. */
	for (int round = 0; round < 3; round++)
		for (uint32_t i = 0; i < info->language_count; i++) {
			const char *other = info->languages[i];
			const bool same = language && strcmp(other, language) == 0;
			const bool of_a_kind = language && is_of_a_kind(other, language);

			if (round == (same ? 0 : of_a_kind ? 1 : 2))
				order.languages[order.count++] = i;
		}
	return order;
}

const char *info_first_of(const struct info_order *order, char *const *texts, uint32_t *found)
{
	for (uint32_t i = 0; i < order->count; i++) {
		const char *text = texts[order->languages[i]];

		if (text && found)
			*found = order->languages[i];
		if (text)
			return text;
	}
	return NULL;
}

uint32_t info_language_index(const struct info *info, const char *language)
{
	return info_order_of(info, language).languages[0];
}

uint32_t info_page_language(const struct info *info, const struct part *part, const char *language)
{
	const struct info_order order = info_order_of(info, language);

	for (uint32_t i = 0; i < order.count; i++)
		if (part->texts[order.languages[i]].has_page)
			return order.languages[i];
	return info->language_count;
}
