/* Looks up texts with glibc's gettext.
 *
 * gettext chooses catalogues by the environment variable LANGUAGE, but not in the locale "C". The
 * look-up therefore runs in a locale object of C.UTF-8, which glibc installs itself, and which is
 * set for the calling thread only: messages of the C library in the log stay English. Replacing
 * the value of LANGUAGE is safe beside other threads that read the environment, because
 * translate_open() adds the variable before there are any, and glibc keeps the old values. */
#include "ui/translate.h"

#include <ctype.h>
#include <errno.h>
#include <libintl.h>
#include <locale.h>
#include <stdbool.h>
#include <stdlib.h>

#define DOMAIN "gopura"

enum { LANGUAGE_BYTES = 36 }; /* the longest language tag that RFC 5646 asks programs to take */

static locale_t catalogues; /* 0: not open */

int translate_open(const char *folder)
{
	const locale_t before = catalogues;

	catalogues = newlocale(LC_MESSAGES_MASK, "C.UTF-8", (locale_t)0);
	if (before)
		freelocale(before);
	if (!catalogues)
		return -errno;
	if (!bindtextdomain(DOMAIN, folder) || !bind_textdomain_codeset(DOMAIN, "UTF-8") ||
	    setenv("LANGUAGE", "", 1) < 0)
		return -ENOMEM;
	return 0;
}

/* Spells a language tag as gettext does: pt_BR. Returns false if it is no tag; a path or a list of
 * languages would mean something else to gettext. */
static bool spell(const char *language, char out[LANGUAGE_BYTES])
{
	size_t i;

	for (i = 0; language[i]; i++) {
		if (i + 1 == LANGUAGE_BYTES ||
		    (!isalnum((unsigned char)language[i]) && language[i] != '-'))
			return false;
		out[i] = language[i] == '-' ? '_' : language[i];
	}
	out[i] = '\0';
	return i > 0;
}

/* Looks up a text, or the plural form for count if many is not NULL. Returns NULL if catalogues
 * cannot be asked. */
static const char *look_up(const char *language, const char *one, const char *many,
			   unsigned long count)
{
	char spelled[LANGUAGE_BYTES];
	const char *text;
	locale_t before;

	if (!catalogues || !spell(language, spelled))
		return NULL;
	if (setenv("LANGUAGE", spelled, 1) < 0)
		return NULL;
	before = uselocale(catalogues);
	textdomain(DOMAIN); /* makes gettext read LANGUAGE again */
	text = many ? dcngettext(DOMAIN, one, many, count, LC_MESSAGES)
		    : dcgettext(DOMAIN, one, LC_MESSAGES);
	uselocale(before);
	setenv("LANGUAGE", "", 1); /* Pango would take it for the user's preference */
	return text;
}

const char *translate(const char *language, const char *text)
{
	const char *found = look_up(language, text, NULL, 1);

	return found ? found : text;
}

const char *translate_plural(const char *language, const char *one, const char *many,
			     unsigned long count)
{
	const char *found = look_up(language, one, many, count);

	return found ? found : count == 1 ? one : many;
}
