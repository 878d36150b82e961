/* Pages in scripts that are not set by placing letter after letter: as Pango itself sets them, in
 * lines that begin where a reader of the language begins one. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tests/ui/compiled.h"
#include "ui/article_layout.h"
#include "ui/theme.h"

enum { WIDTH_PX = 420, VIEW_PX = 900, PX_PER_MM = 5, TEXT_BYTES = 2000 };

/* Sentences of ours; Khmer has zero-width spaces between words, as its writers set them. */
static const struct {
	const char *language, *text;
	const char *never_first; /* letters that no line begins with */
	bool shaped;             /* letters change beside others, or stack */
} scripts[] = {
	{ "km",
	  "ប្រាង្គ\u200bខ្ពស់\u200bជាង​គេ\u200bក្នុង\u200bចំណោម\u200bប្រាង្គ\u200bទាំង\u200bប្រាំ "
	  "ស្ថិត\u200bលើ\u200bបន្ទប់\u200bខាង\u200bក្នុង\u200bបំផុត\u200bនៃ\u200bប្រាសាទ។ "
	  "នៅ\u200bពេល\u200bព្រឹក\u200bព្រះអាទិត្យ\u200bរះ\u200bពី\u200bក្រោយ\u200bកំពូល។",
	  "ាិីឹឺុូួើឿៀេែៃោៅំះៈ៉៊់៌៍្។", true },
	{ "th",
	  "ปรางค์องค์กลางสูงที่สุดในห้าองค์ ตั้งอยู่เหนือห้องชั้นในสุดของปราสาท ทุกเช้าพระอาทิตย์ขึ้นหลังยอดปราสาท "
	  "และนักท่องเที่ยวมารอดูตั้งแต่ก่อนรุ่งสาง",
	  "ะัาำิีึืฺุู็่้๊๋์ๆ", true },
	{ "hi",
	  "पाँच शिखरों में सबसे ऊँचा शिखर मन्दिर के सबसे भीतरी कक्ष के ऊपर खड़ा है। हर सुबह सूर्य इसके पीछे से "
	  "उगता है और यात्री उसकी प्रतीक्षा करते हैं।",
	  "ािीुूृेैोौंँः़्।", true },
	{ "ar",
	  "يقف أعلى الأبراج الخمسة فوق أعمق حجرات المعبد، ولم يدخلها جمع من الناس قط. تشرق الشمس كل صباح من "
	  "خلف القمة وينتظرها الزوار قبل الفجر.",
	  "،.ًٌٍَُِّْ", true },
	{ "ja",
	  "五つの塔のうち最も高い塔は、神殿のいちばん奥の部屋の上に立っています。毎朝、太陽は塔のうしろから昇り、"
	  "人々は夜明け前から「そのとき」を待っています。",
	  "、。」ー", false },
};
enum { SCRIPTS = ARRAY_COUNT(scripts) };

static cairo_surface_t *blank(void)
{
	cairo_surface_t *surface =
		cairo_image_surface_create(CAIRO_FORMAT_RGB24, WIDTH_PX, VIEW_PX);
	cairo_t *context = cairo_create(surface);

	theme_set_source(context, theme_paper, 1);
	cairo_paint(context);
	cairo_destroy(context);
	return surface;
}

/* The page of one paragraph, as the kiosk draws it. */
static cairo_surface_t *page_of(const struct theme *theme, const char *text, int *unknown)
{
	const struct article_layout_options options = { .theme = theme,
							.width_px = WIDTH_PX,
							.view_px = VIEW_PX };
	cairo_surface_t *surface = blank();
	cairo_t *context = cairo_create(surface);
	struct article_layout *article;
	char html[TEXT_BYTES];

	snprintf(html, sizeof(html), "<p>%s</p>", text);
	CHECK(article_layout_create(&article, &options, compiled(html)) == 0);
	*unknown = article_layout_unknown_glyphs(article);
	article_layout_draw(article, context, 0, VIEW_PX);
	article_layout_destroy(article);
	cairo_destroy(context);
	cairo_surface_flush(surface);
	return surface;
}

