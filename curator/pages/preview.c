/* Builds the information, draws the model behind it, and lets the overlay come to rest over it. */
#include "curator/pages/preview.h"

#include <cairo.h>
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "curator/pages/preview_pictures.h"
#include "curator/session/painter.h"
#include "format/picture.h"
#include "geometry/vec.h"
#include "geometry/viewpoint.h"
#include "pipeline/content/info_build.h"
#include "pipeline/content/part_faces.h"
#include "storage/info.h"
#include "storage/info_ask.h"
#include "ui/overlay.h"

enum { QUALITY = 88, STEPS_MAX = 400, STEP_MS = 32, PICTURE_BYTES_MAX = 8 << 20, FOV_DEG = 40 };

static const float part_least_m = 0.5f;  /* size assumed for a part without one */
static const float hidden_share = 0.95f; /* of the distance to the anchor */

struct preview {
	struct site *site; /* borrowed */
	pthread_mutex_t mutex;
	struct region_set set; /* empty */
	struct painter *painter;
};

/* One picture that is being made. */
struct drawing {
	struct preview *preview;
	const struct preview_wish *wish;
	struct info *info;
	struct overlay *overlay;
	struct preview_pictures pictures;
	uint32_t part;
	struct rect scene;
	struct camera camera; /* of the scene */
	struct diagnostics *diagnostics;
};

int preview_create(struct preview **out, struct site *site)
{
	struct preview *preview = calloc(1, sizeof(*preview));
	int rc;

	*out = NULL;
	if (!preview)
		return -ENOMEM;
	preview->site = site;
	pthread_mutex_init(&preview->mutex, NULL);
	rc = region_set_init(&preview->set, site->mesh->triangle_count);
	if (rc == 0)
		rc = painter_create(&preview->painter, site, &preview->set);
	if (rc < 0)
		preview_destroy(preview);
	else
		*out = preview;
	return rc;
}

void preview_destroy(struct preview *preview)
{
	if (!preview)
		return;
	painter_destroy(preview->painter);
	region_set_finish(&preview->set);
	pthread_mutex_destroy(&preview->mutex);
	free(preview);
}

/* ---- the information */

static int build(struct drawing *drawing, struct info_built *out)
{
	struct site *site = drawing->preview->site;
	const struct preview_wish *wish = drawing->wish;
	const char *languages[CONTENT_LANGUAGES_MAX];
	char name[DOCUMENT_NAME_BYTES];
	const struct info_text_instead page = {
		name, { (const uint8_t *)wish->html, wish->html ? strlen(wish->html) : 0 }
	};
	struct part_faces_all faces;
	const struct info_build_options options = { .folder = site->content.folder,
						    .languages = languages,
						    .language_count = site->content.language_count,
						    .instead = &page,
						    .instead_count = wish->html && *wish->html,
						    .skims_pictures = true,
						    .judge_faces = part_faces_judge,
						    .place_faces = part_faces_place,
						    .faces_data = &faces,
						    .diagnostics = drawing->diagnostics };
	int rc;

	snprintf(name, sizeof(name), "pages/%s.%s.html", wish->part, wish->language);
	for (uint32_t n = 0; n < options.language_count; n++)
		languages[n] = site->content.languages[n];
	part_faces_init(&faces, site->scans);
	rc = info_build(out, &options);
	part_faces_finish(&faces);
	return rc;
}

static int open_info(struct drawing *drawing)
{
	struct info_built built;
	int part, rc = build(drawing, &built);

	if (rc == 0)
		rc = info_open(&drawing->info, buffer_bytes(&built.database));
	info_built_finish(&built);
	if (rc < 0)
		return rc;
	part = info_find(drawing->info, drawing->wish->part);
	if (part < 0)
		return diagnostics_add(drawing->diagnostics, -ENOENT, NULL, 0,
				       "there is no such part: somebody may have removed it");
	drawing->part = (uint32_t)part;
	return 0;
}

/* ---- the overlay */

static int tell_parts(struct drawing *drawing)
{
	const uint32_t count = info_part_count(drawing->info);
	struct overlay_part *parts = calloc(count + 1, sizeof(*parts));
	int rc;

	if (!parts)
		return -ENOMEM;
	for (uint32_t n = 0; n < count; n++) {
		const struct info_text text = info_text(drawing->info, n, drawing->wish->language);

		parts[n] = (struct overlay_part){ text.title, text.caption, text.thumbnail,
						  info_part(drawing->info, n)->has_page };
	}
	rc = overlay_parts(drawing->overlay, parts, count);
	free(parts);
	return rc;
}

