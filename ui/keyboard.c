/* The on-screen keyboard: the letters of each language, the layout of keys, drawing and typing. */
#include "ui/keyboard.h"

#include <stdio.h>
#include <string.h>

#include "base/hangul.h"
#include "ui/icon.h"
#include "ui/languages.h"

#define ROW_MM     11.0f
#define COLUMN_MM  14.0f
#define KEY_GAP_MM 0.5f /* margin around each drawn key, inside its target */

static const char latin[] = "q w e r t y u i o p\na s d f g h j k l\nz x c v b n m";

/* Rows from top to bottom, keys from the left. Kana run from the right, as in a kana table. Chinese
 * gets Latin letters, for Pinyin. */
static const struct {
	const char *language, *rows;
} layouts[] = {
	{ "en", latin },
	{ "fr", "a z e r t y u i o p\nq s d f g h j k l m\nw x c v b n '" },
	{ "km", "ក ខ គ ឃ ង ច ឆ ជ ឈ ញ ដ\nឋ ឌ ឍ ណ ត ថ ទ ធ ន ប ផ\nព ភ ម យ រ ល វ ស ហ ឡ អ\n"
		"្ ា ិ ី ឹ ឺ ុ ូ ួ ើ ឿ\nៀ េ ែ ៃ ោ ៅ ំ ះ ់ ៉ ៊\nឥ ឧ ឪ ឫ ឬ ឭ ឮ ឯ ឱ ័ ៍" },
	{ "ja", "ー わ ら や ま は な た さ か あ\n\xe3\x82\x99 を り ゃ み ひ に ち し き い\n"
		"\xe3\x82\x9a ん る ゆ む ふ ぬ つ す く う\nぁ ょ れ ゅ め へ ね て せ け え\n"
		"ぃ っ ろ よ も ほ の と そ こ お" },
	{ "ar", "ض ص ث ق ف غ ع ه خ ح ج\nش س ي ب ل ا ت ن م ك ط\nذ ئ ء ؤ ر ى ة و ز ظ د" },
	{ "th", "ก ข ฃ ค ฅ ฆ ง จ ฉ ช ซ\nฌ ญ ฎ ฏ ฐ ฑ ฒ ณ ด ต ถ\nท ธ น บ ป ผ ฝ พ ฟ ภ ม\n"
		"ย ร ล ว ศ ษ ส ห ฬ อ ฮ\nะ ั า ำ ิ ี ึ ื ุ ู เ\nแ โ ใ ไ ็ ่ ้ ๊ ๋ ์ ๆ" },
	{ "hi", "अ आ इ ई उ ऊ ऋ ए ऐ ओ औ\nा ि ी ु ू ृ े ै ो ौ ्\nक ख ग घ ङ च छ ज झ ञ ट\n"
		"ठ ड ढ ण त थ द ध न प फ\nब भ म य र ल व श ष स ह\nं ः ँ ़ ळ" },
	{ "ko", "ㅂ ㅈ ㄷ ㄱ ㅅ ㅛ ㅕ ㅑ ㅐ ㅔ\nㅁ ㄴ ㅇ ㄹ ㅎ ㅗ ㅓ ㅏ ㅣ\n"
		"ㅋ ㅌ ㅊ ㅍ ㅠ ㅜ ㅡ\nㅃ ㅉ ㄸ ㄲ ㅆ ㅒ ㅖ" },
	{ "ru", "й ц у к е н г ш щ з х ъ\nф ы в а п р о л д ж э\nя ч с м и т ь б ю" },
	{ "uk", "й ц у к е н г ш щ з х ї\nф і в а п р о л д ж є\nґ я ч с м и т ь б ю" },
	{ "el", "ς ε ρ τ υ θ ι ο π\nα σ δ φ γ η ξ κ λ\nζ χ ψ ω β ν μ" },
	{ "he", "ק ר א ט ו ן ם פ\nש ד ג כ ע י ח ל ך ף\nז ס ב ה נ מ צ ת ץ" },
	{ "fa", "ض ص ث ق ف غ ع ه خ ح ج\nش س ی ب ل ا ت ن م ک گ\nظ ط ز ژ ر ذ د پ و چ ء" },
	{ "lo", "ກ ຂ ຄ ງ ຈ ສ ຊ ຍ ດ ຕ ຖ\nທ ນ ບ ປ ຜ ຝ ພ ຟ ມ ຢ ຣ\nລ ວ ຫ ໜ ໝ ອ ຮ ຽ ຼ ັ ົ\n"
		"ະ າ ຳ ິ ີ ຶ ື ຸ ູ ໆ ໌\nເ ແ ໂ ໃ ໄ ່ ້ ໊ ໋" },
	{ "my", "က ခ ဂ ဃ င စ ဆ ဇ ဈ ည ဉ\nဋ ဌ ဍ ဎ ဏ တ ထ ဒ ဓ န ပ\nဖ ဗ ဘ မ ယ ရ လ ဝ သ ဟ ဠ\n"
		"အ ဣ ဤ ဥ ဦ ဧ ဩ ဪ ဿ ျ ြ\nွ ှ ါ ာ ိ ီ ု ူ ေ ဲ ံ\n့ း ် ္" },
	{ "ta", "அ ஆ இ ஈ உ ஊ எ ஏ ஐ ஒ ஓ\nா ி ீ ு ூ ெ ே ை ொ ோ ்\n"
		"க ங ச ஞ ட ண த ந ப ம ய\nர ல வ ழ ள ற ன ஜ ஷ ஸ ஹ\nஔ ௌ ஃ" },
};

