/* The kiosk's own texts in the visitor's language, from the gettext catalogues of ui/po.
 *
 * The English text stands in the source, where it is used; `make po` collects it for translators.
 * One thread: a look-up sets the environment variable LANGUAGE, by which gettext chooses. */
#ifndef GOPURA_UI_TRANSLATE_H
#define GOPURA_UI_TRANSLATE_H

#include "base/compiler.h"

/* Marks a text in a constant table, which translate() receives later. */
#define N_(text) text

/* Opens the catalogues FOLDER/LANGUAGE/LC_MESSAGES/gopura.mo. Call it before the program starts
 * threads. The process's locale stays as it is. Returns a negative errno, after which every text
 * is English. -ENOENT: the system has no locale C.UTF-8. */
must_check int translate_open(const char *folder);

/* Returns a text in a language ("km", "pt-BR"): from the catalogue of the region, otherwise from
 * that of the language, otherwise the English text itself. Never NULL; valid as long as the
 * program runs. */
const char *translate(const char *language, const char *text) __attribute__((format_arg(2)));
/* The same with a number: chooses the language's plural form for count. Both texts contain %d; a
 * form that fits one number only may spell it out. */
const char *translate_plural(const char *language, const char *one, const char *many,
			     unsigned long count) __attribute__((format_arg(2), format_arg(3)));

#endif
