/* Entropy coder of the patch codec: asymmetric numeral systems (Duda 2013, in the range variant)
 * with adaptive models, and plain bits beside them. Private to format/.
 *
 * One set of calls serves both directions, so that encoder and decoder cannot differ: each call
 * takes the value to encode and returns it, or ignores it and returns what it decoded. A model
 * learns while it is used: it counts its symbols and recomputes their probabilities from the counts
 * at fixed intervals, so no table is stored. Everything is integers. */
#ifndef GOPURA_FORMAT_SYMBOL_CODER_H
#define GOPURA_FORMAT_SYMBOL_CODER_H

#include "base/bytes.h"

enum {
	SYMBOLS_MAX = 64,
	SYMBOL_SCALE_BITS = 11, /* probabilities are multiples of 1 / 2048 */
	SYMBOL_SCALE = 1 << SYMBOL_SCALE_BITS,
	SYMBOL_BUCKET_BITS = 3,
	SYMBOL_BUCKETS = SYMBOL_SCALE >> SYMBOL_BUCKET_BITS,
	SYMBOL_COUNT_STEP = 32,
	SYMBOL_NUMBERS_WHOLE = 8, /* numbers that are symbols of their own */
	SYMBOL_NUMBER_BITS = 25
};

/* A state stays in 2^31 .. 2^63 - 1 and moves by words of 32 bits. */
#define SYMBOL_STATE_MIN (UINT64_C(1) << 31)

/* The probabilities of one kind of symbol. All zeros is a model that has not been used. */
struct symbol_model {
	uint16_t left, period; /* symbols until the next update; between two of them */
	uint16_t size;         /* number of symbols; 0: not used yet */
	struct {
		uint16_t start, count;  /* start: cumulated probability, out of SYMBOL_SCALE */
	} symbols[SYMBOLS_MAX + 1];     /* the last one ends the one before */
	uint8_t at[SYMBOL_BUCKETS + 8]; /* the symbol at the first place of each bucket; a fill may
					 * write 7 more */
};

/* Decoding: borrows its bytes. Functions that decode many symbols work on a copy of it, which the
 * compiler keeps in registers, and put it back. */
struct symbol_decoder {
	/* Symbols use two states in turn, so that a processor can decode two at a time. state is
	 * that of the next symbol. */
	uint64_t state, state_after;
	uint32_t bit_count;
	uint64_t bits; /* plain bits that wait to be read */
	/* Beyond the end there are zeros, and the places go on. */
	const uint8_t *words, *plain;
	size_t word_at, word_count, plain_at, plain_bytes;
};

/* Encoding: the ranges of symbols are kept until the end, because they are written backwards. */
struct symbol_encoder {
	bool failed; /* memory was missing */
	/* owned; start and size of the range of each symbol so far */
	uint32_t *ranges;
	size_t range_count, range_capacity;
	struct buffer plain; /* plain bits so far */
	uint64_t bits;       /* and those that do not fill a byte yet */
	uint32_t bit_count;
};

/* One of the two, for code that goes in both directions. */
struct symbol_coder {
	struct symbol_encoder *encoder; /* borrowed; NULL: decoding */
	struct symbol_decoder decoder;
};

void symbol_encoder_init(struct symbol_encoder *encoder);
/* Appends everything that was encoded; symbol_decoder_init reads as much. Returns 0, -ENOMEM or the
 * error of out. */
must_check int symbol_encoder_put(struct symbol_encoder *encoder, struct buffer *out);
void symbol_encoder_finish(struct symbol_encoder *encoder); /* zeroed is fine */

/* Reads what symbol_encoder_put appended; the bytes behind reader must outlive the coder. Returns
 * -EBADMSG if they are too few. A decoder that meets the end of its bytes goes on with zeros: ask
 * symbol_decoder_complete at the end. */
must_check int symbol_decoder_init(struct symbol_decoder *decoder, struct reader *reader);
/* Returns whether all bytes were used, none was missing and the states are those with which the
 * encoder began. */
bool symbol_decoder_complete(const struct symbol_decoder *decoder);

/* Parts of the functions below, for this header alone. */
void symbol_model_prepare(struct symbol_model *model, uint32_t size);
void symbol_encode(struct symbol_encoder *encoder, struct symbol_model *model, uint32_t size,
		   uint32_t symbol);
void symbol_encode_number(struct symbol_encoder *encoder, struct symbol_model *model,
			  uint32_t number, uint32_t bits);
void symbol_encode_bits(struct symbol_encoder *encoder, uint32_t value, uint32_t bits);
/* Returns the next four plain bytes, where fewer are left. */
uint32_t symbol_last_bytes(const uint8_t *plain, size_t at, size_t size);

static force_inline uint32_t symbol_word(const uint8_t *in)
{
	return (uint32_t)in[0] | (uint32_t)in[1] << 8 | (uint32_t)in[2] << 16 |
	       (uint32_t)in[3] << 24;
}

