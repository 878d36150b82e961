/* What every decoder must survive: each truncation, each bit flipped, in an allocation of its exact
 * size so that the sanitizer sees one byte too far. */
#ifndef GOPURA_TESTS_FORMAT_BEND_H
#define GOPURA_TESTS_FORMAT_BEND_H

#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "tests/check.h"

/* Decodes and releases; 0 or negative errno. */
typedef int (*decode_once)(struct bytes bytes, void *data);

static inline int decode_exact(decode_once decode, void *data, const uint8_t *from, size_t size)
{
	uint8_t *exact = malloc(size ? size : 1);
	int rc;

	CHECK(exact != NULL);
	if (size)
		memcpy(exact, from, size);
	rc = decode((struct bytes){ exact, size }, data);
	free(exact);
	return rc;
}

static inline void refuses_every_truncation(decode_once decode, void *data, struct bytes whole)
{
	CHECK(decode_exact(decode, data, whole.data, whole.size) == 0);
	for (size_t n = 0; n < whole.size; n++)
		CHECK(decode_exact(decode, data, whole.data, n) < 0);
}

/* How many of the single-bit flips still decode. */
static inline size_t count_accepted_flips(decode_once decode, void *data, struct bytes whole)
{
	uint8_t *copy = malloc(whole.size);
	size_t accepted = 0;

	CHECK(copy != NULL);
	memcpy(copy, whole.data, whole.size);
	for (size_t bit = 0; bit < whole.size * 8; bit++) {
		copy[bit / 8] ^= (uint8_t)(1u << bit % 8);
		accepted += decode_exact(decode, data, copy, whole.size) == 0;
		copy[bit / 8] ^= (uint8_t)(1u << bit % 8);
	}
	free(copy);
	return accepted;
}

#endif
