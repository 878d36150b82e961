/* The overlay as the app uses it: what is shown, what a tap means, that nothing leaves the panel.
 * With GOPURA_PICTURES=DIR set it also leaves its screens there as PNG, to be looked at. */
#include "ui/overlay.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tests/ui/compiled.h"
#include "tests/ui/places.h"
#include "ui/translate.h"

static const char *const languages[] = { "en", "fr", "km", "ja" };

enum { PARTS = 9 };

static const char *const titles[4][PARTS] = {
	{ "Central tower", "East gopura", "Naga balustrade", "Library, north", "Gallery of reliefs",
	  "Face tower", "Southern causeway", "Sacred basin", "Lintel: churning of the sea" },
	{ "Tour centrale", "Gopura est", "Balustrade de nagas", "Bibliothèque nord",
	  "Galerie des reliefs", "Tour à visages", "Chaussée sud", "Bassin sacré",
	  "Linteau : barattage de la mer" },
	{ "ប្រាង្គកណ្ដាល", "គោបុរៈខាងកើត", "បង្កាន់ដៃនាគ", "បណ្ណាល័យខាងជើង", "ថែវចម្លាក់", "ប្រាសាទមុខ",
	  "ស្ពានខាងត្បូង", "ស្រះទឹក", "ផ្តែរ៖ កូរសមុទ្រទឹកដោះ" },
	{ "中央塔", "東の塔門", "ナーガの欄干", "北の経蔵", "浮き彫りの回廊", "尊顔塔", "南の参道",
	  "聖池", "楣石：乳海攪拌" },
};

static const char *const captions[4] = {
	"The mountain Meru at the middle of the world, built of sandstone in the twelfth century.",
	"Le mont Meru au centre du monde, bâti en grès au douzième siècle.",
	"ភ្នំព្រះសុមេរុនៅកណ្ដាលពិភពលោក សាងសង់ពីថ្មភក់ក្នុងសតវត្សទី១២។",
	"世界の中心にそびえる須弥山。十二世紀に砂岩で築かれた。",
};

static const char *const pages[4] = {
	"<h1>Central tower</h1><p>The tower stands for <em>Mount Meru</em>, the axis of the world. "
	"Four lower towers surround it; see the <a href=\"part:gate\">east gopura</a> and the "
	"<a href=\"part:naga\">naga balustrade</a>.</p>"
	"<figure><img src=\"pictures/tower.png\"><figcaption>From the east, at dawn.</figcaption>"
	"</figure><h2>Building</h2><ul><li>Sandstone from the Kulen hills, <strong>40 km"
	"</strong> away</li><li>Laterite for what nobody sees<ol><li>first course</li>"
	"<li>second course</li></ol></li></ul>"
	"<blockquote><p>It is of such extraordinary construction that it is not possible to "
	"describe it with a pen.</p></blockquote>"
	"<table><tr><th>Height</th><th>Year</th></tr><tr><td>65 m</td><td>about 1150</td></tr>"
	"<tr><td>Base</td><td>1 km<sup>2</sup></td></tr></table>"
	"<p>Long text follows, so that the page has to be scrolled by a finger.</p>"
	"<p>Each face of the tower carries a false door. The mouldings repeat at every storey, "
	"smaller each time, so that the tower seems taller than it is.</p><hr>"
	"<p>Restored several times.</p>",
	"<h1>Tour centrale</h1><p>La tour représente le <em>mont Meru</em>, axe du monde. Voir "
	"la <a href=\"part:gate\">porte est</a>.</p>",
	"<h1>ប្រាង្គកណ្ដាល</h1><p>ប្រាសាទនេះតំណាងឱ្យ<em>ភ្នំព្រះសុមេរុ</em> ដែលជាអ័ក្សនៃពិភពលោក។ "
	"សូមមើល <a href=\"part:gate\">គោបុរៈខាងកើត</a> និង<strong>បង្កាន់ដៃនាគ</strong>។</p>"
	"<h2>ការសាងសង់</h2><ul><li>ថ្មភក់ពីភ្នំគូលែន</li><li>ថ្មបាយក្រៀម</li></ul>"
	"<figure><img src=\"pictures/tower.png\"><figcaption>ទិដ្ឋភាពពីទិសខាងកើត</figcaption></figure>",
	"<h1>中央塔</h1><p>この塔は世界の軸である<em>須弥山</em>を表す。\n<a href=\"part:gate\">東の"
	"塔門</a>も参照。</p><h2>建設</h2><p>砂岩はクーレン山から運ばれた。「直径」などの字形に注意。</p>"
	"<figure><img src=\"pictures/tower.png\"><figcaption>東から見た塔</figcaption></figure>",
};

