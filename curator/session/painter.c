/* Two sizes of picture, each with a raster for the model and one for the region. A pixel shows the
 * region where the region's surface is as near as the model's. */
#include "curator/session/painter.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "curator/region/region_model.h"
#include "curator/view/kept_model.h"
#include "curator/view/view_draw.h"
#include "format/picture.h"
#include "geometry/light.h"
#include "geometry/vec.h"
#include "pipeline/samples/model_master.h"

enum {
	JPEG_QUALITY_SHARP = 90,
	JPEG_QUALITY_FAST = 72,
	FAST_FRAME_MS = 60,  /* above it, the detail of fast pictures gets coarser */
	SPARE_FRAME_MS = 35, /* below it, finer */
	JPEG_BYTES_MAX = 16 << 20,
};

/* Four places in a pixel, each in a row and a column of its own: the steps of nearly level and
 * nearly upright edges become four finer ones. */
static const float shifts_px[][2] = {
	{ -0.125f, -0.375f }, { 0.375f, -0.125f }, { 0.125f, 0.375f }, { -0.375f, 0.125f }
};
static const float detail_sharp_px = 1, detail_fast_min_px = 1.5f, detail_fast_max_px = 12;
/* The region's surface may lie so many pixels (of the detail drawn) behind the model's: the model
 * is drawn from simpler patches. */
static const float behind_px = 2;

struct canvas {
	uint32_t width_px, height_px;
	struct view_draw *model, *region; /* owned */
	uint8_t *marked;                  /* owned; for each pixel, whether it shows the region */
	struct picture picture;           /* owned */
	struct view_image view;           /* borrowed from model */
};

struct painter {
	struct site *site; /* borrowed, as is set */
	const struct region_set *set;
	struct model *model, *region; /* owned */
	struct canvas sharp, fast;
	struct camera sharp_camera;
	bool has_sharp;
	struct canvas shifted; /* the sharp view, seen past other parts of its pixels */
	uint16_t *sums; /* owned; of shifts_done pictures, red, green and blue of each pixel */
	uint32_t shifts_done;
	float detail_fast_px;
};

int painter_create(struct painter **out, struct site *site, const struct region_set *set)
{
	struct painter *painter = calloc(1, sizeof(*painter));
	struct model *master;
	int rc;

	*out = NULL;
	if (!painter)
		return -ENOMEM;
	painter->site = site;
	painter->set = set;
	painter->detail_fast_px = 2;
	rc = model_of_master(&master, site->master);
	if (rc == 0)
		rc = kept_model_create(&painter->model, master);
	if (rc == 0)
		rc = region_model_create(&painter->region, set, site->mesh, &site->blocks);
	if (rc < 0) {
		painter_destroy(painter);
		return rc;
	}
	*out = painter;
	return 0;
}

static void canvas_finish(struct canvas *canvas)
{
	view_draw_destroy(canvas->model);
	view_draw_destroy(canvas->region);
	free(canvas->marked);
	picture_finish(&canvas->picture);
	*canvas = (struct canvas){ 0 };
}

void painter_destroy(struct painter *painter)
{
	if (!painter)
		return;
	canvas_finish(&painter->sharp); /* before the models that they borrow */
	canvas_finish(&painter->fast);
	canvas_finish(&painter->shifted);
	free(painter->sums);
	model_destroy(painter->model);
	model_destroy(painter->region);
	free(painter);
}

static int canvas_resize(struct painter *painter, struct canvas *canvas, uint32_t width_px,
			 uint32_t height_px)
{
	const size_t pixels = (size_t)width_px * height_px;
	int rc;

	if (canvas->width_px == width_px && canvas->height_px == height_px)
		return 0;
	canvas_finish(canvas);
	canvas->marked = calloc(pixels, 1);
	canvas->picture = (struct picture){ width_px, height_px, malloc(4 * pixels) };
	rc = canvas->marked && canvas->picture.rgba ? 0 : -ENOMEM;
	if (rc == 0)
		rc = view_draw_create(&canvas->model, painter->model, width_px, height_px);
	if (rc == 0)
		rc = view_draw_create(&canvas->region, painter->region, width_px, height_px);
	if (rc < 0) {
		canvas_finish(canvas);
		return rc;
	}
	canvas->width_px = width_px;
	canvas->height_px = height_px;
	return 0;
}

/* ---- the region */

