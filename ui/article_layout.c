/* Lays out the blocks of an article with Pango, draws them with Cairo and finds links and pictures
 * by position. */
#include "ui/article_layout.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "ui/bitmap.h"

/* Millimetres. */
#define SIDE_MARGIN_MM    8.0f
#define TOP_MARGIN_MM     3.0f
#define BOTTOM_MARGIN_MM  14.0f
#define MEASURE_EMS       34 /* the longest line, in multiples of the body's type size */
#define INDENT_MM         6.0f
#define QUOTE_MM          6.0f
#define CELL_PADDING_MM   1.6f
#define LINK_TOLERANCE_MM 3.5f

struct item {
	const struct article_block *block;
	int x_px, y_px, width_px, height_px;
	PangoLayout *layout, *marker;     /* owned or NULL */
	struct bitmap picture;            /* scaled; empty if it has not arrived yet */
	double whole_width, whole_height; /* of the picture; 0: not asked for yet */
};

struct link_area {
	float x_px, y_px, width_px, height_px;
	int link;
};

struct article_layout {
	struct article_layout_options options;
	struct article_blocks content;
	struct article_block note[2]; /* the rule and the small print below it */
	char *note_text;              /* owned; NULL: no note */
	struct item *items;           /* one for each block, then those of the note */
	uint32_t item_count;
	struct link_area *links;
	uint32_t link_count, link_room;
	int left_px, column_px; /* of the text */
	int height_px;
};

/* ---- text with attributes ---- */

static void add_attribute(PangoAttrList *list, PangoAttribute *attribute,
			  const struct article_span *span)
{
	attribute->start_index = span->start;
	attribute->end_index = span->end;
	pango_attr_list_insert(list, attribute);
}

static void add_span(PangoAttrList *list, const struct article_span *span, bool italics)
{
	if (span->flags & ARTICLE_EMPHASIS)
		add_attribute(list,
			      italics ? pango_attr_style_new(PANGO_STYLE_ITALIC)
				      : pango_attr_weight_new(PANGO_WEIGHT_MEDIUM),
			      span);
	if (span->flags & ARTICLE_STRONG)
		add_attribute(list, pango_attr_weight_new(PANGO_WEIGHT_BOLD), span);
	if (span->flags & (ARTICLE_SMALL | ARTICLE_SUBSCRIPT | ARTICLE_SUPERSCRIPT))
		add_attribute(list, pango_attr_scale_new(PANGO_SCALE_SMALL), span);
	if (span->flags & ARTICLE_SUBSCRIPT)
		add_attribute(list, pango_attr_baseline_shift_new(PANGO_BASELINE_SHIFT_SUBSCRIPT),
			      span);
	if (span->flags & ARTICLE_SUPERSCRIPT)
		add_attribute(list, pango_attr_baseline_shift_new(PANGO_BASELINE_SHIFT_SUPERSCRIPT),
			      span);
	if (span->link >= 0) {
		add_attribute(list,
			      pango_attr_foreground_new((guint16)(theme_accent.red * 65535),
							(guint16)(theme_accent.green * 65535),
							(guint16)(theme_accent.blue * 65535)),
			      span);
		add_attribute(list, pango_attr_underline_new(PANGO_UNDERLINE_SINGLE), span);
	}
}

static enum text_style style_of(const struct article_block *block)
{
	static const enum text_style styles[ARTICLE_STYLE_COUNT] = {
		[ARTICLE_BODY] = TEXT_BODY,           [ARTICLE_HEADING_1] = TEXT_HEADING_1,
		[ARTICLE_HEADING_2] = TEXT_HEADING_2, [ARTICLE_HEADING_3] = TEXT_HEADING_3,
		[ARTICLE_QUOTE] = TEXT_QUOTE,         [ARTICLE_FIGURE] = TEXT_FIGURE,
		[ARTICLE_CELL] = TEXT_CELL,
	};

	return styles[block->style];
}

static PangoLayout *make_layout(const struct article_layout *article,
				const struct article_block *block, int width_px)
{
	PangoLayout *layout =
		theme_layout(article->options.theme, style_of(block), block->text, width_px);
	PangoAttrList *list = pango_attr_list_new();

	for (uint32_t i = 0; i < block->span_count; i++)
		add_span(list, &block->spans[i], theme_has_italics(article->options.theme));
	pango_layout_set_attributes(layout, list);
	pango_attr_list_unref(list);
	return layout;
}

/* ---- layout ---- */

