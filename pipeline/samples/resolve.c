/* Collects the pixels that show anything in batches, and computes each batch in loops over arrays
 * that the compiler turns into vector instructions. */
#include "pipeline/samples/resolve.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/material/material.h"
#include "pipeline/samples/shading.h"

enum { BATCH = 128, SAMPLES_MAX = SHADING_SAMPLES, DETAILS = 2 };

/* Samples farther from each other, or whose normals have a smaller product, are coloured apart. */
static const float together_m = 0.1f, together_cos = 0.7f;
/* The noises of material_colour that may be finer than a pixel. */
static const float detail_frequencies[DETAILS] = { 23, 97 };

/* Where a ray of the frame goes, in metres per metre ahead: corner + x * right + y * down. */
struct rays {
	float eye_m[3], corner[3], right[3], down[3], px_radians;
};

/* A number for each pixel of the batch. */
typedef float floats[BATCH];

/* A number for each of up to four samples of each pixel. */
typedef float long_floats[SAMPLES_MAX * BATCH];

/* Samples whose blocks are computed. */
struct work {
	long_floats at[3], normal[3], footprint_m, out[4];
	uint32_t pixel[SAMPLES_MAX * BATCH];
	uint32_t count;
};

struct resolve {
	const struct raster *raster; /* borrowed */
	struct drawing_options drawn;
	int samples;        /* per pixel and axis */
	int sample_count;   /* per pixel */
	uint8_t (*rgba)[4]; /* borrowed while a picture is made */
	struct rays rays;
	/* the batch: what the raster has */
	uint32_t count;
	uint32_t place[BATCH]; /* in the picture */
	floats x, y;           /* of the first sample */
	floats inverse_m[SAMPLES_MAX];
	uint32_t surface[SAMPLES_MAX][BATCH], colour[SAMPLES_MAX][BATCH];
	/* what is computed of it; a sample that shows nothing has 0 in there, the others 1 */
	floats there[SAMPLES_MAX], shine[SAMPLES_MAX], at[SAMPLES_MAX][3], normal[SAMPLES_MAX][3];
	floats sum[3], covered, backs;
	/* a round: the samples that lie together with the first one that is left */
	floats left[SAMPLES_MAX], mine[SAMPLES_MAX], middle[3], ahead[3], spread, footprint_m;
	floats block[4], detail[DETAILS], rgb[3];
	floats weight[SAMPLES_MAX + 1], noise, needs_middle, needs_samples;
	uint32_t pixel[BATCH]; /* of the batch, whose samples are left */
	struct work work;
};

int resolve_create(struct resolve **out, const struct raster *raster,
		   const struct drawing_options *drawn, int samples)
{
	struct resolve *resolve = calloc(1, sizeof(*resolve));

	*out = resolve;
	if (!resolve)
		return -ENOMEM;
	resolve->raster = raster;
	resolve->drawn = *drawn;
	resolve->samples = samples;
	resolve->sample_count = samples * samples;
	return 0;
}

void resolve_destroy(struct resolve *resolve)
{
	free(resolve);
}

/* ---- what a sample shows */

vector_inline float root(float x)
{
	return sqrtf(x);
}

/* Unpacks the surfaces of the samples k: see raster.h. */
static vector_clones void unpack_surfaces(struct resolve *r, int k)
{
	uint32_t count = r->count;
	const uint32_t *surface = r->surface[k];
	const float *inverse_m = r->inverse_m[k];

#pragma GCC ivdep
	for (uint32_t i = 0; i < count; i++) {
		bool there = inverse_m[i] > 0;
		int32_t open = (int32_t)(surface[i] >> 24);
		bool back = open < 128;
		float x = (float)(int32_t)(surface[i] & 255) * (2 / 255.0f) - 1;
		float y = (float)(int32_t)(surface[i] >> 8 & 255) * (2 / 255.0f) - 1;
		float z = (float)(int32_t)(surface[i] >> 16 & 255) * (2 / 255.0f) - 1;
		float size = root(x * x + y * y + z * z);

		r->there[k][i] = there ? 1.0f : 0.0f;
		r->covered[i] += there ? 1.0f : 0.0f;
		r->backs[i] += there && back ? 1.0f : 0.0f;
		r->shine[k][i] = back ? (float)(open - 1) * (1 / 126.0f)
				      : (float)(open - 128) * (1 / 127.0f);
		r->normal[k][0][i] = x / size;
		r->normal[k][1][i] = y / size;
		r->normal[k][2][i] = z / size;
	}
}

