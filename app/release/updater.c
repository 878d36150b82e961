/* Follows releases: checks the metadata that arrives, starts loading a newer release, has it
 * written to state.db, and goes back to the release before it when it does not work. */
#include "app/release/updater.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/release/state_writer.h"
#include "app/release/trust.h"
#include "app/release/tuf_follower.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/safe_open.h"

/* A release; root zero: none. */
struct place {
	struct hash root;
	uint32_t root_bytes;
	uint64_t sequence;
};

struct updater {
	struct updater_options options;
	struct state_writer *writer; /* writes the state */
	struct trust trust;
	struct place shown, before; /* the stored release; the one that worked before it */
	bool on_trial;              /* shown is not yet known to work */
	struct buffer shown_file;   /* release.json of shown; empty: not known */
	uint64_t writing; /* sequence that the state writer was asked to store last; 0: stored */
	char said[METRICS_REFUSAL_WHY_BYTES]; /* reason logged last; "": none since an accepted
						 release */
	struct metrics_refusal refusal;
	bool stamp_refused;      /* timestamp.json was: a refused release.json follows from it */
	struct release next;     /* being loaded; sequence 0: none */
	struct buffer next_file; /* release.json of next */
	enum meta_source next_source;
	struct tuf_follower tuf;
};

/* Trusts the root that was given by hand, of either form, and stores it. */
static int pin(struct updater *updater, struct state *state, struct bytes file, const char **why)
{
	int rc = trust_pin(&updater->trust, file, why), stored;

	if (rc == 0) {
		stored = state_set_trust(state, file, STATE_CLEAR_NOTHING);
	} else if (tuf_follower_pin(&updater->tuf, file, NULL) == 0) {
		const struct state_tuf kept = tuf_follower_kept(&updater->tuf);

		rc = 0;
		stored = state_set_tuf(state, &kept, STATE_CLEAR_NOTHING);
		updater->tuf.changed = false;
	} else {
		return rc;
	}
	if (stored < 0)
		log_warn("app", "the trust root could not be stored");
	return rc;
}

/* Finds the trust root: the stored one, or the file given at the first start, which is then stored.
 * Returns 0 also if there is none. */
static int find_trust(struct updater *updater, struct state *state)
{
	struct buffer pinned;
	struct bytes file;
	const char *why = "";
	int rc = state_trust(state, &file);

	if (tuf_follower_is_on(&updater->tuf))
		return 0;
	if (rc == 0) {
		rc = trust_pin(&updater->trust, file, &why);
		if (rc == 0)
			return 0;
		log_error("app", "the stored trust root: %s", why);
	}
	if (!updater->options.trust_path) {
		log_warn(
			"app",
			"no trust root is stored, so no release is accepted; start once with --trust root/1.json");
		return 0;
	}
	buffer_init(&pinned, METADATA_FILE_BYTES_MAX);
	rc = buffer_read_foreign(&pinned, updater->options.trust_path);
	if (rc < 0)
		why = open_problem(rc);
	else
		rc = pin(updater, state, buffer_bytes(&pinned), &why);
	if (rc < 0)
		log_error("app", "%s: %s", updater->options.trust_path, why);
	buffer_finish(&pinned);
	return rc;
}

static void note(struct updater *updater, uint64_t sequence, const char *why)
{
	char what[32];

	snprintf(what, sizeof(what), "release %llu", (unsigned long long)sequence);
	metrics_refusal_note(&updater->refusal, what, why);
	log_warn("app", "refused %s: %s", what, why);
}

static struct place place_of(const struct state_release *release)
{
	return (struct place){ release->root, release->root_bytes, release->sequence };
}

/* Decides about a release on trial at start. If it was started STATE_TRIES_MAX times without
 * success, falls back to the release before it. Otherwise this start is one more try, which is
 * stored before it begins, because it may end in a crash. */
static void judge_trial(struct updater *updater, struct state *state)
{
	struct state_release release;

	if (state_tries(state) == 0 || state_release(state, &release) < 0)
		return;
	if (state_tries(state) < STATE_TRIES_MAX) {
		if (state_try(state) < 0)
			log_warn("app", "the start of a release on trial could not be counted");
	} else if (state_fall_back(state) == 0) {
		note(updater, release.sequence,
		     "it was started three times and never showed a picture");
	}
}