/* A picture that is there from the first call, or only once it arrived. */
struct album {
	struct picture picture;
	bool arrived;
	uint32_t asked;
};

static bool get_picture(void *data, const char *name, struct found_picture *out)
{
	struct album *album = data;

	if (strcmp(name, "pictures/tower.png") != 0)
		return false;
	album->asked++;
	*out = (struct found_picture){ album->arrived ? &album->picture : NULL,
				       album->picture.width, album->picture.height };
	return true;
}

/* A tower before an evening sky, as simple as may be. */
static void paint_album(struct album *album)
{
	uint32_t width = 480, height = 300;

	*album = (struct album){ { width, height, malloc((size_t)width * height * 4) }, true, 0 };
	for (uint32_t y = 0; y < height; y++) {
		for (uint32_t x = 0; x < width; x++) {
			uint8_t *p = album->picture.rgba + ((size_t)y * width + x) * 4;
			float half = 20 + 80 * powf((float)y / (float)height, 1.6f);
			bool material = fabsf((float)x - 240) < half && y > 30;
			uint8_t shade = (uint8_t)(((x / 6 + y / 9) % 2) * 12);

			p[0] = material ? (uint8_t)(150 + shade) : (uint8_t)(230 - y / 4);
			p[1] = material ? (uint8_t)(128 + shade) : (uint8_t)(200 - y / 5);
			p[2] = material ? (uint8_t)(104 + shade) : (uint8_t)(170 + y / 6);
			p[3] = 255;
		}
	}
}

static void give_parts(struct overlay *overlay, int language)
{
	struct overlay_part parts[PARTS];

	for (int i = 0; i < PARTS; i++)
		parts[i] = (struct overlay_part){ titles[language][i], captions[language],
						  i % 2 ? "" : "pictures/tower.png", i != 3 };
	CHECK(overlay_parts(overlay, parts, PARTS) == 0);
}

static bool hides[PARTS]; /* the model does, of the parts */

static void give_anchors(struct overlay *overlay)
{
	struct rect scene = overlay_scene_rect(overlay);
	struct overlay_anchor anchors[PARTS] = { 0 };

	for (int i = 0; i < PARTS; i++) {
		float turn = (float)i * 2.4f, radius = 0.04f + 0.02f * (float)i;

		anchors[i].x_px =
			(float)scene.x_px + (float)scene.width_px * (0.5f + radius * cosf(turn));
		anchors[i].y_px =
			(float)scene.y_px + (float)scene.height_px * (0.45f + radius * sinf(turn));
		anchors[i].visible = i != 6;
		anchors[i].hidden = hides[i];
	}
	overlay_anchors(overlay, anchors, PARTS);
}

static struct overlay *open_overlay(struct album *album, int width, int height)
{
	const struct overlay_options options = { .width_px = width,
						 .height_px = height,
						 .languages = languages,
						 .language_count = 4,
						 .picture = get_picture,
						 .data = album };
	struct overlay *overlay;

	CHECK(overlay_create(&overlay, &options) == 0);
	give_parts(overlay, 0);
	give_anchors(overlay);
	return overlay;
}

/* Until nothing moves; a screen that never comes to rest is a fault. */
static void settle(struct overlay *overlay)
{
	static int64_t now_ms = 1000;
	int frames = 0;

	while (overlay_update(overlay, now_ms += 20))
		CHECK(++frames < 500);
}

static struct bitmap screen(struct overlay *overlay, const char *name)
{
	const char *folder = getenv("GOPURA_PICTURES");
	struct bitmap bitmap;
	cairo_t *context;
	char path[300];

	settle(overlay);
	CHECK(bitmap_init(&bitmap, overlay->width_px, overlay->height_px) == 0);
	context = bitmap_begin(&bitmap);
	cairo_set_source_rgb(context, 0.55, 0.52, 0.47);
	cairo_paint(context);
	overlay_paint(overlay, context);
	bitmap_end(&bitmap, context);
	if (folder) {
		snprintf(path, sizeof(path), "%s/%s-%dx%d.png", folder, name, overlay->width_px,
			 overlay->height_px);
		cairo_surface_write_to_png(bitmap.surface, path);
	}
	return bitmap;
}

