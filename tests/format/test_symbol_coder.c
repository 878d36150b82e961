#include "format/symbol_coder.h"

#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

enum { NUMBERS = 5000 };

/* Small numbers and large ones, plain bits between them. */
static uint32_t number_at(uint32_t i)
{
	uint32_t random = (i + 1) * 2654435761u;

	return (random >> 8) >> random % 25;
}

/* Runs the same calls in both directions. Returns whether every value was the expected one. */
static bool code_all(struct symbol_coder *coder)
{
	struct symbol_model number = { 0 }, side = { 0 };
	bool equal = true;

	for (uint32_t i = 0; i < NUMBERS; i++) {
		uint32_t value = number_at(i), bits = i % 29, plain = (1u << bits) - 1;

		equal &= symbol_code_number(coder, &number, value, SYMBOL_NUMBER_BITS) == value;
		equal &= symbol_code(coder, &side, 2, i % 7 == 0) == (i % 7 == 0);
		equal &= symbol_code_bits(coder, plain & value, bits) == (plain & value);
	}
	return equal;
}

static void encode_all(struct buffer *out)
{
	struct symbol_encoder encoder;
	struct symbol_coder coder = { .encoder = &encoder };

	buffer_init(out, 1 << 20);
	symbol_encoder_init(&encoder);
	CHECK(code_all(&coder));
	CHECK(symbol_encoder_put(&encoder, out) == 0);
	symbol_encoder_finish(&encoder);
}

/* Decodes from bytes without slack for the sanitizer. */
static bool decodes(const uint8_t *data, size_t size)
{
	uint8_t *exact = malloc(size ? size : 1);
	struct symbol_coder coder = { 0 };
	struct reader reader;
	bool equal;

	memcpy(exact, data, size);
	reader_init(&reader, (struct bytes){ exact, size });
	equal = symbol_decoder_init(&coder.decoder, &reader) == 0;
	equal = equal && code_all(&coder) && symbol_decoder_complete(&coder.decoder);
	free(exact);
	return equal;
}

static void decodes_what_was_encoded(void **state)
{
	struct buffer out;

	(void)state;
	encode_all(&out);
	CHECK(decodes(out.data, out.size));
	buffer_finish(&out);
}

static void notices_every_missing_byte(void **state)
{
	struct buffer out;

	(void)state;
	encode_all(&out);
	for (size_t n = 0; n < out.size; n += n < 100 ? 1 : 97)
		CHECK(!decodes(out.data, n));
	buffer_finish(&out);
}

/* Fewer words or plain bytes than were written, as their counts tell: the decoder goes on with
 * zeros and says so at the end. */
static void notices_counts_that_are_too_small(void **state)
{
	struct buffer out;

	(void)state;
	encode_all(&out);
	for (size_t at = 0; at <= 4; at += 4) {
		uint8_t kept[4];

		memcpy(kept, out.data + at, 4);
		memcpy(out.data + at, "\1\0\0", 4);
		CHECK(!decodes(out.data, out.size));
		memcpy(out.data + at, kept, 4);
	}
	buffer_finish(&out);
}

/* 10 000 symbols, of which one in a hundred is not the usual one: 0.08 bits each. */
static void learns_what_is_likely(void **state)
{
	struct symbol_encoder encoder;
	struct symbol_coder coder = { .encoder = &encoder };
	struct symbol_model model = { 0 };
	struct buffer out;

	(void)state;
	buffer_init(&out, 1 << 20);
	symbol_encoder_init(&encoder);
	for (uint32_t i = 0; i < 10000; i++)
		symbol_code(&coder, &model, SYMBOLS_MAX, i % 100 == 0 ? 3 : 40);
	CHECK(symbol_encoder_put(&encoder, &out) == 0);
	CHECK(out.size > 100 && out.size < 300);
	symbol_encoder_finish(&encoder);
	buffer_finish(&out);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(decodes_what_was_encoded),
		cmocka_unit_test(notices_every_missing_byte),
		cmocka_unit_test(notices_counts_that_are_too_small),
		cmocka_unit_test(learns_what_is_likely),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
