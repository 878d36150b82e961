/* The catalogues of ui/po as the kiosk reads them: every language is complete and has its own
 * plural forms, and nothing but the answer changes with the language. */
#include "ui/translate.h"

#include <dirent.h>
#include <errno.h>
#include <locale.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/compiler.h"
#include "tests/check.h"
#include "ui/endonym.h"

static const char close_text[] = "Close";
static const char second_text[] = "Returning to the start in %d second";
static const char seconds_text[] = "Returning to the start in %d seconds";

enum { LANGUAGES_MIN = 18 }; /* besides English, whose texts are in the sources */

/* Calls check for the folder of each language. */
static int for_each_language(void (*check)(const char *language))
{
	DIR *folder = opendir(TEST_LOCALE);
	struct dirent *entry;
	int count = 0;

	CHECK(folder);
	while ((entry = readdir(folder)))
		if (entry->d_name[0] != '.') {
			check(entry->d_name);
			count++;
		}
	closedir(folder);
	return count;
}

static void check_answers(const char *language)
{
	if (strcmp(translate(language, close_text), close_text) == 0)
		fail_msg("%s: \"%s\" is in English", language, close_text);
	if (strcmp(ui_endonym(language), language) == 0)
		fail_msg("%s has no name for the visitor", language);
}

static void every_catalogue_answers(void **state)
{
	(void)state;
	CHECK(for_each_language(check_answers) >= LANGUAGES_MIN);
}

static void a_region_has_the_texts_of_its_language(void **state)
{
	(void)state;
	CHECK(strcmp(translate("pt", close_text), "Fechar") == 0);
	CHECK(strcmp(translate("pt-BR", close_text), "Fechar") == 0);
	CHECK(strcmp(translate("zh-Hant-TW", close_text), translate("zh", close_text)) == 0);
}

static void what_is_unknown_is_english(void **state)
{
	static const char *const unknown[] = { "en", "en-GB", "xx", "ptx", "", "C", "pt:fr" };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(unknown); i++)
		if (translate(unknown[i], close_text) != close_text)
			fail_msg("%s: %s", unknown[i], translate(unknown[i], close_text));
	CHECK(strcmp(translate("fr", "Of no catalogue"), "Of no catalogue") == 0);
	CHECK(strcmp(translate_plural("xx", second_text, seconds_text, 1), second_text) == 0);
	CHECK(strcmp(translate_plural("en", second_text, seconds_text, 2), seconds_text) == 0);
}

/* The language comes from a release: it must not lead to another folder. */
static void a_language_is_no_path(void **state)
{
	char path[300];

	(void)state;
	snprintf(path, sizeof(path), "../%s/fr", strrchr(TEST_LOCALE, '/') + 1);
	CHECK(translate(path, close_text) == close_text);
	CHECK(translate("fr/../fr", close_text) == close_text);
	CHECK(translate("fr.UTF-8", close_text) == close_text);
	memset(path, 'f', sizeof(path) - 1);
	path[sizeof(path) - 1] = '\0';
	CHECK(translate(path, close_text) == close_text);
}