/* Replaces the shares of open sky by light (geometry/light.h). */
static vector_clones void light_samples(struct resolve *r, int k)
{
	uint32_t count = r->count;
	const float *sun = r->drawn.sun;
	const float sun_x = sun[0], sun_y = sun[1], sun_z = sun[2];

#pragma GCC ivdep
	for (uint32_t i = 0; i < count; i++) {
		float open = r->shine[k][i], x = r->normal[k][0][i], y = r->normal[k][1][i],
		      z = r->normal[k][2][i];
		float facing = x * sun_x + y * sun_y + z * sun_z;

		facing = facing > 0 ? facing : 0;
		r->shine[k][i] =
			open * (0.36f + 0.20f * z) + 0.62f * facing * (0.35f + 0.65f * open);
	}
}

/* A sample that shows nothing is placed at the eye, so that all numbers are finite. */
static vector_clones void place_samples(struct resolve *r, int k)
{
	uint32_t count = r->count;
	const struct rays *rays = &r->rays;
	float off_x = (float)(k % r->samples) + 0.5f, off_y = (float)(k / r->samples) + 0.5f;

	for (int c = 0; c < 3; c++) {
		float eye = rays->eye_m[c], corner = rays->corner[c], right = rays->right[c],
		      down = rays->down[c];

#pragma GCC ivdep
		for (uint32_t i = 0; i < count; i++) {
			float ray = corner + (r->x[i] + off_x) * right + (r->y[i] + off_y) * down;

			float distance = r->inverse_m[k][i] > 0 ? 1 / r->inverse_m[k][i] : 0;

			r->at[k][c][i] = eye + ray * distance;
		}
	}
}

static vector_clones void sum_colours(struct resolve *r, int k)
{
	uint32_t count = r->count;

	for (int c = 0; c < 3; c++) {
#pragma GCC ivdep
		for (uint32_t i = 0; i < count; i++) {
			int32_t byte = (int32_t)(r->colour[k][i] >> 8 * c & 255);
			float value = (float)byte * (1 / 255.0f) * r->shine[k][i];

			r->sum[c][i] += r->there[k][i] * (value < 1 ? value : 1);
		}
	}
}

/* ---- the material */