/* Of the canvas's camera and view. */
static int mark_region(struct painter *painter, struct canvas *canvas, const struct camera *camera,
		       float detail_px)
{
	const size_t pixels = (size_t)canvas->width_px * canvas->height_px;
	const float *seen = canvas->view.inverse_m;
	const float share = 1 - behind_px * detail_px / canvas->view.px_per_radian;
	struct view_image region;
	int rc;

	memset(canvas->marked, 0, pixels);
	if (painter->set->count == 0)
		return 0;
	rc = view_draw_image(canvas->region, camera, 0, &region);
	if (rc < 0)
		return rc;
	for (size_t i = 0; i < pixels; i++)
		canvas->marked[i] = seen[i] > 0 && region.inverse_m[i] > seen[i] * share;
	return 0;
}

/* ---- colours */

/* Whether a marked pixel has a neighbour that is not. */
static bool is_edge(const struct canvas *canvas, uint32_t x, uint32_t y)
{
	const uint8_t *at = canvas->marked + (size_t)y * canvas->width_px + x;

	return (x > 0 && !at[-1]) || (x + 1 < canvas->width_px && !at[1]) ||
	       (y > 0 && !at[-(ptrdiff_t)canvas->width_px]) ||
	       (y + 1 < canvas->height_px && !at[canvas->width_px]);
}

static void light_pixel(const struct painter *painter, const struct view_image *view, size_t i,
			float rgb[3])
{
	float normal[3], light = 1;

	for (int c = 0; c < 3; c++)
		normal[c] = (float)view->normals[i][c] / 127;
	if (painter->site->lit)
		light = light_at(normal, (float)view->open[i] / 255, painter->site->content.sun);
	for (int c = 0; c < 3; c++)
		rgb[c] = vec_least(255, (float)view->colours[i][c] * light);
}

static void paint_pixel(const struct painter *painter, struct canvas *canvas, uint32_t x,
			uint32_t y)
{
	static const float region[3] = { 20, 120, 255 }, edge[3] = { 190, 225, 255 };
	const size_t i = (size_t)y * canvas->width_px + x;
	uint8_t *to = canvas->picture.rgba + 4 * i;
	float rgb[3];

	if (canvas->view.inverse_m[i] <= 0) {
		memcpy(to, painter->site->content.background, 3);
		return;
	}
	light_pixel(painter, &canvas->view, i, rgb);
	if (canvas->marked[i]) {
		const bool at_edge = is_edge(canvas, x, y);

		for (int c = 0; c < 3; c++)
			rgb[c] = at_edge ? edge[c] : 0.5f * rgb[c] + 0.5f * region[c];
	}
	for (int c = 0; c < 3; c++)
		to[c] = (uint8_t)rgb[c];
}

static void paint_pixels(const struct painter *painter, struct canvas *canvas)
{
	for (uint32_t y = 0; y < canvas->height_px; y++)
		for (uint32_t x = 0; x < canvas->width_px; x++)
			paint_pixel(painter, canvas, x, y);
}

static int paint(const struct painter *painter, struct canvas *canvas, int quality,
		 struct buffer *out)
{
	paint_pixels(painter, canvas);
	return picture_encode_jpeg(out, &canvas->picture, quality);
}

/* ---- frames */

static int draw_sharp(struct painter *painter, const struct camera *camera, struct buffer *out)
{
	int rc = canvas_resize(painter, &painter->sharp, (uint32_t)camera->width_px,
			       (uint32_t)camera->height_px);

	painter->has_sharp = false;
	if (rc == 0)
		rc = view_draw_image(painter->sharp.model, camera, detail_sharp_px,
				     &painter->sharp.view);
	if (rc < 0)
		return rc;
	painter->sharp_camera = *camera;
	painter->has_sharp = true;
	return painter_draw_again(painter, out);
}

int painter_draw_again(struct painter *painter, struct buffer *out)
{
	int rc = painter->has_sharp ? 0 : -EINVAL;

	painter->shifts_done = 0;
	if (rc == 0)
		rc = mark_region(painter, &painter->sharp, &painter->sharp_camera, detail_sharp_px);
	return rc == 0 ? paint(painter, &painter->sharp, JPEG_QUALITY_SHARP, out) : rc;
}

/* ---- smooth edges */

/* Turns a camera so little that its middle moves by so many pixels. */
static void shift_camera(struct camera *camera, const float by_px[2])
{
	const float distance_m = vec_distance(camera->target_m, camera->eye_m);
	float ray[3];

	camera_ray(camera, (float)camera->width_px / 2 + by_px[0],
		   (float)camera->height_px / 2 + by_px[1], ray);
	vec_copy(camera->target_m, camera->eye_m);
	vec_add_scaled(camera->target_m, camera->target_m, distance_m, ray);
}