static void numbers_take_the_plural_forms_of_the_language(void **state)
{
	static const struct {
		const char *language;
		unsigned long count;
		const char *text;
	} cases[] = {
		{ "en", 0, "Returning to the start in 0 seconds" },
		{ "en", 1, "Returning to the start in 1 second" },
		{ "en", 15, "Returning to the start in 15 seconds" },
		{ "fr", 0, "Retour au début dans 0 seconde" },
		{ "fr", 1, "Retour au début dans 1 seconde" },
		{ "fr", 2, "Retour au début dans 2 secondes" },
		{ "de", 1, "Zurück zum Anfang in 1 Sekunde" },
		{ "de", 0, "Zurück zum Anfang in 0 Sekunden" },
		{ "ru", 1, "Возврат к началу через 1 секунду" },
		{ "ru", 3, "Возврат к началу через 3 секунды" },
		{ "ru", 5, "Возврат к началу через 5 секунд" },
		{ "ru", 11, "Возврат к началу через 11 секунд" },
		{ "ru", 21, "Возврат к началу через 21 секунду" },
		{ "pl", 1, "Powrót do początku za 1 sekundę" },
		{ "pl", 2, "Powrót do początku za 2 sekundy" },
		{ "pl", 12, "Powrót do początku za 12 sekund" },
		{ "pl", 21, "Powrót do początku za 21 sekund" },
		{ "pl", 22, "Powrót do początku za 22 sekundy" },
		{ "ar", 1, "يعود إلى البداية بعد ثانية واحدة." },
		{ "ar", 2, "يعود إلى البداية بعد ثانيتين." },
		{ "ar", 3, "يعود إلى البداية بعد 3 ثوانٍ." },
		{ "ar", 10, "يعود إلى البداية بعد 10 ثوانٍ." },
		{ "ar", 11, "يعود إلى البداية بعد 11 ثانية." },
		{ "ja", 1, "あと1秒で最初にもどります。" },
		{ "ja", 2, "あと2秒で最初にもどります。" },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		char text[200];

		snprintf(text, sizeof(text),
			 translate_plural(cases[i].language, second_text, seconds_text,
					  cases[i].count),
			 (int)cases[i].count);
		if (strcmp(text, cases[i].text) != 0)
			fail_msg("%s, %lu: %s", cases[i].language, cases[i].count, text);
	}
}

/* Messages of the C library in the log stay English, and no other part of the program sees the
 * visitor's language. */
static void the_process_keeps_its_locale(void **state)
{
	char before[200], *after;

	(void)state;
	snprintf(before, sizeof(before), "%s", strerror(ENOENT));
	CHECK(strcmp(translate("fr", close_text), "Fermer") == 0);
	after = strerror(ENOENT);
	CHECK(strcmp(before, after) == 0 && strcmp(before, "No such file or directory") == 0);
	CHECK(strcmp(setlocale(LC_ALL, NULL), "C") == 0);
	CHECK(uselocale((locale_t)0) == LC_GLOBAL_LOCALE);
	CHECK(strcmp(getenv("LANGUAGE"), "") == 0);
}

static atomic_bool reading = true;

static void *read_environment(void *data)
{
	size_t *read = data;

	while (reading) {
		const char *language = getenv("LANGUAGE");

		*read += strlen(language) + (getenv("HOME") != NULL);
	}
	return NULL;
}

/* As Mesa's threads do beside the frame's. */
static void other_threads_may_read_the_environment(void **state)
{
	size_t read = 0;
	pthread_t thread;

	(void)state;
	CHECK(pthread_create(&thread, NULL, read_environment, &read) == 0);
	for (int i = 0; i < 20000; i++) {
		CHECK(strcmp(translate("fr", close_text), "Fermer") == 0);
		CHECK(strcmp(translate("de", close_text), "Schließen") == 0);
	}
	reading = false;
	CHECK(pthread_join(thread, NULL) == 0);
}

static void without_catalogues_all_is_english(void **state)
{
	(void)state;
	CHECK(translate("fr", close_text) == close_text);
	CHECK(translate_plural("fr", second_text, seconds_text, 1) == second_text);
	CHECK(translate_open(TEST_LOCALE) == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(without_catalogues_all_is_english), /* opens them */
		cmocka_unit_test(every_catalogue_answers),
		cmocka_unit_test(a_region_has_the_texts_of_its_language),
		cmocka_unit_test(what_is_unknown_is_english),
		cmocka_unit_test(a_language_is_no_path),
		cmocka_unit_test(numbers_take_the_plural_forms_of_the_language),
		cmocka_unit_test(the_process_keeps_its_locale),
		cmocka_unit_test(other_threads_may_read_the_environment),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