/* Reads the state, before the state writer takes it over. */
static int read_state(struct updater *updater, struct state *state)
{
	struct state_release release;
	struct state_tuf tuf = { 0 };
	int rc;

	if (state_tuf(state, &tuf) < 0)
		tuf = (struct state_tuf){ 0 };
	rc = tuf_follower_init(&updater->tuf, &tuf, updater->options.target);
	if (rc < 0)
		return rc;
	judge_trial(updater, state);
	updater->trust.sequence_floor = state_sequence_floor(state);
	updater->trust.time_floor_s = state_time_floor_s(state);
	if (state_release(state, &release) == 0) {
		updater->shown = place_of(&release);
		buffer_put(&updater->shown_file, release.file.data, release.file.size);
		if (updater->shown_file.error)
			return updater->shown_file.error; /* a root would clear its floor */
	}
	if (state_previous(state, &release) == 0)
		updater->before = place_of(&release);
	updater->on_trial = state_tries(state) > 0;
	if (updater->on_trial)
		log_info("app", "release %llu is on trial, start %u of %d",
			 (unsigned long long)updater->shown.sequence, state_tries(state),
			 STATE_TRIES_MAX);
	return find_trust(updater, state);
}

int updater_create(struct updater **out, const struct updater_options *options)
{
	struct updater *updater = calloc(1, sizeof(*updater));
	struct state *state = NULL;
	int rc;

	*out = NULL;
	if (!updater)
		return -ENOMEM;
	updater->options = *options;
	buffer_init(&updater->next_file, METADATA_FILE_BYTES_MAX);
	buffer_init(&updater->shown_file, METADATA_FILE_BYTES_MAX);
	rc = state_create(&state, options->state_path);
	if (rc == 0)
		rc = read_state(updater, state);
	if (rc == 0)
		rc = state_writer_create(&updater->writer, state);
	else
		state_destroy(state);
	updater->options.state_path = updater->options.trust_path = NULL; /* borrowed */
	updater->options.target = NULL;
	if (rc < 0) {
		updater_destroy(updater);
		return rc;
	}
	*out = updater;
	return 0;
}

void updater_destroy(struct updater *updater)
{
	if (!updater)
		return;
	state_writer_destroy(updater->writer);
	tuf_follower_finish(&updater->tuf);
	buffer_finish(&updater->next_file);
	buffer_finish(&updater->shown_file);
	free(updater);
}

void updater_start(struct updater *updater)
{
	if (hash_is_zero(updater->shown.root))
		return;
	log_info("app", "release %llu is stored in the state",
		 (unsigned long long)updater->shown.sequence);
	updater->options.begin(updater->options.data, updater->shown.root,
			       updater->shown.root_bytes);
}

static struct trust_time time_now(void)
{
	return (struct trust_time){ clock_wall_is_set() ? clock_wall_s() : 0 };
}

static void begin_next(struct updater *updater, const struct release *release, struct bytes file,
		       enum meta_source source)
{
	if (updater->next.sequence == release->sequence) {
		if (source == META_FROM_STICK)
			updater->next_source = source;
		return; /* it is being loaded already */
	}
	buffer_clear(&updater->next_file);
	buffer_put(&updater->next_file, file.data, file.size);
	if (updater->next_file.error)
		return;
	updater->next = *release;
	updater->next_source = source;
	log_info("app", "release %llu is %s%s%s", (unsigned long long)release->sequence,
		 source == META_FROM_STICK ? "on the stick" : "published",
		 release->comment[0] ? ": " : "", release->comment);
	/* If the new release has the same root, there is nothing to load: it is stored, and what
	 * was loading is dropped. */
	if (hash_equal(updater->shown.root, release->root))
		updater_remember(updater, release->root);
	updater->options.begin(updater->options.data, release->root, release->root_bytes);
}

/* Drops the release being loaded and returns to the one that is shown. */
static void drop_next(struct updater *updater, const char *why)
{
	note(updater, updater->next.sequence, why);
	updater->next = (struct release){ 0 };
	if (!hash_is_zero(updater->shown.root))
		updater->options.begin(updater->options.data, updater->shown.root,
				       updater->shown.root_bytes);
}

/* Drops the release being loaded if a key that signed it is no longer trusted. */
static void drop_distrusted(struct updater *updater)
{
	struct release release;
	const char *why = "";

	if (updater->next.sequence == 0 ||
	    release_decode(&release, &updater->trust.root, buffer_bytes(&updater->next_file),
			   &why) == 0)
		return;
	drop_next(updater, why);
}

