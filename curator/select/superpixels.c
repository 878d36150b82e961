/* Floods the contrast of a view from markers, in the order of its bytes; then gathers what each
 * superpixel is, and where they touch. */
#include "curator/select/superpixels.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/map.h"
#include "curator/select/contrast.h"
#include "geometry/vec.h"

enum { LEVELS = 256, NOWHERE = -1 };

/* How much each contrast counts in a byte, and how much the distance from the marker's square. */
static const float colour_share = 0.6f, turn_share = 400, step_share = 20, compact_share = 3;

/* Pixels that wait, sorted by level, first come first served. */
struct flood {
	const struct view_image *image;
	uint8_t *contrast;  /* of each pixel */
	uint32_t *of_pixel; /* the result, borrowed */
	int32_t *next;      /* of each pixel that waits: the one after it */
	int32_t first[LEVELS], last[LEVELS];
	float (*markers)[2];         /* where each superpixel began, pixels */
	uint32_t count, marker_room; /* superpixels so far */
};

/* ---- contrast */

/* Between the pixels on both sides of one, in one direction; the edge of what shows is the
 * strongest. */
static float across(const struct view_image *image, uint32_t before, uint32_t at, uint32_t behind)
{
	const float *w = image->inverse_m;
	float colour = 0, dot = 0;

	if (w[before] <= 0 || w[behind] <= 0)
		return LEVELS - 1;
	for (int i = 0; i < 3; i++) {
		colour +=
			fabsf((float)image->colours[before][i] - (float)image->colours[behind][i]);
		dot += (float)image->normals[before][i] * (float)image->normals[behind][i];
	}
	const float step = fabsf(w[before] - 2 * w[at] + w[behind]) / w[at] * image->px_per_radian;
	return colour_share * colour / 3 + turn_share * vec_most(0, 1 - dot / (127 * 127)) +
	       step_share * step;
}

static void find_contrast(const struct view_image *image, uint8_t *contrast)
{
	const uint32_t width = image->width_px, height = image->height_px;

	for (uint32_t y = 0, at = 0; y < height; y++) {
		for (uint32_t x = 0; x < width; x++, at++) {
			float sum = 0;

			contrast[at] = 0;
			if (image->inverse_m[at] <= 0)
				continue;
			if (x > 0 && x + 1 < width)
				sum = across(image, at - 1, at, at + 1);
			if (y > 0 && y + 1 < height)
				sum = vec_most(sum, across(image, at - width, at, at + width));
			contrast[at] = (uint8_t)vec_least(sum, LEVELS - 1);
		}
	}
}

/* ---- flooding */

static int add_marker(struct flood *flood, uint32_t pixel)
{
	int rc = ARRAY_RESERVE(flood->markers, flood->marker_room, flood->count + 1, UINT32_MAX);

	if (rc < 0)
		return rc;
	flood->markers[flood->count][0] = (float)(pixel % flood->image->width_px);
	flood->markers[flood->count][1] = (float)(pixel / flood->image->width_px);
	flood->of_pixel[pixel] = flood->count++;
	return 0;
}

static void wait_at(struct flood *flood, uint32_t pixel, uint32_t level)
{
	flood->next[pixel] = NOWHERE;
	if (flood->first[level] == NOWHERE)
		flood->first[level] = (int32_t)pixel;
	else
		flood->next[flood->last[level]] = (int32_t)pixel;
	flood->last[level] = (int32_t)pixel;
}

/* A neighbour that nobody has joins the superpixel, and waits until its own neighbours' turn. */
static void join(struct flood *flood, uint32_t pixel, uint32_t superpixel, uint32_t level)
{
	const float *marker = flood->markers[superpixel];

	if (flood->of_pixel[pixel] != SUPERPIXEL_NONE || flood->image->inverse_m[pixel] <= 0)
		return;
	const float x = (float)(pixel % flood->image->width_px) - marker[0],
		    y = (float)(pixel / flood->image->width_px) - marker[1];
	const float wanted = (float)flood->contrast[pixel] + compact_share * sqrtf(x * x + y * y);
	const uint32_t its = (uint32_t)vec_least(wanted, LEVELS - 1);

	flood->of_pixel[pixel] = superpixel;
	wait_at(flood, pixel, its > level ? its : level);
}

