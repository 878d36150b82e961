/* What a visitor's query finds, in which order, in scripts with and without spaces; and the credits
 * of a part. */
#include <errno.h>
#include <sqlite3.h>

#include "storage/info_ask.h"
#include "storage/info_index.h"
#include "storage/words.h"
#include "tests/pipeline/content/info_folder.h"

static const char *const languages[] = { "en", "fr", "km", "ja", "ko", "zh" };

static const char parts[] =
	"{\"credits\": {\"rights\": {\"en\": \"© The museum\", \"fr\": \"© Le musée\"}, \"date\": "
	"\"2026\"},\n"
	"\"parts\": [\n"
	"{\"id\": \"tower\", \"anchor\": [0, 0, 1],\n"
	"  \"title\": {\"en\": \"Central tower\", \"fr\": \"Tour centrale\", \"km\": "
	"\"ប្រាង្គកណ្តាល\", \"ja\": \"中央塔\", \"ko\": \"중앙 탑\", \"zh\": "
	"\"中央塔\"},\n"
	"  \"reading\": {\"ja\": \"ちゅうおうとう\", \"zh\": \"zhōngyāng tǎ zhongyangta\"},\n"
	"  \"caption\": {\"en\": \"The mountain above the gate.\", \"fr\": \"Élevée au cœur.\"},\n"
	"  \"credits\": {\"creator\": [\"A. Mason\", \" B.\\n\\tMason \"], \"date\": \"1150\",\n"
	"    \"subject\": {\"en\": \"Sanctuary, prang\", \"fr\": \"Sanctuaire\"}}},\n"
	"{\"id\": \"naga\", \"anchor\": [0, 0, 2],\n"
	"  \"title\": {\"en\": \"Naga balustrade\", \"fr\": \"Balustrade de nāgas\", \"km\": "
	"\"បង្កាន់ដៃនាគ\", \"ja\": \"ナーガの欄干\"},\n"
	"  \"caption\": {\"en\": \"Of porous stone.\"}},\n"
	"{\"id\": \"gate\", \"anchor\": [0, 0, 3], \"page\": false,\n"
	"  \"title\": {\"en\": \"East gate\", \"fr\": \"Porte est\", \"km\": \"គោបុរៈ\", \"ja\": "
	"\"東の塔門\"}}\n"
	"]}\n";

static int set_up_search(void **state)
{
	int rc = set_up(state);

	write_text("parts.json", parts);
	write_text("pages/naga.en.html",
		   "<h1>Naga</h1><p>A ser<em>pent</em> leads to the gate; see the "
		   "<a href=\"part:tower\">tower</a>.</p><table><tr><td>one</td><td>two</td></tr>"
		   "</table>");
	return rc;
}

static void build_folder(struct info_built *out, int expected)
{
	const struct info_build_options options = { .folder = folder,
						    .languages = languages,
						    .language_count = ARRAY_COUNT(languages),
						    .diagnostics = &told };

	diagnostics_finish(&told);
	if (info_build(out, &options) != expected)
		fail_msg("%s", told.count ? told.first.text : "no diagnostic");
}

static struct info *open_folder(void)
{
	struct info_built built;
	struct info *info;

	build_folder(&built, 0);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	info_built_finish(&built);
	return info;
}

/* The ids of what is found, such as "gate tower". */
static const char *found(struct info *info, const char *query, const char *language)
{
	static char text[200];
	uint32_t list[8], count = info_search(info, query, language, list, 8);

	text[0] = 0;
	for (uint32_t i = 0; i < count; i++)
		snprintf(text + strlen(text), sizeof(text) - strlen(text), "%s%s", i ? " " : "",
			 info_part(info, list[i])->id);
	return text;
}

#define FINDS(query, language, ids)                                                                \
	do {                                                                                       \
		const char *got = found(info, query, language);                                    \
		if (strcmp(got, ids) != 0)                                                         \
			fail_msg("\"%s\" (%s) finds \"%s\", not \"%s\"", query, language, got,     \
				 ids);                                                             \
	} while (0)

static void a_word_is_found_as_it_is_typed(void **state)
{
	struct info *info = open_folder();

	(void)state;
	FINDS("b", "en", "naga");
	FINDS("bal", "en", "naga");
	FINDS("balustrade", "en", "naga");
	FINDS("balustrades", "en", "");
	FINDS("lustrade", "en", ""); /* words begin where words begin */
	FINDS("naga bal", "en", "naga");
	FINDS("bal naga", "en", "naga");
	FINDS("naga tower", "en", "naga"); /* its page says tower */
	FINDS("serpent", "en", "naga");    /* marked up in the middle of the word */
	FINDS("onetwo", "en", "");         /* two cells are two words */
	FINDS("", "en", "");
	FINDS(" \t-*\"'(", "en", "");
	info_close(info);
}

