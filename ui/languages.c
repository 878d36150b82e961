/* Keeps copies of the languages' codes. */
#include "ui/languages.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

int languages_copy(struct languages *out, const char *const *codes, uint32_t count)
{
	*out = (struct languages){ 0 };
	for (uint32_t i = 0; i < count; i++) {
		out->codes[i] = strdup(codes[i]);
		if (!out->codes[i])
			return -ENOMEM;
		out->count++;
	}
	return 0;
}

void languages_free(struct languages *languages)
{
	for (uint32_t i = 0; i < languages->count; i++)
		free(languages->codes[i]);
	*languages = (struct languages){ 0 };
}

bool languages_set(struct languages *languages, const char *code)
{
	for (uint32_t i = 0; i < languages->count; i++) {
		if (strcmp(languages->codes[i], code) != 0)
			continue;
		languages->current = (int)i;
		return true;
	}
	return false;
}

bool languages_is(const char *tag, const char *language)
{
	const size_t size = strlen(language);

	return strncmp(tag, language, size) == 0 && (tag[size] == '\0' || tag[size] == '-');
}
