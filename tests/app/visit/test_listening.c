/* Listening to a page, with a speaker that the test moves on. */
#include "app/visit/listening.h"

#include <errno.h>

#include "tests/app/visit/visit_fixture.h"
#include "ui/overlay_state.h"

static struct {
	struct speaker_state state;
	size_t bytes; /* of the text that was begun last */
	int starts, stops;
} fake;

int speaker_create(struct speaker **out, uint32_t loudness)
{
	CHECK(loudness == 50);
	fake.starts = fake.stops = 0;
	fake.state = (struct speaker_state){ 0 };
	*out = (struct speaker *)&fake;
	return 0;
}

void speaker_destroy(struct speaker *speaker)
{
	(void)speaker;
}

int speaker_start(struct speaker *speaker, struct bytes opus)
{
	(void)speaker;
	fake.bytes = opus.size;
	fake.starts++;
	fake.state = (struct speaker_state){ .speaks = true };
	return 0;
}

void speaker_stop(struct speaker *speaker)
{
	(void)speaker;
	fake.stops++;
	fake.state = (struct speaker_state){ 0 };
}

struct speaker_state speaker_state(struct speaker *speaker)
{
	(void)speaker;
	return fake.state;
}

/* ---- a visit with a spoken page */

static struct buffer recording;

static void do_action(enum overlay_action_kind kind, int part)
{
	const struct overlay_action action = { .kind = kind, .part = part };

	actions_carry_out(&visit.actions, &action);
}

static int begin(void **state)
{
	int rc = begin_visit(state);

	buffer_init(&recording, 1 << 20);
	CHECK(buffer_read_file(&recording, "demo/content/pages/central-tower.en.opus") == 0);
	write_file("pages/tower.en.opus", recording.data, recording.size);
	write_text("pages/tower.en.vtt", "WEBVTT\n\n00:01.000 --> 00:02.000\nOne tower\n\n"
					 "00:02.500 --> 00:04.000\nof five.\n");
	write_file("pages/gate.en.opus", recording.data, recording.size);
	show_words();
	do_action(OVERLAY_OPEN_PAGE, 0);
	CHECK(overlay_page(words()) == 0);
	return rc;
}

static int end(void **state)
{
	buffer_finish(&recording);
	return end_visit(state);
}

static const struct page_view *page(void)
{
	return &words()->page;
}

/* What the kiosk asks the fetcher for arrives. */
static void arrive(void)
{
	CHECK(information_view_give(visit.shown.view, hash_of(buffer_bytes(&recording)),
				    buffer_bytes(&recording)));
	listening_turn(&visit.listening);
}

static bool wants_recording(void)
{
	struct message_want wants[8];
	const uint32_t count = information_view_wants(visit.shown.view, wants, ARRAY_COUNT(wants));
	bool found = false;

	for (uint32_t i = 0; i < count; i++)
		found |= hash_equal(wants[i].hash, hash_of(buffer_bytes(&recording)));
	return found;
}

static void listen(void)
{
	do_action(OVERLAY_LISTEN, 0);
	if (visit.listening.on && !visit.listening.speaks)
		arrive();
	CHECK(visit.listening.on && fake.state.speaks);
}

static void at(uint32_t ms)
{
	now_ms += 50;
	fake.state.at_ms = ms;
	visit.redraw.wanted = false;
	listening_turn(&visit.listening);
}

/* ---- claims */

static void asks_for_a_text_only_when_it_is_wanted(void **state)
{
	(void)state;
	CHECK(page()->is_spoken);
	CHECK(!wants_recording() && listening_wait_ms(&visit.listening) < 0);
	do_action(OVERLAY_LISTEN, 0);
	CHECK(wants_recording() && fake.starts == 0);
	CHECK(page()->spoken.fade.on); /* the strip shows that it was heard */
	arrive();
	CHECK(!wants_recording() && fake.starts == 1 && fake.bytes == recording.size);
	CHECK(listening_wait_ms(&visit.listening) > 0);
}

