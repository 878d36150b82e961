/* Rules for the quality of tiles, compared at equal bytes and at equal SSIM.
 *
 *   bench_quality CONTENT_DIR
 *
 * Draws what six eyes around a scan without pictures see, cuts the finest level into tiles, encodes
 * each at every quality, and lets each rule share out the bytes that uniform qualities take. Errors
 * are those of decoded tiles against what was encoded, where they show the scan. Prints JSON. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/samples.h"
#include "format/tile.h"
#include "pipeline/content/scans.h"
#include "pipeline/samples/chunks.h"
#include "pipeline/samples/pieces.h"
#include "pipeline/samples/pyramid.h"
#include "pipeline/samples/resolve.h"
#include "pipeline/samples/scale_space.h"
#include "pipeline/samples/tile_loss.h"
#include "pipeline/samples/tile_quality.h"

enum {
	LEVELS = 4,
	SIDE_PX = SAMPLE_IMAGE_PX << (LEVELS - 1),
	FRAME_PX = 2 * SIDE_PX,
	RANGE_PX = SIDE_PX / 2,
	SIDE_TILES = 1 << (LEVELS - 1),
	TILES_MAX = 6 * CUBE_FACES * SIDE_TILES * SIDE_TILES,
	WORST = 20,
	BEST = 97,
	SCALES = 5,
	WINDOW = TILE_WINDOW_PX,
};

static const struct scale_space_options scale_options = { SCALES, { 1, 2, 4, 8, 16 }, 0.004f };

struct trial {
	uint32_t bytes;
	double squares, ssim; /* sums over covered pixels' channels, and over windows */
};

static struct trial trials[TILES_MAX][BEST + 1];
static uint32_t windows[TILES_MAX], pixels[TILES_MAX], tile_count;
static uint32_t counts[SCALES][TILES_MAX];
static bool is_relief[TILES_MAX];

static void check(int rc, const char *doing)
{
	if (rc >= 0)
		return;
	fprintf(stderr, "bench_quality: %s: %s\n", doing, strerror(-rc));
	exit(1);
}

/* ---- tiles */

static struct trial measure(const uint8_t *rgb, const bool *covered, int quality)
{
	static uint8_t decoded[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3];
	struct buffer object;
	struct trial trial = { 0 };

	buffer_init(&object, 1 << 20);
	check(tile_encode(&object, rgb, SAMPLE_IMAGE_PX, quality, TILE_QUICK), "encode");
	check(tile_decode(decoded, SAMPLE_IMAGE_PX, buffer_bytes(&object)), "decode");
	trial.bytes = (uint32_t)object.size;
	buffer_finish(&object);
	for (uint32_t i = 0; i < SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX; i++)
		for (int c = 0; covered[i] && c < 3; c++) {
			double d = (double)rgb[3 * i + c] - decoded[3 * i + c];

			trial.squares += d * d;
		}
	for (uint32_t y = 0; y < SAMPLE_IMAGE_PX; y += WINDOW)
		for (uint32_t x = 0; x < SAMPLE_IMAGE_PX; x += WINDOW)
			if (covered[(y + WINDOW / 2) * SAMPLE_IMAGE_PX + x + WINDOW / 2])
				trial.ssim += tile_window_ssim(rgb, decoded, x, y);
	return trial;
}

static void take_tile(const struct pyramid *pyramid, uint32_t x, uint32_t y)
{
	static uint8_t rgb[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3];
	static bool covered[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX];
	uint32_t n = tile_count;

	pixels[n] = windows[n] = 0;
	for (uint32_t i = 0; i < SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX; i++) {
		uint32_t row = i / SAMPLE_IMAGE_PX, column = i % SAMPLE_IMAGE_PX;

		covered[i] = pyramid->levels[0][(size_t)(y + row) * SIDE_PX + x + column][3] > 0;
		pixels[n] += covered[i];
		windows[n] +=
			covered[i] && row % WINDOW == WINDOW / 2 && column % WINDOW == WINDOW / 2;
	}
	if (!windows[n])
		return;
	pyramid_sharpen(pyramid, 0, x, y, SAMPLE_IMAGE_PX, rgb);
	for (int quality = WORST; quality <= BEST; quality++)
		trials[n][quality] = measure(rgb, covered, quality);
	tile_count++;
}

/* ---- faces */

struct stand {
	struct model *model;
	struct sight *sight;
	struct pieces *pieces;
	struct raster *raster;
	struct resolve *resolve;
	struct pyramid pyramid;
	float near[RANGE_PX * RANGE_PX];
};