/* ---- layout ---- */

static const char *find_rows(const char *language)
{
	for (size_t i = 0; i < ARRAY_COUNT(layouts); i++)
		if (languages_is(language, layouts[i].language))
			return layouts[i].rows;
	return latin;
}

static bool is_latin(const char *rows)
{
	return (unsigned char)rows[0] < 0x80;
}

/* Returns the number of keys in the longest row. */
static int count_columns(const char *rows)
{
	int most = 0, count = 1;

	for (const char *p = rows; *p; p++) {
		count = *p == '\n' ? 1 : count + (*p == ' ');
		if (count > most)
			most = count;
	}
	return most;
}

static struct keyboard_key *add(struct keyboard *keyboard, enum keyboard_key_kind kind)
{
	struct keyboard_key *key = &keyboard->keys[keyboard->key_count++];

	*key = (struct keyboard_key){ .kind = kind };
	return key;
}

/* Kana form a table: the rows have a meaning and must not be rearranged. */
static bool is_table(const char *rows)
{
	return rows == find_rows("ja");
}

/* Places letters in rows of at most `columns` cells. Until place_cells(), x_px is the column and
 * y_px the row. on: one row continues into the next. Returns the number of rows. */
static int place_letters(struct keyboard *keyboard, const char *rows, int columns, bool on)
{
	int row = 0, column = 0;

	keyboard->key_count = 0;
	while (*rows) {
		size_t size = strcspn(rows, " \n");
		struct keyboard_key *key;

		if (column == columns) {
			row++;
			column = 0;
		}
		key = add(keyboard, KEY_TEXT);
		snprintf(key->text, sizeof(key->text), "%.*s", (int)size, rows);
		key->x_px = column++;
		key->y_px = row;
		rows += size;
		if (*rows == '\n' && !on) {
			row++;
			column = 0;
		}
		rows += *rows != 0;
	}
	return row + 1;
}

/* Converts cells into pixels and centres each row. */
static void place_cells(struct keyboard *keyboard, int column_px, int row_px)
{
	for (uint32_t first = 0; first < keyboard->key_count;) {
		uint32_t end = first;
		int left_px;

		while (end < keyboard->key_count &&
		       keyboard->keys[end].y_px == keyboard->keys[first].y_px)
			end++;
		left_px = (keyboard->width_px - (int)(end - first) * column_px) / 2;
		for (; first < end; first++) {
			struct keyboard_key *key = &keyboard->keys[first];

			key->x_px = left_px + key->x_px * column_px;
			key->width_px = column_px;
			key->height_px = row_px;
		}
	}
	for (uint32_t i = 0; i < keyboard->key_count; i++)
		keyboard->keys[i].y_px *= row_px;
}