static int px(const struct article_layout *article, float mm)
{
	return theme_px(article->options.theme, mm);
}

static float space_before_mm(const struct article_block *block, const struct article_block *above)
{
	if (!above)
		return TOP_MARGIN_MM;
	if (block->kind != ARTICLE_TEXT)
		return 4.0f;
	switch (block->style) {
	case ARTICLE_HEADING_1:
		return 7.0f;
	case ARTICLE_HEADING_2:
		return 7.0f;
	case ARTICLE_HEADING_3:
		return 5.5f;
	case ARTICLE_FIGURE:
		return above->kind == ARTICLE_IMAGE ? 1.4f : 3.0f;
	default:
		return block->marker && above->indent ? 1.6f : 3.2f;
	}
}

/* Sets the size of a picture's place. */
static void place_picture(const struct article_layout *article, struct item *item, int x_px,
			  int width_px)
{
	const int most_px = article->options.view_px * 3 / 4;

	item->x_px = x_px;
	item->width_px = width_px;
	item->height_px = (int)lround(width_px * item->whole_height / item->whole_width);
	if (item->height_px > most_px) {
		item->width_px = (int)lround(most_px * item->whole_width / item->whole_height);
		item->x_px += (width_px - item->width_px) / 2;
		item->height_px = most_px;
	}
	if (item->height_px < 1)
		item->height_px = 1;
	if (item->width_px < 1)
		item->width_px = 1;
}

static bool is_scaled(const struct item *item)
{
	return item->picture.surface && item->picture.width_px == item->width_px &&
	       item->picture.height_px == item->height_px;
}

/* Places a picture by its size, or its announced size, or a guess. Asking for a picture also
 * requests it, so one that is here is not asked for again. */
static void measure_picture(struct article_layout *article, struct item *item)
{
	const struct picture_source *pictures = &article->options.pictures;
	const int x_px = item->x_px, width_px = item->width_px;
	struct found_picture found = { 0 };

	if (item->picture.surface)
		place_picture(article, item, x_px, width_px);
	if (is_scaled(item))
		return;
	bitmap_finish(&item->picture);
	if (!pictures->get || !pictures->get(pictures->data, item->block->text, &found))
		found = (struct found_picture){ 0 };
	item->whole_width = 4;
	item->whole_height = 3;
	if (found.picture) {
		item->whole_width = found.picture->width;
		item->whole_height = found.picture->height;
	} else if (found.width_px > 0 && found.height_px > 0) {
		item->whole_width = found.width_px;
		item->whole_height = found.height_px;
	}
	place_picture(article, item, x_px, width_px);
	/* If memory runs out, the place stays empty; the text can still be read. */
	if (found.picture &&
	    bitmap_from_picture(&item->picture, found.picture, item->width_px, item->height_px) < 0)
		bitmap_finish(&item->picture);
}

static void place_item(struct article_layout *article, struct item *item, int x_px, int y_px,
		       int width_px)
{
	const struct article_block *block = item->block;
	int indent_px = (int)block->indent * px(article, INDENT_MM) +
			(block->quote ? px(article, QUOTE_MM) : 0);

	if (indent_px > width_px / 2) /* half the line stays, however deep the lists are */
		indent_px = width_px / 2;
	/* Indented on the side where lines of the language begin. */
	item->x_px = theme_is_right_to_left(article->options.theme) ? x_px : x_px + indent_px;
	item->y_px = y_px;
	item->width_px = width_px - indent_px > 1 ? width_px - indent_px : 1;
	switch (block->kind) {
	case ARTICLE_RULE:
		item->height_px = px(article, 0.4f);
		break;
	case ARTICLE_IMAGE:
		measure_picture(article, item);
		break;
	case ARTICLE_TEXT:
		if (!item->layout)
			item->layout = make_layout(article, block, item->width_px);
		pango_layout_get_pixel_size(item->layout, NULL, &item->height_px);
		if (block->marker && !item->marker)
			item->marker = theme_layout(article->options.theme, style_of(block),
						    block->marker, -1);
	}
}

/* Places the blocks of one table row, from block first on. Returns how many there are and moves
 * *y_px below the row. */