/* The mean of the samples that a texel of the range image has. */
static void take_range(struct stand *stand)
{
	enum { FINER = FRAME_PX / RANGE_PX };
	for (uint32_t i = 0; i < RANGE_PX * RANGE_PX; i++) {
		uint32_t x0 = i % RANGE_PX * FINER, y0 = i / RANGE_PX * FINER, seen = 0;
		struct raster_block block;
		float sum = 0;

		stand->near[i] = 0;
		if (!raster_get_block(stand->raster, x0 / RASTER_BLOCK_PX, y0 / RASTER_BLOCK_PX,
				      &block))
			continue;
		for (uint32_t k = 0; k < FINER * FINER; k++) {
			uint32_t x = (x0 + k % FINER) % RASTER_BLOCK_PX;
			float near = block.inverse_m[(y0 + k / FINER) % RASTER_BLOCK_PX *
							     RASTER_BLOCK_PX +
						     x];

			sum += near;
			seen += near > 0;
		}
		stand->near[i] = seen ? sum / (float)seen : 0;
	}
}

static bool draw(struct stand *stand, const float eye_m[3], int face)
{
	struct camera camera = { .width_px = FRAME_PX, .height_px = FRAME_PX };
	const uint32_t *pieces;
	uint64_t covered, backs;
	uint32_t count;
	float matrix[16];

	camera.fov_deg = (float)(2 * atan((double)SAMPLE_IMAGE_PX / SAMPLE_TILE_PX) * 180 / M_PI);
	for (int i = 0; i < 3; i++) {
		camera.eye_m[i] = eye_m[i];
		camera.target_m[i] = eye_m[i] + cube_axes[face].forward[i];
		camera.up[i] = cube_axes[face].up[i];
	}
	if (!sight_range(stand->sight, eye_m, cube_axes[face].forward, &camera.near_m,
			 &camera.far_m))
		return false;
	raster_begin(stand->raster, &camera);
	camera_matrix(&camera, matrix);
	pieces = sight_visible(stand->sight, matrix, eye_m, &count);
	for (uint32_t n = 0; n < count; n++) {
		struct model_mesh mesh;

		check(pieces_get(stand->pieces, pieces[n], &mesh), "a piece");
		raster_draw(stand->raster, &mesh);
	}
	if (!raster_range(stand->raster, &camera.near_m, &camera.far_m))
		return false;
	resolve_take(stand->resolve, &camera, stand->pyramid.levels[0]);
	pyramid_count(&stand->pyramid, &covered, &backs);
	pyramid_reduce(&stand->pyramid);
	pyramid_fill(&stand->pyramid);
	take_range(stand);
	return true;
}

static void take_face(struct stand *stand)
{
	const struct range_image image = { RANGE_PX, RANGE_PX, stand->near };
	static uint32_t found[SCALES][SIDE_TILES * SIDE_TILES];
	struct feature_queue queue;
	struct scale_map map;
	uint32_t point;

	check(scale_map_make(&map, &image, &scale_options), "a scale map");
	check(feature_queue_make(&queue, &map), "a queue");
	memset(found, 0, sizeof(found));
	for (uint32_t scale = SCALES; scale > 0; scale--) {
		if (scale < SCALES)
			memcpy(found[scale - 1], found[scale], sizeof(found[0]));
		while (feature_queue_pop(&queue, scale, &point)) {
			uint32_t x = point % RANGE_PX * SIDE_TILES / RANGE_PX;

			found[scale - 1]
			     [point / RANGE_PX * SIDE_TILES / RANGE_PX * SIDE_TILES + x]++;
		}
	}
	for (uint32_t i = 0; i < SIDE_TILES * SIDE_TILES; i++) {
		uint32_t apron = SAMPLE_APRON_PX << (LEVELS - 1);

		for (uint32_t scale = 0; scale < SCALES; scale++)
			counts[scale][tile_count] = found[scale][i];
		take_tile(&stand->pyramid,
			  apron + i % SIDE_TILES * SAMPLE_TILE_PX - SAMPLE_APRON_PX,
			  apron + i / SIDE_TILES * SAMPLE_TILE_PX - SAMPLE_APRON_PX);
	}
	feature_queue_finish(&queue);
	scale_map_finish(&map);
}

