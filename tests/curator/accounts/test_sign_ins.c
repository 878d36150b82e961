#include "curator/accounts/sign_ins.h"

#include <stdio.h>
#include <string.h>

#include "tests/check.h"

static struct sign_ins sign_ins;

static int start(void **state)
{
	(void)state;
	memset(&sign_ins, 0, sizeof(sign_ins));
	return 0;
}

static void a_key_finds_its_own_and_no_other(void **state)
{
	char ana[SIGN_IN_SECRET_BYTES], rolf[SIGN_IN_SECRET_BYTES];

	(void)state;
	sign_ins_begin(&sign_ins, "ana", 0, ana);
	sign_ins_begin(&sign_ins, "rolf", 0, rolf);
	CHECK(strlen(ana) == 64 && strcmp(ana, rolf) != 0);
	CHECK(strcmp(sign_ins_find(&sign_ins, ana, 1)->name, "ana") == 0);
	CHECK(strcmp(sign_ins_find(&sign_ins, rolf, 1)->name, "rolf") == 0);
	CHECK(!sign_ins_find(&sign_ins, "", 1));
	rolf[63] ^= 1;
	CHECK(!sign_ins_find(&sign_ins, rolf, 1));
	sign_ins_end(&sign_ins, ana);
	CHECK(!sign_ins_find(&sign_ins, ana, 1));
}

static void the_table_has_no_cookie_in_it(void **state)
{
	char key[SIGN_IN_SECRET_BYTES];

	(void)state;
	sign_ins_begin(&sign_ins, "ana", 0, key);
	CHECK(!memmem(&sign_ins, sizeof(sign_ins), key, 16));
}

static void it_ends_when_nobody_uses_it(void **state)
{
	char key[SIGN_IN_SECRET_BYTES];

	(void)state;
	sign_ins_begin(&sign_ins, "ana", 1000, key);
	CHECK(sign_ins_find(&sign_ins, key, 1000 + SIGN_IN_IDLE_MS - 1));
	CHECK(!sign_ins_find(&sign_ins, key, 1000 + SIGN_IN_IDLE_MS));
	CHECK(!sign_ins_find(&sign_ins, key, 1000)); /* for good */
}

static void it_ends_after_half_a_day_of_use(void **state)
{
	char key[SIGN_IN_SECRET_BYTES];
	int64_t now_ms = 0;

	(void)state;
	sign_ins_begin(&sign_ins, "ana", now_ms, key);
	for (; now_ms < SIGN_IN_WHOLE_MS; now_ms += SIGN_IN_IDLE_MS / 2) {
		struct sign_in *sign_in = sign_ins_find(&sign_ins, key, now_ms);

		CHECK(sign_in);
		sign_in->used_ms = now_ms;
	}
	CHECK(!sign_ins_find(&sign_ins, key, now_ms));
}

static void an_account_has_only_so_many(void **state)
{
	char keys[SIGN_INS_OF_ACCOUNT_MAX + 1][SIGN_IN_SECRET_BYTES], other[SIGN_IN_SECRET_BYTES];

	(void)state;
	sign_ins_begin(&sign_ins, "rolf", 0, other);
	for (unsigned n = 0; n <= SIGN_INS_OF_ACCOUNT_MAX; n++)
		sign_ins_begin(&sign_ins, "ana", 1 + n, keys[n]);
	CHECK(!sign_ins_find(&sign_ins, keys[0], 100));
	for (unsigned n = 1; n <= SIGN_INS_OF_ACCOUNT_MAX; n++)
		CHECK(sign_ins_find(&sign_ins, keys[n], 100));
	CHECK(sign_ins_find(&sign_ins, other, 100));
	sign_ins_end_all(&sign_ins, "ana");
	CHECK(!sign_ins_find(&sign_ins, keys[1], 100) && sign_ins_find(&sign_ins, other, 100));
}

static void a_full_table_drops_the_one_used_longest_ago(void **state)
{
	char first[SIGN_IN_SECRET_BYTES], key[SIGN_IN_SECRET_BYTES], name[16];

	(void)state;
	sign_ins_begin(&sign_ins, "first", 0, first);
	for (unsigned n = 0; n < SIGN_INS_MAX; n++) {
		snprintf(name, sizeof(name), "a%u", n);
		sign_ins_begin(&sign_ins, name, 1 + n, key);
	}
	CHECK(!sign_ins_find(&sign_ins, first, 1000) && sign_ins_find(&sign_ins, key, 1000));
}

static void requests_are_limited_and_time_gives_new_ones(void **state)
{
	char key[SIGN_IN_SECRET_BYTES];
	struct sign_in *sign_in;

	(void)state;
	sign_ins_begin(&sign_ins, "ana", 0, key);
	sign_in = sign_ins_find(&sign_ins, key, 0);
	for (unsigned n = 0; n < SIGN_IN_REQUESTS_AT_ONCE; n++)
		CHECK(sign_in_may_ask(sign_in, 0));
	CHECK(!sign_in_may_ask(sign_in, 0));
	for (unsigned n = 0; n < SIGN_IN_REQUESTS_PER_S; n++)
		CHECK(sign_in_may_ask(sign_in, 1000));
	CHECK(!sign_in_may_ask(sign_in, 1000));
	for (unsigned n = 0; n < SIGN_IN_REQUESTS_AT_ONCE; n++)
		CHECK(sign_in_may_ask(sign_in, 10000000));
	CHECK(!sign_in_may_ask(sign_in, 10000000));
}

static void a_secret_is_the_whole_text_or_none(void **state)
{
	char key[SIGN_IN_SECRET_BYTES], token[SIGN_IN_SECRET_BYTES + 1];

	(void)state;
	snprintf(token, sizeof(token), "%s", sign_ins_begin(&sign_ins, "ana", 0, key)->token);
	CHECK(sign_in_secret_is(sign_ins_find(&sign_ins, key, 0)->token, token));
	CHECK(!sign_in_secret_is(token, "") && !sign_in_secret_is(token, key));
	CHECK(!sign_in_secret_is("", ""));
	token[64] = '0';
	token[65] = '\0';
	CHECK(!sign_in_secret_is(sign_ins_find(&sign_ins, key, 0)->token, token));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(a_key_finds_its_own_and_no_other, start),
		cmocka_unit_test_setup(the_table_has_no_cookie_in_it, start),
		cmocka_unit_test_setup(it_ends_when_nobody_uses_it, start),
		cmocka_unit_test_setup(it_ends_after_half_a_day_of_use, start),
		cmocka_unit_test_setup(an_account_has_only_so_many, start),
		cmocka_unit_test_setup(a_full_table_drops_the_one_used_longest_ago, start),
		cmocka_unit_test_setup(requests_are_limited_and_time_gives_new_ones, start),
		cmocka_unit_test_setup(a_secret_is_the_whole_text_or_none, start),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