static void spread(struct flood *flood, uint32_t pixel, uint32_t level)
{
	const uint32_t width = flood->image->width_px, height = flood->image->height_px;
	const uint32_t x = pixel % width, y = pixel / width, its = flood->of_pixel[pixel];

	if (x > 0)
		join(flood, pixel - 1, its, level);
	if (x + 1 < width)
		join(flood, pixel + 1, its, level);
	if (y > 0)
		join(flood, pixel - width, its, level);
	if (y + 1 < height)
		join(flood, pixel + width, its, level);
}

static void run_flood(struct flood *flood)
{
	for (uint32_t level = 0; level < LEVELS; level++) {
		while (flood->first[level] != NOWHERE) {
			const int32_t pixel = flood->first[level];

			flood->first[level] = flood->next[pixel];
			spread(flood, (uint32_t)pixel, level);
		}
	}
}

/* The pixel with the least contrast of a square that starts there, away from the square's edge so
 * that two markers are not neighbours; SUPERPIXEL_NONE: nothing shows. */
static uint32_t calmest(const struct flood *flood, uint32_t left, uint32_t top)
{
	const struct view_image *image = flood->image;
	uint32_t best = SUPERPIXEL_NONE;

	for (uint32_t y = top + 1; y < top + SUPERPIXEL_SIDE_PX - 1 && y < image->height_px; y++) {
		for (uint32_t x = left + 1;
		     x < left + SUPERPIXEL_SIDE_PX - 1 && x < image->width_px; x++) {
			const uint32_t at = y * image->width_px + x;

			if (image->inverse_m[at] > 0 &&
			    (best == SUPERPIXEL_NONE ||
			     flood->contrast[at] < flood->contrast[best]))
				best = at;
		}
	}
	return best;
}

/* Floods from a marker in each square. What they do not reach, because nothing shows around it,
 * gets a marker of its own. */
static int flood_all(struct flood *flood)
{
	const uint32_t width = flood->image->width_px, height = flood->image->height_px;
	int rc = 0;

	for (uint32_t y = 0; y < height; y += SUPERPIXEL_SIDE_PX) {
		for (uint32_t x = 0; x < width; x += SUPERPIXEL_SIDE_PX) {
			const uint32_t at = calmest(flood, x, y);

			rc = at == SUPERPIXEL_NONE ? 0 : add_marker(flood, at);
			if (rc < 0)
				return rc;
			if (at != SUPERPIXEL_NONE)
				wait_at(flood, at, 0);
		}
	}
	run_flood(flood);
	for (uint32_t at = 0; at < width * height; at++) {
		if (flood->image->inverse_m[at] <= 0 || flood->of_pixel[at] != SUPERPIXEL_NONE)
			continue;
		rc = add_marker(flood, at);
		if (rc < 0)
			return rc;
		wait_at(flood, at, 0);
		run_flood(flood);
	}
	return 0;
}

/* ---- what they are */

static void gather(struct superpixels *out, const struct view_image *image)
{
	for (uint32_t at = 0; at < image->width_px * image->height_px; at++) {
		struct superpixel *its;

		if (out->of_pixel[at] == SUPERPIXEL_NONE)
			continue;
		its = &out->all[out->of_pixel[at]];
		its->pixel_count++;
		for (int i = 0; i < 3; i++) {
			its->colour[i] += image->colours[at][i];
			its->normal[i] += image->normals[at][i];
		}
	}
	for (uint32_t n = 0; n < out->count; n++) {
		struct superpixel *its = &out->all[n];

		vec_scale(its->colour, 1 / (float)its->pixel_count, its->colour);
		vec_normalise(its->normal);
	}
}

