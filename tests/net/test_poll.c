#include "net/poll.h"

#include "tests/check.h"
#include "tests/net/fake_http.h"

struct stage {
	struct link link;
	struct poll *poll;
	struct metrics_refusal refusal;
	char passed[256]; /* "root1 timestamp ..." */
};

static void on_meta(void *data, enum meta_role role, uint32_t version, struct bytes bytes)
{
	static const char *const names[] = { "root", "release", "timestamp" };
	struct stage *stage = data;
	size_t used = strlen(stage->passed);

	snprintf(stage->passed + used, sizeof(stage->passed) - used, "%s%u:%.*s ", names[role],
		 version, (int)bytes.size, (const char *)bytes.data);
}

static int set_up(void **state)
{
	struct stage *stage = calloc(1, sizeof(*stage));
	struct poll_options options = {
		.link = &stage->link, .period_s = 60, .meta = on_meta, .data = stage
	};

	*state = stage;
	memset(&server, 0, sizeof(server));
	server.now_ms = 1000;
	link_init(&stage->link);
	stage->link.refusal = &stage->refusal;
	CHECK(poll_create(&stage->poll, &options) == 0);
	poll_trust(stage->poll, 1);
	return 0;
}

static int tear_down(void **state)
{
	struct stage *stage = *state;

	poll_destroy(stage->poll);
	free(stage);
	return 0;
}

/* Answers the open request, which must be for path: with text, or "" for "has it not". */
static void answer(const char *path, const char *text)
{
	CHECK(asked(0)->open && strcmp(asked(0)->path, path) == 0);
	if (text[0])
		give(asked(0), (struct bytes){ (const uint8_t *)text, strlen(text) });
	end(asked(0), text[0] ? 0 : -ENOENT);
}

static void expect_passed(struct stage *stage, const char *expected)
{
	CHECK(strcmp(stage->passed, expected) == 0);
	stage->passed[0] = '\0';
}

static void look_once(struct stage *stage)
{
	poll_start(stage->poll, 0);
	poll_work(stage->poll);
	answer("root/2.json", "");
	answer("timestamp.json", "T");
	answer("release.json", "R");
	expect_passed(stage, "timestamp0:T release0:R ");
}

/* The kiosk has checked what it was told last, and says which root it has now. */
static void kiosk_says(struct stage *stage, uint32_t root_version)
{
	poll_trust(stage->poll, root_version);
	poll_work(stage->poll);
}

static void next_round(struct stage *stage)
{
	server.count = 0; /* there is room for a few only */
	server.now_ms += 66001;
	poll_work(stage->poll);
}

static void says_new_roots_first_and_the_other_two_always(void **state)
{
	struct stage *stage = *state;

	poll_work(stage->poll);
	CHECK(server.count == 0); /* nobody asked yet */
	look_once(stage);
	poll_work(stage->poll);
	CHECK(server.count == 3); /* not before the minute is over */
	CHECK(poll_due_ms(stage->poll) >= server.now_ms + 54000);
	CHECK(poll_due_ms(stage->poll) <= server.now_ms + 66000);
	next_round(stage);
	answer("root/2.json", "");
	answer("timestamp.json", "T"); /* the kiosk may have had no memory for it */
	answer("release.json", "S");
	expect_passed(stage, "timestamp0:T release0:S ");
	next_round(stage);
	answer("root/2.json", "");
	answer("timestamp.json", "T");
	end(asked(0), 0); /* not modified */
	expect_passed(stage, "timestamp0:T release0:S ");
}

static void follows_several_roots_in_one_round(void **state)
{
	struct stage *stage = *state;

	look_once(stage);
	next_round(stage);
	answer("root/2.json", "B");
	expect_passed(stage, "root2:B ");
	CHECK(server.count == 1); /* the kiosk has not said that it is good */
	kiosk_says(stage, 2);
	answer("root/3.json", "C");
	kiosk_says(stage, 3);
	answer("root/4.json", "");
	answer("timestamp.json", "T"); /* the same again, but it may be good under the new root */
	answer("release.json", "R");
	expect_passed(stage, "root3:C timestamp0:T release0:R ");
}

/* Whoever answers with what is no root (a captive portal) changes nothing. */
static void asks_for_the_next_root_until_the_kiosk_has_it(void **state)
{
	struct stage *stage = *state;
	char page[64];

	poll_start(stage->poll, 0);
	poll_work(stage->poll);
	for (int round = 0; round < 200; round++) {
		snprintf(page, sizeof(page), "<html>Log in, guest %d", round);
		answer("root/2.json", page);
		kiosk_says(stage, 1); /* refused */
		answer("timestamp.json", page);
		answer("release.json", page);
		stage->passed[0] = '\0';
		next_round(stage);
	}
	CHECK(asked(0)->get.etag[0] == '\0'); /* the portal could have made one up */
	answer("root/2.json", "B");
	expect_passed(stage, "root2:B ");
	kiosk_says(stage, 2);
	answer("root/3.json", "");
	answer("timestamp.json", "T");
	answer("release.json", "R");
	expect_passed(stage, "timestamp0:T release0:R ");
}

static void says_what_was_refused_once_and_goes_on(void **state)
{
	struct stage *stage = *state;

	poll_start(stage->poll, 0);
	poll_work(stage->poll);
	answer("root/2.json", "bad");
	expect_passed(stage, "root2:bad ");
	poll_work(stage->poll);
	CHECK(server.count == 1 && poll_due_ms(stage->poll) == server.now_ms + 3000);
	server.now_ms += 3000; /* a kiosk that says nothing does not stop it */
	poll_work(stage->poll);
	answer("timestamp.json", "T");
	answer("release.json", "R");
	expect_passed(stage, "timestamp0:T release0:R ");
	next_round(stage);
	answer("root/2.json", "bad");
	answer("timestamp.json", "T");
	answer("release.json", "R");
	expect_passed(stage, "timestamp0:T release0:R ");
}