static void titles_come_before_captions_before_pages(void **state)
{
	struct info *info = open_folder();
	uint32_t list[1];

	(void)state;
	FINDS("gate", "en", "gate tower naga");
	CHECK(info_search(info, "gate", "en", list, 1) == 1 && list[0] == 2);
	info_close(info);
}

static void subjects_are_searched_as_captions_are(void **state)
{
	struct info *info = open_folder();

	(void)state;
	FINDS("sanctuary", "en", "tower");
	FINDS("prang", "en", "tower");
	FINDS("sanctuaire", "fr", "tower");
	info_close(info);
}

static void the_visitors_language_comes_first(void **state)
{
	struct info *info = open_folder();

	(void)state;
	FINDS("tour", "fr", "tower");
	FINDS("tour", "en", "tower");    /* other languages answer too */
	FINDS("por", "en", "naga gate"); /* its caption before a French title */
	FINDS("por", "fr", "gate naga");
	info_close(info);
}

static void accents_case_and_widths_make_no_difference(void **state)
{
	struct info *info = open_folder();

	(void)state;
	FINDS("NAGAS", "fr", "naga");
	FINDS("nâgas", "fr", "naga");
	FINDS("elevee", "fr", "tower");
	FINDS("coeur", "fr", "tower");
	FINDS("cœur", "fr", "tower");
	FINDS("ＴＯＷＥＲ", "en", "tower naga"); /* full width */
	info_close(info);
}

static void scripts_without_spaces_are_found_anywhere(void **state)
{
	struct info *info = open_folder();

	(void)state;
	FINDS("欄", "ja", "naga");
	FINDS("なーが", "ja", "naga"); /* hiragana finds katakana */
	FINDS("央塔", "ja", "tower");
	FINDS("塔央", "ja", "");
	FINDS("ちゅうおう", "ja", "tower"); /* by its reading */
	FINDS("កណ្តាល", "km", "tower");
	FINDS("កណ្", "km", "tower"); /* half a cluster, while it is typed */
	FINDS("នាគ", "km", "naga");
	FINDS("បង្កាន់\xe2\x80\x8bដៃ", "km", "naga"); /* U+200B between words or not */
	info_close(info);
}

static void korean_is_found_by_its_letters_and_chinese_by_pinyin(void **state)
{
	static const char *const typed[] = { "ㅈ",   "주",   "중",      "중ㅇ",
					     "중아", "중앙", "중앙 ㅌ", "중앙 탑" };
	struct info *info = open_folder();

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(typed); i++)
		FINDS(typed[i], "ko", "tower");
	FINDS("주ㅏ", "ko", "");
	FINDS("앙", "ko", ""); /* words begin where words begin */
	FINDS("中央", "zh", "tower");
	FINDS("zhongyang", "zh", "tower");
	FINDS("zhong ta", "zh", "tower");
	FINDS("zhongyangta", "zh", "tower");
	info_close(info);
}

/* Itself, those of its kind, then as the release has them. */
static void languages_stand_in_for_one_another(void **state)
{
	static const char *const others[] = { "en", "km", "pt-BR", "pt" };
	const struct info_build_options options = { .folder = folder,
						    .languages = others,
						    .language_count = ARRAY_COUNT(others),
						    .diagnostics = &told };
	const char *language;
	struct info_built built;
	struct bytes article;
	struct info *info;

	(void)state;
	write_text("parts.json",
		   "{\"parts\": [{\"id\": \"tower\", \"anchor\": [0, 0, 1], \"title\": {\"en\": "
		   "\"Tower\", \"pt\": \"Torre\"}},\n{\"id\": \"lion\", \"anchor\": [0, 0, 2], "
		   "\"title\": {\"en\": \"Lion\"}}]}");
	write_text("pages/tower.pt.html", "<h1>Torre</h1>");
	write_text("pages/tower.en.html", "<h1>Tower</h1>");
	write_text("pages/lion.pt-BR.html", "<h1>Leão</h1>");
	write_text("pages/lion.en.html", "<h1>Lion</h1>");
	CHECK(info_build(&built, &options) == 0);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	CHECK(strcmp(info_text(info, 0, "pt-BR").title, "Torre") == 0);
	CHECK(strcmp(info_text(info, 0, "pt-AO").title, "Torre") == 0);
	CHECK(strcmp(info_text(info, 0, "km").title, "Tower") == 0);
	CHECK(strcmp(info_text(info, 1, "pt").title, "Lion") == 0);
	CHECK(info_page(info, 0, "pt-BR", &article, &language) == 0 && strcmp(language, "pt") == 0);
	CHECK(info_page(info, 0, "km", &article, &language) == 0 && strcmp(language, "km") == 0);
	CHECK(info_page(info, 1, "pt", &article, &language) == 0 && strcmp(language, "pt-BR") == 0);
	CHECK(info_page(info, 1, "xx", &article, &language) == 0 && strcmp(language, "en") == 0);
	CHECK(strcmp(info_nearest_language(info, "pt"), "pt") == 0);
	CHECK(strcmp(info_nearest_language(info, "pt-AO"), "pt-BR") == 0);
	CHECK(strcmp(info_nearest_language(info, "km-KH"), "km") == 0);
	CHECK(strcmp(info_nearest_language(info, "p"), "en") == 0);
	CHECK(strcmp(info_nearest_language(info, ""), "en") == 0);
	info_close(info);
	info_built_finish(&built);
}

