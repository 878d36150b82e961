/* Estimates the bytes of fragments: codes the whole picture at one quality as fragment_jpeg.c
 * would, first to count the symbols, whence the lengths of their Huffman codes, then to add up the
 * bits of each fragment.
 *
 * A coefficient that is zero at one quality is zero at every lower one. So qualities are computed
 * from the best down, and a mask for each block says which coefficients are left. */
#include "pipeline/texmesh/coefficient_bytes.h"

#include <errno.h>
#include <string.h>

static const uint8_t knots[COEFFICIENT_KNOTS] = { 1,  3,  5,  7,  10, 14, 20, 28, 38, 50, 60,
						  68, 75, 80, 84, 87, 90, 91, 92, 93, 94, 95 };

/* Where the coefficients of a scan, from low to high frequencies, are in a block. */
static const uint8_t zigzag[COEFFICIENTS_OF_BLOCK] = {
	0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18, 11, 4,  5,  12, 19, 26, 33, 40, 48,
	41, 34, 27, 20, 13, 6,  7,  14, 21, 28, 35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23,
	30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63,
};

enum {
	SYMBOLS = 256,
	LENGTH_MOST = 16,       /* bits of a code */
	ZEROES = 0xf0,          /* symbol: 16 coefficients are zero */
	EMPTY_RUN_MOST = 32767, /* blocks whose rest is empty, in one code */
};

/* One scan: counts its symbols, or with the lengths of their codes adds up bits. */
struct scan {
	uint64_t counts[SYMBOLS];
	uint8_t lengths[SYMBOLS];
	uint64_t *bits; /* borrowed; for each fragment; NULL while counting */
};

/* Numbers that are the same for every scan of a quality. */
struct estimate {
	const struct coefficients *coefficients;
	uint64_t *masks[COEFFICIENT_PLANES]; /* for each block: bit k: zigzag[k] is not zero */
	uint64_t *bits;                      /* for each fragment */
	/* By table, place in the scan and size before rounding: how many bits the size has after.
	 */
	uint8_t sizes[2][COEFFICIENTS_OF_BLOCK][COEFFICIENT_MOST + 1];
	uint32_t quality;
};

static uint32_t bits_of(uint32_t number)
{
	return number == 0 ? 0 : 32 - (uint32_t)__builtin_clz(number);
}

static inline void put(struct scan *scan, uint32_t fragment, uint32_t symbol, uint32_t extra_bits)
{
	if (scan->bits)
		scan->bits[fragment] += scan->lengths[symbol] + extra_bits;
	else
		scan->counts[symbol]++;
}

/* ---- lengths of Huffman codes: the two rarest groups become one, their members a bit longer */

static int rarest(const uint64_t *counts, int count, int except)
{
	int best = -1;

	for (int i = 0; i < count; i++)
		if (counts[i] > 0 && i != except && (best < 0 || counts[i] < counts[best]))
			best = i;
	return best;
}

static void find_lengths(struct scan *scan)
{
	enum { ALL = SYMBOLS + 1 }; /* JPEG keeps one code free: that of ones only */
	uint64_t counts[ALL];
	uint16_t group[ALL];
	uint32_t lengths[ALL] = { 0 };

	memcpy(counts, scan->counts, sizeof(scan->counts));
	counts[SYMBOLS] = 1;
	for (int i = 0; i < ALL; i++)
		group[i] = (uint16_t)i;
	for (;;) {
		int a = rarest(counts, ALL, -1), b = rarest(counts, ALL, a);

		if (b < 0)
			break;
		counts[a] += counts[b];
		counts[b] = 0;
		for (int i = 0; i < ALL; i++) {
			if (group[i] == b)
				group[i] = (uint16_t)a;
			if (group[i] == a)
				lengths[i]++;
		}
	}
	for (int i = 0; i < SYMBOLS; i++)
		scan->lengths[i] = (uint8_t)(lengths[i] < LENGTH_MOST ? lengths[i] : LENGTH_MOST);
}

/* ---- the scans */

