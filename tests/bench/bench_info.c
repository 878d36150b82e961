/* What the information database costs: bench_info FOLDER builds it of a content folder in English,
 * French, Khmer and Japanese, opens it, and asks it. JSON to standard output. */
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "pipeline/content/info_build.h"
#include "storage/info_ask.h"

enum { ROUNDS = 50, FOUND_MAX = 100 };

static double ms_since(int64_t start_us)
{
	return (double)(clock_thread_us() - start_us) / 1000;
}

/* As a visitor types: a letter, more of them, a word, two, in three scripts. */
static void ask(struct info *info)
{
	static const char *const queries[][2] = { { "t", "en" },     { "the", "en" },
						  { "tower", "en" }, { "naga tow", "en" },
						  { "塔", "ja" },    { "なーが", "ja" },
						  { "ប្រា", "km" },   { "pierre", "fr" } };
	double most_ms = 0, least_ms = 1e9;
	uint32_t parts[FOUND_MAX], found = 0;

	for (size_t i = 0; i < ARRAY_COUNT(queries); i++) {
		int64_t start_us = clock_thread_us();
		double mean_ms;

		for (int round = 0; round < ROUNDS; round++)
			found += info_search(info, queries[i][0], queries[i][1], parts, FOUND_MAX);
		mean_ms = ms_since(start_us) / ROUNDS;
		most_ms = mean_ms > most_ms ? mean_ms : most_ms;
		least_ms = mean_ms < least_ms ? mean_ms : least_ms;
	}
	printf(" \"search_least_ms\": %.2f, \"search_most_ms\": %.2f, \"found\": %u}\n", least_ms,
	       most_ms, found / ROUNDS);
}

static double read_pages(struct info *info)
{
	int64_t start_us = clock_thread_us();
	struct bytes article;
	uint32_t count = 0;

	for (int round = 0; round < ROUNDS; round++)
		for (uint32_t part = 0; part < info_part_count(info); part++)
			count += info_page(info, part, "km", &article, NULL) == 0;
	return count ? ms_since(start_us) / count : 0;
}

int main(int argc, char **argv)
{
	static const char *const languages[] = { "en", "fr", "km", "ja" };
	struct diagnostics diagnostics = { 0 };
	struct info_build_options options = { .folder = argc == 2 ? argv[1] : "",
					      .languages = languages,
					      .language_count = 4,
					      .diagnostics = &diagnostics };
	struct info_built built;
	struct info *info;
	int64_t start_us = clock_thread_us();

	if (argc != 2 || info_build(&built, &options) < 0) {
		diagnostics_print(&diagnostics, stderr, "");
		fprintf(stderr, "usage: bench_info FOLDER\n");
		return 1;
	}
	printf("{\"parts\": %u, \"pages\": %u, \"bytes\": %zu, \"build_ms\": %.1f,\n",
	       built.part_count, built.page_count, built.database.size, ms_since(start_us));
	start_us = clock_thread_us();
	if (info_open(&info, buffer_bytes(&built.database)) < 0)
		return 1;
	printf(" \"open_ms\": %.2f,", ms_since(start_us));
	printf(" \"page_ms\": %.4f,\n", read_pages(info));
	ask(info);
	info_close(info);
	info_built_finish(&built);
	return 0;
}
