#include "app/release/updater.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/release/state_writer.h"
#include "app/release/trust.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/safe_open.h"

/* Of a release; root zero: none. */
struct place {
	struct hash root;
	uint32_t root_bytes;
	uint64_t sequence;
};

struct follow {
	struct follow_options options;
	struct keeper *keeper; /* of the state */
	struct update update;
	struct place shown, before; /* remembered; the one that worked before it */
	bool on_trial;              /* shown was not seen to work yet */
	struct buffer shown_file;   /* its release.json; empty: not known */
	uint64_t writing;           /* sequence that the keeper was asked to write last; 0: done */
	const char *said; /* of a refusal, in the log; static; "": none since a good release */
	struct refusal refusal;
	bool stamp_refused;  /* the last timestamp.json was: a refused release.json is a consequence
			      */
	struct release next; /* brought now; sequence 0: none */
	struct buffer next_file; /* its release.json */
	enum meta_source next_source;
};

/* The trust root in use: what the state remembers, or the pinned file at the first start. */
static int find_trust(struct follow *follow, struct state *state)
{
	struct buffer pinned;
	struct bytes file;
	const char *why = "";
	int rc = state_trust(state, &file);

	if (rc == 0) {
		rc = update_pin(&follow->update, file, &why);
		if (rc == 0)
			return 0;
		log_error("app", "the remembered trust root: %s", why);
	}
	if (!follow->options.trust_path) {
		log_warn("app", "no trust root yet: updates need --trust root/1.json once");
		return 0;
	}
	buffer_init(&pinned, METADATA_FILE_BYTES_MOST);
	rc = buffer_read_foreign(&pinned, follow->options.trust_path);
	if (rc < 0)
		why = open_problem(rc);
	else
		rc = update_pin(&follow->update, buffer_bytes(&pinned), &why);
	if (rc == 0 && state_set_trust(state, buffer_bytes(&pinned), STATE_CLEAR_NOTHING) < 0)
		log_warn("app", "the trust root could not be remembered");
	if (rc < 0)
		log_error("app", "%s: %s", follow->options.trust_path, why);
	buffer_finish(&pinned);
	return rc;
}

static void note(struct follow *follow, uint64_t sequence, const char *why)
{
	char what[32];

	snprintf(what, sizeof(what), "release %llu", (unsigned long long)sequence);
	refusal_note(&follow->refusal, what, why);
	log_warn("app", "refused %s: %s", what, why);
}

static struct place place_of(const struct state_release *release)
{
	return (struct place){ release->root, release->root_bytes, release->sequence };
}

/* A release on trial that was begun so often and never got to a picture does not work here. Else
 * this is one more try, written down before it begins: what follows may be a crash. */
static void judge_trial(struct follow *follow, struct state *state)
{
	struct state_release release;

	if (state_tries(state) == 0 || state_release(state, &release) < 0)
		return;
	if (state_tries(state) < STATE_TRIES_MOST) {
		if (state_try(state) < 0)
			log_warn("app", "a try of a new release could not be remembered");
	} else if (state_fall_back(state) == 0) {
		note(follow, release.sequence,
		     "it was started three times and never got to a picture");
	}
}

/* What the state says, before the keeper has it. */
static int read_state(struct follow *follow, struct state *state)
{
	struct state_release release;

	judge_trial(follow, state);
	follow->update.sequence_floor = state_sequence_floor(state);
	follow->update.time_floor_s = state_time_floor_s(state);
	if (state_release(state, &release) == 0) {
		follow->shown = place_of(&release);
		buffer_put(&follow->shown_file, release.file.data, release.file.size);
	}
	if (state_previous(state, &release) == 0)
		follow->before = place_of(&release);
	follow->on_trial = state_tries(state) > 0;
	if (follow->on_trial)
		log_info("app", "release %llu is on trial, start %u of %d",
			 (unsigned long long)follow->shown.sequence, state_tries(state),
			 STATE_TRIES_MOST);
	return find_trust(follow, state);
}

int follow_create(struct follow **out, const struct follow_options *options)
{
	struct follow *follow = calloc(1, sizeof(*follow));
	struct state *state = NULL;
	int rc;

	*out = NULL;
	if (!follow)
		return -ENOMEM;
	follow->options = *options;
	follow->said = "";
	buffer_init(&follow->next_file, METADATA_FILE_BYTES_MOST);
	buffer_init(&follow->shown_file, METADATA_FILE_BYTES_MOST);
	rc = state_create(&state, options->state_path);
	if (rc == 0)
		rc = read_state(follow, state);
	if (rc == 0)
		rc = keeper_create(&follow->keeper, state);
	else
		state_destroy(state);
	follow->options.state_path = follow->options.trust_path = NULL; /* borrowed */
	if (rc < 0) {
		follow_destroy(follow);
		return rc;
	}
	*out = follow;
	return 0;
}