static void a_query_of_operators_or_rubbish_is_only_words(void **state)
{
	struct info *info = open_folder();
	char long_query[3000];

	(void)state;
	FINDS("NEAR", "en", "");
	FINDS("gate\" OR \"naga", "en", "");
	FINDS("title : gate", "en", "");
	FINDS("ga\xffte", "en", "gate tower naga"); /* what is no UTF-8 ends it */
	memset(long_query, 'a', sizeof(long_query));
	long_query[sizeof(long_query) - 1] = 0;
	FINDS(long_query, "en", "");
	for (size_t i = 1; i < sizeof(long_query) - 1; i += 2)
		long_query[i] = ' ';
	FINDS(long_query, "en", "tower naga"); /* "a": above; A ser.. */
	info_close(info);
}

static bool take(void *data, int64_t content_id)
{
	(void)content_id;
	*(uint32_t *)data += 1;
	return true;
}

/* Operators, quotes, halves of characters: whatever a text holds, FTS5 gets words of it. */
static void no_text_is_an_error_of_syntax(void **state)
{
	static const char *const pieces[] = { "\"",   "*",    "(",   ")",    " AND ", " OR ",
					      "NOT ", "NEAR", "{a}", "^",    ":",     "+",
					      "-",    "gate", "塔",  "\xe5", "\xff",  "\x01",
					      "ក្",    "\t",   "'",   ";",    "\\",    "--",
					      "a",    "é" };
	struct info_built built;
	unsigned char *image;
	uint32_t random = 3, found = 0;
	sqlite3 *db;

	(void)state;
	build_folder(&built, 0);
	CHECK(sqlite3_open(":memory:", &db) == SQLITE_OK);
	image = sqlite3_malloc64(built.database.size);
	memcpy(image, built.database.data, built.database.size);
	CHECK(sqlite3_deserialize(db, "main", image, (sqlite3_int64)built.database.size,
				  (sqlite3_int64)built.database.size,
				  SQLITE_DESERIALIZE_FREEONCLOSE) == SQLITE_OK);
	for (int i = 0; i < 5000; i++) {
		char text[100] = "";

		for (int k = 0; k < 8; k++) {
			random = random * 1664525u + 1013904223u;
			strncat(text, pieces[(random >> 8) % ARRAY_COUNT(pieces)], 10);
		}
		if (info_index_find(db, text, take, &found) != SQLITE_OK)
			fail_msg("\"%s\": %s", text, sqlite3_errmsg(db));
	}
	CHECK(found > 100);
	sqlite3_close(db);
	info_built_finish(&built);
}

static void words_are_folded_as_the_header_says(void **state)
{
	static const struct {
		const char *text, *words;
	} cases[] = {
		{ "Élève, 12th-century!", " eleve 12th century" },
		{ "Straße Œuvre", " strasse oeuvre" },
		{ "カンボジア", " か ん ぼ じ あ" },
		{ "12世紀", " 12 世 紀" },
		{ "مَعْبَد", " معبد" },
		{ "أنغكور", " انغكور" },
		{ "کوهی", " كوهي" },
		{ "Πύργος", " πυργοσ" },
		{ "앙코르 닭ㄱ", " ㅇㅏㅇㅋㅗㄹㅡ ㄷㅏㄹㄱㄱ" },
		{ "ปราสาท", " ป ร า ส า ท" },
		{ "मंदिर", " मंदिर" },
		{ "", "" },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct buffer out;

		buffer_init(&out, 1000);
		CHECK(words_of(&out, cases[i].text) == 0);
		buffer_put_u8(&out, 0);
		if (strcmp((char *)out.data, cases[i].words) != 0)
			fail_msg("\"%s\" gives \"%s\"", cases[i].text, (char *)out.data);
		buffer_finish(&out);
	}
}