static uint32_t place_row(struct article_layout *article, uint32_t first, int *y_px)
{
	const struct item *items = &article->items[first];
	const uint32_t row = items->block->row, columns = items->block->column_count;
	uint32_t count = 0;
	int padding_px = px(article, CELL_PADDING_MM), lowest_px = *y_px, below_px = 0;

	while (first + count < article->item_count && items[count].block->row == row) {
		struct item *item = &article->items[first + count];
		uint32_t column = item->block->column;
		int left_px = article->column_px * (int)column / (int)columns;
		int right_px = article->column_px * (int)(column + 1) / (int)columns;

		if (count == 0 || items[count - 1].block->column != column)
			below_px = *y_px;
		place_item(article, item, article->left_px + left_px, below_px + padding_px,
			   right_px - left_px - 2 * padding_px > 1
				   ? right_px - left_px - 2 * padding_px
				   : 1);
		below_px = item->y_px + item->height_px;
		if (below_px + padding_px > lowest_px)
			lowest_px = below_px + padding_px;
		count++;
	}
	*y_px = lowest_px;
	return count;
}

static int add_link_area(struct article_layout *article, struct link_area area)
{
	int rc = ARRAY_RESERVE(article->links, article->link_room, article->link_count + 1,
			       UINT32_MAX);

	if (rc == 0)
		article->links[article->link_count++] = area;
	return rc;
}

/* Adds a rectangle for each line that the link touches. */
static int find_link_areas(struct article_layout *article, const struct item *item,
			   const struct article_span *span)
{
	PangoLayoutIter *iter = pango_layout_get_iter(item->layout);
	int rc = 0;

	do {
		PangoLayoutLine *line = pango_layout_iter_get_line_readonly(iter);
		int top, bottom, count = 0, *ranges = NULL;

		if ((int)span->end <= line->start_index ||
		    (int)span->start >= line->start_index + line->length)
			continue;
		pango_layout_iter_get_line_yrange(iter, &top, &bottom);
		pango_layout_line_get_x_ranges(line, (int)span->start, (int)span->end, &ranges,
					       &count);
		for (int i = 0; i < count && rc == 0; i++)
			rc = add_link_area(
				article,
				(struct link_area){
					(float)item->x_px + (float)ranges[2 * i] / PANGO_SCALE,
					(float)item->y_px + (float)top / PANGO_SCALE,
					(float)(ranges[2 * i + 1] - ranges[2 * i]) / PANGO_SCALE,
					(float)(bottom - top) / PANGO_SCALE, span->link });
		g_free(ranges);
	} while (rc == 0 && pango_layout_iter_next_line(iter));
	pango_layout_iter_free(iter);
	return rc;
}

static int find_links(struct article_layout *article)
{
	int rc = 0;

	article->link_count = 0;
	for (uint32_t i = 0; i < article->item_count; i++) {
		const struct item *item = &article->items[i];

		for (uint32_t k = 0; item->layout && k < item->block->span_count && rc == 0; k++)
			if (item->block->spans[k].link >= 0)
				rc = find_link_areas(article, item, &item->block->spans[k]);
	}
	return rc;
}

static int lay_out(struct article_layout *article)
{
	uint32_t i = 0;
	int y_px = 0;

	while (i < article->item_count) {
		struct item *item = &article->items[i];
		const struct article_block *block = item->block;
		const struct article_block *above = i > 0 ? item[-1].block : NULL;

		/* Rows of one table have no space between them. */
		if (!block->row || !above || !above->row)
			y_px += px(article, space_before_mm(block, above));
		if (block->row) {
			i += place_row(article, i, &y_px);
			continue;
		}
		place_item(article, item, article->left_px, y_px, article->column_px);
		y_px += item->height_px;
		i++;
	}
	article->height_px = y_px + px(article, BOTTOM_MARGIN_MM);
	return find_links(article);
}

static void drop_layouts(struct article_layout *article)
{
	for (uint32_t i = 0; i < article->item_count; i++) {
		struct item *item = &article->items[i];

		if (item->layout)
			g_object_unref(item->layout);
		if (item->marker)
			g_object_unref(item->marker);
		item->layout = item->marker = NULL;
	}
}

int article_layout_resize(struct article_layout *article, int width_px, int view_px)
{
	int measure_px = MEASURE_EMS * theme_style_px(article->options.theme, TEXT_BODY);
	int rc;

	article->options.width_px = width_px;
	article->options.view_px = view_px;
	article->column_px = width_px - 2 * px(article, SIDE_MARGIN_MM);
	if (article->column_px > measure_px)
		article->column_px = measure_px;
	if (article->column_px < 1)
		article->column_px = 1;
	article->left_px = (width_px - article->column_px) / 2;
	drop_layouts(article); /* they were made for another width or type size */
	rc = lay_out(article);
	if (rc < 0)
		article->link_count = 0;
	return rc;
}