void follow_destroy(struct follow *follow)
{
	if (!follow)
		return;
	keeper_destroy(follow->keeper);
	buffer_finish(&follow->next_file);
	buffer_finish(&follow->shown_file);
	free(follow);
}

void follow_start(struct follow *follow)
{
	if (hash_is_zero(follow->shown.root))
		return;
	log_info("app", "release %llu is remembered", (unsigned long long)follow->shown.sequence);
	follow->options.begin(follow->options.data, follow->shown.root, follow->shown.root_bytes);
}

/* The later of clock and floor; 0 where the clock is not known to be set. */
static struct update_time time_now(const struct follow *follow)
{
	const int64_t now_s = clock_wall_s(), floor_s = follow->update.time_floor_s;

	if (!clock_wall_is_set())
		return (struct update_time){ 0 };
	return (struct update_time){ now_s > floor_s ? now_s : floor_s };
}

static void begin_next(struct follow *follow, const struct release *release, struct bytes file,
		       enum meta_source source)
{
	if (follow->next.sequence == release->sequence) {
		if (source == META_FROM_STICK)
			follow->next_source = source;
		return; /* it is on its way */
	}
	buffer_clear(&follow->next_file);
	buffer_put(&follow->next_file, file.data, file.size);
	if (follow->next_file.error)
		return;
	follow->next = *release;
	follow->next_source = source;
	log_info("app", "release %llu is %s%s%s", (unsigned long long)release->sequence,
		 source == META_FROM_STICK ? "on the stick" : "published",
		 release->comment[0] ? ": " : "", release->comment);
	/* The same pictures under a new signature: nothing to bring, and what was coming is not
	 * wanted any more. */
	if (hash_equal(follow->shown.root, release->root))
		follow_remember(follow, release->root);
	follow->options.begin(follow->options.data, release->root, release->root_bytes);
}

/* What was being brought was signed by a key that is trusted no more: back to what is shown. */
static void drop_distrusted(struct follow *follow)
{
	struct release release;
	const char *why = "";

	if (follow->next.sequence == 0 ||
	    release_decode(&release, &follow->update.trust, buffer_bytes(&follow->next_file),
			   &why) == 0)
		return;
	note(follow, follow->next.sequence, why);
	follow->next = (struct release){ 0 };
	if (!hash_is_zero(follow->shown.root))
		follow->options.begin(follow->options.data, follow->shown.root,
				      follow->shown.root_bytes);
}

/* Root N+1. What was trusted under the keys that it takes away goes with them, in memory and, in
 * one change with the root, on disk; what is shown stays. */
static int take_root(struct follow *follow, struct bytes bytes, const char **why)
{
	const uint64_t sequence_floor = follow->update.sequence_floor;
	const int64_t time_floor_s = follow->update.time_floor_s;
	enum state_clear clear = STATE_CLEAR_NOTHING;
	int rc = update_root(&follow->update, bytes, buffer_bytes(&follow->shown_file), why);

	if (rc < 0)
		return rc;
	if (follow->update.sequence_floor < sequence_floor)
		clear |= STATE_CLEAR_SEQUENCE_FLOOR;
	if (follow->update.time_floor_s < time_floor_s)
		clear |= STATE_CLEAR_TIME_FLOOR;
	if (clear != STATE_CLEAR_NOTHING)
		log_info("app", "root %u takes keys away: what they had set is cleared",
			 follow->update.trust.version);
	if (keeper_set_trust(follow->keeper, bytes, clear) < 0)
		log_warn("app", "the new trust root could not be remembered");
	drop_distrusted(follow);
	return 0;
}

void follow_meta(struct follow *follow, enum meta_role role, uint32_t version, struct bytes bytes,
		 enum meta_source source)
{
	static const char *const names[][3] = {
		[META_FROM_SERVER] = { "root", "release.json", "timestamp.json" },
		[META_FROM_STICK] = { "root of the stick", "release.json of the stick",
				      "timestamp.json of the stick" },
	};
	const char *const name = names[source][role];
	const struct update_time time = time_now(follow);
	const int64_t time_floor_s = follow->update.time_floor_s;
	struct release release;
	const char *why = "";
	int rc = 0;

