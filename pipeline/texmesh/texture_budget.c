/* Counts feature points by fragments, and has their qualities chosen and written until the files
 * themselves fit. */
#include "pipeline/texmesh/texture_budget.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/samples/tile_quality.h"
#include "pipeline/texmesh/fragment_jpeg.h"
#include "pipeline/texmesh/vertex_scales.h"

enum {
	FRAGMENT_PX = 32,
	QUALITY_BEST = FRAGMENT_JPEG_QUALITY_MOST,
	QUALITY_WORST = 40, /* below it a picture of half the side looks better */
};

enum { HALVINGS_MAX = 6, SIDE_LEAST_PX = 16, ROUNDS = 6, FILE_BYTES_MAX = 1 << 30 };

/* How much a fragment with the most feature points is better than one with none. */
static const double deviation = 20;

/* A texture that is no single colour, its sides halved. */
struct picture {
	uint32_t texture, width, height, columns, rows;
	uint8_t *rgb;
	bool *used;         /* for each fragment */
	uint32_t *numbers;  /* for each fragment: its place among those that are used */
	uint8_t *qualities; /* for each fragment */
	struct fragment_jpeg *jpeg;
};

/* A fragment that shows something. */
struct used_fragment {
	uint32_t picture, fragment;
};

struct work {
	const struct texture_options *options;
	uint32_t picture_count;
	struct picture *pictures;
	uint32_t *picture_of; /* for each texture; picture_count: none */
	uint32_t fragment_count;
	struct used_fragment *fragments;
	uint32_t *counts;   /* as struct tile_features has them */
	uint8_t *qualities; /* of the fragments that are used */
	uint8_t best;       /* what the pictures are compressed with */
};

static void drop_pictures(struct work *work)
{
	for (uint32_t i = 0; i < work->picture_count; i++) {
		struct picture *picture = &work->pictures[i];

		free(picture->rgb);
		free(picture->used);
		free(picture->numbers);
		free(picture->qualities);
		fragment_jpeg_destroy(picture->jpeg);
		*picture = (struct picture){ .texture = picture->texture };
	}
	free(work->fragments);
	free(work->counts);
	free(work->qualities);
	work->fragments = NULL;
	work->counts = NULL;
	work->qualities = NULL;
	work->fragment_count = 0;
}

/* ---- pictures of one size */

/* Means of squares of 2^halvings pixels, as far as there are any. */
static int shrink(struct picture *out, const struct mesh_texture *from, uint32_t halvings)
{
	uint32_t across = 1u << halvings;

	while (across > 1 &&
	       (from->width / across < SIDE_LEAST_PX || from->height / across < SIDE_LEAST_PX))
		across /= 2;
	out->width = from->width / across;
	out->height = from->height / across;
	out->rgb = malloc((size_t)out->width * out->height * 3);
	if (!out->rgb)
		return -ENOMEM;
	for (uint32_t y = 0; y < out->height; y++)
		for (uint32_t x = 0; x < out->width; x++) {
			uint32_t sums[3] = { 0 };

			for (uint32_t i = 0; i < across * across; i++) {
				const size_t row = (size_t)y * across + i / across;
				const uint8_t *p = &from->rgb[3 * (row * from->width + x * across +
								   i % across)];

				for (int k = 0; k < 3; k++)
					sums[k] += p[k];
			}
			for (int k = 0; k < 3; k++)
				out->rgb[3 * ((size_t)y * out->width + x) + k] =
					(uint8_t)((sums[k] + across * across / 2) /
						  (across * across));
		}
	return 0;
}

static uint32_t limit(float at, uint32_t count)
{
	const float floor_at = floorf(at);

	return floor_at <= 0 ? 0 : floor_at >= (float)count ? count - 1 : (uint32_t)floor_at;
}

/* The column or row of fragments that a texture coordinate of 0..1 is in. */
static uint32_t fragment_at(float share, uint32_t side_px, uint32_t count)
{
	return limit(share * (float)side_px / FRAGMENT_PX, count);
}

/* Marks the fragments that triangles lie in, by their boxes; all of them where a coordinate repeats
 * the picture or is no number. */