static void take_scan(const char *folder)
{
	struct diagnostics diagnostics = { 0 };
	static struct content content;
	static struct stand stand;
	const struct mesh *mesh;
	struct scans *scans;
	struct drawing_options drawn = { 0 };
	float longest = 0;

	check(content_read(&content, folder, &diagnostics), folder);
	check(scans_create(&scans, &content), folder);
	check(scans_get_mesh(scans, &mesh, &diagnostics), folder);
	drawn.lit = content_is_lit(&content, false);
	drawn.procedural = content.colours == CONTENT_COLOURS_PROCEDURAL;
	drawn.substance = content.substance;
	memcpy(drawn.sun, content.sun, sizeof(drawn.sun));
	check(chunks_create(&stand.model, mesh, content.import.default_colour), "the model");
	check(sight_create(&stand.sight, stand.model), "sight");
	check(pieces_create(&stand.pieces, stand.model), "pieces");
	check(raster_create(&stand.raster, FRAME_PX, !drawn.procedural), "a raster");
	check(resolve_create(&stand.resolve, stand.raster, &drawn, 2), "colours");
	check(pyramid_init(&stand.pyramid, SIDE_PX), "a pyramid");
	for (int k = 0; k < 3; k++)
		longest = fmaxf(longest, stand.model->high_m[k] - stand.model->low_m[k]);
	for (int n = 0; n < 6; n++) {
		float eye[3];

		for (int k = 0; k < 3; k++)
			eye[k] = (stand.model->low_m[k] + stand.model->high_m[k]) / 2;
		eye[0] += longest * 0.75f * cosf((float)n * 1.05f + 0.3f);
		eye[1] += longest * 0.75f * sinf((float)n * 1.05f + 0.3f);
		sight_look(stand.sight, eye, 2.0f / SIDE_PX);
		for (int face = 0; face < CUBE_FACES; face++)
			if (draw(&stand, eye, face))
				take_face(&stand);
	}
	resolve_destroy(stand.resolve);
	raster_destroy(stand.raster);
	pieces_destroy(stand.pieces);
	sight_destroy(stand.sight);
	pyramid_finish(&stand.pyramid);
	model_destroy(stand.model);
	scans_destroy(scans);
	content_release(&content);
}

/* ---- rules */

struct result {
	uint64_t bytes;
	double psnr, ssim, relief_psnr, relief_ssim;
	uint32_t scale;
	double quality;
};

static double psnr(double squares, uint64_t count)
{
	return 10 * log10(255.0 * 255.0 * 3 * (double)count / squares);
}

static struct result judge(const uint8_t *qualities)
{
	struct result result = { 0 };
	double squares[2] = { 0 }, ssim[2] = { 0 };
	uint64_t pixel_count[2] = { 0 }, window_count[2] = { 0 };

	for (uint32_t i = 0; i < tile_count; i++) {
		const struct trial *trial = &trials[i][qualities[i]];

		result.bytes += trial->bytes;
		for (int k = 0; k <= is_relief[i]; k++) {
			squares[k] += trial->squares;
			ssim[k] += trial->ssim;
			pixel_count[k] += pixels[i];
			window_count[k] += windows[i];
		}
	}
	result.psnr = psnr(squares[0], pixel_count[0]);
	result.ssim = ssim[0] / (double)window_count[0];
	result.relief_psnr = psnr(squares[1], pixel_count[1]);
	result.relief_ssim = ssim[1] / (double)window_count[1];
	return result;
}

struct rule {
	const char *name;
	double deviation;  /* of the paper's rule */
	char optimised_by; /* 0: the paper's rule; p, s: the best possible for PSNR, for SSIM */
};

static uint8_t limited(uint8_t quality)
{
	return quality < WORST ? WORST : quality > BEST ? BEST : quality;
}

static uint32_t tile_bytes(void *user, uint32_t tile, uint8_t quality)
{
	(void)user;
	return trials[tile][limited(quality)].bytes;
}

/* The quality of every tile at which what a byte gains is lambda. */
static uint64_t optimise(uint8_t *qualities, char by, double lambda)
{
	uint64_t bytes = 0;

	for (uint32_t i = 0; i < tile_count; i++) {
		double best = INFINITY;

		for (uint8_t q = WORST; q <= BEST; q++) {
			const struct trial *trial = &trials[i][q];
			double loss =
				(by == 'p' ? trial->squares : -trial->ssim) + lambda * trial->bytes;

			if (loss < best) {
				best = loss;
				qualities[i] = q;
			}
		}
		bytes += trials[i][qualities[i]].bytes;
	}
	return bytes;
}

static struct result share_out(const struct rule *rule, uint64_t budget_bytes)
{
	static uint8_t qualities[TILES_MAX];
	static uint32_t packed[SCALES * TILES_MAX];
	struct tile_budget_options options = { .deviation = rule->deviation,
					       .best = BEST,
					       .worst = WORST,
					       .budget_bytes = budget_bytes,
					       .tile_bytes = tile_bytes };
	struct tile_budget_result met = { 0 };
	struct result result;