/* How many pixels of a rectangle differ from the first one there. */
static int painted(const struct bitmap *bitmap, struct rect rect)
{
	int count = 0;
	uint32_t first = 0;

	for (int y = rect.y_px; y < rect.y_px + rect.height_px; y++) {
		const uint32_t *row =
			(const uint32_t *)(const void *)(bitmap->pixels +
							 (size_t)y * bitmap->stride_bytes);

		for (int x = rect.x_px; x < rect.x_px + rect.width_px; x++) {
			if (x == rect.x_px && y == rect.y_px)
				first = row[x];
			count += row[x] != first;
		}
	}
	return count;
}

static void check_layers(const struct overlay *overlay)
{
	struct overlay_layer layers[OVERLAY_LAYERS_MAX];
	uint32_t count = overlay_layers(overlay, layers, OVERLAY_LAYERS_MAX);

	CHECK(count > 0 && count < OVERLAY_LAYERS_MAX);
	for (uint32_t i = 0; i < count; i++) {
		const struct overlay_layer *layer = &layers[i];

		CHECK(layer->bitmap < OVERLAY_BITMAPS_MAX && layer->revision > 0);
		CHECK(layer->alpha > 0 && layer->alpha <= 1 && layer->pixels->surface);
		for (int c = 0; c < 4; c++) {
			CHECK(layer->corners_px[c][0] >= -8 &&
			      layer->corners_px[c][0] <= (float)overlay->width_px + 8);
			CHECK(layer->corners_px[c][1] >= -8 &&
			      layer->corners_px[c][1] <= (float)overlay->height_px + 8);
		}
		CHECK(layer->source[0] >= 0 && layer->source[2] <= 1 &&
		      layer->source[1] < layer->source[3] && layer->source[3] <= 1.0001f);
	}
}

static const int sizes[][2] = { { 640, 360 },   { 360, 640 },   { 1280, 720 }, { 1920, 1080 },
				{ 1080, 1920 }, { 3840, 2160 }, { 800, 600 },  { 320, 320 } };

/* Every screen on every panel, in every language; all inside, all settled. */
static void shows_every_screen_on_every_panel(void **state)
{
	struct album album;

	(void)state;
	paint_album(&album);
	for (size_t s = 0; s < ARRAY_COUNT(sizes); s++) {
		struct overlay *overlay = open_overlay(&album, sizes[s][0], sizes[s][1]);
		struct bitmap invited;

		for (int language = 0; language < 4; language++) {
			struct bitmap bitmap;
			char name[40];

			overlay_language(overlay, languages[language]);
			give_parts(overlay, language);
			overlay_show_help(overlay, true);
			snprintf(name, sizeof(name), "help-%s", languages[language]);
			bitmap = screen(overlay, name);
			CHECK(painted(&bitmap, help_place(overlay)) > 100);
			bitmap_finish(&bitmap);
			check_layers(overlay);

			overlay_ask(overlay, 12);
			snprintf(name, sizeof(name), "asked-%s", languages[language]);
			bitmap = screen(overlay, name);
			CHECK(painted(&bitmap, question_place(overlay)) > 500);
			bitmap_finish(&bitmap);
			check_layers(overlay);
			overlay_ask(overlay, -1);
			settle(overlay);

			overlay_show_card(overlay, 0);
			snprintf(name, sizeof(name), "card-%s", languages[language]);
			bitmap = screen(overlay, name);
			CHECK(painted(&bitmap, card_place(overlay)) > 500);
			bitmap_finish(&bitmap);
			check_layers(overlay);

			CHECK(overlay_show_page(overlay, 0, compiled(pages[language]),
						"© The museum · 1150") == 0);
			CHECK(article_layout_unknown_glyphs(overlay->page.article) == 0);
			give_anchors(overlay);
			snprintf(name, sizeof(name), "page-%s", languages[language]);
			bitmap = screen(overlay, name);
			CHECK(painted(&bitmap, page_window(overlay)) > 500);
			bitmap_finish(&bitmap);
			check_layers(overlay);
			overlay_widen_page(overlay, true);
			snprintf(name, sizeof(name), "wide-%s", languages[language]);
			bitmap = screen(overlay, name);
			CHECK(painted(&bitmap, page_window(overlay)) > 500);
			bitmap_finish(&bitmap);
			check_layers(overlay);
			overlay_close_page(overlay);
			give_anchors(overlay);
			settle(overlay);
			CHECK(overlay_page(overlay) == -1 && !overlay->page.article);
		}
		settle(overlay);
		overlay_invite(overlay, true);
		invited = screen(overlay, "invited");
		CHECK(painted(&invited, invitation_place(overlay)) > 500);
		bitmap_finish(&invited);
		check_layers(overlay);
		overlay_destroy(overlay);
	}
	picture_finish(&album.picture);
}