/* The bottom row: switch to other letters, space, backspace. */
static void place_bottom(struct keyboard *keyboard, int y_px, int row_px, bool has_latin,
			 int column_px)
{
	int side_px = 2 * column_px, space_px = 5 * column_px, x_px;

	if (2 * side_px + space_px > keyboard->width_px)
		space_px = keyboard->width_px - 2 * side_px;
	x_px = (keyboard->width_px - 2 * side_px - space_px) / 2;
	if (has_latin)
		*add(keyboard, KEY_LATIN) =
			(struct keyboard_key){ KEY_LATIN, "", x_px, y_px, side_px, row_px };
	x_px += has_latin ? side_px : side_px / 2;
	*add(keyboard, KEY_SPACE) =
		(struct keyboard_key){ KEY_SPACE, "", x_px, y_px, space_px, row_px };
	*add(keyboard, KEY_BACKSPACE) =
		(struct keyboard_key){ KEY_BACKSPACE, "", x_px + space_px, y_px, side_px, row_px };
}

void keyboard_layout(struct keyboard *out, const struct theme *theme, const char *language,
		     bool use_latin, int width_px, int most_height_px)
{
	const char *own = find_rows(language), *rows = use_latin ? latin : own;
	int target_px = theme_px(theme, THEME_TARGET_MM), columns = count_columns(rows);
	int most_rows = most_height_px / target_px;
	int column_px, row_px, row_count;

	*out = (struct keyboard){ .width_px = width_px, .latin = use_latin };
	if (columns * target_px > width_px)
		columns = width_px / target_px > 4 ? width_px / target_px : 4;
	row_count = place_letters(out, rows, columns, false) + 1;
	/* If the panel is too low, let rows run on into longer ones. */
	while (row_count > most_rows && !is_table(rows) && (columns + 1) * target_px <= width_px)
		row_count = place_letters(out, rows, ++columns, true) + 1;
	column_px = width_px / columns;
	if (column_px > theme_px(theme, COLUMN_MM))
		column_px = theme_px(theme, COLUMN_MM);
	row_px = theme_px(theme, ROW_MM);
	if (row_px * row_count > most_height_px)
		row_px = most_height_px / row_count > 1 ? most_height_px / row_count : 1;
	place_cells(out, column_px, row_px);
	place_bottom(out, (row_count - 1) * row_px, row_px, !is_latin(own), column_px);
	out->height_px = row_count * row_px;
}

int keyboard_key_at(const struct keyboard *keyboard, float x_px, float y_px)
{
	for (uint32_t i = 0; i < keyboard->key_count; i++) {
		const struct keyboard_key *key = &keyboard->keys[i];

		if (x_px >= (float)key->x_px && x_px < (float)(key->x_px + key->width_px) &&
		    y_px >= (float)key->y_px && y_px < (float)(key->y_px + key->height_px))
			return (int)i;
	}
	return -1;
}

/* ---- drawing ---- */

/* A combining mark is shown on a dotted circle. The two kana marks have signs of their own. */
static void label_of(const struct keyboard *keyboard, const struct keyboard_key *key, char *label,
		     size_t label_bytes)
{
	gunichar c = g_utf8_get_char(key->text);

	if (key->kind == KEY_LATIN)
		snprintf(label, label_bytes, "%s", keyboard->latin ? "← abc" : "abc");
	else if (c == 0x3099 || c == 0x309a)
		snprintf(label, label_bytes, "%s", c == 0x3099 ? "゛" : "゜");
	else
		snprintf(label, label_bytes, "%s%s", g_unichar_ismark(c) ? "◌" : "", key->text);
}