/* A layout of nothing but Pango's: a context of its own, the page's type, the column's width. */
static PangoLayout *plain_layout(const struct theme *theme, const char *language, const char *text,
				 int column_px)
{
	PangoLayout *like = theme_layout(theme, TEXT_BODY, "", column_px), *layout;
	PangoContext *context = pango_font_map_create_context(pango_cairo_font_map_get_default());

	pango_context_set_language(context, pango_language_from_string(language));
	pango_cairo_context_set_font_options(context,
					     pango_cairo_context_get_font_options(theme->context));
	pango_context_set_round_glyph_positions(context, FALSE);
	layout = pango_layout_new(context);
	pango_layout_set_font_description(layout, pango_layout_get_font_description(like));
	pango_layout_set_line_spacing(layout, pango_layout_get_line_spacing(like));
	pango_layout_set_wrap(layout, PANGO_WRAP_WORD_CHAR);
	pango_layout_set_width(layout, column_px * PANGO_SCALE);
	pango_layout_set_text(layout, text, -1);
	g_object_unref(context);
	g_object_unref(like);
	return layout;
}

static uint32_t pixel(cairo_surface_t *surface, int x, int y)
{
	const unsigned char *row = cairo_image_surface_get_data(surface) +
				   (size_t)y * (size_t)cairo_image_surface_get_stride(surface);
	uint32_t value;

	memcpy(&value, row + 4 * x, 4);
	return value & 0xffffff;
}

/* Of the picture's pixels that one of both has ink on, the share that differ by an eighth or more.
 */
static double difference(cairo_surface_t *a, cairo_surface_t *b)
{
	const uint32_t paper = pixel(a, 0, 0);
	uint32_t ink = 0, differ = 0;

	for (int y = 0; y < VIEW_PX; y++) {
		for (int x = 0; x < WIDTH_PX; x++) {
			const uint32_t p = pixel(a, x, y), q = pixel(b, x, y);
			const int green = (int)(p >> 8 & 0xff) - (int)(q >> 8 & 0xff);

			ink += p != paper || q != paper;
			differ += abs(green) >= 32;
		}
	}
	CHECK(ink > 500);
	return (double)differ / ink;
}

static int first_ink_row(cairo_surface_t *surface)
{
	const uint32_t paper = pixel(surface, 0, 0);

	for (int y = 0; y < VIEW_PX; y++)
		for (int x = 0; x < WIDTH_PX; x++)
			if (pixel(surface, x, y) != paper)
				return y;
	return -1;
}

static cairo_surface_t *drawn_at(PangoLayout *layout, int x_px, int y_px)
{
	cairo_surface_t *surface = blank();
	cairo_t *context = cairo_create(surface);

	theme_set_source(context, theme_ink, 1);
	cairo_move_to(context, x_px, y_px);
	pango_cairo_show_layout(context, layout);
	cairo_destroy(context);
	cairo_surface_flush(surface);
	return surface;
}

/* At the page's margin, its first ink on the row where the page has it. */
static cairo_surface_t *drawn(PangoLayout *layout, int margin_px, int ink_row)
{
	cairo_surface_t *surface = drawn_at(layout, margin_px, 0);
	const int y_px = ink_row - first_ink_row(surface);

	cairo_surface_destroy(surface);
	return drawn_at(layout, margin_px, y_px);
}

/* Letter for letter: what a program shows that knows no shaping. */
static void part_letters(const char *text, char out[4 * TEXT_BYTES])
{
	char *end = out;

	for (const char *at = text; *at;) {
		const char *next = g_utf8_next_char(at);

		memcpy(end, at, (size_t)(next - at));
		end += next - at;
		memcpy(end, "\u200c", 3); /* zero-width non-joiner */
		end += 3;
		at = next;
	}
	*end = '\0';
}

static void is_set_as_pango_sets_it(void **state)
{
	(void)state;
	for (size_t i = 0; i < SCRIPTS; i++) {
		struct theme theme;
		cairo_surface_t *page, *reference;
		PangoLayout *layout;
		char parted[4 * TEXT_BYTES];
		const int margin_px = 8 * PX_PER_MM, column_px = WIDTH_PX - 2 * margin_px;
		double same, other;
		int unknown;

		CHECK(theme_init(&theme, PX_PER_MM, scripts[i].language) == 0);
		page = page_of(&theme, scripts[i].text, &unknown);
		if (unknown > 0)
			fail_msg("%s: no font has %d of its glyphs", scripts[i].language, unknown);
		layout = plain_layout(&theme, scripts[i].language, scripts[i].text, column_px);
		reference = drawn(layout, margin_px, first_ink_row(page));
		same = difference(page, reference);
		if (getenv("GOPURA_PICTURES")) {
			char path[300];

			snprintf(path, sizeof(path), "%s/script-%s.png", getenv("GOPURA_PICTURES"),
				 scripts[i].language);
			cairo_surface_write_to_png(page, path);
			snprintf(path, sizeof(path), "%s/script-%s-pango.png",
				 getenv("GOPURA_PICTURES"), scripts[i].language);
			cairo_surface_write_to_png(reference, path);
		}
		if (same > 0.01)
			fail_msg("%s: %.3f of its ink is not where Pango has it",
				 scripts[i].language, same);
		cairo_surface_destroy(reference);
		g_object_unref(layout);
		part_letters(scripts[i].text, parted);
		layout = plain_layout(&theme, scripts[i].language, parted, column_px);
		reference = drawn(layout, margin_px, first_ink_row(page));
		other = difference(page, reference);
		if (scripts[i].shaped && other < 0.1)
			fail_msg("%s: letters apart look the same (%.3f)", scripts[i].language,
				 other);
		cairo_surface_destroy(reference);
		cairo_surface_destroy(page);
		g_object_unref(layout);
		theme_finish(&theme);
	}
}