static struct rect close_place(const struct overlay *overlay)
{
	const struct screen now = overlay_screen(overlay);

	return page_view_close_button(&overlay->page, &now);
}

static struct rect widen_place(const struct overlay *overlay)
{
	const struct screen now = overlay_screen(overlay);

	return page_view_widen_button(&overlay->page, &now);
}

static int scroll_most(const struct overlay *overlay)
{
	const struct screen now = overlay_screen(overlay);

	return page_view_scroll_most(&overlay->page, &now);
}

/* The middle of a rectangle. */
static struct overlay_action tap(const struct overlay *overlay, struct rect rect)
{
	return overlay_tap(overlay, (float)rect.x_px + (float)rect.width_px / 2,
			   (float)rect.y_px + (float)rect.height_px / 2);
}

static void a_tap_means_what_is_under_it(void **state)
{
	struct overlay_action action;
	struct rect chrome;
	struct album album;
	struct overlay *overlay;

	(void)state;
	paint_album(&album);
	overlay = open_overlay(&album, 1280, 720);
	settle(overlay);
	action = tap(overlay, help_place(overlay));
	CHECK(action.kind == OVERLAY_HELP && overlay_help(overlay));
	overlay_show_help(overlay, false);
	settle(overlay);
	CHECK(overlay->callouts.callouts.count >= 6);
	for (uint32_t i = 0; i < overlay->callouts.callouts.count; i++) {
		const struct callout *c = &overlay->callouts.callouts.list[i];

		CHECK(c->part != 6); /* hidden */
		action = overlay_tap(overlay, (float)c->x_px + 3, (float)c->y_px + 3);
		CHECK(action.kind == OVERLAY_OPEN_CARD && action.part == (int)c->part);
	}
	CHECK(overlay_tap(overlay, 640, 5).kind == OVERLAY_NONE);

	overlay_show_card(overlay, 2);
	settle(overlay);
	action = tap(overlay, card_place(overlay));
	CHECK(action.kind == OVERLAY_OPEN_PAGE && action.part == 2);
	action = overlay_tap(overlay,
			     (float)(card_place(overlay).x_px + card_place(overlay).width_px) - 8,
			     (float)card_place(overlay).y_px + 8);
	CHECK(action.kind == OVERLAY_CLOSE_CARD);
	overlay_show_card(overlay, 3); /* has no page */
	CHECK(tap(overlay, card_place(overlay)).kind == OVERLAY_SWALLOWED);

	chrome = bar_place(overlay);
	action = overlay_tap(overlay, (float)chrome.x_px + 4, (float)chrome.y_px + 4);
	CHECK(action.kind == OVERLAY_HOME);
	action = overlay_tap(overlay, (float)(chrome.x_px + chrome.width_px) - 4,
			     (float)chrome.y_px + 4);
	CHECK(action.kind == OVERLAY_LANGUAGE && strcmp(action.language, "ja") == 0);
	overlay_destroy(overlay);
	picture_finish(&album.picture);
}