static void shows_the_words_that_are_said(void **state)
{
	(void)state;
	listen();
	at(500);
	CHECK(strcmp(page()->spoken.words, "") == 0);
	at(1000);
	CHECK(strcmp(page()->spoken.words, "One tower") == 0 && visit.redraw.wanted);
	at(1100);
	CHECK(!visit.redraw.wanted); /* nothing new */
	at(2200);
	CHECK(strcmp(page()->spoken.words, "") == 0);
	at(2500);
	CHECK(strcmp(page()->spoken.words, "of five.") == 0);
	CHECK(page()->spoken.share > 0.1f && page()->spoken.share < 0.13f);
	fake.state = (struct speaker_state){ 0 }; /* the end of the text */
	listening_turn(&visit.listening);
	CHECK(!visit.listening.on && !page()->spoken.fade.on && page()->is_spoken);
}

static void ends_by_its_button_or_any_other(void **state)
{
	static const enum overlay_action_kind others[] = { OVERLAY_LISTEN, OVERLAY_HOME,
							   OVERLAY_CLOSE_PAGE, OVERLAY_SEARCH,
							   OVERLAY_LARGE };

	(void)state;
	for (size_t n = 0; n < ARRAY_COUNT(others); n++) {
		do_action(OVERLAY_OPEN_PAGE, 0);
		listen();
		do_action(others[n], 0);
		CHECK(!visit.listening.on && !fake.state.speaks);
		CHECK(fake.stops == (int)n + 1);
	}
	do_action(OVERLAY_OPEN_PAGE, 0);
	listen();
	do_action(OVERLAY_SWALLOWED, 0); /* a tap beside the links of the page */
	CHECK(visit.listening.on);
}

static void ends_with_its_page(void **state)
{
	(void)state;
	listen();
	overlay_close_page(words()); /* as when the visitor leaves */
	listening_turn(&visit.listening);
	CHECK(!visit.listening.on && fake.stops == 1);
	do_action(OVERLAY_OPEN_PAGE, 0);
	listen();
	information_view_set_language(visit.shown.view, "km"); /* its page has no text */
	listening_turn(&visit.listening);
	CHECK(!visit.listening.on && !page()->is_spoken);
	information_view_set_language(visit.shown.view, "en");
	CHECK(page()->is_spoken);
	listen();
	listening_on_release(&visit.listening, NULL);
	CHECK(!visit.listening.on);
}

static void is_not_offered_where_nothing_can_be_heard(void **state)
{
	(void)state;
	listen();
	fake.state = (struct speaker_state){ .failed = true };
	listening_turn(&visit.listening);
	CHECK(!visit.listening.on && !page()->is_spoken);
	do_action(OVERLAY_OPEN_PAGE, 1); /* another page offers it anew: it may be plugged in */
	CHECK(page()->is_spoken);
}

static void touch(void)
{
	visitor_take_touch(&visit.visitor, &(struct touch_event){ .phase = TOUCH_DOWN });
	visitor_take_touch(&visit.visitor, &(struct touch_event){ .phase = TOUCH_UP });
}

/* Who cannot read does not see the question either. */
static void who_listens_is_not_asked(void **state)
{
	(void)state;
	touch();
	listen();
	for (int s = 0; s < 600; s++) {
		after(S);
		CHECK(visit.visitor.presence.state == PRESENCE_SOMEBODY);
	}
	fake.state = (struct speaker_state){ 0 };
	listening_turn(&visit.listening);
	after(179 * S);
	CHECK(visit.visitor.presence.state == PRESENCE_SOMEBODY);
	after(S);
	CHECK(visit.visitor.presence.state == PRESENCE_ASKED);
}

static void a_text_that_does_not_come_keeps_nobody(void **state)
{
	(void)state;
	touch();
	do_action(OVERLAY_LISTEN, 0);
	after(180 * S);
	CHECK(visit.visitor.presence.state == PRESENCE_ASKED);
}

#define LISTENED(test) cmocka_unit_test_setup_teardown(test, begin, end)

int main(void)
{
	const struct CMUnitTest tests[] = {
		LISTENED(asks_for_a_text_only_when_it_is_wanted),
		LISTENED(shows_the_words_that_are_said),
		LISTENED(ends_by_its_button_or_any_other),
		LISTENED(ends_with_its_page),
		LISTENED(is_not_offered_where_nothing_can_be_heard),
		LISTENED(who_listens_is_not_asked),
		LISTENED(a_text_that_does_not_come_keeps_nobody),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