/* At many widths: no line begins with a mark that belongs to the letter before it, or that ends a
 * sentence. */
static void breaks_lines_where_readers_do(void **state)
{
	uint32_t lines = 0;

	(void)state;
	for (size_t i = 0; i < SCRIPTS; i++) {
		struct theme theme;

		CHECK(theme_init(&theme, PX_PER_MM, scripts[i].language) == 0);
		for (int width_px = 120; width_px < 600; width_px += 13) {
			PangoLayout *layout =
				theme_layout(&theme, TEXT_BODY, scripts[i].text, width_px);

			for (int n = 0; n < pango_layout_get_line_count(layout); n++) {
				const PangoLayoutLine *line =
					pango_layout_get_line_readonly(layout, n);
				const char *begins = scripts[i].text + line->start_index;

				lines++;
				if (g_utf8_strchr(scripts[i].never_first, -1,
						  g_utf8_get_char(begins)))
					fail_msg("%s, %d px: a line begins with %.12s",
						 scripts[i].language, width_px, begins);
			}
			g_object_unref(layout);
		}
		theme_finish(&theme);
	}
	CHECK(lines > 1000);
}

/* A family by the name of its files: "Noto Serif CJK JP" is in NotoSerifCJK-Bold.ttc. */
static void file_of(const char *family, char *out)
{
	const char *end = strstr(family, "CJK") ? strstr(family, "CJK") + 3 : strchr(family, 0);

	for (; family < end; family++)
		if (*family != ' ')
			*out++ = *family;
	*out++ = '-';
	*out = 0;
}

/* What is set in one family here is set in the same on the appliance, which has those of a list. */
static void every_font_is_in_the_image(void **state)
{
	static const struct {
		const char *language, *text;
	} texts[] = {
		{ "en", "tower" }, { "km", "ប្រាង្គ" },  { "ja", "塔" },     { "zh", "塔" },
		{ "ko", "탑" },    { "ar", "برج" },    { "th", "ปรางค์" },  { "hi", "शिखर" },
		{ "ru", "башня" }, { "el", "πύργος" }, { "he", "מגדל" },   { "fa", "برج" },
		{ "lo", "ຫໍ" },     { "my", "စင်" },     { "ta", "கோபுரம்" }, { "vi", "Tháp" },
	};
	static char list[8192];
	FILE *file = fopen("image/fonts", "r");
	size_t size;

	(void)state;
	CHECK(file);
	size = fread(list, 1, sizeof(list) - 1, file);
	list[size] = 0;
	fclose(file);
	for (size_t i = 0; i < ARRAY_COUNT(texts); i++) {
		struct theme theme;

		CHECK(theme_init(&theme, PX_PER_MM, texts[i].language) == 0);
		for (int style = 0; style < TEXT_STYLE_COUNT; style++) {
			PangoLayout *layout =
				theme_layout(&theme, (enum text_style)style, texts[i].text, -1);
			GSList *run = pango_layout_get_line_readonly(layout, 0)->runs;

			for (; run; run = run->next) {
				PangoFontDescription *font = pango_font_describe(
					((PangoGlyphItem *)run->data)->item->analysis.font);
				char name[200];

				file_of(pango_font_description_get_family(font), name);
				if (!strstr(list, name))
					fail_msg("%s: image/fonts has no %s", texts[i].language,
						 name);
				/* Of its own script, not what some other font has of it. */
				CHECK(strncmp(name, "Noto", 4) == 0);
				pango_font_description_free(font);
			}
			g_object_unref(layout);
		}
		theme_finish(&theme);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(is_set_as_pango_sets_it),
		cmocka_unit_test(breaks_lines_where_readers_do),
		cmocka_unit_test(every_font_is_in_the_image),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