/* Lists the blocks of the article and, where there are credits, a rule and the credits. */
static int make_items(struct article_layout *article, const char *credits)
{
	const uint32_t count = article->content.block_count;

	if (credits && *credits) {
		article->note_text = strdup(credits);
		if (!article->note_text)
			return -ENOMEM;
		article->note[0] =
			(struct article_block){ .kind = ARTICLE_RULE, .style = ARTICLE_FIGURE };
		article->note[1] = (struct article_block){ .kind = ARTICLE_TEXT,
							   .style = ARTICLE_FIGURE,
							   .text = article->note_text };
	}
	article->items = calloc(count + ARRAY_COUNT(article->note), sizeof(*article->items));
	if (!article->items)
		return -ENOMEM;
	article->item_count = count + (article->note_text ? ARRAY_COUNT(article->note) : 0);
	for (uint32_t i = 0; i < article->item_count; i++)
		article->items[i].block =
			i < count ? &article->content.blocks[i] : &article->note[i - count];
	return 0;
}

int article_layout_create(struct article_layout **out, const struct article_layout_options *options,
			  struct bytes bytes)
{
	struct article_layout *article = calloc(1, sizeof(*article));
	int rc;

	*out = NULL;
	if (!article)
		return -ENOMEM;
	article->options = *options;
	article->options.credits = NULL;
	rc = article_decode(&article->content, bytes);
	if (rc == 0)
		rc = make_items(article, options->credits);
	if (rc == 0)
		rc = article_layout_resize(article, options->width_px, options->view_px);
	if (rc < 0) {
		article_layout_destroy(article);
		return rc;
	}
	*out = article;
	return 0;
}

void article_layout_destroy(struct article_layout *article)
{
	if (!article)
		return;
	for (uint32_t i = 0; i < article->item_count; i++) {
		if (article->items[i].layout)
			g_object_unref(article->items[i].layout);
		if (article->items[i].marker)
			g_object_unref(article->items[i].marker);
		bitmap_finish(&article->items[i].picture);
	}
	free(article->items);
	free(article->links);
	free(article->note_text);
	article_finish(&article->content);
	free(article);
}

/* ---- queries and drawing ---- */

int article_layout_height_px(const struct article_layout *article)
{
	return article->height_px;
}

static void draw_picture(const struct item *item, cairo_t *context)
{
	if (item->picture.surface) {
		cairo_set_source_surface(context, item->picture.surface, item->x_px, item->y_px);
		cairo_paint(context);
		return;
	}
	cairo_rectangle(context, item->x_px, item->y_px, item->width_px, item->height_px);
	theme_set_source(context, theme_paper_shade, 1);
	cairo_fill(context);
}

static struct colour colour_of(enum article_style style)
{
	return style == ARTICLE_FIGURE || style == ARTICLE_QUOTE ? theme_ink_soft : theme_ink;
}

static void draw_quote_bar(const struct article_layout *article, const struct item *item,
			   cairo_t *context)
{
	int x_px = item->x_px - px(article, QUOTE_MM) + px(article, 1.0f);

	cairo_rectangle(context, x_px, item->y_px, px(article, 0.8f), item->height_px);
	theme_set_source(context, theme_accent, 0.55);
	cairo_fill(context);
}

static void draw_item(const struct article_layout *article, const struct item *item,
		      cairo_t *context)
{
	if (item->block->kind == ARTICLE_RULE) {
		cairo_rectangle(context, item->x_px, item->y_px, item->width_px, item->height_px);
		theme_set_source(context, theme_line, 1);
		cairo_fill(context);
		return;
	}
	if (item->block->kind == ARTICLE_IMAGE) {
		draw_picture(item, context);
		return;
	}
	if (item->block->quote)
		draw_quote_bar(article, item, context);
	theme_set_source(context, colour_of(item->block->style), 1);
	cairo_move_to(context, item->x_px, item->y_px);
	pango_cairo_show_layout(context, item->layout);
	if (item->marker) {
		int width_px;

		pango_layout_get_pixel_size(item->marker, &width_px, NULL);
		theme_set_source(context, theme_accent, 1);
		cairo_move_to(context,
			      theme_is_right_to_left(article->options.theme)
				      ? item->x_px + item->width_px + px(article, 1.8f)
				      : item->x_px - width_px - px(article, 1.8f),
			      item->y_px);
		pango_cairo_show_layout(context, item->marker);
	}
}

