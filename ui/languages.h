/* The languages of a release, and which of them is set. */
#ifndef GOPURA_UI_LANGUAGES_H
#define GOPURA_UI_LANGUAGES_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"
#include "ui/overlay_data.h"

struct languages {
	char *codes[OVERLAY_LANGUAGES_MAX]; /* owned: "en", "pt-BR" */
	uint32_t count;
	int current; /* index of the language that is set */
};

/* Copies 1 .. OVERLAY_LANGUAGES_MAX codes; the first is set. Returns -ENOMEM; free it then too. */
must_check int languages_copy(struct languages *out, const char *const *codes, uint32_t count);
void languages_free(struct languages *languages); /* zeroed is fine */
/* Sets a language. Returns false, and changes nothing, if there is no such language. */
bool languages_set(struct languages *languages, const char *code);

/* Returns whether a tag such as "pt-BR" is of that language ("pt"). */
bool languages_is(const char *tag, const char *language);

#endif