/* Accepts root N+1. What the withdrawn keys had set is cleared, in memory and, in one transaction
 * with the root, on disk. The release that is shown stays. */
static int take_root(struct updater *updater, struct bytes bytes, const char **why)
{
	const uint64_t sequence_floor = updater->trust.sequence_floor;
	const int64_t time_floor_s = updater->trust.time_floor_s;
	enum state_clear clear = STATE_CLEAR_NOTHING;
	int rc = trust_root(&updater->trust, bytes, buffer_bytes(&updater->shown_file), why);

	if (rc < 0)
		return rc;
	if (updater->trust.sequence_floor < sequence_floor)
		clear |= STATE_CLEAR_SEQUENCE_FLOOR;
	if (updater->trust.time_floor_s < time_floor_s)
		clear |= STATE_CLEAR_TIME_FLOOR;
	if (clear != STATE_CLEAR_NOTHING)
		log_info("app", "root %u revokes keys; the limits that they set are cleared",
			 updater->trust.root.version);
	if (state_writer_set_trust(updater->writer, bytes, clear) < 0)
		log_warn("app", "the new trust root could not be stored");
	drop_distrusted(updater);
	return 0;
}

/* Counts a refusal, and logs it unless it is the one that was logged last. why: "" if rc says it.
 */
static void refuse(struct updater *updater, const char *name, int rc, const char *why)
{
	if (*why == '\0')
		why = strerror(-rc);
	if (strncmp(why, updater->said, sizeof(updater->said) - 1) != 0)
		log_warn("app", "refused %s: %s", name, why);
	snprintf(updater->said, sizeof(updater->said), "%s", why);
	metrics_refusal_note(&updater->refusal, name, why);
}

/* ---- The Update Framework: docs/tuf.md, On the terminal */

/* Has what the follower changed written, and forgets what withdrawn keys had set. */
static void store_tuf(struct updater *updater)
{
	struct tuf_follower *tuf = &updater->tuf;
	const struct state_tuf kept = tuf_follower_kept(tuf);
	const enum state_clear clear = tuf->clear;

	if (!tuf->changed)
		return;
	if (clear & STATE_CLEAR_SEQUENCE_FLOOR)
		updater->trust.sequence_floor = 0;
	if (clear & STATE_CLEAR_TIME_FLOOR)
		updater->trust.time_floor_s = 0;
	if (clear != STATE_CLEAR_NOTHING)
		log_info("app", "root %u revokes keys; the limits that they set are cleared",
			 tuf->version[TUF_ROOT]);
	if (state_writer_set_tuf(updater->writer, &kept, clear) < 0)
		log_warn("app", "the trusted metadata could not be stored");
	tuf->changed = false;
	tuf->clear = STATE_CLEAR_NOTHING;
	if (clear != STATE_CLEAR_NOTHING && updater->next.sequence > 0)
		drop_next(updater, "a key that signed it is no longer trusted");
}

/* Runs the workflow as far as the files that are here go. */
static void follow_tuf(struct updater *updater, enum meta_source source)
{
	const char *const name = source == META_FROM_STICK ? "tuf of the stick" : "tuf";
	const struct bytes known[2] = { buffer_bytes(&updater->shown_file),
					updater->next.sequence > 0
						? buffer_bytes(&updater->next_file)
						: (struct bytes){ NULL, 0 } };
	const struct trust_time time = time_now();
	const char *why = updater->tuf.why;
	struct release release;
	struct buffer file;
	int rc;

	if (updater->writing)
		return; /* as for a root in updater_meta; the next timestamp runs it again */
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	rc = tuf_follower_run(&updater->tuf, source, trust_now_s(&updater->trust, time), known,
			      &file);
	store_tuf(updater);
	if (trust_raise_time_floor(&updater->trust, updater->tuf.issued_s, time))
		state_writer_raise_time_floor(updater->writer, updater->trust.time_floor_s);
	if (rc == -EAGAIN) {
		updater->options.ask(updater->options.data, &updater->tuf.ask);
		buffer_finish(&file);
		return;
	}
	if (rc == 0) {
		rc = trust_target(&updater->trust, buffer_bytes(&file), time, &release, &why);
		if (rc > 0)
			begin_next(updater, &release, buffer_bytes(&file), source);
	}
	if (rc < 0)
		refuse(updater, name, rc, why);
	else
		updater->said[0] = '\0';
	buffer_finish(&file);
}