static void a_page_scrolls_links_and_closes(void **state)
{
	struct overlay_action action = { 0 };
	struct rect view;
	struct album album;
	struct overlay *overlay;

	(void)state;
	paint_album(&album);
	overlay = open_overlay(&album, 1280, 720);
	CHECK(overlay_show_page(overlay, 0, compiled(pages[0]), "") == 0);
	CHECK(overlay_page(overlay) == 0 && overlay_scene_rect(overlay).width_px == 640);
	settle(overlay);
	view = page_window(overlay);
	CHECK(overlay_covers(overlay, (float)view.x_px + 10, (float)view.y_px + 10));
	CHECK(!overlay_covers(overlay, 200, 200));
	CHECK(tap(overlay, close_place(overlay)).kind == OVERLAY_CLOSE_PAGE);

	/* Somewhere in the first paragraphs lies the link to the gate. */
	for (int y = view.y_px; y < view.y_px + 300 && !action.link; y += 4)
		for (int x = view.x_px; x < view.x_px + view.width_px && !action.link; x += 8)
			action = overlay_tap(overlay, (float)x, (float)y);
	CHECK(action.kind == OVERLAY_LINK && strcmp(action.link, "gate") == 0);

	CHECK(scroll_most(overlay) > 200);
	overlay_scroll(overlay, -150); /* the finger goes up */
	CHECK(overlay->page.scroll.px == 150);
	overlay_scroll(overlay, 1000);
	CHECK(overlay->page.scroll.px == 0);
	overlay_fling(overlay, -100000);
	settle(overlay);
	CHECK(overlay->page.scroll.px == (float)scroll_most(overlay));
	check_layers(overlay);
	CHECK(overlay_show_page(overlay, 0, (struct bytes){ (const uint8_t *)"", 0 }, "x") ==
	      -EBADMSG);
	CHECK(overlay_page(overlay) == 0); /* the one before stays */
	overlay_destroy(overlay);
	picture_finish(&album.picture);
}

/* Over the whole panel and beside the model again, about where it was read. */
static void a_page_takes_the_whole_panel_on_request(void **state)
{
	struct album album;
	struct overlay *overlay;
	struct rect half, bar;
	float read;

	(void)state;
	paint_album(&album);
	overlay = open_overlay(&album, 1280, 720);
	overlay_widen_page(overlay, true); /* there is none */
	CHECK(!overlay_page_is_wide(overlay));
	CHECK(overlay_show_page(overlay, 0, compiled(pages[0]), "") == 0);
	settle(overlay);
	half = page_place(overlay);
	CHECK(tap(overlay, widen_place(overlay)).kind == OVERLAY_WIDEN_PAGE);
	overlay_scroll(overlay, -150);
	read = overlay->page.scroll.px / (float)article_layout_height_px(overlay->page.article);

	overlay_widen_page(overlay, true);
	settle(overlay);
	CHECK(overlay_page_is_wide(overlay) && page_place(overlay).width_px == 1280);
	CHECK(fabsf(overlay->page.scroll.px /
			    (float)article_layout_height_px(overlay->page.article) -
		    read) < 0.1f);
	bar = bar_place(overlay);
	CHECK(page_window(overlay).y_px + page_window(overlay).height_px <= bar.y_px);
	CHECK(overlay_covers(overlay, 100, 300));
	CHECK(overlay_tap(overlay, 100, 300).kind == OVERLAY_SWALLOWED);
	CHECK(overlay_scene_rect(overlay).width_px == half.x_px); /* the eye stays where it is */
	CHECK(tap(overlay, close_place(overlay)).kind == OVERLAY_CLOSE_PAGE);
	CHECK(tap(overlay, widen_place(overlay)).kind == OVERLAY_WIDEN_PAGE);
	CHECK(overlay_show_page(overlay, 1, compiled(pages[0]), "") == 0); /* by a link */
	CHECK(overlay_page_is_wide(overlay));

	overlay_show_card(overlay, 2); /* of a part that has no page: look at it */
	CHECK(!overlay_page_is_wide(overlay) && overlay_page(overlay) == 1);
	overlay_show_card(overlay, -1);
	overlay_widen_page(overlay, true);
	overlay_set_comfort(overlay, (struct overlay_comfort){ .reach = true });
	CHECK(!overlay_page_is_wide(overlay) && widen_place(overlay).width_px == 0);
	overlay_widen_page(overlay, true);
	CHECK(!overlay_page_is_wide(overlay));
	overlay_set_comfort(overlay, (struct overlay_comfort){ 0 });
	overlay_widen_page(overlay, true);
	overlay_close_page(overlay);
	CHECK(overlay_show_page(overlay, 0, compiled(pages[0]), "") == 0); /* the next one */
	CHECK(page_place(overlay).x_px == half.x_px);
	overlay_destroy(overlay);
	picture_finish(&album.picture);
}