static void draw_key(cairo_t *context, const struct keyboard *keyboard,
		     const struct keyboard_key *key, const struct theme *theme)
{
	double gap = theme_px(theme, KEY_GAP_MM), x = key->x_px + key->width_px / 2.0;
	double y = key->y_px + key->height_px / 2.0;
	PangoLayout *layout;
	char label[16];
	int width_px, height_px;

	theme_rounded(context, key->x_px + gap, key->y_px + gap, key->width_px - 2 * gap,
		      key->height_px - 2 * gap, theme_px(theme, THEME_RADIUS_MM));
	theme_set_source(context, theme_paper, 1);
	cairo_fill(context);
	theme_set_source(context, theme_ink, 1);
	if (key->kind == KEY_SPACE || key->kind == KEY_BACKSPACE) {
		icon_draw(context, key->kind == KEY_SPACE ? ICON_SPACE : ICON_BACKSPACE, x, y,
			  theme_px(theme, 4.2f));
		return;
	}
	label_of(keyboard, key, label, sizeof(label));
	layout = theme_layout(theme, key->kind == KEY_TEXT ? TEXT_BODY : TEXT_BUTTON, label, -1);
	pango_layout_get_pixel_size(layout, &width_px, &height_px);
	cairo_move_to(context, x - width_px / 2.0, y - height_px / 2.0);
	pango_cairo_show_layout(context, layout);
	g_object_unref(layout);
}

int keyboard_draw(struct bitmap *out, const struct keyboard *keyboard, const struct theme *theme)
{
	cairo_t *context;
	int rc = bitmap_init(out, keyboard->width_px, keyboard->height_px);

	if (rc < 0)
		return rc;
	context = bitmap_begin(out);
	theme_set_source(context, theme_line, 1);
	cairo_paint(context);
	for (uint32_t i = 0; i < keyboard->key_count; i++)
		draw_key(context, keyboard, &keyboard->keys[i], theme);
	bitmap_end(out, context);
	return 0;
}

/* ---- typing ---- */

/* Returns the text up to `end` followed by the Korean letters, composed into syllables. Release
 * with g_free. */
static char *with_letters(const char *text, const char *end, uint32_t *letters, size_t count)
{
	char *syllables =
		g_ucs4_to_utf8(letters, (glong)hangul_compose(letters, count), NULL, NULL, NULL);
	char *typed =
		g_strdup_printf("%.*s%s", (int)(end - text), text, syllables ? syllables : "");

	g_free(syllables);
	return typed;
}

/* Returns the text after the key was pressed. Release with g_free. */
static char *type_key(const struct keyboard_key *key, const char *text)
{
	const char *end = text + strlen(text), *last = end;
	uint32_t letters[2 * HANGUL_LETTERS_MAX];
	size_t count = 0;

	if (end > text) {
		last = g_utf8_find_prev_char(text, end);
		count = hangul_letters(g_utf8_get_char(last), letters);
	}
	if (key->kind == KEY_BACKSPACE) /* removes a letter of a syllable, else a character */
		return with_letters(text, last, letters, count > 0 ? count - 1 : 0);
	if (key->kind == KEY_TEXT) {
		const size_t added = hangul_letters(g_utf8_get_char(key->text), letters + count);

		if (added > 0)
			return with_letters(text, count > 0 ? last : end, letters, count + added);
	}
	return g_strconcat(text, key->kind == KEY_SPACE ? " " : key->text, NULL);
}

bool keyboard_type(const struct keyboard_key *key, char *text, size_t text_bytes)
{
	const size_t size = strlen(text);
	char *typed, *composed;
	bool fits;

	if (key->kind == KEY_LATIN || (key->kind == KEY_BACKSPACE && size == 0))
		return false;
	if (key->kind == KEY_SPACE && (size == 0 || text[size - 1] == ' '))
		return false; /* no two spaces in a row */
	typed = type_key(key, text);
	composed = g_utf8_normalize(typed, -1, G_NORMALIZE_NFC);
	fits = composed && strlen(composed) < text_bytes;
	if (fits)
		snprintf(text, text_bytes, "%s", composed);
	g_free(composed);
	g_free(typed);
	return fits;
}