static int make_room_for_sums(struct painter *painter)
{
	const struct canvas *sharp = &painter->sharp;
	const bool is_new = painter->shifted.width_px != sharp->width_px ||
			    painter->shifted.height_px != sharp->height_px;
	int rc = canvas_resize(painter, &painter->shifted, sharp->width_px, sharp->height_px);

	if (rc == 0 && is_new) {
		free(painter->sums);
		painter->sums = malloc((size_t)sharp->width_px * sharp->height_px * 3 *
				       sizeof(*painter->sums));
		painter->shifts_done = 0;
		rc = painter->sums ? 0 : -ENOMEM;
		if (rc < 0)
			canvas_finish(&painter->shifted);
	}
	return rc;
}

static void add_picture(struct painter *painter)
{
	const struct canvas *canvas = &painter->shifted;
	const size_t pixels = (size_t)canvas->width_px * canvas->height_px;

	if (painter->shifts_done == 0)
		memset(painter->sums, 0, pixels * 3 * sizeof(*painter->sums));
	for (size_t i = 0; i < pixels; i++)
		for (size_t c = 0; c < 3; c++)
			painter->sums[3 * i + c] += canvas->picture.rgba[4 * i + c];
	painter->shifts_done++;
}

static int encode_mean(struct painter *painter, struct buffer *out)
{
	struct picture *picture = &painter->shifted.picture;
	const size_t pixels = (size_t)picture->width * picture->height;
	const uint32_t count = painter->shifts_done;

	for (size_t i = 0; i < pixels; i++)
		for (size_t c = 0; c < 3; c++)
			picture->rgba[4 * i + c] =
				(uint8_t)((painter->sums[3 * i + c] + count / 2) / count);
	painter->shifts_done = 0;
	return picture_encode_jpeg(out, picture, JPEG_QUALITY_SHARP);
}

int painter_smooth(struct painter *painter, struct buffer *out)
{
	struct camera camera = painter->sharp_camera;
	int rc = painter->has_sharp ? make_room_for_sums(painter) : -EINVAL;

	if (rc < 0)
		return rc;
	shift_camera(&camera, shifts_px[painter->shifts_done]);
	rc = view_draw_image(painter->shifted.model, &camera, detail_sharp_px,
			     &painter->shifted.view);
	if (rc == 0)
		rc = mark_region(painter, &painter->shifted, &camera, detail_sharp_px);
	if (rc < 0)
		return rc;
	paint_pixels(painter, &painter->shifted);
	add_picture(painter);
	return painter->shifts_done < ARRAY_COUNT(shifts_px) ? 1 : encode_mean(painter, out);
}

/* ---- fast frames */

static int draw_fast(struct painter *painter, const struct camera *camera, struct buffer *out)
{
	const int64_t begun_ms = clock_now_ms();
	struct camera half = *camera;
	int64_t took_ms;
	int rc;

	half.width_px = camera->width_px / 4 * 2;
	half.height_px = camera->height_px / 4 * 2;
	rc = canvas_resize(painter, &painter->fast, (uint32_t)half.width_px,
			   (uint32_t)half.height_px);
	if (rc == 0)
		rc = view_draw_image(painter->fast.model, &half, painter->detail_fast_px,
				     &painter->fast.view);
	if (rc == 0)
		rc = mark_region(painter, &painter->fast, &half, painter->detail_fast_px);
	if (rc == 0)
		rc = paint(painter, &painter->fast, JPEG_QUALITY_FAST, out);
	took_ms = clock_now_ms() - begun_ms;
	if (took_ms > FAST_FRAME_MS)
		painter->detail_fast_px =
			vec_least(painter->detail_fast_px * 1.25f, detail_fast_max_px);
	else if (took_ms < SPARE_FRAME_MS)
		painter->detail_fast_px =
			vec_most(painter->detail_fast_px / 1.1f, detail_fast_min_px);
	return rc;
}

int painter_draw(struct painter *painter, const struct camera *camera, bool sharp,
		 struct buffer *out)
{
	return sharp ? draw_sharp(painter, camera, out) : draw_fast(painter, camera, out);
}

const struct view_image *painter_view(const struct painter *painter, struct camera *camera)
{
	*camera = painter->sharp_camera;
	return painter->has_sharp ? &painter->sharp.view : NULL;
}