	if (rule->optimised_by) {
		double low = 1e-12, high = 1e6;

		for (int n = 0; n < 100; n++) {
			double middle = sqrt(low * high);

			if (optimise(qualities, rule->optimised_by, middle) > budget_bytes)
				low = middle;
			else
				high = middle;
		}
		optimise(qualities, rule->optimised_by, high);
		return judge(qualities);
	}
	for (uint32_t scale = 0; scale < SCALES; scale++)
		memcpy(packed + scale * tile_count, counts[scale], tile_count * sizeof(*packed));
	options.features = (struct tile_features){ tile_count, SCALES, packed };
	check(tile_budget_meet(&met, qualities, &options), "the budget");
	for (uint32_t i = 0; i < tile_count; i++)
		qualities[i] = limited(qualities[i]);
	result = judge(qualities);
	result.scale = met.scale;
	result.quality = met.quality;
	return result;
}

/* Returns the least bytes with which a rule has that SSIM. */
static uint64_t bytes_for(const struct rule *rule, double ssim, bool relief, uint64_t around)
{
	uint64_t low = around / 2, high = around * 2;

	while (high - low > around / 500) {
		uint64_t middle = (low + high) / 2;
		struct result result = share_out(rule, middle);

		if ((relief ? result.relief_ssim : result.ssim) < ssim)
			low = middle;
		else
			high = middle;
	}
	return high;
}

static int descending(const void *a, const void *b)
{
	const uint32_t *x = a, *y = b;

	return (*x < *y) - (*x > *y);
}

/* The quarter of the tiles with the most feature points at the second scale is the relief. */
static void find_relief(void)
{
	static uint32_t sorted[TILES_MAX];

	memcpy(sorted, counts[1], tile_count * sizeof(*sorted));
	qsort(sorted, tile_count, sizeof(*sorted), descending);
	for (uint32_t i = 0; i < tile_count; i++)
		is_relief[i] = counts[1][i] > 0 && counts[1][i] >= sorted[tile_count / 4];
}

int main(int argc, char **argv)
{
	static const struct rule rules[] = {
		{ "uniform", 0, 0 },         { "scale-space 20", 20, 0 },
		{ "scale-space 40", 40, 0 }, { "scale-space -20", -20, 0 },
		{ "best for PSNR", 0, 'p' }, { "best for SSIM", 0, 's' }
	};
	static const uint8_t levels[] = { 60, 80, 90 };
	static uint8_t same[TILES_MAX];
	const char *comma = "";

	if (argc != 2) {
		fprintf(stderr, "usage: bench_quality CONTENT_DIR\n");
		return 2;
	}
	take_scan(argv[1]);
	find_relief();
	printf("{\"tiles\": %u, \"features\": [", tile_count);
	for (int scale = 0; scale < SCALES; scale++) {
		uint64_t sum = 0;

		for (uint32_t i = 0; i < tile_count; i++)
			sum += counts[scale][i];
		printf("%s%llu", scale ? ", " : "", (unsigned long long)sum);
	}
	printf("], \"rows\": [");
	for (size_t l = 0; l < ARRAY_COUNT(levels); l++) {
		struct result uniform;

		memset(same, levels[l], tile_count);
		uniform = judge(same);
		for (size_t r = 0; r < ARRAY_COUNT(rules); r++) {
			struct result got = share_out(&rules[r], uniform.bytes);
			uint64_t all = bytes_for(&rules[r], uniform.ssim, false, uniform.bytes);
			uint64_t relief =
				bytes_for(&rules[r], uniform.relief_ssim, true, uniform.bytes);

			printf("%s\n{\"rule\": \"%s\", \"uniform\": %u, \"scale\": %u, \"quality\": "
			       "%.1f, \"bytes\": %llu, \"psnr\": %.2f, \"ssim\": %.4f, "
			       "\"relief_psnr\": %.2f, \"relief_ssim\": %.4f, "
			       "\"bytes_at_ssim\": %.3f, \"bytes_at_relief_ssim\": %.3f}",
			       comma, rules[r].name, levels[l], got.scale, got.quality,
			       (unsigned long long)got.bytes, got.psnr, got.ssim, got.relief_psnr,
			       got.relief_ssim, (double)all / (double)uniform.bytes,
			       (double)relief / (double)uniform.bytes);
			comma = ",";
		}
	}
	printf("\n]}\n");
	return 0;
}
