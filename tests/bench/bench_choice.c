/* What a choice of tiles could save that knew which tiles are shown.
 *
 *   bench_choice CONTENT [SHOWN...]
 *
 * CONTENT has samples for a budget. SHOWN: files of shown.h, one for each view (bench_view
 * --shown). The choice knows every second view, and the others judge it: by what their tiles lose,
 * each weighted by its pixels. Prints JSON: the bytes of all tiles at each quality; for each level,
 * the finest first, its shares of bytes and of pixels, and the share of its tiles that any view
 * shows; and the bytes saved at the loss of uniform quality 40, 60 and 80, where all tiles count
 * the same and where they count by what is shown. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "pipeline/samples/tile_choice.h"
#include "pipeline/samples/tile_loss.h"
#include "render/plan/repository.h"

enum { STEPS = 12 };

struct tile {
	uint32_t level;
	double windows;
	double pixels[2]; /* of the views that are known, and of those that judge */
	uint32_t sizes[SAMPLE_CHOICES_MAX], losses[SAMPLE_CHOICES_MAX];
};

static struct samples_store *store;
static const struct sample_grid *grid;
static struct tile *tiles;
static uint32_t tile_count, tile_room;
static struct map tile_of; /* packed name -> index of tiles */

static void check(int rc, const char *doing)
{
	if (rc >= 0)
		return;
	fprintf(stderr, "bench_choice: %s: %s\n", doing, strerror(-rc));
	exit(1);
}

static void take_face(const struct sample_face *face)
{
	const uint32_t point = sample_grid_number(grid, face->point);

	check(ARRAY_RESERVE(tiles, tile_room, tile_count + face->tile_count, UINT32_MAX), "tiles");
	for (uint32_t i = 0; i < face->tile_count; i++) {
		struct tile *tile = &tiles[tile_count];
		const uint32_t level = face_tile_level(face->tiles[i]);
		uint32_t row, column;
		struct tile_name name;

		face_tile_place(level, face->tiles[i], &row, &column);
		name = (struct tile_name){ .face = point * CUBE_FACES + (uint32_t)face->face,
					   .level = (uint8_t)level,
					   .row = (uint8_t)row,
					   .column = (uint8_t)column };
		*tile = (struct tile){ .level = level, .windows = fmax(face->windows[i], 1) };
		memcpy(tile->sizes, &face->choice_sizes[i * SAMPLE_CHOICES_MAX],
		       sizeof(tile->sizes));
		memcpy(tile->losses, &face->losses[i * SAMPLE_CHOICES_MAX], sizeof(tile->losses));
		check(map_set(&tile_of, tile_name_pack(name), tile_count++), "tiles");
	}
}

static void take_view(const char *path, int half)
{
	FILE *file = fopen(path, "re");
	uint32_t face, level, row, column;
	double pixels;

	if (!file)
		check(-errno, path);
	while (fscanf(file, "%u %u %u %u %lf", &face, &level, &row, &column, &pixels) == 5) {
		const struct tile_name name = { face, (uint8_t)level, (uint8_t)row,
						(uint8_t)column };
		const uint64_t at = map_get(&tile_of, tile_name_pack(name));

		check(at == MAP_NONE ? -ENOENT : 0, path); /* of another release */
		tiles[at].pixels[half] += pixels;
	}
	fclose(file);
}

/* Chooses for so many bytes. Returns what is lost in the views that judge. */
static double loss_of(enum tile_choice_rule rule, const float *weights, uint64_t bytes)
{
	struct tile_choice choice;
	double loss = 0;

	check(tile_choice_make(&choice, store, rule, weights, bytes), "a choice");
	for (uint32_t i = 0; i < tile_count; i++)
		loss += tiles[i].pixels[1] * tiles[i].losses[choice.choices[i]] / tiles[i].windows;
	tile_choice_finish(&choice);
	return loss;
}

static uint64_t bytes_at(uint32_t choice)
{
	uint64_t bytes = 0;

	for (uint32_t i = 0; i < tile_count; i++)
		bytes += tiles[i].sizes[choice];
	return bytes;
}

static void print_saved(const char *name, const float *weights)
{
	struct tile_choice least;

	check(tile_choice_make(&least, store, TILE_CHOICE_GAIN, NULL, 0), "the least");
	printf(", \"%s\": [", name);
	for (uint32_t c = 1; c + 1 < grid->choice_count; c++) {
		const uint64_t bytes = bytes_at(c);
		const double loss = loss_of(TILE_CHOICE_QUALITY, NULL, bytes);
		uint64_t low = least.least_bytes, high = 2 * bytes;

		for (int n = 0; n < STEPS; n++) {
			const uint64_t middle = (low + high) / 2;

			if (loss_of(TILE_CHOICE_GAIN, weights, middle) > loss)
				low = middle;
			else
				high = middle;
		}
		printf("%s%.3f", c > 1 ? ", " : "", 1 - (double)high / (double)bytes);
	}
	printf("]");
	tile_choice_finish(&least);
}

static void print_levels(void)
{
	const double all_bytes = (double)bytes_at(2);
	double all_pixels = 0;

	for (uint32_t i = 0; i < tile_count; i++)
		all_pixels += tiles[i].pixels[0] + tiles[i].pixels[1];
	printf(", \"levels\": [");
	for (uint32_t level = grid->level_count; level-- > 0;) {
		double bytes = 0, pixels = 0, count = 0, any = 0;

		for (uint32_t i = 0; i < tile_count; i++) {
			const double here = tiles[i].pixels[0] + tiles[i].pixels[1];

			if (tiles[i].level != level)
				continue;
			bytes += tiles[i].sizes[2];
			pixels += here;
			count++;
			any += here > 0;
		}
		printf("{\"bytes\": %.3f, \"pixels\": %.3f, \"shown\": %.3f}%s", bytes / all_bytes,
		       pixels / all_pixels, any / fmax(count, 1), level > 0 ? ", " : "");
	}
	printf("]");
}

int main(int argc, char **argv)
{
	struct sample_face face;
	double pixels = 0, windows = 0;
	float *weights;
	int rc;

	check(argc >= 2 ? 0 : -EINVAL, "usage: bench_choice CONTENT [SHOWN...]");
	check(samples_store_open(&store, argv[1]), argv[1]);
	grid = samples_store_grid(store);
	check(grid->choice_count > 1 ? 0 : -EINVAL, "samples for a budget");
	while ((rc = samples_store_next(store, &face)) == 1)
		take_face(&face);
	check(rc, argv[1]);
	printf("{\"tile_bytes\": [");
	for (uint32_t c = 0; c < grid->choice_count; c++)
		printf("%s%llu", c ? ", " : "", (unsigned long long)bytes_at(c));
	printf("]");
	for (int i = 2; i < argc; i++)
		take_view(argv[i], i % 2);
	weights = malloc((tile_count + 1) * sizeof(*weights));
	check(weights ? 0 : -ENOMEM, "weights");
	for (uint32_t i = 0; i < tile_count; i++) {
		pixels += tiles[i].pixels[0];
		windows += tiles[i].windows;
	}
	/* What no view shows gets bytes too, once nothing else gains by them. */
	for (uint32_t i = 0; i < tile_count; i++)
		weights[i] =
			(float)(tiles[i].pixels[0] / tiles[i].windows + 0.01 * pixels / windows);
	if (pixels > 0) {
		print_levels();
		print_saved("alike", NULL);
		print_saved("known", weights);
	}
	printf("}\n");
	free(weights);
	free(tiles);
	map_finish(&tile_of);
	samples_store_close(store);
	return 0;
}
