/* Smooths a range image at growing scales, and finds the zero crossings of its Laplacian.
 *
 * Irregular sampling: each pass of the separable smoothing fits a line to the texels that are seen,
 * weighted by the Gaussian, and takes its value in the middle. Where all texels are seen, that is
 * the Gaussian mean. Beside holes and edges a mean would be drawn to the seen side, which bends
 * planes; the line keeps them exact, and bridges small holes. */
#include "pipeline/samples/scale_space.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* Sigmas that the kernel reaches, and the size of its weights: whole numbers, so that they do not
 * depend on the last bit of exp. */
enum { REACH_SIGMAS = 3, RADIUS_MAX = REACH_SIGMAS * SCALE_SPACE_SIGMA_PX_MAX + 1 };

static const double kernel_one = 65536;
/* A line is fitted if the seen texels spread over this share of the kernel's variance. */
static const double spread_least = 0.01;
/* A texel has a smooth value if this share of its kernel is seen. */
static const double support_least = 0.4;
/* Numbers that differ by no more than this share are equal. */
static const double rounding = 1e-6;

struct smoothing {
	uint32_t width, height, radius;
	double sigma;
	double kernel[RADIUS_MAX + 1]; /* from the middle outwards */
	double kernel_sum;
	/* Each width * height, owned. A weight is the share of a kernel that is seen. */
	double *seen; /* 0 or 1 */
	double *values, *row_values, *row_weights, *smooth, *weights;
	double *bends; /* the Laplacian; 0: not known */
};

static void set_kernel(struct smoothing *work, double sigma)
{
	work->sigma = sigma;
	work->radius = (uint32_t)ceil(REACH_SIGMAS * sigma);
	work->kernel_sum = 0;
	for (uint32_t u = 0; u <= work->radius; u++) {
		double weight = exp(-(double)u * u / (2 * sigma * sigma));

		work->kernel[u] = floor(kernel_one * weight + 0.5);
		work->kernel_sum += work->kernel[u] * (u ? 2 : 1);
	}
}

/* A line of texels, `stride` apart. */
struct line {
	const double *values, *weights;
	uint32_t count;
	size_t stride;
};

/* Fits the line around texel `at`. *weight: the share of the kernel that is seen; 0 if that is too
 * little for a line. */
static double fit(const struct smoothing *work, const struct line *line, uint32_t at,
		  double *weight)
{
	double m0 = 0, m1 = 0, m2 = 0, f0 = 0, f1 = 0, spread;
	uint32_t first = at > work->radius ? at - work->radius : 0;
	uint32_t last = at + work->radius < line->count ? at + work->radius : line->count - 1;

	for (uint32_t n = first; n <= last; n++) {
		double u = (double)n - (double)at;
		double g = work->kernel[n < at ? at - n : n - at] * line->weights[n * line->stride];
		double f = line->values[n * line->stride];

		m0 += g;
		m1 += g * u;
		m2 += g * u * u;
		f0 += g * f;
		f1 += g * u * f;
	}
	spread = m0 * m2 - m1 * m1;
	*weight = 0;
	if (!(spread > spread_least * work->sigma * work->sigma * m0 * m0))
		return 0;
	*weight = m0 / work->kernel_sum;
	return (m2 * f0 - m1 * f1) / spread;
}

static void smooth_image(const struct smoothing *work)
{
	const uint32_t width = work->width, height = work->height;

	for (uint32_t y = 0; y < height; y++) {
		size_t start = (size_t)y * width;
		const struct line row = { work->values + start, work->seen + start, width, 1 };

		for (uint32_t x = 0; x < width; x++)
			work->row_values[start + x] =
				fit(work, &row, x, &work->row_weights[start + x]);
	}
	for (uint32_t x = 0; x < width; x++) {
		const struct line column = { work->row_values + x, work->row_weights + x, height,
					     width };

		for (uint32_t y = 0; y < height; y++) {
			size_t at = (size_t)y * width + x;

			work->smooth[at] = fit(work, &column, y, &work->weights[at]);
		}
	}
}