/* Notes that pixel a and its neighbour b touch, if they belong to two. */
static int touch(struct superpixels *out, struct map *known, const struct view_image *image,
		 uint32_t a, uint32_t b)
{
	uint32_t first = out->of_pixel[a], second = out->of_pixel[b];
	struct superpixel_border *border;
	uint64_t index;
	int rc;

	if (first == second || first == SUPERPIXEL_NONE || second == SUPERPIXEL_NONE)
		return 0;
	if (first > second) {
		const uint32_t other = first;

		first = second;
		second = other;
	}
	const map_key key = (map_key)first << 32 | second;
	index = map_get(known, key);
	if (index == MAP_NONE) {
		rc = ARRAY_RESERVE(out->borders, out->border_room, out->border_count + 1,
				   UINT32_MAX);
		if (rc == 0)
			rc = map_set(known, key, out->border_count);
		if (rc < 0)
			return rc;
		index = out->border_count++;
		out->borders[index] = (struct superpixel_border){ first, second, 0, 0 };
	}
	border = &out->borders[index];
	border->length_px++;
	border->step += contrast_step(image, a, b);
	return 0;
}

static int find_borders(struct superpixels *out, const struct view_image *image)
{
	const uint32_t width = image->width_px, height = image->height_px;
	struct map known = { 0 };
	int rc = 0;

	for (uint32_t y = 0, at = 0; y < height && rc == 0; y++) {
		for (uint32_t x = 0; x < width && rc == 0; x++, at++) {
			if (x + 1 < width)
				rc = touch(out, &known, image, at, at + 1);
			if (rc == 0 && y + 1 < height)
				rc = touch(out, &known, image, at, at + width);
		}
	}
	for (uint32_t n = 0; n < out->border_count; n++)
		out->borders[n].step /= (float)out->borders[n].length_px;
	map_finish(&known);
	return rc;
}

int superpixels_make(struct superpixels *out, const struct view_image *image)
{
	const size_t pixels = (size_t)image->width_px * image->height_px;
	struct flood flood = { .image = image };
	int rc = -ENOMEM;

	memset(out, 0, sizeof(*out));
	memset(flood.first, 0xff, sizeof(flood.first)); /* NOWHERE */
	out->of_pixel = malloc(pixels * sizeof(*out->of_pixel));
	flood.of_pixel = out->of_pixel;
	flood.contrast = malloc(pixels);
	flood.next = malloc(pixels * sizeof(*flood.next));
	if (out->of_pixel && flood.contrast && flood.next) {
		memset(out->of_pixel, 0xff, pixels * sizeof(*out->of_pixel)); /* SUPERPIXEL_NONE */
		find_contrast(image, flood.contrast);
		rc = flood_all(&flood);
	}
	out->count = flood.count;
	out->all = calloc(flood.count + 1, sizeof(*out->all));
	if (rc == 0 && !out->all)
		rc = -ENOMEM;
	if (rc == 0) {
		gather(out, image);
		rc = find_borders(out, image);
	}
	free(flood.contrast);
	free(flood.next);
	free(flood.markers);
	if (rc < 0)
		superpixels_finish(out);
	return rc;
}

float superpixel_border_cost(const struct superpixels *superpixels,
			     const struct superpixel_border *border)
{
	const struct superpixel *a = &superpixels->all[border->a],
				*b = &superpixels->all[border->b];
	const struct contrast contrast = { contrast_colour(a->colour, b->colour),
					   contrast_turn(a->normal, b->normal), border->step };

	return contrast_border_cost(&contrast);
}

void superpixels_finish(struct superpixels *superpixels)
{
	if (!superpixels)
		return;
	free(superpixels->of_pixel);
	free(superpixels->all);
	free(superpixels->borders);
	memset(superpixels, 0, sizeof(*superpixels));
}