/* A stick had it. */
static void begins_a_round_when_the_kiosk_has_another_root(void **state)
{
	struct stage *stage = *state;

	poll_start(stage->poll, 0);
	poll_work(stage->poll);
	answer("root/2.json", "");
	kiosk_says(stage, 5);
	CHECK(server.cancelled == 1);
	answer("root/6.json", "");
	answer("timestamp.json", "T");
	answer("release.json", "R");
	expect_passed(stage, "timestamp0:T release0:R ");
}

/* The publisher writes release.json, then the timestamp that names it; who looks in between has the
 * new release under the old timestamp, and refuses it. */
static void says_a_release_again_under_its_timestamp_unless_it_is_gone(void **state)
{
	struct stage *stage = *state;

	look_once(stage);
	server.now_ms += 66001;
	poll_work(stage->poll);
	answer("root/2.json", "");
	answer("timestamp.json", "T");
	answer("release.json", "S");
	expect_passed(stage, "timestamp0:T release0:S ");
	server.now_ms += 66001;
	poll_work(stage->poll);
	answer("root/2.json", "");
	answer("timestamp.json", "U");
	answer("release.json", "S");
	expect_passed(stage, "timestamp0:U release0:S ");
	server.now_ms += 66001;
	poll_work(stage->poll);
	answer("root/2.json", "");
	answer("timestamp.json", "U");
	answer("release.json", ""); /* it is gone */
	expect_passed(stage, "timestamp0:U ");
}

static void says_all_again_when_asked(void **state)
{
	struct stage *stage = *state;

	look_once(stage);
	poll_start(stage->poll, 0);
	expect_passed(stage, "timestamp0:T release0:R ");
	poll_work(stage->poll);
	CHECK(server.count == 4); /* and looks at once */
	poll_stop(stage->poll);
	CHECK(server.cancelled == 1);
	poll_work(stage->poll);
	CHECK(server.count == 4 && poll_due_ms(stage->poll) == INT64_MAX);
	look_once(stage); /* what was known before poll_stop is forgotten */
}

static void tries_again_after_pauses_when_the_server_is_away(void **state)
{
	struct stage *stage = *state;

	poll_start(stage->poll, 0);
	for (size_t n = 1; n < 8; n++) {
		poll_work(stage->poll);
		CHECK(server.count == n);
		end(asked(0), -EHOSTUNREACH);
		poll_work(stage->poll);
		CHECK(server.count == n && !stage->link.online);
		CHECK(poll_due_ms(stage->poll) > server.now_ms);
		server.now_ms = poll_due_ms(stage->poll);
	}
	poll_work(stage->poll);
	answer("root/2.json", "B");
	CHECK(stage->link.online);
	expect_passed(stage, "root2:B ");
}

static void refuses_endless_data(void **state)
{
	struct stage *stage = *state;
	uint8_t *large = calloc(1, MESSAGE_META_BYTES_MAX + 1);

	poll_start(stage->poll, 0);
	poll_work(stage->poll);
	CHECK(asked(0)->get.ceiling == MESSAGE_META_BYTES_MAX);
	give(asked(0), (struct bytes){ large, MESSAGE_META_BYTES_MAX + 1 });
	end(asked(0), -EBADMSG); /* as net/http.c ends it */
	CHECK(stage->passed[0] == '\0');
	CHECK(stage->refusal.count == 1 && strcmp(stage->refusal.what, "root/2.json") == 0);
	CHECK(strcmp(stage->refusal.why, "larger than the limit for such a file") == 0);
	answer("timestamp.json", ""); /* goes on with the others */
	answer("release.json", "R");
	expect_passed(stage, "release0:R ");
	free(large);
}

static void brings_the_timestamp_alone_to_a_kiosk_that_follows_tuf(void **state)
{
	struct stage *stage = *state;

	look_once(stage);
	kiosk_says(stage, MESSAGE_TRUST_TUF); /* begins a round at once */
	answer("tuf/timestamp.json", "T");
	poll_work(stage->poll);
	CHECK(server.count == 4);
	expect_passed(stage, "timestamp0:T ");
	next_round(stage);
	CHECK(!asked(0)->etag[0]);
	answer("tuf/timestamp.json", "T"); /* the same again is passed on too */
	expect_passed(stage, "timestamp0:T ");
	next_round(stage);
	answer("tuf/timestamp.json", "");
	CHECK(strcmp(stage->refusal.what, "tuf/timestamp.json") == 0);
	expect_passed(stage, "");
	kiosk_says(stage, 1); /* another kiosk */
	answer("root/2.json", "");
	answer("timestamp.json", "T");
	answer("release.json", "R");
	expect_passed(stage, "timestamp0:T release0:R ");
}

#define STAGED(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		STAGED(says_new_roots_first_and_the_other_two_always),
		STAGED(follows_several_roots_in_one_round),
		STAGED(asks_for_the_next_root_until_the_kiosk_has_it),
		STAGED(says_what_was_refused_once_and_goes_on),
		STAGED(begins_a_round_when_the_kiosk_has_another_root),
		STAGED(says_a_release_again_under_its_timestamp_unless_it_is_gone),
		STAGED(says_all_again_when_asked),
		STAGED(tries_again_after_pauses_when_the_server_is_away),
		STAGED(refuses_endless_data),
		STAGED(brings_the_timestamp_alone_to_a_kiosk_that_follows_tuf),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
