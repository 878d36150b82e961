/* Codes symbols by adaptive models and asymmetric numeral systems. */
#include "format/symbol_coder.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum {
	SCALE = SYMBOL_SCALE,
	TOTAL_MAX = 30000, /* then the past is worth half */
	PERIOD_MIN = 8,
	PERIOD_MAX = 1024
};
_Static_assert(TOTAL_MAX + PERIOD_MAX * SYMBOL_COUNT_STEP <= UINT16_MAX, "counts fit");
_Static_assert(SYMBOL_NUMBERS_WHOLE + 2 * (SYMBOL_NUMBER_BITS - 3) <= SYMBOLS_MAX, "numbers fit");

/* Computes the ranges of the symbols from their counts: each has at least one place of SCALE. */
static void spread(struct symbol_model *model)
{
	uint32_t size = model->size, total = 0, per_count, sum = 0, at = 0;

	for (uint32_t s = 0; s < size; s++)
		total += model->symbols[s].count;
	per_count = ((SCALE - size) << 15) / total;
	for (uint32_t s = 0; s < size; s++) {
		uint64_t eight = s * 0x0101010101010101u;
		uint32_t end, last;

		sum += model->symbols[s].count;
		end = s + 1 < size ? s + 1 + (sum * per_count >> 15) : SCALE;
		model->symbols[s + 1].start = (uint16_t)end;
		last = (end + (1 << SYMBOL_BUCKET_BITS) - 1) >> SYMBOL_BUCKET_BITS;
		do {
			memcpy(model->at + at, &eight, sizeof(eight));
			at += 8;
		} while (at < last);
		at = last;
	}
	if (total > TOTAL_MAX)
		for (uint32_t s = 0; s < size; s++)
			model->symbols[s].count = (uint16_t)((model->symbols[s].count + 1) / 2);
}

/* Called when no symbols are left until the next update: of a new model at once. */
void symbol_model_prepare(struct symbol_model *model, uint32_t size)
{
	if (model->size == 0) {
		model->size = (uint16_t)size;
		for (uint32_t s = 0; s < size; s++)
			model->symbols[s].count = (uint16_t)(1 + (SYMBOL_COUNT_STEP / 2 >> s / 4));
		model->period = PERIOD_MIN;
	} else if (model->period < PERIOD_MAX) {
		model->period = (uint16_t)(2 * model->period);
	}
	model->left = model->period;
	spread(model);
}

void symbol_encoder_init(struct symbol_encoder *encoder)
{
	*encoder = (struct symbol_encoder){ 0 };
	buffer_init(&encoder->plain, UINT32_MAX);
}

void symbol_encoder_finish(struct symbol_encoder *encoder)
{
	free(encoder->ranges);
	buffer_finish(&encoder->plain);
	*encoder = (struct symbol_encoder){ 0 };
}

static void keep_range(struct symbol_encoder *encoder, uint32_t start, uint32_t size)
{
	if (encoder->range_count == encoder->range_capacity) {
		size_t capacity = encoder->range_capacity ? 2 * encoder->range_capacity : 4096;
		uint32_t *ranges = realloc(encoder->ranges, capacity * sizeof(*ranges));

		if (!ranges) {
			encoder->failed = true;
			return;
		}
		encoder->ranges = ranges;
		encoder->range_capacity = capacity;
	}
	encoder->ranges[encoder->range_count++] = start | size << 16;
}

void symbol_encode(struct symbol_encoder *encoder, struct symbol_model *model, uint32_t size,
		   uint32_t symbol)
{
	uint32_t start;

	if (model->left == 0)
		symbol_model_prepare(model, size);
	model->left--;
	start = model->symbols[symbol].start;
	keep_range(encoder, start, model->symbols[symbol + 1].start - start);
	model->symbols[symbol].count += SYMBOL_COUNT_STEP;
}

