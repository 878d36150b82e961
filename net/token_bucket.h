/* A rate limit for bytes, as a token bucket: requests take tokens, time brings them back. A request
 * may take more than there are; the next one then waits until they are paid back. */
#ifndef GOPURA_NET_TOKEN_BUCKET_H
#define GOPURA_NET_TOKEN_BUCKET_H

#include <stdbool.h>
#include <stdint.h>

struct token_bucket {
	uint64_t bytes_per_s; /* 0: no limit */
	int64_t bytes;        /* may be requested now; negative: overdrawn */
	int64_t filled_ms;    /* when bytes was computed (clock_now_ms) */
};

/* Full: half a second's worth may be requested at once. */
void token_bucket_init(struct token_bucket *bucket, uint64_t bytes_per_s);
/* Adds what the limit allows since the last call. At most half a second's worth is saved up. */
void token_bucket_refill(struct token_bucket *bucket);
void token_bucket_take(struct token_bucket *bucket, uint32_t bytes);
/* Returns true if nothing may be requested before the time of token_bucket_due_ms. */
bool token_bucket_is_empty(const struct token_bucket *bucket);
/* Returns when a refill makes the bucket non-empty (clock_now_ms); 0: it is not empty. */
int64_t token_bucket_due_ms(const struct token_bucket *bucket);

#endif