static void find_bends(const struct smoothing *work)
{
	const uint32_t width = work->width;
	const double *f = work->smooth, *weights = work->weights;

	for (uint32_t y = 1; y + 1 < work->height; y++)
		for (uint32_t x = 1; x + 1 < width; x++) {
			size_t at = (size_t)y * width + x;
			bool known = weights[at] >= support_least &&
				     weights[at - 1] >= support_least &&
				     weights[at + 1] >= support_least &&
				     weights[at - width] >= support_least &&
				     weights[at + width] >= support_least;

			work->bends[at] = known ? (f[at - 1] - f[at]) + (f[at + 1] - f[at]) +
							  (f[at - width] - f[at]) +
							  (f[at + width] - f[at])
						: 0;
		}
}

/* Where the signs of the Laplacian are looked for, and how strong it must be there. */
struct crossing {
	size_t step;   /* between neighbours: 1, or a row */
	size_t beyond; /* as many steps away from them */
	double least;
	uint8_t scale;
};

/* Marks one of the texels `at` and its next if the Laplacian changes its sign between them: the
 * seen one where it is nearer to zero, and of equals the first. It must have the same signs farther
 * out, and be strong there: beside a flat part it is zero but for rounding, and signs mean nothing.
 */
static void mark_crossing(struct scale_map *map, const struct smoothing *work, size_t at,
			  const struct crossing *crossing)
{
	const size_t next = at + crossing->step, out = crossing->beyond * crossing->step;
	double first = work->bends[at], second = work->bends[next];
	double before = work->bends[at - out], after = work->bends[next + out];
	double least = crossing->least * work->smooth[at];
	bool is_first = fabs(first) <= fabs(second) * (1 + rounding);

	if (!(before > 0 && first > 0 && second <= 0 && after < 0) &&
	    !(before < 0 && first < 0 && second >= 0 && after > 0))
		return;
	if (fabs(before) < least || fabs(after) < least)
		return;
	if (!(work->seen[is_first ? at : next] > 0))
		is_first = !is_first;
	if (work->seen[is_first ? at : next] > 0)
		map->scales[is_first ? at : next] = crossing->scale;
}

static void mark_crossings(struct scale_map *map, const struct smoothing *work, uint8_t scale,
			   double step_share)
{
	const uint32_t width = work->width, height = work->height;
	const double sigma = work->sigma;
	/* Half a sigma beside a step of height h, the Laplacian is
	 * h exp(-1/8) / (2 sqrt(2 pi) sigma^2). */
	const uint32_t beyond = sigma < 3 ? 1 : (uint32_t)(sigma / 2 + 0.5);
	struct crossing crossing = { 1, beyond, 0.17603 * step_share / (sigma * sigma), scale };

	for (uint32_t y = 0; y < height; y++)
		for (uint32_t x = beyond; x + 1 + beyond < width; x++)
			mark_crossing(map, work, (size_t)y * width + x, &crossing);
	crossing.step = width;
	for (uint32_t y = beyond; y + 1 + beyond < height; y++)
		for (uint32_t x = 0; x < width; x++)
			mark_crossing(map, work, (size_t)y * width + x, &crossing);
}

static bool is_sane(const struct range_image *image, const struct scale_space_options *options)
{
	if (image->width_px < 1 || image->width_px > SCALE_SPACE_SIDE_PX_MAX ||
	    image->height_px < 1 || image->height_px > SCALE_SPACE_SIDE_PX_MAX ||
	    options->scale_count < 1 || options->scale_count > SCALE_SPACE_SCALES_MAX ||
	    !(options->step_share > 0))
		return false;
	for (uint32_t i = 0; i < options->scale_count; i++)
		if (!(options->sigma_px[i] > (i ? options->sigma_px[i - 1] : 0)) ||
		    options->sigma_px[i] > SCALE_SPACE_SIGMA_PX_MAX)
			return false;
	return true;
}