void symbol_encode_number(struct symbol_encoder *encoder, struct symbol_model *model,
			  uint32_t number, uint32_t bits)
{
	uint32_t symbol = number, plain = 0;

	if (number >= SYMBOL_NUMBERS_WHOLE) {
		plain = 30 - (uint32_t)__builtin_clz(number);
		symbol = SYMBOL_NUMBERS_WHOLE + 2 * (plain - 2) + (number >> plain & 1);
	}
	symbol_encode(encoder, model, SYMBOL_NUMBERS_WHOLE + 2 * (bits - 3), symbol);
	if (plain > 0)
		symbol_encode_bits(encoder, number & ((1u << plain) - 1), plain);
}

void symbol_encode_bits(struct symbol_encoder *encoder, uint32_t value, uint32_t bits)
{
	encoder->bits |= (uint64_t)value << encoder->bit_count;
	encoder->bit_count += bits;
	for (; encoder->bit_count >= 8; encoder->bit_count -= 8) {
		buffer_put_u8(&encoder->plain, (uint8_t)encoder->bits);
		encoder->bits >>= 8;
	}
}

/* Fills words, which has room for one for each symbol, from its end backwards. Returns where they
 * begin. states receives those of the first and the second symbol. */
static size_t encode_backwards(const struct symbol_encoder *encoder, uint32_t *words,
			       uint64_t states[2])
{
	size_t at = encoder->range_count;

	states[0] = states[1] = SYMBOL_STATE_MIN;
	for (size_t i = encoder->range_count; i-- > 0;) {
		uint32_t start = encoder->ranges[i] & 0xffff, size = encoder->ranges[i] >> 16;
		uint64_t *state = &states[i & 1];

		if (*state >= (uint64_t)size << (63 - SYMBOL_SCALE_BITS)) {
			words[--at] = (uint32_t)*state;
			*state >>= 32;
		}
		*state = (*state / size << SYMBOL_SCALE_BITS) + *state % size + start;
	}
	return at;
}

int symbol_encoder_put(struct symbol_encoder *encoder, struct buffer *out)
{
	uint32_t *words = malloc((encoder->range_count + 1) * sizeof(*words));
	uint64_t states[2];
	size_t at;

	if (!words || encoder->failed) {
		free(words);
		return -ENOMEM;
	}
	at = encode_backwards(encoder, words, states);
	if (encoder->bit_count > 0)
		buffer_put_u8(&encoder->plain, (uint8_t)encoder->bits);
	buffer_put_u32(out, (uint32_t)(encoder->range_count - at));
	buffer_put_u32(out, (uint32_t)encoder->plain.size);
	buffer_put_u64(out, states[0]);
	buffer_put_u64(out, states[1]);
	for (; at < encoder->range_count; at++)
		buffer_put_u32(out, words[at]);
	buffer_put(out, encoder->plain.data, encoder->plain.size);
	free(words);
	return encoder->plain.error < 0 ? encoder->plain.error : out->error;
}

int symbol_decoder_init(struct symbol_decoder *decoder, struct reader *reader)
{
	uint32_t word_count = reader_u32(reader), plain_bytes = reader_u32(reader);

	*decoder = (struct symbol_decoder){ .state = reader_u64(reader),
					    .word_count = word_count,
					    .plain_bytes = plain_bytes };
	decoder->state_after = reader_u64(reader);
	decoder->words = reader_bytes(reader, 4 * (size_t)word_count).data;
	decoder->plain = reader_bytes(reader, plain_bytes).data;
	return reader->failed ? -EBADMSG : 0;
}

bool symbol_decoder_complete(const struct symbol_decoder *decoder)
{
	return decoder->state == SYMBOL_STATE_MIN && decoder->state_after == SYMBOL_STATE_MIN &&
	       decoder->word_at == decoder->word_count && decoder->bits == 0 &&
	       decoder->plain_at - decoder->bit_count / 8 == decoder->plain_bytes;
}

uint32_t symbol_last_bytes(const uint8_t *plain, size_t at, size_t size)
{
	uint32_t word = 0;

	for (uint32_t i = 0; i < 4 && at + i < size; i++)
		word |= (uint32_t)plain[at + i] << 8 * i;
	return word;
}
