/* Documents that follow the pages of several parts, and several of one part. */
#include <errno.h>

#include "storage/info.h"
#include "tests/pipeline/content/info_folder.h"

static const char parts[] =
	"{\"parts\": [\n"
	"{\"id\": \"tower\", \"anchor\": [0, 0, 1], \"title\": {\"en\": \"Tower\"},\n"
	" \"documents\": [\"works\", \"gate\"]},\n"
	"{\"id\": \"gate\", \"anchor\": [0, 0, 2], \"title\": {\"en\": \"Gate\"}},\n"
	"{\"id\": \"naga\", \"anchor\": [0, 0, 3], \"title\": {\"en\": \"Naga\"}, \"page\": false,\n"
	" \"documents\": [\"works\"]}]}\n";

static void write_documents(void)
{
	write_text("parts.json", parts);
	write_text("pages/works.en.html",
		   "<html><body><h2>Works</h2><p>Stones were put back in 1998.</p>"
		   "<img src=\"pictures/b.png\" alt=\"Works\"></body></html>");
}

/* Where a text is in a part's article; -1: it is not there. */
static int place(struct info *info, const char *part, const char *text)
{
	struct bytes article;
	const uint8_t *at;

	if (info_page(info, (uint32_t)info_find(info, part), "en", &article, NULL) < 0)
		return -1;
	at = memmem(article.data, article.size, text, strlen(text));
	return at ? (int)(at - article.data) : -1;
}

static void one_document_is_on_the_pages_of_several_parts(void **state)
{
	struct info_built built;
	struct info *info;

	(void)state;
	write_documents();
	CHECK(build(&built) == 0);
	CHECK(info_open(&info, buffer_bytes(&built.database)) == 0);
	/* Its own page, then its documents in their order, of which one is another part's page. */
	CHECK(place(info, "tower", "Central tower") > 0);
	CHECK(place(info, "tower", "1998") > place(info, "tower", "Central tower"));
	CHECK(place(info, "tower", "One enters here") > place(info, "tower", "1998"));
	CHECK(place(info, "gate", "One enters here") > 0 && place(info, "gate", "1998") < 0);
	CHECK(place(info, "naga", "1998") > 0 && info_part(info, 2)->has_page);
	CHECK(info_find_picture(info, "pictures/b.png"));
	info_close(info);
	info_built_finish(&built);
}

static void a_document_that_is_missing_or_named_wrongly_is_told(void **state)
{
	static const char *const wrong[][2] = {
		{ "[\"works\", \"works\"]", "each once" },
		{ "[\"tower\"]", "each once" },
		{ "[\"../x\"]", "each once" },
		{ "[7]", "each once" },
		{ "\"works\"", "must be a list" },
		{ "[\"nothing\"]", "write pages/nothing.en.html" },
	};
	struct info_built built;
	char text[400];

	(void)state;
	write_documents();
	for (unsigned n = 0; n < ARRAY_COUNT(wrong); n++) {
		snprintf(text, sizeof(text),
			 "{\"parts\": [\n{\"id\": \"tower\", \"anchor\": [0, 0, 1], \"title\":"
			 " {\"en\": \"Tower\"}, \"documents\": %s}]}",
			 wrong[n][0]);
		write_text("parts.json", text);
		CHECK(build(&built) == -EINVAL);
		CHECK(was_told("parts.json", 2, wrong[n][1]));
	}
}

static void faults_of_a_document_have_its_file_and_line(void **state)
{
	struct info_built built;

	(void)state;
	write_documents();
	write_text("pages/works.en.html", "<p>x</p>\n<p><a href=\"part:nobody\">y</a></p>");
	CHECK(build(&built) == -EINVAL);
	CHECK(was_told("pages/works.en.html", 2, "no part has that id"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(one_document_is_on_the_pages_of_several_parts,
						set_up, tear_down),
		cmocka_unit_test_setup_teardown(a_document_that_is_missing_or_named_wrongly_is_told,
						set_up, tear_down),
		cmocka_unit_test_setup_teardown(faults_of_a_document_have_its_file_and_line, set_up,
						tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