/* A picture that comes late takes its place without moving the text. */
static void a_late_picture_moves_nothing(void **state)
{
	struct bitmap before, after;
	struct album album;
	struct overlay *overlay;
	int height_px;

	(void)state;
	paint_album(&album);
	album.arrived = false;
	overlay = open_overlay(&album, 1280, 720);
	CHECK(overlay_show_page(overlay, 0, compiled(pages[0]), "") == 0);
	CHECK(album.asked > 0);
	height_px = article_layout_height_px(overlay->page.article);
	before = screen(overlay, "page-waiting");
	album.arrived = true;
	overlay_picture_arrived(overlay, "pictures/other.png");
	CHECK(!overlay_update(overlay, 100000000));
	overlay_picture_arrived(overlay, "pictures/tower.png");
	after = screen(overlay, "page-arrived");
	CHECK(article_layout_height_px(overlay->page.article) == height_px);
	CHECK(memcmp(before.pixels, after.pixels,
		     (size_t)before.stride_bytes * (size_t)before.height_px) != 0);
	bitmap_finish(&before);
	bitmap_finish(&after);
	overlay_destroy(overlay);
	picture_finish(&album.picture);
}

/* Fades begin at nothing and are monotonous: nothing pops. */
static void nothing_pops(void **state)
{
	struct overlay_layer layers[OVERLAY_LAYERS_MAX];
	struct album album;
	struct overlay *overlay;
	float last = 0;

	(void)state;
	paint_album(&album);
	overlay = open_overlay(&album, 1280, 720);
	overlay_show_help(overlay, false);
	settle(overlay);
	overlay_show_card(overlay, 0);
	for (int64_t now_ms = 900000; now_ms < 900400; now_ms += 16) {
		float alpha = 0;
		uint32_t count;

		overlay_update(overlay, now_ms);
		count = overlay_layers(overlay, layers, OVERLAY_LAYERS_MAX);
		for (uint32_t i = 0; i < count; i++)
			if (layers[i].bitmap == overlay->card.sprite.id)
				alpha = layers[i].alpha;
		CHECK(alpha >= last && alpha - last < 0.9f);
		last = alpha;
	}
	CHECK(last == 1);
	overlay_destroy(overlay);
	picture_finish(&album.picture);
}

/* Of the part's label; 0: it has none. */
static float label_alpha(struct overlay *overlay, int part)
{
	struct overlay_layer layers[OVERLAY_LAYERS_MAX];
	const uint32_t count = overlay_layers(overlay, layers, OVERLAY_LAYERS_MAX);

	for (uint32_t i = 0; i < count; i++)
		for (uint32_t k = 0; k < CALLOUT_LABELS; k++)
			if (overlay->callouts.labels[k].sprite.id == layers[i].bitmap &&
			    overlay->callouts.labels[k].part == part)
				return layers[i].alpha;
	return 0;
}

static void what_is_hidden_dims_and_goes_if_it_stays_so(void **state)
{
	struct album album;
	struct overlay *overlay;
	int64_t now_ms = 700000;

	(void)state;
	paint_album(&album);
	overlay = open_overlay(&album, 1280, 720);
	overlay_show_help(overlay, false);
	settle(overlay);
	CHECK(label_alpha(overlay, 2) == 1);
	for (int turn = 0; turn < 3; turn++) { /* a pillar that passes */
		hides[2] = true;
		for (int64_t end_ms = now_ms + 1000; now_ms < end_ms; now_ms += 16) {
			give_anchors(overlay);
			overlay_update(overlay, now_ms);
		}
		CHECK(label_alpha(overlay, 2) > 0.2f && label_alpha(overlay, 2) < 0.6f);
		hides[2] = false;
		give_anchors(overlay);
		settle(overlay);
		CHECK(label_alpha(overlay, 2) == 1);
	}
	hides[2] = true;
	give_anchors(overlay);
	settle(overlay);
	CHECK(label_alpha(overlay, 2) == 0 && label_alpha(overlay, 1) == 1);
	give_anchors(overlay); /* and does not come back */
	settle(overlay);
	CHECK(label_alpha(overlay, 2) == 0);
	hides[2] = false;
	overlay_destroy(overlay);
	picture_finish(&album.picture);
}

static void the_invitation_takes_the_place_of_the_help(void **state)
{
	struct album album;
	struct overlay *overlay;

	(void)state;
	paint_album(&album);
	overlay = open_overlay(&album, 1280, 720);
	overlay_show_help(overlay, false);
	overlay_invite(overlay, true);
	settle(overlay);
	CHECK(!overlay_help(overlay) && overlay->invitation.fade.alpha == 1);
	overlay_invite(overlay, false);                                     /* somebody came */
	CHECK(tap(overlay, help_place(overlay)).kind == OVERLAY_SWALLOWED); /* by this touch */
	settle(overlay);
	CHECK(overlay_help(overlay) && overlay->invitation.fade.alpha == 0);
	CHECK(tap(overlay, help_place(overlay)).kind == OVERLAY_HELP);
	overlay_destroy(overlay);
	picture_finish(&album.picture);
}