static void credits_are_of_the_part_or_of_all(void **state)
{
	struct info *info = open_folder();

	(void)state;
	CHECK(strcmp(info_credits(info, 0, "en"), "A. Mason · B. Mason · 1150 · © The museum") ==
	      0);
	CHECK(strcmp(info_credits(info, 1, "fr"), "2026 · © Le musée") == 0);
	CHECK(strcmp(info_credits(info, 1, "ja"), "2026 · © The museum") == 0);
	info_close(info);
}

static void credits_that_are_no_dublin_core_are_refused(void **state)
{
	static const struct {
		const char *credits, *words;
	} cases[] = {
		{ "{\"author\": \"x\"}", "none of creator" },
		{ "{\"rights\": 7}", "\"rights\" must be a text" },
		{ "{\"rights\": \"  \"}", "\"rights\" must be a text" },
		{ "{\"rights\": {}}", "\"rights\" must be a text" },
		{ "{\"rights\": {\"de\": 3}}", "\"rights\" must be a text" },
		{ "[]", "\"credits\" must be a text" },
	};
	struct info_built built;
	char text[400];

	(void)state;
	for (size_t i = 0; i < 2 * ARRAY_COUNT(cases); i++) {
		const char *credits = cases[i / 2].credits;

		if (i % 2)
			snprintf(text, sizeof(text),
				 "{\"credits\": %s, \"parts\": [\n{\"id\": \"a\", \"anchor\": "
				 "[0,0,0], \"page\": false, \"title\": {\"en\": \"x\"}}]}",
				 credits);
		else
			snprintf(text, sizeof(text),
				 "{\"parts\": [\n{\"id\": \"a\", \"anchor\": [0,0,0], \"page\": "
				 "false, \"title\": {\"en\": \"x\"}, \"credits\": %s}]}",
				 credits);
		write_text("parts.json", text);
		build_folder(&built, -EINVAL);
		if (!was_told("parts.json", 2, cases[i / 2].words))
			fail_msg("case %zu: %s", i, told.first.text);
	}
}

/* Damage of the index alone finds less; nothing breaks, and the texts are there. */
static void a_damaged_index_finds_less_and_breaks_nothing(void **state)
{
	struct info_built built;
	uint32_t random = 7, list[8];

	(void)state;
	build_folder(&built, 0);
	for (int i = 0; i < 400; i++) {
		struct buffer *image = &built.database;
		size_t at = (random = random * 1664525u + 1013904223u) % image->size;
		uint8_t before = image->data[at];
		struct info *info;

		image->data[at] ^= (uint8_t)(1 + (random >> 24) % 255);
		if (info_open(&info, buffer_bytes(image)) == 0) {
			for (size_t l = 0; l < 4; l++)
				CHECK(info_search(info, "塔 gate na", languages[l], list, 8) <= 8);
			CHECK(info_search(info, "ga", "en", list, 8) <= 8);
			CHECK(info_credits(info, 0, "fr"));
		}
		info_close(info);
		image->data[at] = before;
	}
	info_built_finish(&built);
}

int main(void)
{
#define IN_A_FOLDER(claim) cmocka_unit_test_setup_teardown(claim, set_up_search, tear_down)
	const struct CMUnitTest tests[] = {
		IN_A_FOLDER(a_word_is_found_as_it_is_typed),
		IN_A_FOLDER(titles_come_before_captions_before_pages),
		IN_A_FOLDER(subjects_are_searched_as_captions_are),
		IN_A_FOLDER(the_visitors_language_comes_first),
		IN_A_FOLDER(no_text_is_an_error_of_syntax),
		IN_A_FOLDER(accents_case_and_widths_make_no_difference),
		IN_A_FOLDER(scripts_without_spaces_are_found_anywhere),
		IN_A_FOLDER(korean_is_found_by_its_letters_and_chinese_by_pinyin),
		IN_A_FOLDER(languages_stand_in_for_one_another),
		IN_A_FOLDER(a_query_of_operators_or_rubbish_is_only_words),
		cmocka_unit_test(words_are_folded_as_the_header_says),
		IN_A_FOLDER(credits_are_of_the_part_or_of_all),
		IN_A_FOLDER(credits_that_are_no_dublin_core_are_refused),
		IN_A_FOLDER(a_damaged_index_finds_less_and_breaks_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