static void smoothing_finish(struct smoothing *work)
{
	free(work->seen);
	free(work->values);
	free(work->row_values);
	free(work->row_weights);
	free(work->smooth);
	free(work->weights);
	free(work->bends);
}

/* smoothing_finish frees it, also after a failure. */
static int smoothing_init(struct smoothing *work, const struct range_image *image)
{
	size_t count = (size_t)image->width_px * image->height_px;
	double **const arrays[] = { &work->seen,        &work->values, &work->row_values,
				    &work->row_weights, &work->smooth, &work->weights,
				    &work->bends };

	*work = (struct smoothing){ .width = image->width_px, .height = image->height_px };
	for (size_t i = 0; i < ARRAY_COUNT(arrays); i++) {
		*arrays[i] = calloc(count, sizeof(**arrays[i]));
		if (!*arrays[i])
			return -ENOMEM;
	}
	for (size_t i = 0; i < count; i++) {
		work->seen[i] = image->inverse_m[i] > 0 ? 1 : 0;
		work->values[i] = image->inverse_m[i] > 0 ? (double)image->inverse_m[i] : 0;
	}
	return 0;
}

int scale_map_make(struct scale_map *out, const struct range_image *image,
		   const struct scale_space_options *options)
{
	struct smoothing work;
	int rc;

	*out = (struct scale_map){ 0 };
	if (!is_sane(image, options))
		return -EINVAL;
	*out = (struct scale_map){ image->width_px, image->height_px, options->scale_count,
				   calloc((size_t)image->width_px * image->height_px, 1) };
	rc = smoothing_init(&work, image);
	if (!out->scales)
		rc = -ENOMEM;
	for (uint32_t i = 0; rc == 0 && i < options->scale_count; i++) {
		set_kernel(&work, (double)options->sigma_px[i]);
		smooth_image(&work);
		find_bends(&work);
		mark_crossings(out, &work, (uint8_t)(i + 1), (double)options->step_share);
	}
	smoothing_finish(&work);
	if (rc < 0)
		scale_map_finish(out);
	return rc;
}

void scale_map_finish(struct scale_map *map)
{
	if (!map)
		return;
	free(map->scales);
	*map = (struct scale_map){ 0 };
}

/* ---- the queue */

int feature_queue_make(struct feature_queue *out, const struct scale_map *map)
{
	size_t count = (size_t)map->width_px * map->height_px;
	uint32_t ends[SCALE_SPACE_SCALES_MAX + 2] = { 0 };

	*out = (struct feature_queue){ .scale_count = map->scale_count };
	for (size_t i = 0; i < count; i++)
		out->counts[map->scales[i]]++;
	out->counts[0] = 0; /* at no scale: not in the queue */
	for (uint32_t scale = map->scale_count; scale > 0; scale--) {
		ends[scale] = out->counts[scale + 1]; /* where its points begin */
		out->counts[scale] += out->counts[scale + 1];
	}
	out->counts[0] = out->counts[1];
	out->points = malloc((out->counts[1] ? out->counts[1] : 1) * sizeof(*out->points));
	if (!out->points) {
		*out = (struct feature_queue){ 0 };
		return -ENOMEM;
	}
	for (size_t i = 0; i < count; i++)
		if (map->scales[i])
			out->points[ends[map->scales[i]]++] = (uint32_t)i;
	return 0;
}

void feature_queue_finish(struct feature_queue *queue)
{
	if (!queue)
		return;
	free(queue->points);
	*queue = (struct feature_queue){ 0 };
}

bool feature_queue_pop(struct feature_queue *queue, uint32_t scale, uint32_t *point)
{
	if (scale > queue->scale_count || queue->next >= queue->counts[scale])
		return false;
	*point = queue->points[queue->next++];
	return true;
}