static void the_question_counts_down_in_the_language_that_is_set(void **state)
{
	struct album album;
	struct overlay *overlay;
	uint32_t revision;

	(void)state;
	paint_album(&album);
	overlay = open_overlay(&album, 1280, 720);
	overlay_ask(overlay, 9);
	settle(overlay);
	revision = overlay->question.sprite.revision;
	overlay_ask(overlay, 9);
	settle(overlay);
	CHECK(overlay->question.sprite.revision == revision);
	overlay_ask(overlay, 8);
	settle(overlay);
	CHECK(overlay->question.sprite.revision == revision + 1);
	overlay_language(overlay, languages[1]);
	settle(overlay);
	CHECK(overlay->question.sprite.revision == revision + 2);
	overlay_destroy(overlay);
	picture_finish(&album.picture);
}

static void refuses_impossible_panels(void **state)
{
	struct overlay_options options = {
		.width_px = 100, .height_px = 100, .languages = languages, .language_count = 4
	};
	struct overlay *overlay;

	(void)state;
	CHECK(overlay_create(&overlay, &options) == -EINVAL && !overlay);
	options.width_px = options.height_px = 1000;
	options.language_count = 0;
	CHECK(overlay_create(&overlay, &options) == -EINVAL);
	options.language_count = 1; /* no switch, no pictures, no parts */
	CHECK(overlay_create(&overlay, &options) == 0);
	settle(overlay);
	CHECK(overlay->bar.button_count == 5); /* home, back, help, large type, reach */
	overlay_destroy(overlay);
	overlay_destroy(NULL);
}

/* It stands where it stands, and answers where it leads somewhere. */
static void the_way_back_answers_where_there_is_one(void **state)
{
	struct album album;
	struct overlay *overlay;
	struct rect bar;
	float x, y;

	(void)state;
	paint_album(&album);
	overlay = open_overlay(&album, 1280, 720);
	bar = bar_place(overlay);
	CHECK(overlay->bar.buttons[1].kind == BAR_BACK);
	x = (float)(bar.x_px + overlay->bar.buttons[1].x_px + 10);
	y = (float)(bar.y_px + 10);
	CHECK(overlay_tap(overlay, x, y).kind == OVERLAY_SWALLOWED);
	overlay_offer_back(overlay, true);
	settle(overlay);
	CHECK(overlay_tap(overlay, x, y).kind == OVERLAY_BACK);
	overlay_offer_back(overlay, false);
	CHECK(overlay_tap(overlay, x, y).kind == OVERLAY_SWALLOWED);
	overlay_destroy(overlay);
	picture_finish(&album.picture);
}

/* A model without parts has no names to tap. */
static void the_help_speaks_of_names_where_there_are_some(void **state)
{
	struct rect with, without;
	struct album album;
	struct overlay *overlay;

	(void)state;
	paint_album(&album);
	overlay = open_overlay(&album, 1280, 720);
	settle(overlay);
	with = help_place(overlay);
	CHECK(overlay_parts(overlay, NULL, 0) == 0);
	settle(overlay);
	without = help_place(overlay);
	CHECK(3 * without.width_px < 2 * with.width_px + with.width_px / 4);
	give_parts(overlay, 0);
	settle(overlay);
	CHECK(help_place(overlay).width_px == with.width_px);
	overlay_destroy(overlay);
	picture_finish(&album.picture);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shows_every_screen_on_every_panel),
		cmocka_unit_test(a_tap_means_what_is_under_it),
		cmocka_unit_test(a_page_scrolls_links_and_closes),
		cmocka_unit_test(a_page_takes_the_whole_panel_on_request),
		cmocka_unit_test(the_way_back_answers_where_there_is_one),
		cmocka_unit_test(a_late_picture_moves_nothing),
		cmocka_unit_test(nothing_pops),
		cmocka_unit_test(what_is_hidden_dims_and_goes_if_it_stays_so),
		cmocka_unit_test(the_invitation_takes_the_place_of_the_help),
		cmocka_unit_test(the_question_counts_down_in_the_language_that_is_set),
		cmocka_unit_test(refuses_impossible_panels),
		cmocka_unit_test(the_help_speaks_of_names_where_there_are_some),
	};

	if (translate_open(TEST_LOCALE) < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