static int open_page(struct drawing *drawing)
{
	const char *language = drawing->wish->language;
	struct bytes article;
	int rc = info_page(drawing->info, drawing->part, language, &article, NULL);

	if (rc == -ENOENT)
		return diagnostics_add(drawing->diagnostics, rc, NULL, 0,
				       "the part has no page yet");
	return rc < 0 ? rc
		      : overlay_show_page(drawing->overlay, (int)drawing->part, article,
					  info_credits(drawing->info, drawing->part, language));
}

static int make_overlay(struct drawing *drawing)
{
	const char *languages[OVERLAY_LANGUAGES_MAX];
	const struct overlay_options options = {
		.width_px = PREVIEW_WIDTH_PX,
		.height_px = PREVIEW_HEIGHT_PX,
		.languages = languages,
		.language_count = info_language_count(drawing->info),
		.picture = preview_pictures_get,
		.data = &drawing->pictures,
	};
	int rc;

	for (uint32_t n = 0; n < options.language_count; n++)
		languages[n] = info_language(drawing->info, n);
	rc = overlay_create(&drawing->overlay, &options);
	if (rc < 0)
		return rc;
	overlay_language(drawing->overlay, drawing->wish->language);
	overlay_show_help(drawing->overlay, false);
	rc = tell_parts(drawing);
	if (rc == 0 && drawing->wish->kind == PREVIEW_CARD)
		overlay_show_card(drawing->overlay, (int)drawing->part);
	if (rc == 0 && drawing->wish->kind == PREVIEW_PAGE)
		rc = open_page(drawing);
	drawing->scene = overlay_scene_rect(drawing->overlay);
	return rc;
}

/* ---- the model */

static void look(struct drawing *drawing)
{
	const struct site *site = drawing->preview->site;
	const struct info_part *part = info_part(drawing->info, drawing->part);
	float from_m[3], size_m[3];

	vec_sub(size_m, site->master->box_max_m, site->master->box_min_m);
	for (int i = 0; i < 3; i++)
		from_m[i] = site->content.has_start
				    ? site->content.start_eye_m[i]
				    : part->anchor_m[i] + (i < 2 ? -1 : 0.5f) * vec_length(size_m);
	drawing->camera = (struct camera){ .up = { 0, 0, 1 },
					   .fov_deg = FOV_DEG,
					   .near_m = vec_length(size_m) / 5000,
					   .far_m = vec_length(size_m) * 100,
					   .width_px = drawing->scene.width_px & ~1,
					   .height_px = drawing->scene.height_px & ~1 };
	viewpoint_of_region(&part->region, part->anchor_m, part_least_m, from_m,
			    drawing->camera.eye_m, drawing->camera.target_m);
}

/* Whether the model is before the anchor. */
static bool is_hidden(const struct view_image *view, float x_px, float y_px, float distance_m)
{
	const uint32_t x = (uint32_t)fmaxf(x_px, 0), y = (uint32_t)fmaxf(y_px, 0);
	float inverse_m;

	if (x >= view->width_px || y >= view->height_px)
		return false;
	inverse_m = view->inverse_m[(size_t)y * view->width_px + x];
	return inverse_m > 0 && 1 / inverse_m < hidden_share * distance_m;
}

static void place_anchors(struct drawing *drawing, const struct view_image *view)
{
	static struct overlay_anchor anchors[OVERLAY_PARTS_MAX]; /* under the mutex */
	const struct camera *camera = &drawing->camera;
	const uint32_t count = info_part_count(drawing->info);

	for (uint32_t n = 0; n < count && n < OVERLAY_PARTS_MAX; n++) {
		const struct info_part *part = info_part(drawing->info, n);
		const float away_m = vec_distance(part->anchor_m, camera->eye_m);
		struct overlay_anchor *anchor = &anchors[n];
		float x = -1, y = -1;
		const bool before = camera_pixel(camera, part->anchor_m, &x, &y);

		anchor->visible = before && x >= 0 && y >= 0 && x < (float)camera->width_px &&
				  y < (float)camera->height_px;
		anchor->hidden = anchor->visible && is_hidden(view, x, y, away_m);
		anchor->x_px = x + (float)drawing->scene.x_px;
		anchor->y_px = y + (float)drawing->scene.y_px;
		anchor->size_px = 2 * region_size_m(&part->region) * camera_px_per_radian(camera) /
				  fmaxf(away_m, 0.01f);
	}
	overlay_anchors(drawing->overlay, anchors, count);
}