static void mark_used(struct work *work)
{
	const struct reduced_mesh *copy = work->options->copy;

	for (uint32_t i = 0; i < copy->triangle_count; i++) {
		const uint32_t *t = copy->triangles[i];
		const uint32_t p = work->picture_of[copy->materials[t[0]]];
		float low[2] = { 1, 1 }, high[2] = { 0, 0 };

		if (p == work->picture_count)
			continue;
		struct picture *picture = &work->pictures[p];
		for (int k = 0; k < 3; k++)
			for (int axis = 0; axis < 2; axis++) {
				low[axis] = fminf(low[axis], copy->uvs[t[k]][axis]);
				high[axis] = fmaxf(high[axis], copy->uvs[t[k]][axis]);
			}
		if (!(low[0] >= 0 && low[1] >= 0 && high[0] <= 1 && high[1] <= 1 &&
		      low[0] <= high[0] && low[1] <= high[1])) {
			low[0] = low[1] = 0;
			high[0] = high[1] = 1;
		}
		const uint32_t left = fragment_at(low[0], picture->width, picture->columns);
		const uint32_t right = fragment_at(high[0], picture->width, picture->columns);
		const uint32_t top = fragment_at(1 - high[1], picture->height, picture->rows);
		const uint32_t bottom = fragment_at(1 - low[1], picture->height, picture->rows);
		for (uint32_t row = top; row <= bottom; row++)
			memset(&picture->used[row * picture->columns + left], true,
			       right - left + 1);
	}
}

static int list_fragments(struct work *work)
{
	uint32_t most = 0;

	for (uint32_t p = 0; p < work->picture_count; p++)
		most += work->pictures[p].columns * work->pictures[p].rows;
	work->fragments = malloc(((size_t)most + 1) * sizeof(*work->fragments));
	work->counts = calloc(((size_t)most + 1) * VERTEX_SCALES, sizeof(*work->counts));
	work->qualities = malloc((size_t)most + 1);
	if (!work->fragments || !work->counts || !work->qualities)
		return -ENOMEM;
	for (uint32_t p = 0; p < work->picture_count; p++) {
		struct picture *picture = &work->pictures[p];

		for (uint32_t i = 0; i < picture->columns * picture->rows; i++) {
			picture->numbers[i] = work->fragment_count;
			if (picture->used[i])
				work->fragments[work->fragment_count++] =
					(struct used_fragment){ p, i };
		}
	}
	return 0;
}

/* A vertex counts at its last scale and at all finer ones, in the fragment that it shows. */
static void count_features(struct work *work)
{
	const struct reduced_mesh *copy = work->options->copy;

	for (uint32_t i = 0; work->options->scales && i < copy->vertex_count; i++) {
		const uint32_t p = work->picture_of[copy->materials[i]];
		const float *uv = copy->uvs[i];

		if (p == work->picture_count ||
		    !(uv[0] >= 0 && uv[0] <= 1 && uv[1] >= 0 && uv[1] <= 1))
			continue;
		const struct picture *picture = &work->pictures[p];
		const uint32_t column = fragment_at(uv[0], picture->width, picture->columns);
		const uint32_t row = fragment_at(1 - uv[1], picture->height, picture->rows);
		const uint32_t fragment = row * picture->columns + column;

		/* it is used: the vertex is a corner of some triangle */
		for (uint32_t s = 0; s < work->options->scales[i]; s++)
			work->counts[(size_t)s * work->fragment_count +
				     picture->numbers[fragment]]++;
	}
}

static int make_pictures(struct work *work, uint32_t halvings)
{
	int rc = 0;

	drop_pictures(work);
	for (uint32_t p = 0; p < work->picture_count && rc == 0; p++) {
		struct picture *picture = &work->pictures[p];
		size_t count;

		rc = shrink(picture, &work->options->scan->textures[picture->texture], halvings);
		picture->columns = (picture->width + FRAGMENT_PX - 1) / FRAGMENT_PX;
		picture->rows = (picture->height + FRAGMENT_PX - 1) / FRAGMENT_PX;
		count = (size_t)picture->columns * picture->rows;
		picture->used = calloc(count + 1, sizeof(*picture->used));
		picture->numbers = calloc(count + 1, sizeof(*picture->numbers));
		picture->qualities = malloc(count + 1);
		if (rc == 0 && (!picture->used || !picture->numbers || !picture->qualities))
			rc = -ENOMEM;
	}
	if (rc == 0) {
		mark_used(work);
		rc = list_fragments(work);
	}
	if (rc == 0)
		count_features(work);
	return rc;
}