/* Draws a hairline below each table row, after the row's last block. */
static void draw_row_line(const struct article_layout *article, uint32_t i, cairo_t *context)
{
	const struct item *items = article->items;
	uint32_t row = items[i].block->row;
	int lowest_px = 0;

	if (!row || (i + 1 < article->item_count && items[i + 1].block->row == row))
		return;
	for (uint32_t k = i + 1; k-- > 0 && items[k].block->row == row;)
		if (items[k].y_px + items[k].height_px > lowest_px)
			lowest_px = items[k].y_px + items[k].height_px;
	cairo_rectangle(context, article->left_px, lowest_px + px(article, CELL_PADDING_MM) - 1,
			article->column_px, 1);
	theme_set_source(context, theme_line, 1);
	cairo_fill(context);
}

void article_layout_draw(const struct article_layout *article, cairo_t *context, int top_px,
			 int height_px)
{
	int slack_px = px(article, 4.0f); /* swashes and marks reach beyond their boxes */

	cairo_save(context);
	theme_set_source(context, theme_paper, 1);
	cairo_paint(context);
	cairo_translate(context, 0, -top_px);
	for (uint32_t i = 0; i < article->item_count; i++) {
		const struct item *item = &article->items[i];

		if (item->y_px - slack_px >= top_px + height_px ||
		    item->y_px + item->height_px + slack_px <= top_px)
			continue;
		draw_item(article, item, context);
		draw_row_line(article, i, context);
	}
	cairo_restore(context);
}

static float outside(float at, float low, float size)
{
	return at < low ? low - at : at > low + size ? at - low - size : 0;
}

const char *article_layout_link_at(const struct article_layout *article, float x_px, float y_px)
{
	float nearest_px = LINK_TOLERANCE_MM * article->options.theme->px_per_mm;
	const char *found = NULL;

	for (uint32_t i = 0; i < article->link_count; i++) {
		const struct link_area *area = &article->links[i];
		float distance_px = hypotf(outside(x_px, area->x_px, area->width_px),
					   outside(y_px, area->y_px, area->height_px));

		if (distance_px <= nearest_px) {
			found = article->content.links[area->link];
			nearest_px = distance_px;
		}
	}
	return found;
}

uint32_t article_layout_picture_count(const struct article_layout *article)
{
	uint32_t count = 0;

	for (uint32_t i = 0; i < article->item_count; i++)
		count += article->items[i].block->kind == ARTICLE_IMAGE;
	return count;
}

const char *article_layout_picture(const struct article_layout *article, uint32_t picture,
				   const char **caption)
{
	const struct item *items = article->items;
	const struct article_block *below;
	uint32_t i = 0;

	while (i < article->item_count && (items[i].block->kind != ARTICLE_IMAGE || picture-- > 0))
		i++;
	below = i + 1 < article->item_count ? items[i + 1].block : NULL;
	if (caption)
		*caption = below && below->kind == ARTICLE_TEXT && below->style == ARTICLE_FIGURE
				   ? below->text
				   : "";
	return i < article->item_count ? items[i].block->text : "";
}

int article_layout_picture_at(const struct article_layout *article, float x_px, float y_px)
{
	int picture = 0;

	for (uint32_t i = 0; i < article->item_count; i++) {
		const struct item *item = &article->items[i];

		if (item->block->kind != ARTICLE_IMAGE)
			continue;
		if (x_px >= (float)item->x_px && x_px < (float)(item->x_px + item->width_px) &&
		    y_px >= (float)item->y_px && y_px < (float)(item->y_px + item->height_px))
			return picture;
		picture++;
	}
	return -1;
}

int article_layout_picture_arrived(struct article_layout *article, const char *name)
{
	for (uint32_t i = 0; i < article->item_count; i++) {
		const struct item *item = &article->items[i];

		if (item->block->kind != ARTICLE_IMAGE || strcmp(item->block->text, name) != 0)
			continue;
		/* It fails only if memory runs out; then links are lost, and the text stays. */
		if (lay_out(article) < 0)
			article->link_count = 0;
		return item->y_px;
	}
	return -1;
}

int article_layout_unknown_glyphs(const struct article_layout *article)
{
	int count = 0;

	for (uint32_t i = 0; i < article->item_count; i++)
		if (article->items[i].layout)
			count += pango_layout_get_unknown_glyphs_count(article->items[i].layout);
	return count;
}