static force_inline uint32_t symbol_decode_bits(struct symbol_decoder *decoder, uint32_t bits)
{
	uint32_t value;

	if (decoder->bit_count < bits) {
		uint32_t word;

		if (decoder->plain_at + 4 <= decoder->plain_bytes)
			word = symbol_word(decoder->plain + decoder->plain_at);
		else
			word = symbol_last_bytes(decoder->plain, decoder->plain_at,
						 decoder->plain_bytes);
		decoder->bits |= (uint64_t)word << decoder->bit_count;
		decoder->bit_count += 32;
		decoder->plain_at += 4;
	}
	value = (uint32_t)decoder->bits & ((1u << bits) - 1);
	decoder->bits >>= bits;
	decoder->bit_count -= bits;
	return value;
}

static force_inline uint32_t symbol_decode(struct symbol_decoder *decoder,
					   struct symbol_model *model, uint32_t size)
{
	uint64_t state = decoder->state;
	uint32_t place = state & (SYMBOL_SCALE - 1), symbol, start;
	uint64_t word;
	bool low;

	if (model->left == 0)
		symbol_model_prepare(model, size);
	model->left--;
	symbol = model->at[place >> SYMBOL_BUCKET_BITS];
	while (place >= model->symbols[symbol + 1].start)
		symbol++;
	start = model->symbols[symbol].start;
	state = (model->symbols[symbol + 1].start - start) * (state >> SYMBOL_SCALE_BITS) + place -
		start;
	model->symbols[symbol].count += SYMBOL_COUNT_STEP;
	word = decoder->word_at < decoder->word_count
		       ? symbol_word(decoder->words + 4 * decoder->word_at)
		       : 0;
	word |= state << 32;
	/* Written so that the compiler makes no branch of it, which no processor could foresee. */
	low = state < SYMBOL_STATE_MIN;
	state = low ? word : state;
	decoder->word_at += low;
	decoder->state = decoder->state_after;
	decoder->state_after = state;
	return symbol;
}

/* Codes bits plain bits, 0 to 28. */
static force_inline uint32_t symbol_code_bits(struct symbol_coder *coder, uint32_t value,
					      uint32_t bits)
{
	if (!coder->encoder)
		return symbol_decode_bits(&coder->decoder, bits);
	symbol_encode_bits(coder->encoder, value, bits);
	return value;
}

/* Codes one of size symbols (2 to SYMBOLS_MAX); size is the same in every call with this model. The
 * first are the likely ones until the model knows better. */
static force_inline uint32_t symbol_code(struct symbol_coder *coder, struct symbol_model *model,
					 uint32_t size, uint32_t symbol)
{
	if (!coder->encoder)
		return symbol_decode(&coder->decoder, model, size);
	symbol_encode(coder->encoder, model, size, symbol);
	return symbol;
}

/* Codes a number below 2^bits (3 to SYMBOL_NUMBER_BITS, the same in every call with this model);
 * small numbers take few bits. From SYMBOL_NUMBERS_WHOLE on, a symbol says the highest bit of a
 * number and the bit below it; the rest are plain bits. */
static force_inline uint32_t symbol_code_number(struct symbol_coder *coder,
						struct symbol_model *model, uint32_t number,
						uint32_t bits)
{
	uint32_t symbol, plain;

	if (coder->encoder) {
		symbol_encode_number(coder->encoder, model, number, bits);
		return number;
	}
	symbol = symbol_decode(&coder->decoder, model, SYMBOL_NUMBERS_WHOLE + 2 * (bits - 3));
	if (symbol < SYMBOL_NUMBERS_WHOLE)
		return symbol;
	plain = (symbol - SYMBOL_NUMBERS_WHOLE) / 2 + 2;
	return (2 | (symbol & 1)) << plain | symbol_decode_bits(&coder->decoder, plain);
}

/* Maps small differences of either sign to small numbers (zigzag): 0, -1, 1, -2 ... */
static force_inline uint32_t symbol_fold(int32_t difference)
{
	return (uint32_t)difference << 1 ^ (difference < 0 ? UINT32_MAX : 0);
}

static force_inline int32_t symbol_unfold(uint32_t folded)
{
	return (int32_t)(folded >> 1 ^ (folded & 1 ? UINT32_MAX : 0));
}

/* Codes the difference of two numbers of bits bits, which wraps around. Returns it in that many
 * bits. */
static force_inline int32_t symbol_code_difference(struct symbol_coder *coder,
						   struct symbol_model *model, int32_t difference,
						   int bits)
{
	int32_t mask = (1 << bits) - 1;

	difference &= mask;
	if (difference > mask / 2)
		difference -= mask + 1;
	return symbol_unfold(
		       symbol_code_number(coder, model, symbol_fold(difference), (uint32_t)bits)) &
	       mask;
}

#endif