/* Compresses the pictures anew; no fragment will be better than best. */
static int compress(struct work *work, uint8_t best)
{
	int rc = 0;

	work->best = best;
	for (uint32_t p = 0; p < work->picture_count && rc == 0; p++) {
		struct picture *picture = &work->pictures[p];

		fragment_jpeg_destroy(picture->jpeg);
		rc = fragment_jpeg_create(&picture->jpeg, picture->rgb, picture->width,
					  picture->height, FRAGMENT_PX, picture->used, best);
	}
	return rc;
}

/* ---- qualities */

static uint32_t fragment_bytes(void *user, uint32_t fragment, uint8_t quality)
{
	const struct work *work = user;
	const struct used_fragment *f = &work->fragments[fragment];

	return fragment_jpeg_bytes(work->pictures[f->picture].jpeg, f->fragment, quality);
}

static int write_files(struct work *work, struct buffer *jpegs, uint64_t *bytes)
{
	int rc = 0;

	*bytes = 0;
	for (uint32_t p = 0; p < work->picture_count; p++)
		memset(work->pictures[p].qualities, QUALITY_WORST,
		       (size_t)work->pictures[p].columns * work->pictures[p].rows);
	for (uint32_t i = 0; i < work->fragment_count; i++) {
		const struct used_fragment *f = &work->fragments[i];

		work->pictures[f->picture].qualities[f->fragment] = work->qualities[i];
	}
	for (uint32_t p = 0; p < work->picture_count && rc == 0; p++) {
		const struct picture *picture = &work->pictures[p];
		struct buffer *file = &jpegs[picture->texture];

		if (file->ceiling == 0)
			buffer_init(file, FILE_BYTES_MAX);
		buffer_clear(file);
		rc = fragment_jpeg_write(picture->jpeg, picture->qualities, file);
		*bytes += file->size;
	}
	return rc;
}

static void describe(struct texture_result *out, const struct work *work,
		     const struct tile_budget_result *met)
{
	out->picture_count = work->picture_count;
	out->fragment_count = work->fragment_count;
	out->scale = work->options->scales ? met->scale : 0;
	out->quality = fmin(met->quality, work->best);
	out->least = work->best;
	out->most = 0;
	for (uint32_t i = 0; i < work->fragment_count; i++) {
		uint8_t quality = work->qualities[i];

		quality = quality < work->best ? quality : work->best;
		out->least = quality < out->least ? quality : out->least;
		out->most = quality > out->most ? quality : out->most;
	}
}

/* Has the qualities chosen for estimates of the files' bytes, and corrects what may be spent by how
 * much the files differ from it, until they are within 2 % below the budget. */
static int meet(struct work *work, struct buffer *jpegs, struct texture_result *out)
{
	const uint64_t budget = work->options->budget_bytes;
	struct tile_budget_options options = {
		.features = { work->fragment_count, VERTEX_SCALES, work->counts },
		.deviation = work->options->scales ? deviation : 0,
		/* a file has at most its best, which those below the mean reach with more */
		.best = (uint8_t)fmin(100, work->best + deviation),
		.worst = QUALITY_WORST,
		.budget_bytes = budget,
		.tile_bytes = fragment_bytes,
		.user = work,
	};
	double low = 0, high = 0;

	for (int round = 0; round < ROUNDS; round++) {
		struct tile_budget_result met;
		int rc = tile_budget_meet(&met, work->qualities, &options);
		const bool is_least = rc == -E2BIG;
		const bool is_top = rc == 0 && met.scale == 1 && met.quality >= options.best;

		if (rc < 0 && !is_least)
			return rc;
		rc = write_files(work, jpegs, &out->bytes);
		if (rc < 0)
			return rc;
		describe(out, work, &met);
		out->is_best = is_top;
		const double ratio =
			met.total_bytes > 0 ? (double)out->bytes / (double)met.total_bytes : 1;
		if (out->bytes > budget) {
			if (is_least)
				return -E2BIG;
			high = (double)options.budget_bytes;
		} else if ((double)out->bytes >= 0.98 * (double)budget || is_least || is_top) {
			return 0;
		} else {
			low = (double)options.budget_bytes;
		}
		double next = 0.99 * (double)budget / ratio;
		if (high > 0 && next >= high)
			next = low > 0 ? (low + high) / 2 : 0.97 * high;
		options.budget_bytes = (uint64_t)next;
	}
	return out->bytes <= budget ? 0 : -E2BIG;
}