/* Handles a root of The Update Framework that was asked for because of a release. */
static void go_over(struct updater *updater, const struct message_file *file)
{
	struct tuf_follower *tuf = &updater->tuf;
	char name[64];
	const int rc = tuf_follower_first(tuf, file, &updater->trust.root);

	if (rc == 0) {
		log_info("app",
			 "root %u of The Update Framework is trusted from now on, and the earlier "
			 "form no more",
			 tuf->version[TUF_ROOT]);
		store_tuf(updater);
	} else if (rc == -EAGAIN) {
		updater->options.ask(updater->options.data, &tuf->ask);
	} else if (rc != -ENOKEY) {
		snprintf(name, sizeof(name), "tuf/%.32s", file->name);
		refuse(updater, name, rc, tuf->why);
	}
}

void updater_file(struct updater *updater, const struct message_file *file)
{
	if (!tuf_follower_is_on(&updater->tuf)) {
		go_over(updater, file);
		return;
	}
	tuf_follower_add(&updater->tuf, file);
	follow_tuf(updater, file->source);
}

/* ---- the earlier form */

void updater_meta(struct updater *updater, enum meta_role role, uint32_t version,
		  struct bytes bytes, enum meta_source source)
{
	static const char *const names[][3] = {
		[META_FROM_SERVER] = { "root", "release.json", "timestamp.json" },
		[META_FROM_STICK] = { "root of the stick", "release.json of the stick",
				      "timestamp.json of the stick" },
	};
	const char *const name = names[source][role];
	const struct trust_time time = time_now();
	const int64_t time_floor_s = updater->trust.time_floor_s;
	struct release release;
	const char *why = "";
	int rc = 0;

	if (tuf_follower_is_on(&updater->tuf)) {
		if (role == META_TIMESTAMP && updater->options.ask) {
			tuf_follower_begin(&updater->tuf, source, bytes);
			follow_tuf(updater, source);
		}
		return;
	}
	switch (role) {
	case META_ROOT:
		if (version != updater->trust.root.version + 1)
			return; /* already known, or an earlier one is missing */
		if (updater->writing)
			return; /* the fetcher will be asked again; the release being stored may be
				   an old key's */
		rc = take_root(updater, bytes, &why);
		break;
	case META_TIMESTAMP:
		rc = trust_timestamp(&updater->trust, bytes, time, &why);
		if (updater->trust.time_floor_s > time_floor_s)
			state_writer_raise_time_floor(updater->writer, updater->trust.time_floor_s);
		break;
	case META_RELEASE:
		rc = trust_release(&updater->trust, bytes, time, &release, &why);
		if (rc > 0)
			begin_next(updater, &release, bytes, source);
		if (rc >= 0 && updater->options.ask &&
		    tuf_follower_begin_first(&updater->tuf, release.tuf_root, source))
			updater->options.ask(updater->options.data, &updater->tuf.ask);
		else if (rc >= 0)
			updater->said[0] = '\0'; /* not above: it may be of that root, which is
						     refused again in each round */
		break;
	}
	if (rc < 0 && !(role == META_RELEASE && updater->stamp_refused))
		refuse(updater, name, rc, why);
	if (role == META_TIMESTAMP)
		updater->stamp_refused = rc < 0;
}

uint32_t updater_root_version(const struct updater *updater)
{
	if (tuf_follower_is_on(&updater->tuf))
		return MESSAGE_TRUST_TUF;
	return updater->trust.trusted ? updater->trust.root.version : 0;
}

void updater_remember(struct updater *updater, struct hash root)
{
	const struct state_release release = {
		.root = updater->next.root,
		.root_bytes = updater->next.root_bytes,
		.sequence = updater->next.sequence,
		.file = buffer_bytes(&updater->next_file),
	};
	int rc;

	if (release.sequence == 0 || !hash_equal(release.root, root)) {
		updater->options.remembered(updater->options.data, root, 0); /* stored already */
		return;
	}
	rc = state_writer_activate(updater->writer, &release);
	if (rc < 0)
		updater->options.remembered(updater->options.data, root, rc);
	else
		updater->writing = release.sequence;
}

