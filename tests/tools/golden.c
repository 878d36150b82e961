/* Keeps reviewed pictures (tests/golden), and compares fresh ones with them.
 *
 *   golden keep FRESH.png GOLDEN.png
 *     writes GOLDEN.png with 16 levels per channel, so that it is small
 *   golden compare GOLDEN.png FRESH.png SIDE.png
 *     prints the root mean square of the worst square of 24 px; beyond the tolerance it writes
 *     SIDE.png: kept picture, fresh picture, difference
 *
 * The worst square counts, because a mean over the picture would not notice a missing label. */
#include <errno.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/picture.h"

enum { LEVEL = 16, SQUARE = 24, WORST_MAX = 34 };

static int read_picture(struct picture *out, const char *path)
{
	struct buffer file;
	int rc;

	*out = (struct picture){ 0 };
	buffer_init(&file, 64 << 20);
	rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = picture_decode(out, buffer_bytes(&file));
	buffer_finish(&file);
	if (rc < 0)
		fprintf(stderr, "%s: %s\n", path, strerror(-rc));
	for (size_t i = 0; rc == 0 && i < (size_t)out->width * out->height * 4; i++)
		out->rgba[i] = (uint8_t)(out->rgba[i] / LEVEL * 255 / (256 / LEVEL - 1));
	return rc;
}

static int write_picture(const struct picture *picture, const char *path)
{
	png_image image = { .version = PNG_IMAGE_VERSION,
			    .width = picture->width,
			    .height = picture->height,
			    .format = PNG_FORMAT_RGB };
	const size_t count = (size_t)picture->width * picture->height;
	uint8_t *rgb = malloc(3 * count);
	int rc = -ENOMEM;

	if (!rgb)
		return rc;
	for (size_t i = 0; i < count; i++)
		memcpy(rgb + 3 * i, picture->rgba + 4 * i, 3);
	rc = png_image_write_to_file(&image, path, 0, rgb, 0, NULL) ? 0 : -EIO;
	if (rc < 0)
		fprintf(stderr, "%s: %s\n", path, image.message);
	free(rgb);
	return rc;
}

static double square_difference(const struct picture *a, const struct picture *b, uint32_t x0,
				uint32_t y0)
{
	double sum = 0, count = 0;

	for (uint32_t y = y0; y < y0 + SQUARE && y < a->height; y++)
		for (uint32_t x = x0; x < x0 + SQUARE && x < a->width; x++)
			for (int c = 0; c < 3; c++) {
				const size_t at = 4 * ((size_t)y * a->width + x) + (size_t)c;
				const double d = a->rgba[at] - b->rgba[at];

				sum += d * d;
				count++;
			}
	return sqrt(sum / count);
}

static double worst_square(const struct picture *a, const struct picture *b, uint32_t at[2])
{
	double worst = -1;

	for (uint32_t y = 0; y < a->height; y += SQUARE / 2)
		for (uint32_t x = 0; x < a->width; x += SQUARE / 2) {
			const double is = square_difference(a, b, x, y);

			if (is > worst) {
				worst = is;
				at[0] = x;
				at[1] = y;
			}
		}
	return worst;
}

/* Kept, fresh, and where they differ: white. */
static int write_side(const struct picture *a, const struct picture *b, const char *path)
{
	struct picture side = { .width = 3 * a->width, .height = a->height };
	int rc;

	side.rgba = calloc((size_t)side.width * side.height, 4);
	if (!side.rgba)
		return -ENOMEM;
	for (uint32_t y = 0; y < a->height; y++)
		for (uint32_t x = 0; x < a->width; x++) {
			const size_t from = 4 * ((size_t)y * a->width + x);
			uint8_t *to = side.rgba + 4 * ((size_t)y * side.width + x);

			for (int c = 0; c < 3; c++) {
				to[c] = a->rgba[from + (size_t)c];
				to[4 * a->width + (uint32_t)c] = b->rgba[from + (size_t)c];
				to[8 * a->width + (uint32_t)c] = (uint8_t)abs(
					a->rgba[from + (size_t)c] - b->rgba[from + (size_t)c]);
			}
		}
	rc = write_picture(&side, path);
	picture_finish(&side);
	return rc;
}

static int compare(const char *golden, const char *fresh, const char *side)
{
	struct picture a = { 0 }, b = { 0 };
	uint32_t at[2] = { 0 };
	double worst = 0;
	int rc = read_picture(&a, golden);

	if (rc == 0)
		rc = read_picture(&b, fresh);
	if (rc == 0 && (a.width != b.width || a.height != b.height)) {
		fprintf(stderr, "%s: %ux%u, not %ux%u\n", fresh, b.width, b.height, a.width,
			a.height);
		rc = -EINVAL;
	}
	if (rc == 0) {
		worst = worst_square(&a, &b, at);
		printf("%s: %.1f at %u %u\n", golden, worst, at[0], at[1]);
		if (worst > WORST_MAX)
			rc = write_side(&a, &b, side) < 0 ? -EIO : -ERANGE;
	}
	picture_finish(&a);
	picture_finish(&b);
	return rc;
}

int main(int argc, char **argv)
{
	struct picture picture;
	int rc;

	if (argc == 5 && strcmp(argv[1], "compare") == 0)
		return compare(argv[2], argv[3], argv[4]) == 0 ? 0 : 1;
	if (argc != 4 || strcmp(argv[1], "keep") != 0) {
		fputs("usage: golden keep FRESH GOLDEN | golden compare GOLDEN FRESH SIDE\n",
		      stderr);
		return 2;
	}
	rc = read_picture(&picture, argv[2]);
	if (rc == 0)
		rc = write_picture(&picture, argv[3]);
	picture_finish(&picture);
	return rc == 0 ? 0 : 1;
}