	switch (role) {
	case META_ROOT:
		if (version != follow->update.trust.version + 1)
			return; /* known already, or not to be judged yet */
		if (follow->writing)
			return; /* asked for again; what is written now may be an old key's */
		rc = take_root(follow, bytes, &why);
		break;
	case META_TIMESTAMP:
		rc = update_timestamp(&follow->update, bytes, time, &why);
		if (follow->update.time_floor_s > time_floor_s)
			keeper_raise_time_floor(follow->keeper, follow->update.time_floor_s);
		break;
	case META_RELEASE:
		rc = update_release(&follow->update, bytes, time, &release, &why);
		if (rc > 0)
			begin_next(follow, &release, bytes, source);
		break;
	}
	if (rc < 0 && !(role == META_RELEASE && follow->stamp_refused)) {
		if (why != follow->said) /* it will be the same in a minute */
			log_warn("app", "refused %s: %s", name, why);
		follow->said = why;
		refusal_note(&follow->refusal, name, why);
	}
	if (role == META_TIMESTAMP)
		follow->stamp_refused = rc < 0;
	if (rc >= 0 && role == META_RELEASE)
		follow->said = "";
}

uint32_t follow_root_version(const struct follow *follow)
{
	return follow->update.trusted ? follow->update.trust.version : 0;
}

void follow_remember(struct follow *follow, struct hash root)
{
	const struct state_release release = {
		.root = follow->next.root,
		.root_bytes = follow->next.root_bytes,
		.sequence = follow->next.sequence,
		.file = buffer_bytes(&follow->next_file),
	};
	int rc;

	if (release.sequence == 0 || !hash_equal(release.root, root)) {
		follow->options.remembered(follow->options.data, root, 0); /* it is already */
		return;
	}
	rc = keeper_activate(follow->keeper, &release);
	if (rc < 0)
		follow->options.remembered(follow->options.data, root, rc);
	else
		follow->writing = release.sequence;
}

uint64_t follow_sequence(const struct follow *follow)
{
	/* The floor may have been cleared since. */
	return follow->update.sequence_floor > 0 ? follow->update.sequence_floor
						 : follow->shown.sequence;
}

const struct refusal *follow_refusal(const struct follow *follow)
{
	return &follow->refusal;
}

int follow_fd(const struct follow *follow)
{
	return keeper_fd(follow->keeper);
}

/* As state_activate has it. */
static void take_answer(struct follow *follow, const struct keeper_answer *answer)
{
	if (!hash_equal(follow->shown.root, answer->root)) {
		if (!follow->on_trial)
			follow->before = follow->shown;
		follow->on_trial = true;
	}
	follow->shown = (struct place){ answer->root, answer->root_bytes, answer->sequence };
	buffer_clear(&follow->shown_file);
	if (follow->next.sequence == answer->sequence) {
		buffer_put(&follow->shown_file, follow->next_file.data, follow->next_file.size);
		follow->next = (struct release){ 0 };
	}
}

bool follow_next_on_stick(const struct follow *follow)
{
	return follow->next.sequence > 0 && follow->next_source == META_FROM_STICK;
}

bool follow_on_trial(const struct follow *follow)
{
	return follow->on_trial;
}

bool follow_has_before(const struct follow *follow)
{
	return !hash_is_zero(follow->before.root);
}

void follow_prove(struct follow *follow)
{
	if (!follow->on_trial)
		return;
	follow->on_trial = false;
	keeper_prove(follow->keeper);
}

void follow_fall_back(struct follow *follow, const char *why)
{
	if (!follow->on_trial || !follow_has_before(follow))
		return;
	note(follow, follow->shown.sequence, why);
	follow->shown = follow->before;
	buffer_clear(&follow->shown_file);
	follow->before = (struct place){ 0 };
	follow->on_trial = false;
	follow->next = (struct release){ 0 }; /* it gives way */
	keeper_fall_back(follow->keeper);
	follow->options.begin(follow->options.data, follow->shown.root, follow->shown.root_bytes);
}

void follow_refuse(struct follow *follow, struct hash root, const char *why)
{
	if (hash_equal(follow->next.root, root))
		note(follow, follow->next.sequence, why);
}

int follow_dispatch(struct follow *follow)
{
	struct keeper_answer answer;

	if (!keeper_take(follow->keeper, &answer))
		return 0;
	if (answer.sequence == follow->writing)
		follow->writing = 0;
	if (answer.rc < 0) {
		log_error("app", "release %llu could not be remembered: %s",
			  (unsigned long long)answer.sequence, strerror(-answer.rc));
	} else {
		take_answer(follow, &answer);
		update_accept(&follow->update, answer.sequence);
		log_info("app", "release %llu is shown", (unsigned long long)answer.sequence);
	}
	follow->options.remembered(follow->options.data, answer.root, answer.rc);
	return 0;
}