uint64_t updater_sequence(const struct updater *updater)
{
	/* The floor may have been cleared by a new root. */
	return updater->trust.sequence_floor > 0 ? updater->trust.sequence_floor
						 : updater->shown.sequence;
}

static int64_t earlier(int64_t a, int64_t b)
{
	return a == 0 || (b > 0 && b < a) ? b : a;
}

void updater_trust(const struct updater *updater, struct updater_trust *out)
{
	const struct tuf_follower *tuf = &updater->tuf;
	const struct trust *trust = &updater->trust;
	struct release release;

	*out = (struct updater_trust){ .tuf = tuf_follower_is_on(tuf) };
	if (release_decode_target(&release, buffer_bytes(&updater->shown_file), NULL) == 0)
		out->release_expires_s = release.expires_s;
	if (out->tuf) {
		out->root_version = tuf->version[TUF_ROOT];
		out->timestamp_version = tuf->version[TUF_TIMESTAMP];
		out->root_expires_s = tuf->expires_s[TUF_ROOT];
		out->timestamp_expires_s = tuf->expires_s[TUF_TIMESTAMP];
		out->release_expires_s =
			earlier(out->release_expires_s,
				earlier(tuf->expires_s[TUF_SNAPSHOT], tuf->expires_s[TUF_TARGETS]));
		return;
	}
	if (trust->trusted) {
		out->root_version = trust->root.version;
		out->root_expires_s = trust->root.expires_s;
	}
	if (trust->have_timestamp)
		out->timestamp_expires_s = trust->timestamp.expires_s;
}

const struct metrics_refusal *updater_refusal(const struct updater *updater)
{
	return &updater->refusal;
}

int updater_fd(const struct updater *updater)
{
	return state_writer_fd(updater->writer);
}

/* Updates shown, before and on_trial as state_activate does in the state. */
static void take_answer(struct updater *updater, const struct state_writer_answer *answer)
{
	if (!hash_equal(updater->shown.root, answer->root)) {
		if (!updater->on_trial)
			updater->before = updater->shown;
		updater->on_trial = true;
	}
	updater->shown = (struct place){ answer->root, answer->root_bytes, answer->sequence };
	buffer_clear(&updater->shown_file);
	if (updater->next.sequence == answer->sequence) {
		buffer_put(&updater->shown_file, updater->next_file.data, updater->next_file.size);
		updater->next = (struct release){ 0 };
	}
}

bool updater_next_on_stick(const struct updater *updater)
{
	return updater->next.sequence > 0 && updater->next_source == META_FROM_STICK;
}

bool updater_on_trial(const struct updater *updater)
{
	return updater->on_trial;
}

bool updater_has_before(const struct updater *updater)
{
	return !hash_is_zero(updater->before.root);
}

void updater_prove(struct updater *updater)
{
	if (!updater->on_trial)
		return;
	updater->on_trial = false;
	state_writer_prove(updater->writer);
}

void updater_fall_back(struct updater *updater, const char *why)
{
	if (!updater->on_trial || !updater_has_before(updater))
		return;
	note(updater, updater->shown.sequence, why);
	updater->shown = updater->before;
	buffer_clear(&updater->shown_file);
	updater->before = (struct place){ 0 };
	updater->on_trial = false;
	updater->next = (struct release){ 0 }; /* the fallback replaces it */
	state_writer_fall_back(updater->writer);
	updater->options.begin(updater->options.data, updater->shown.root,
			       updater->shown.root_bytes);
}

void updater_refuse(struct updater *updater, struct hash root, const char *why)
{
	if (hash_equal(updater->next.root, root))
		note(updater, updater->next.sequence, why);
}

int updater_dispatch(struct updater *updater)
{
	struct state_writer_answer answer;

	if (!state_writer_take(updater->writer, &answer))
		return 0;
	if (answer.sequence == updater->writing)
		updater->writing = 0;
	if (answer.rc < 0) {
		log_error("app", "release %llu could not be stored: %s",
			  (unsigned long long)answer.sequence, strerror(-answer.rc));
	} else {
		take_answer(updater, &answer);
		trust_accept(&updater->trust, answer.sequence);
		log_info("app", "release %llu is shown", (unsigned long long)answer.sequence);
	}
	updater->options.remembered(updater->options.data, answer.root, answer.rc);
	return 0;
}