static int meet_with(struct work *work, uint8_t best, struct buffer *jpegs,
		     struct texture_result *out)
{
	int rc = compress(work, best);

	return rc == 0 ? meet(work, jpegs, out) : rc;
}

/* Finds the lowest best quality with which the budget is spent: with a higher one than is needed,
 * what is left of a fragment is written in finer steps than it has. Where these take too much, the
 * one below is as good as it gets. */
static int meet_at_best(struct work *work, struct buffer *jpegs, struct texture_result *out)
{
	static const uint8_t bests[] = { 45, 55, 65, 75, 85, QUALITY_BEST };
	uint32_t low = 0, high = sizeof(bests) - 1, at = high;
	int rc = 0;

	while (low < high) {
		at = (low + high) / 2;
		rc = meet_with(work, bests[at], jpegs, out);
		if (rc < 0 && rc != -E2BIG)
			return rc;
		if (rc == -E2BIG || !out->is_best)
			high = at;
		else
			low = at + 1;
	}
	if (at != low)
		rc = meet_with(work, bests[low], jpegs, out);
	return rc == -E2BIG && low > 0 ? meet_with(work, bests[low - 1], jpegs, out) : rc;
}

/* Lists the textures that are pictures and that some triangle shows. */
static int list_pictures(struct work *work)
{
	const struct mesh *scan = work->options->scan;
	const struct reduced_mesh *copy = work->options->copy;
	bool *shown = calloc((size_t)scan->texture_count + 1, sizeof(*shown));

	work->pictures = calloc((size_t)scan->texture_count + 1, sizeof(*work->pictures));
	work->picture_of = calloc((size_t)scan->texture_count + 1, sizeof(*work->picture_of));
	if (!shown || !work->pictures || !work->picture_of) {
		free(shown);
		return -ENOMEM;
	}
	for (uint32_t i = 0; i < copy->vertex_count; i++)
		shown[copy->materials[i]] = true;
	for (uint32_t t = 0; t < scan->texture_count; t++) {
		shown[t] = shown[t] && !mesh_texture_is_colour(&scan->textures[t]);
		if (shown[t])
			work->pictures[work->picture_count++].texture = t;
	}
	for (uint32_t t = 0, p = 0; t < scan->texture_count; t++)
		work->picture_of[t] = shown[t] ? p++ : work->picture_count;
	free(shown);
	return 0;
}

int texture_budget_meet(struct buffer *jpegs, struct texture_result *out,
			const struct texture_options *options)
{
	struct work work = { .options = options };
	int rc = list_pictures(&work);

	*out = (struct texture_result){ .is_best = work.picture_count == 0 };
	if (rc == 0 && work.picture_count > 0) {
		rc = -E2BIG;
		for (uint32_t halvings = 0; rc == -E2BIG && halvings <= HALVINGS_MAX; halvings++) {
			out->halvings = halvings;
			rc = make_pictures(&work, halvings);
			if (rc == 0)
				rc = meet_at_best(&work, jpegs, out);
		}
		out->is_best = out->is_best && rc == 0 && out->halvings == 0;
	}
	drop_pictures(&work);
	free(work.pictures);
	free(work.picture_of);
	return rc;
}
