/* Compares pictures with the truth.
 *
 *   compare_pictures TRUTH_DIR OTHER_DIR [#RRGGBB]
 *
 * For every view-NNNN.png of TRUTH_DIR: PSNR and SSIM against the file of the same name in
 * OTHER_DIR, over the union of both silhouettes (alpha = coverage), both on one fixed background,
 * so that an outline that is too wide counts as an error. Prints a JSON line per view, then one
 * with the means and the mean of the worst 5 % (at least one view). SSIM after Wang et al. 2004 on
 * luma, 8 x 8 windows.
 *
 * With a colour, both are on that background, a release's, and OTHER_DIR's silhouettes are what
 * differs from it: for pictures whose alpha is a guess (render/lumigraph/backdrop.h). */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/picture.h"
#include "tests/silhouette.h"

enum { VIEWS_MAX = 1000, WINDOW = 8 };

static uint8_t background[3] = { 96, 96, 96 };

static int read_picture(struct picture *out, const char *folder, int view)
{
	struct buffer file;
	char path[1024];
	int rc;

	snprintf(path, sizeof(path), "%s/view-%04d.png", folder, view);
	buffer_init(&file, 256 << 20);
	rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = picture_decode(out, buffer_bytes(&file));
	buffer_finish(&file);
	return rc;
}

static float over_background(const struct picture *picture, size_t at, int channel)
{
	const uint8_t *pixel = picture->rgba + 4 * at;
	const float alpha = pixel[3] / 255.0f;

	return pixel[channel] * alpha + background[channel] * (1 - alpha);
}

/* Makes of a picture with coverage what a panel shows, with the silhouette in its alpha. */
static void show(struct picture *picture)
{
	const size_t count = (size_t)picture->width * picture->height;

	for (size_t i = 0; i < count; i++)
		for (int c = 0; c < 3; c++)
			picture->rgba[4 * i + (size_t)c] =
				(uint8_t)(over_background(picture, i, c) + 0.5f);
	silhouette_mark(picture->rgba, count, background);
}

static bool is_covered(const struct picture *a, const struct picture *b, size_t at)
{
	return a->rgba[4 * at + 3] > 0 || b->rgba[4 * at + 3] > 0;
}

static double psnr_of(const struct picture *a, const struct picture *b)
{
	double sum = 0;
	size_t count = 0;

	for (size_t i = 0; i < (size_t)a->width * a->height; i++) {
		if (!is_covered(a, b, i))
			continue;
		for (int c = 0; c < 3; c++) {
			double d = over_background(a, i, c) - over_background(b, i, c);

			sum += d * d;
		}
		count += 3;
	}
	if (count == 0 || sum == 0)
		return 99;
	return fmin(99, 10 * log10(255.0 * 255.0 * (double)count / sum));
}

static float luma(const struct picture *picture, size_t at)
{
	return 0.299f * over_background(picture, at, 0) + 0.587f * over_background(picture, at, 1) +
	       0.114f * over_background(picture, at, 2);
}

static double window_ssim(const struct picture *a, const struct picture *b, uint32_t x0,
			  uint32_t y0)
{
	const double c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;
	const double n = WINDOW * WINDOW;
	double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
	double va, vb, cov, ma, mb;

	for (uint32_t y = y0; y < y0 + WINDOW; y++)
		for (uint32_t x = x0; x < x0 + WINDOW; x++) {
			const size_t at = (size_t)y * a->width + x;
			const double p = luma(a, at), q = luma(b, at);

			sa += p;
			sb += q;
			saa += p * p;
			sbb += q * q;
			sab += p * q;
		}
	ma = sa / n;
	mb = sb / n;
	va = saa / n - ma * ma;
	vb = sbb / n - mb * mb;
	cov = sab / n - ma * mb;
	return (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
}

/* Over the windows whose middle either silhouette covers, every four pixels. */
static double ssim_of(const struct picture *a, const struct picture *b)
{
	double sum = 0;
	size_t count = 0;

	for (uint32_t y = 0; y + WINDOW <= a->height; y += 4)
		for (uint32_t x = 0; x + WINDOW <= a->width; x += 4) {
			const size_t middle = (size_t)(y + WINDOW / 2) * a->width + x + WINDOW / 2;

			if (!is_covered(a, b, middle))
				continue;
			sum += window_ssim(a, b, x, y);
			count++;
		}
	return count ? sum / (double)count : 1;
}

static int by_value(const void *a, const void *b)
{
	const double left = *(const double *)a, right = *(const double *)b;

	return left < right ? -1 : left > right;
}

static int compare_view(const char *truth_dir, const char *other_dir, int view, bool as_shown,
			double *psnr, double *ssim)
{
	struct picture truth = { 0 }, other = { 0 };
	int rc = read_picture(&truth, truth_dir, view);

	if (rc < 0)
		return rc;
	rc = read_picture(&other, other_dir, view);
	if (rc < 0 || truth.width != other.width || truth.height != other.height) {
		fprintf(stderr, "view %d: %s has no picture of the same size\n", view, other_dir);
		rc = -EINVAL;
	} else {
		if (as_shown)
			show(&other);
		*psnr = psnr_of(&truth, &other);
		*ssim = ssim_of(&truth, &other);
	}
	picture_finish(&truth);
	picture_finish(&other);
	return rc;
}

int main(int argc, char **argv)
{
	static double psnr[VIEWS_MAX];
	double psnr_sum = 0, ssim_sum = 0, worst = 0;
	int views = 0, worst_count, rc = 0;
	unsigned rgb = 0;

	if ((argc != 3 && argc != 4) || (argc == 4 && sscanf(argv[3], "#%6x", &rgb) != 1)) {
		fprintf(stderr, "usage: compare_pictures TRUTH_DIR OTHER_DIR [#RRGGBB]\n");
		return 2;
	}
	for (int c = 0; c < 3 && argc == 4; c++)
		background[c] = (uint8_t)(rgb >> (16 - 8 * c));
	while (views < VIEWS_MAX) {
		double ssim;

		rc = compare_view(argv[1], argv[2], views, argc == 4, &psnr[views], &ssim);
		if (rc < 0)
			break;
		printf("{\"view\": %d, \"psnr_db\": %.3f, \"ssim\": %.5f}\n", views, psnr[views],
		       ssim);
		psnr_sum += psnr[views++];
		ssim_sum += ssim;
	}
	if (rc != -ENOENT || views == 0) {
		fprintf(stderr, "stopped at view %d: %s\n", views, strerror(-rc));
		return 1;
	}
	qsort(psnr, (size_t)views, sizeof(psnr[0]), by_value);
	worst_count = views / 20 ? views / 20 : 1;
	for (int i = 0; i < worst_count; i++)
		worst += psnr[i];
	printf("{\"views\": %d, \"psnr_db\": %.3f, \"psnr_worst5_db\": %.3f, \"ssim\": %.5f}\n",
	       views, psnr_sum / views, worst / worst_count, ssim_sum / views);
	return 0;
}