/* Chooses the samples of a round, and their middle. */
static vector_clones void choose_samples(struct resolve *r, uint32_t count)
{
	float px_radians = r->rays.px_radians, together = together_m * together_m;
	const float *eye = r->rays.eye_m;
	const float eye_x = eye[0], eye_y = eye[1], eye_z = eye[2];

#pragma GCC ivdep
	for (uint32_t i = 0; i < count; i++) {
		float from[3], ahead[3], middle[3] = { 0 }, normal[3] = { 0 }, number = 0;
		float spread = 0, size, mine[SAMPLES_MAX];

		for (int c = 0; c < 3; c++) {
			from[c] = r->at[3][c][i];
			ahead[c] = r->normal[3][c][i];
		}
		for (int k = 2; k >= 0; k--)
			for (int c = 0; c < 3; c++) {
				bool left = r->left[k][i] > 0.5f;

				from[c] = left ? r->at[k][c][i] : from[c];
				ahead[c] = left ? r->normal[k][c][i] : ahead[c];
			}
		for (int k = 0; k < SAMPLES_MAX; k++) {
			float x = r->at[k][0][i] - from[0], y = r->at[k][1][i] - from[1],
			      z = r->at[k][2][i] - from[2];
			float along = r->normal[k][0][i] * ahead[0] +
				      r->normal[k][1][i] * ahead[1] + r->normal[k][2][i] * ahead[2];
			bool is_mine = (r->left[k][i] > 0.5f) &
				       (x * x + y * y + z * z <= together) &
				       (along >= together_cos);

			mine[k] = is_mine ? 1.0f : 0.0f;
			number += mine[k];
			for (int c = 0; c < 3; c++) {
				middle[c] += is_mine ? r->at[k][c][i] : 0;
				normal[c] += is_mine ? r->normal[k][c][i] : 0;
			}
		}
		for (int c = 0; c < 3; c++)
			middle[c] /= number;
		for (int k = 0; k < SAMPLES_MAX; k++) {
			float x = r->at[k][0][i] - middle[0], y = r->at[k][1][i] - middle[1],
			      z = r->at[k][2][i] - middle[2];
			float square = x * x + y * y + z * z;

			square = mine[k] > 0.5f ? square : 0;
			spread = square > spread ? square : spread;
			r->mine[k][i] = mine[k];
			r->left[k][i] -= mine[k];
		}
		size = root(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
		for (int c = 0; c < 3; c++) {
			r->middle[c][i] = middle[c];
			r->ahead[c][i] = normal[c] / size;
		}
		r->spread[i] = root(spread);
		middle[0] -= eye_x;
		middle[1] -= eye_y;
		middle[2] -= eye_z;
		r->footprint_m[i] =
			px_radians *
			root(middle[0] * middle[0] + middle[1] * middle[1] + middle[2] * middle[2]);
	}
}

/* Adds the place of a sample to the work. */
static void add_work(struct resolve *r, uint32_t i, uint32_t sample)
{
	struct work *work = &r->work;
	uint32_t n = work->count++;

	for (int c = 0; c < 3; c++) {
		work->at[c][n] = r->at[sample][c][i];
		work->normal[c][n] = r->ahead[c][i];
	}
	work->footprint_m[n] = r->footprint_m[i];
	work->pixel[n] = i;
}

static void add_all_samples(struct resolve *r, uint32_t i)
{
	for (uint32_t k = 0; k < SAMPLES_MAX; k++)
		if (r->mine[k][i] > 0.5f)
			add_work(r, i, k);
}

static struct material_places places_of(const struct work *work)
{
	return (struct material_places){
		work->count,     work->at[0],     work->at[1],     work->at[2],
		work->normal[0], work->normal[1], work->normal[2], work->footprint_m,
	};
}

/* Adds to a detail of each pixel those of its samples k, or of the middles if k is SAMPLES_MAX:
 * noise times weight. */
static vector_clones void add_detail(struct resolve *r, int n, const float *noise,
				     const float *weight, uint32_t count)
{
	float *detail = r->detail[n];

#pragma GCC ivdep
	for (uint32_t i = 0; i < count; i++)
		detail[i] += noise[i] * weight[i];
}

/* Sets, for a detail of that frequency, what the middle's noise weighs in it, what each sample's
 * does, and what it is without either. Returns bits: 1 if middles are needed, 2 if samples are. */
static vector_clones unsigned weigh_details(struct resolve *r, int n, uint32_t count)
{
	float frequency = detail_frequencies[n], middles = 0, samples = 0;

#pragma GCC ivdep
	for (uint32_t i = 0; i < count; i++) {
		float cells = frequency * r->footprint_m[i];
		float number = r->mine[0][i] + r->mine[1][i] + r->mine[2][i] + r->mine[3][i];
		float middle = cells < 0.15f ? 1 : 0;
		float sample = (cells >= 0.15f) & (cells < 1) ? 1 / number : 0;

		r->weight[SAMPLES_MAX][i] = middle;
		for (int k = 0; k < SAMPLES_MAX; k++)
			r->weight[k][i] = r->mine[k][i] > 0.5f ? sample : 0;
		r->detail[n][i] = cells >= 1 ? 0.5f : 0;
		r->needs_middle[i] = middle;
		r->needs_samples[i] = sample;
	}
	for (uint32_t i = 0; i < count; i++) {
		middles = r->needs_middle[i] > middles ? r->needs_middle[i] : middles;
		samples = r->needs_samples[i] > samples ? r->needs_samples[i] : samples;
	}
	return (middles > 0 ? 1u : 0) | (samples > 0 ? 2u : 0);
}

/* Sets a detail of each pixel: at the middle if it is much coarser than a pixel, else the mean of
 * the samples' ones. */
static void find_detail(struct resolve *r, int n, uint32_t count)
{
	unsigned needed = weigh_details(r, n, count);

	for (int k = 0; k <= SAMPLES_MAX; k++) {
		const floats *at = k < SAMPLES_MAX ? r->at[k] : r->middle;
		const struct material_places places = {
			.count = count,
			.x = at[0],
			.y = at[1],
			.z = at[2],
			.footprint_m = r->footprint_m,
		};

		if (!(needed & (k < SAMPLES_MAX ? 2 : 1)) ||
		    (k > 0 && k < SAMPLES_MAX && r->sample_count == 1))
			continue;
		material_details(r->noise, &places, detail_frequencies[n]);
		add_detail(r, n, r->noise, r->weight[k], count);
	}
}

static float mine_count(const struct resolve *r, uint32_t i)
{
	return r->mine[0][i] + r->mine[1][i] + r->mine[2][i] + r->mine[3][i];
}

/* Sets the block of each pixel, or the mean of the samples' ones if a joint is near. */
static void find_blocks(struct resolve *r, uint32_t count)
{
	struct work *work = &r->work;
	const struct material_places middles = {
		count,       r->middle[0], r->middle[1], r->middle[2],
		r->ahead[0], r->ahead[1],  r->ahead[2],  r->footprint_m,
	};
	const struct material_blocks blocks = { r->block[0], r->block[1], r->block[2],
						r->block[3] };
	const struct material_blocks several = { work->out[0], work->out[1], work->out[2],
						 work->out[3] };
	struct material_places places;

	material_blocks(&blocks, &middles);
	work->count = 0;
	for (uint32_t i = 0; i < count; i++)
		if (r->block[3][i] <= 0.014f + 1.2f * r->spread[i]) {
			r->block[0][i] = r->block[1][i] = r->block[2][i] = 0;
			add_all_samples(r, i);
		}
	places = places_of(work);
	material_blocks(&several, &places);
	for (uint32_t j = 0; j < work->count; j++) {
		uint32_t i = work->pixel[j];
		float share = 1 / mine_count(r, i);

		for (int c = 0; c < 3; c++)
			r->block[c][i] += share * work->out[c][j];
	}
}

/* Replaces the material's colour by the sum of what its samples show in the light. */
static vector_clones void light_round(struct resolve *r, uint32_t count)
{
	for (int c = 0; c < 3; c++) {
#pragma GCC ivdep
		for (uint32_t i = 0; i < count; i++) {
			float sum = 0;

			for (int k = 0; k < SAMPLES_MAX; k++) {
				float value = r->rgb[c][i] * r->shine[k][i];

				value = value < 1 ? value : 1;
				sum += r->mine[k][i] > 0.5f ? value : 0;
			}
			r->rgb[c][i] = sum;
		}
	}
}

static void paint_substance(struct resolve *r, uint32_t count)
{
	float *const rgb[3] = { r->rgb[0], r->rgb[1], r->rgb[2] };
	const float *const at[3] = { r->middle[0], r->middle[1], r->middle[2] };

	substance_colours(rgb, r->drawn.substance, at, r->footprint_m, count);
}

static void paint_stone(struct resolve *r, uint32_t count)
{
	const struct material_places places = {
		count,       r->middle[0], r->middle[1], r->middle[2],
		r->ahead[0], r->ahead[1],  r->ahead[2],  r->footprint_m,
	};
	const struct material_blocks blocks = { r->block[0], r->block[1], r->block[2],
						r->block[3] };
	float *const rgb[3] = { r->rgb[0], r->rgb[1], r->rgb[2] };

	for (int n = 0; n < DETAILS; n++)
		find_detail(r, n, count);
	find_blocks(r, count);
	material_paints(rgb, &places, &blocks, r->detail[0], r->detail[1]);
}

static void paint(struct resolve *r, uint32_t count)
{
	if (r->drawn.substance != SUBSTANCE_NONE)
		paint_substance(r, count);
	else
		paint_stone(r, count);
	light_round(r, count);
	for (int c = 0; c < 3; c++)
		for (uint32_t i = 0; i < count; i++)
			r->sum[c][r->pixel[i]] += r->rgb[c][i];
}

static vector_clones bool any_is_left(const struct resolve *r, uint32_t count)
{
	uint32_t any = 0;

	for (int k = 0; k < SAMPLES_MAX; k++)
		for (uint32_t i = 0; i < count; i++)
			any |= r->left[k][i] > 0.5f ? 1 : 0;
	return any;
}

/* Moves the pixels that have samples left to the front. Returns how many there are. */
static uint32_t keep_what_is_left(struct resolve *r, uint32_t count)
{
	uint32_t kept = 0;

	if (!any_is_left(r, count))
		return 0;
	for (uint32_t i = 0; i < count; i++) {
		if (r->left[0][i] + r->left[1][i] + r->left[2][i] + r->left[3][i] < 0.5f)
			continue;
		for (int k = 0; k < SAMPLES_MAX; k++) {
			for (int c = 0; c < 3; c++) {
				r->at[k][c][kept] = r->at[k][c][i];
				r->normal[k][c][kept] = r->normal[k][c][i];
			}
			r->left[k][kept] = r->left[k][i];
			r->shine[k][kept] = r->shine[k][i];
		}
		r->pixel[kept++] = r->pixel[i];
	}
	return kept;
}

static void sum_material(struct resolve *r)
{
	uint32_t count = r->count;

	for (int k = 0; k < SAMPLES_MAX; k++)
		memcpy(r->left[k], r->there[k], count * sizeof(*r->left[k]));
	for (uint32_t i = 0; i < count; i++)
		r->pixel[i] = i;
	while (count > 0) {
		choose_samples(r, count);
		paint(r, count);
		count = keep_what_is_left(r, count);
	}
}

/* ---- pixels */

static vector_clones void write_pixels(struct resolve *r)
{
	float weight = (float)(SHADING_SAMPLES / r->sample_count);
	uint32_t count = r->count, pixels[BATCH];

#pragma GCC ivdep
	for (uint32_t i = 0; i < count; i++) {
		uint32_t pixel = 0;

		for (int c = 0; c < 3; c++) {
			float value = r->sum[c][i] / r->covered[i] * 255 + 0.5f;

			pixel |= ((uint32_t)(int32_t)(value > 0 ? value : 0) & 255) << 8 * c;
		}
		pixel |= (uint32_t)(int32_t)(weight *
					     (r->covered[i] * SHADING_COVERED + r->backs[i]))
			 << 24;
		pixels[i] = pixel;
	}
	for (uint32_t i = 0; i < count; i++)
		memcpy(r->rgba[r->place[i]], &pixels[i], sizeof(pixels[i]));
}

static void finish_batch(struct resolve *r)
{
	memset(r->sum, 0, sizeof(r->sum));
	memset(r->covered, 0, sizeof(r->covered));
	memset(r->backs, 0, sizeof(r->backs));
	for (int k = 0; k < r->sample_count; k++) {
		unpack_surfaces(r, k);
		if (r->drawn.lit)
			light_samples(r, k);
		else
			for (uint32_t i = 0; i < r->count; i++)
				r->shine[k][i] = 1;
		if (r->drawn.procedural)
			place_samples(r, k);
		else
			sum_colours(r, k);
	}
	if (r->drawn.procedural)
		sum_material(r);
	write_pixels(r);
	r->count = 0;
}

/* Copies a number of each sample of a block to the batch's array of samples, sample by sample. */
vector_inline void sort_samples(void *to, const void *block, uint32_t samples)
{
	uint32_t side = RASTER_BLOCK_PX / samples;

	for (uint32_t k = 0; k < samples * samples; k++)
		for (uint32_t y = 0; y < side; y++)
			for (uint32_t x = 0; x < side; x++) {
				uint32_t row = y * samples + k / samples;
				uint32_t column = x * samples + k % samples;

				memcpy((uint8_t *)to + 4 * (size_t)(k * BATCH + y * side + x),
				       (const uint8_t *)block +
					       4 * (size_t)(row * RASTER_BLOCK_PX + column),
				       4);
			}
}

vector_inline void copy_block(struct resolve *r, const struct raster_block *block, uint32_t samples)
{
	sort_samples(&r->inverse_m[0][r->count], block->inverse_m, samples);
	sort_samples(&r->surface[0][r->count], block->surface, samples);
	if (block->colour)
		sort_samples(&r->colour[0][r->count], block->colour, samples);
}

static vector_clones void copy_samples(struct resolve *r, const struct raster_block *block)
{
	if (r->samples == 2)
		copy_block(r, block, 2);
	else
		copy_block(r, block, 1);
}

static void move_pixel(struct resolve *r, uint32_t to, uint32_t from)
{
	for (int k = 0; k < r->sample_count; k++) {
		r->inverse_m[k][to] = r->inverse_m[k][from];
		r->surface[k][to] = r->surface[k][from];
		r->colour[k][to] = r->colour[k][from];
	}
	r->x[to] = r->x[from];
	r->y[to] = r->y[from];
	r->place[to] = r->place[from];
}

/* Adds the pixels of a block that show anything to the batch. */
static void add_block(struct resolve *r, const struct raster_block *block, uint32_t x, uint32_t y,
		      uint32_t width_px)
{
	uint32_t samples = (uint32_t)r->samples, side = RASTER_BLOCK_PX / samples;
	uint32_t first = r->count, end = first + side * side;

	copy_samples(r, block);
	for (uint32_t row = 0; row < side; row++)
		for (uint32_t column = 0; column < side; column++) {
			uint32_t i = first + row * side + column;

			r->x[i] = (float)(x + column * samples);
			r->y[i] = (float)(y + row * samples);
			r->place[i] = (y / samples + row) * width_px + x / samples + column;
		}
	for (uint32_t i = first; i < end; i++) {
		float any = 0;

		for (int k = 0; k < r->sample_count; k++)
			any += r->inverse_m[k][i];
		if (any <= 0)
			continue;
		if (i > r->count)
			move_pixel(r, r->count, i);
		r->count++;
	}
}

static void set_rays(struct rays *rays, const struct camera *camera)
{
	float scale = 1 / camera_px_per_radian(camera), view[16];

	camera_view(camera, view);
	rays->px_radians = scale;
	for (int i = 0; i < 3; i++) {
		rays->eye_m[i] = camera->eye_m[i];
		rays->right[i] = view[4 * i] * scale;
		rays->down[i] = -view[4 * i + 1] * scale;
		rays->corner[i] = -view[4 * i + 2] - (float)camera->width_px / 2 * rays->right[i] -
				  (float)camera->height_px / 2 * rays->down[i];
	}
}

void resolve_take(struct resolve *resolve, const struct camera *camera, uint8_t (*rgba)[4])
{
	uint32_t side_px = (uint32_t)camera->width_px, blocks = side_px / RASTER_BLOCK_PX;
	uint32_t width_px = side_px / (uint32_t)resolve->samples;
	uint32_t block_px = RASTER_BLOCK_SAMPLES / (uint32_t)resolve->sample_count;
	struct raster_block block;

	resolve->rgba = rgba;
	set_rays(&resolve->rays, camera);
	memset(rgba, 0, (size_t)width_px * width_px * sizeof(*rgba));
	for (uint32_t row = 0; row < blocks; row++) {
		for (uint32_t column = 0; column < blocks; column++) {
			if (!raster_get_block(resolve->raster, column, row, &block))
				continue;
			if (resolve->count + block_px > BATCH)
				finish_batch(resolve);
			add_block(resolve, &block, column * RASTER_BLOCK_PX, row * RASTER_BLOCK_PX,
				  width_px);
		}
	}
	finish_batch(resolve);
}