static void code_means(struct estimate *estimate, struct scan *scan, int plane_index)
{
	const struct coefficients *coefficients = estimate->coefficients;
	const struct coefficient_plane *plane = &coefficients->planes[plane_index];
	int factor = coefficients->factors[estimate->quality][plane->table][0];
	int before = 0;

	for (uint32_t row = 0; row < coefficients->unit_rows; row++) {
		struct unit_order at = { .unit_row = row };

		while (unit_order_next(&at, coefficients, plane)) {
			uint32_t fragment =
				coefficients_fragment(coefficients, at.unit_column, row);
			int mean = before;
			uint32_t size;

			if (coefficients->used[fragment])
				mean = coefficient_round(
					coefficients_of(plane, at.column, at.row)[0], factor);
			size = bits_of((uint32_t)abs(mean - before));
			put(scan, fragment, size, size);
			before = mean;
		}
	}
}

/* Clears what becomes zero at this quality from the masks of a plane. */
static void shrink_masks(struct estimate *estimate, int plane_index)
{
	const struct coefficient_plane *plane = &estimate->coefficients->planes[plane_index];
	size_t count = (size_t)plane->columns * plane->rows;

	for (size_t i = 0; i < count; i++) {
		const int16_t *block = plane->blocks + i * COEFFICIENTS_OF_BLOCK;

		for (uint64_t left = estimate->masks[plane_index][i]; left; left &= left - 1) {
			int k = __builtin_ctzll(left);

			if (estimate->sizes[plane->table][k][abs(block[zigzag[k]])] == 0)
				estimate->masks[plane_index][i] ^= left & -left;
		}
	}
}

/* Codes a block up to its last coefficient that is not zero. */
static void code_block(struct scan *scan, uint32_t fragment, const int16_t *block, uint64_t mask,
		       const uint8_t sizes[COEFFICIENTS_OF_BLOCK][COEFFICIENT_MOST + 1])
{
	int before = 0;

	for (; mask; mask &= mask - 1) {
		int k = __builtin_ctzll(mask), zeroes = k - before - 1;
		uint32_t size = sizes[k][abs(block[zigzag[k]])];

		for (; zeroes > 15; zeroes -= 16)
			put(scan, fragment, ZEROES, 0);
		put(scan, fragment, (uint32_t)zeroes << 4 | size, size);
		before = k;
	}
}

/* Ends of blocks are counted in one code, which comes before the next block that has something; its
 * bits are those of that block. */
static void code_plane(struct estimate *estimate, struct scan *scan, int plane_index)
{
	const struct coefficient_plane *plane = &estimate->coefficients->planes[plane_index];
	const uint64_t *masks = estimate->masks[plane_index];
	uint32_t ends = 0, fragment = 0;

	for (uint32_t row = 0; row < plane->rows; row++)
		for (uint32_t column = 0; column < plane->columns; column++) {
			uint64_t mask = *masks++;

			fragment = coefficients_fragment(estimate->coefficients,
							 column / plane->unit_blocks,
							 row / plane->unit_blocks);
			if (ends > 0 && (mask || ends == EMPTY_RUN_MOST)) {
				put(scan, fragment, (bits_of(ends) - 1) << 4, bits_of(ends) - 1);
				ends = 0;
			}
			code_block(scan, fragment, coefficients_of(plane, column, row), mask,
				   estimate->sizes[plane->table]);
			if (!(mask >> 63)) /* the last coefficient needs no end */
				ends++;
		}
	if (ends > 0)
		put(scan, fragment, (bits_of(ends) - 1) << 4, bits_of(ends) - 1);
}

/* Counts with the first call of a coder, adds up bits with the second. planes: of one scan. */
static void code_scan(struct estimate *estimate, int first, int last,
		      void (*code)(struct estimate *, struct scan *, int))
{
	struct scan scan = { 0 };

	for (int plane = first; plane <= last; plane++)
		code(estimate, &scan, plane);
	find_lengths(&scan);
	scan.bits = estimate->bits;
	for (int plane = first; plane <= last; plane++)
		code(estimate, &scan, plane);
}

/* ---- all qualities */

