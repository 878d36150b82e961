/* Counts tokens in bytes; without a limit it does nothing. */
#include "net/token_bucket.h"

#include "base/clock.h"

enum { REFILL_MS_MAX = 3600000 }; /* so that a long sleep at a high rate does not overflow */

void token_bucket_init(struct token_bucket *bucket, uint64_t bytes_per_s)
{
	*bucket = (struct token_bucket){ .bytes_per_s = bytes_per_s,
					 .bytes = (int64_t)bytes_per_s / 2,
					 .filled_ms = clock_now_ms() };
}

void token_bucket_refill(struct token_bucket *bucket)
{
	const int64_t rate = (int64_t)bucket->bytes_per_s, now_ms = clock_now_ms();
	int64_t elapsed_ms = now_ms - bucket->filled_ms;

	if (elapsed_ms > REFILL_MS_MAX)
		elapsed_ms = REFILL_MS_MAX;
	bucket->bytes += elapsed_ms * rate / 1000;
	if (bucket->bytes > rate / 2)
		bucket->bytes = rate / 2;
	bucket->filled_ms = now_ms;
}

void token_bucket_take(struct token_bucket *bucket, uint32_t bytes)
{
	if (bucket->bytes_per_s > 0)
		bucket->bytes -= bytes;
}

bool token_bucket_is_empty(const struct token_bucket *bucket)
{
	return bucket->bytes_per_s > 0 && bucket->bytes <= 0;
}

int64_t token_bucket_due_ms(const struct token_bucket *bucket)
{
	if (!token_bucket_is_empty(bucket))
		return 0;
	return bucket->filled_ms + 1 + -bucket->bytes * 1000 / (int64_t)bucket->bytes_per_s;
}
