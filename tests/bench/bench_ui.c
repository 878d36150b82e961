/* What words cost the thread that draws frames: CPU time of each piece, on a 1920 x 1080 panel.
 * bench_ui PAGE.html writes JSON to standard output. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "format/article.h"
#include "pipeline/content/page_compile.h"
#include "storage/plain_page.h"
#include "ui/overlay.h"
#include "ui/overlay_state.h"
#include "ui/translate.h"

enum { PARTS = 200, ROUNDS = 60 };

static struct overlay *overlay;

static void give_anchors(float turn)
{
	static struct overlay_anchor anchors[PARTS];

	for (int i = 0; i < PARTS; i++) {
		float angle = turn + (float)i * 2.4f, radius = 40 + 2 * (float)i;

		anchors[i] = (struct overlay_anchor){ .x_px = 960 + radius * 1.4f * cosf(angle),
						      .y_px = 450 + radius * sinf(angle),
						      .visible = true };
	}
	overlay_anchors(overlay, anchors, PARTS);
}

static int give_parts(void)
{
	static struct overlay_part parts[PARTS];
	static char titles[PARTS][40];

	for (int i = 0; i < PARTS; i++) {
		snprintf(titles[i], sizeof(titles[i]), "Gallery of reliefs, bay %d", i + 1);
		parts[i] = (struct overlay_part){ titles[i], "A caption of ordinary length.", "",
						  true };
	}
	return overlay_parts(overlay, parts, PARTS);
}

static int64_t worst(int64_t a, int64_t b)
{
	return a > b ? a : b;
}

static int64_t least(int64_t a, int64_t b)
{
	return a < b ? a : b;
}

/* Until nothing moves; the worst frame. */
static int64_t settle(int64_t *now_ms)
{
	int64_t most_us = 0, start_us;
	bool moving = true;

	while (moving) {
		start_us = clock_thread_us();
		moving = overlay_update(overlay, *now_ms += 16);
		most_us = worst(most_us, clock_thread_us() - start_us);
	}
	return most_us;
}

/* Opens the Khmer keyboard, the largest, and types; the worst frame of each. */
static void measure_search(int64_t *now_ms, int64_t *open_us, int64_t *typed_us)
{
	overlay_language(overlay, "km");
	settle(now_ms);
	for (int i = 0; i < 5; i++) {
		overlay_show_search(overlay, true);
		*open_us = worst(*open_us, settle(now_ms));
		for (uint32_t key = 0; key < 9; key++) {
			const uint32_t found[] = { key, key + 7, key + 20, key + 3, key + 90 };

			overlay_press(overlay, (int)key);
			overlay_found(overlay, found, ARRAY_COUNT(found));
			*typed_us = worst(*typed_us, settle(now_ms));
		}
		overlay_show_search(overlay, false);
		settle(now_ms);
	}
}

/* What the page costs before it is laid out: the least of some rounds. */
static void measure_forms(struct bytes html, struct bytes page)
{
	int64_t compile_us = INT64_MAX, decode_us = INT64_MAX, plain_us = INT64_MAX;

	for (int i = 0; i < 10; i++) {
		struct article_blocks article;
		struct buffer out;
		int64_t start_us = clock_thread_us();

		buffer_init(&out, ARTICLE_BYTES_MAX);
		if (page_compile(&out, html) < 0)
			exit(1);
		compile_us = least(compile_us, clock_thread_us() - start_us);
		buffer_clear(&out);
		start_us = clock_thread_us();
		if (plain_page(&out, html) < 0)
			exit(1);
		plain_us = least(plain_us, clock_thread_us() - start_us);
		buffer_finish(&out);
		start_us = clock_thread_us();
		if (article_decode(&article, page) < 0)
			exit(1);
		decode_us = least(decode_us, clock_thread_us() - start_us);
		article_finish(&article);
	}
	printf(" \"html_bytes\": %zu, \"compile_ms\": %.3f, \"decode_ms\": %.3f,"
	       " \"plain_ms\": %.3f,\n",
	       html.size, (double)compile_us / 1000, (double)decode_us / 1000,
	       (double)plain_us / 1000);
}

static void measure(struct bytes html, struct bytes page)
{
	int64_t now_ms = 1000, start_us, turn_us = 0, turn_most_us = 0, open_most_us = 0;
	int64_t update_most_us = 0, scroll_most_us = 0, search_us = 0, typed_us = 0;

	for (int i = 0; i < ROUNDS; i++) {
		give_anchors((float)i * 0.01f);
		start_us = clock_thread_us();
		overlay_update(overlay, now_ms += 16);
		start_us = clock_thread_us() - start_us;
		turn_us += start_us;
		turn_most_us = worst(turn_most_us, start_us);
	}
	for (int i = 0; i < 5; i++) {
		start_us = clock_thread_us();
		if (overlay_show_page(overlay, 0, page, "") < 0)
			exit(1);
		open_most_us = worst(open_most_us, clock_thread_us() - start_us);
		update_most_us = worst(update_most_us, settle(&now_ms));
		overlay_scroll(overlay, -600);
		scroll_most_us = worst(scroll_most_us, settle(&now_ms));
		overlay_close_page(overlay);
		settle(&now_ms);
	}
	measure_search(&now_ms, &search_us, &typed_us);
	printf("{\"panel\": \"1920x1080\", \"parts\": %d, \"page_bytes\": %zu,\n", PARTS,
	       page.size);
	measure_forms(html, page);
	printf(" \"turning_frame_ms\": %.2f, \"turning_frame_worst_ms\": %.2f,\n"
	       " \"page_open_worst_ms\": %.2f, \"page_frame_worst_ms\": %.2f,"
	       " \"scroll_frame_worst_ms\": %.2f,\n"
	       " \"search_open_worst_ms\": %.2f, \"letter_frame_worst_ms\": %.2f}\n",
	       (double)turn_us / ROUNDS / 1000, (double)turn_most_us / 1000,
	       (double)open_most_us / 1000, (double)update_most_us / 1000,
	       (double)scroll_most_us / 1000, (double)search_us / 1000, (double)typed_us / 1000);
}

int main(int argc, char **argv)
{
	static const char *const languages[] = { "en", "fr", "km", "ja" };
	const struct overlay_options options = {
		.width_px = 1920, .height_px = 1080, .languages = languages, .language_count = 4
	};
	struct buffer html, page;

	buffer_init(&html, 1 << 20);
	buffer_init(&page, ARTICLE_BYTES_MAX);
	if (argc != 2 || buffer_read_file(&html, argv[1]) < 0 || translate_open(TEST_LOCALE) < 0 ||
	    page_compile(&page, buffer_bytes(&html)) < 0 ||
	    overlay_create(&overlay, &options) < 0 || give_parts() < 0) {
		fprintf(stderr, "usage: bench_ui PAGE.html\n");
		return 1;
	}
	measure(buffer_bytes(&html), buffer_bytes(&page));
	overlay_destroy(overlay);
	buffer_finish(&html);
	buffer_finish(&page);
	return 0;
}