static void set_quality(struct estimate *estimate, uint32_t quality)
{
	estimate->quality = quality;
	for (int table = 0; table < 2; table++)
		for (int k = 0; k < COEFFICIENTS_OF_BLOCK; k++) {
			int factor = estimate->coefficients->factors[quality][table][zigzag[k]];

			for (int size = 0; size <= COEFFICIENT_MOST; size++)
				estimate->sizes[table][k][size] =
					(uint8_t)bits_of((uint32_t)coefficient_round(size, factor));
		}
	memset(estimate->bits, 0,
	       (size_t)estimate->coefficients->columns * estimate->coefficients->rows *
		       sizeof(*estimate->bits));
}

static int estimate_init(struct estimate *estimate, const struct coefficients *coefficients)
{
	estimate->coefficients = coefficients;
	estimate->bits = malloc((size_t)coefficients->columns * coefficients->rows *
				sizeof(*estimate->bits));
	if (!estimate->bits)
		return -ENOMEM;
	for (int i = 0; i < COEFFICIENT_PLANES; i++) {
		const struct coefficient_plane *plane = &coefficients->planes[i];
		size_t count = (size_t)plane->columns * plane->rows;

		estimate->masks[i] = calloc(count, sizeof(*estimate->masks[i]));
		if (!estimate->masks[i])
			return -ENOMEM;
		for (size_t block = 0; block < count; block++)
			for (int k = 1; k < COEFFICIENTS_OF_BLOCK; k++)
				if (plane->blocks[block * COEFFICIENTS_OF_BLOCK + zigzag[k]] != 0)
					estimate->masks[i][block] |= (uint64_t)1 << k;
	}
	return 0;
}

static void estimate_destroy(struct estimate *estimate)
{
	if (!estimate)
		return;
	for (int i = 0; i < COEFFICIENT_PLANES; i++)
		free(estimate->masks[i]);
	free(estimate->bits);
	free(estimate);
}

static void fill_knot(uint32_t *table, struct estimate *estimate, int knot)
{
	size_t fragments = (size_t)estimate->coefficients->columns * estimate->coefficients->rows;

	set_quality(estimate, knots[knot]);
	code_scan(estimate, 0, 0, code_means);
	code_scan(estimate, 1, 2, code_means); /* colours share their codes */
	for (int plane = 0; plane < COEFFICIENT_PLANES; plane++) {
		shrink_masks(estimate, plane);
		code_scan(estimate, plane, plane, code_plane);
	}
	for (size_t i = 0; i < fragments; i++)
		table[i * COEFFICIENT_KNOTS + (size_t)knot] =
			(uint32_t)((estimate->bits[i] + 7) / 8);
}

int coefficient_bytes(uint32_t **out, const struct coefficients *coefficients)
{
	size_t fragments = (size_t)coefficients->columns * coefficients->rows;
	struct estimate *estimate = calloc(1, sizeof(*estimate));
	uint32_t *table = malloc(fragments * COEFFICIENT_KNOTS * sizeof(*table));
	int rc = estimate && table ? estimate_init(estimate, coefficients) : -ENOMEM;

	for (int knot = COEFFICIENT_KNOTS - 1; knot >= 0 && rc == 0; knot--)
		fill_knot(table, estimate, knot);
	estimate_destroy(estimate);
	if (rc < 0) {
		free(table);
		table = NULL;
	}
	/* Other neighbours and other codes may make a better quality a little smaller. */
	for (size_t i = 0; i < fragments && table; i++)
		for (size_t knot = i * COEFFICIENT_KNOTS + 1; knot < (i + 1) * COEFFICIENT_KNOTS;
		     knot++)
			if (table[knot] < table[knot - 1])
				table[knot] = table[knot - 1];
	*out = table;
	return rc;
}

uint32_t coefficient_bytes_at(const uint32_t bytes[COEFFICIENT_KNOTS], uint32_t quality)
{
	uint32_t knot = 0, width;

	while (knots[knot] < quality)
		knot++;
	if (knots[knot] == quality)
		return bytes[knot];
	width = knots[knot] - knots[knot - 1];
	return bytes[knot - 1] + (uint32_t)((uint64_t)(bytes[knot] - bytes[knot - 1]) *
					    (quality - knots[knot - 1]) / width);
}