/* Cairo's pixels, from red, green, blue, alpha without transparency. */
static void copy_pixels(cairo_surface_t *to, const struct picture *from, const struct rect *at)
{
	const int stride = cairo_image_surface_get_stride(to);
	uint8_t *pixels = cairo_image_surface_get_data(to);

	for (uint32_t y = 0; y < from->height; y++)
		for (uint32_t x = 0; x < from->width; x++) {
			const uint8_t *p = from->rgba + 4 * ((size_t)y * from->width + x);
			const uint32_t value =
				0xff000000u | (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];

			memcpy(pixels + (size_t)stride * (y + (uint32_t)at->y_px) +
				       4 * (x + (size_t)at->x_px),
			       &value, 4);
		}
	cairo_surface_mark_dirty(to);
}

static int draw_model(struct drawing *drawing, cairo_surface_t *to)
{
	struct painter *painter = drawing->preview->painter;
	struct picture picture = { 0 };
	struct buffer file;
	int rc;

	look(drawing);
	buffer_init(&file, PICTURE_BYTES_MAX);
	rc = painter_draw(painter, &drawing->camera, true, &file);
	if (rc == 0)
		rc = picture_decode(&picture, buffer_bytes(&file));
	if (rc == 0) {
		struct camera camera;

		copy_pixels(to, &picture, &drawing->scene);
		place_anchors(drawing, painter_view(painter, &camera));
	}
	picture_finish(&picture);
	buffer_finish(&file);
	return rc;
}

/* ---- the picture */

static int encode(struct buffer *out, cairo_surface_t *from)
{
	struct picture picture = { PREVIEW_WIDTH_PX, PREVIEW_HEIGHT_PX,
				   malloc(4 * PREVIEW_WIDTH_PX * PREVIEW_HEIGHT_PX) };
	const uint8_t *pixels;
	int rc;

	if (!picture.rgba)
		return -ENOMEM;
	cairo_surface_flush(from);
	pixels = cairo_image_surface_get_data(from);
	for (size_t n = 0; n < (size_t)PREVIEW_WIDTH_PX * PREVIEW_HEIGHT_PX; n++) {
		uint32_t value;

		memcpy(&value, pixels + 4 * n, 4);
		picture.rgba[4 * n] = (uint8_t)(value >> 16);
		picture.rgba[4 * n + 1] = (uint8_t)(value >> 8);
		picture.rgba[4 * n + 2] = (uint8_t)value;
		picture.rgba[4 * n + 3] = 255;
	}
	rc = picture_encode_jpeg(out, &picture, QUALITY);
	picture_finish(&picture);
	return rc;
}

static int paint(struct drawing *drawing, cairo_surface_t *surface, struct buffer *out)
{
	const uint8_t *back = drawing->preview->site->content.background;
	cairo_t *context = cairo_create(surface);
	int rc;

	cairo_set_source_rgb(context, back[0] / 255.0, back[1] / 255.0, back[2] / 255.0);
	cairo_paint(context);
	cairo_surface_flush(surface);
	rc = draw_model(drawing, surface);
	if (rc == 0) {
		for (int n = 0; n < STEPS_MAX; n++)
			if (!overlay_update(drawing->overlay, (int64_t)n * STEP_MS) && n > 0)
				break;
		overlay_paint(drawing->overlay, context);
	}
	cairo_destroy(context);
	return rc < 0 ? rc : encode(out, surface);
}

static int draw(struct drawing *drawing, struct buffer *out)
{
	cairo_surface_t *surface;
	int rc = open_info(drawing);

	if (rc == 0)
		rc = make_overlay(drawing);
	if (rc < 0)
		return rc;
	surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, PREVIEW_WIDTH_PX,
					     PREVIEW_HEIGHT_PX);
	rc = cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS ? paint(drawing, surface, out)
								   : -ENOMEM;
	cairo_surface_destroy(surface);
	return rc;
}

int preview_draw(struct preview *preview, const struct preview_wish *wish, struct buffer *out,
		 struct diagnostics *diagnostics)
{
	struct drawing drawing = { .preview = preview, .wish = wish, .diagnostics = diagnostics };
	int rc;

	pthread_mutex_lock(&preview->mutex);
	preview_pictures_init(&drawing.pictures, &preview->site->content);
	rc = draw(&drawing, out);
	overlay_destroy(drawing.overlay);
	preview_pictures_finish(&drawing.pictures);
	info_close(drawing.info);
	pthread_mutex_unlock(&preview->mutex);
	return rc;
}
