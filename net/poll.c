/* State machine that requests root, timestamp and release metadata in turn, and passes changed
 * files to the kiosk. It waits for the kiosk's verdict after a new root. */
#include "net/poll.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/log.h"

enum {
	ETAG_BYTES_MAX = 128,
	PATH_BYTES = 32,
	VERDICT_MS = 3000, /* how long the kiosk may take to accept or reject a root */
};

enum stage { STAGE_IDLE, STAGE_ROOT, STAGE_VERDICT, STAGE_TIMESTAMP, STAGE_RELEASE };

struct known {
	struct buffer file; /* empty: none yet */
	char etag[ETAG_BYTES_MAX];
};

struct poll {
	struct poll_options options;
	bool running;
	int64_t next_ms;
	uint32_t failures;
	bool logged_refusal; /* a missing or oversized file was logged */
	enum stage stage;
	struct http_request *request;
	struct buffer body;
	uint32_t root_version; /* version of the root that the kiosk has */
	struct known root; /* the server's candidate for the next root; nobody has checked it yet */
	int64_t verdict_ms; /* in STAGE_VERDICT: when to stop waiting for the kiosk */
	struct known timestamp, release;
};

int poll_create(struct poll **out, const struct poll_options *options)
{
	struct poll *poll = calloc(1, sizeof(*poll));

	*out = poll;
	if (!poll)
		return -ENOMEM;
	poll->options = *options;
	buffer_init(&poll->body, MESSAGE_META_BYTES_MAX);
	buffer_init(&poll->root.file, MESSAGE_META_BYTES_MAX);
	buffer_init(&poll->timestamp.file, MESSAGE_META_BYTES_MAX);
	buffer_init(&poll->release.file, MESSAGE_META_BYTES_MAX);
	return 0;
}

static void forget(struct known *known)
{
	buffer_finish(&known->file);
	known->etag[0] = '\0';
}

/* Ends the round and forgets all files, so that the next round requests them again. */
static void reset(struct poll *poll)
{
	if (poll->request) {
		http_cancel(poll->request);
		poll->options.link->in_flight--;
	}
	poll->request = NULL;
	poll->stage = STAGE_IDLE;
	poll->next_ms = 0;
	forget(&poll->root);
	forget(&poll->timestamp);
	forget(&poll->release);
}

void poll_stop(struct poll *poll)
{
	reset(poll);
	poll->running = false;
}

void poll_destroy(struct poll *poll)
{
	if (!poll)
		return;
	poll_stop(poll);
	buffer_finish(&poll->body);
	free(poll);
}

static void pass_on(struct poll *poll, enum meta_role role, uint32_t version,
		    const struct known *known)
{
	if (known->file.size)
		poll->options.meta(poll->options.data, role, version, buffer_bytes(&known->file));
}

void poll_start(struct poll *poll, uint32_t period_s)
{
	if (period_s)
		poll->options.period_s = period_s;
	pass_on(poll, META_ROOT, poll->root_version + 1, &poll->root);
	pass_on(poll, META_TIMESTAMP, 0, &poll->timestamp);
	pass_on(poll, META_RELEASE, 0, &poll->release);
	poll->running = true;
	if (poll->stage == STAGE_IDLE)
		poll->next_ms = 0;
}

void poll_trust(struct poll *poll, uint32_t root_version)
{
	if (root_version != poll->root_version) {
		reset(poll);
		poll->root_version = root_version;
	} else if (poll->stage == STAGE_VERDICT) {
		/* the root was rejected: poll_work continues with the other files */
		poll->verdict_ms = 0;
	}
}

static struct known *known_of_stage(struct poll *poll)
{
	switch (poll->stage) {
	case STAGE_ROOT:
		return &poll->root;
	case STAGE_TIMESTAMP:
		return &poll->timestamp;
	default:
		return &poll->release;
	}
}

static bool is_tuf(const struct poll *poll)
{
	return poll->root_version == MESSAGE_TRUST_TUF;
}

static const char *path_of_stage(const struct poll *poll, char out[PATH_BYTES])
{
	if (poll->stage == STAGE_ROOT)
		snprintf(out, PATH_BYTES, "root/%u.json", poll->root_version + 1);
	else
		snprintf(out, PATH_BYTES, "%s%s.json", is_tuf(poll) ? "tuf/" : "",
			 poll->stage == STAGE_RELEASE ? "release" : "timestamp");
	return out;
}

/* ---- answers */

static bool on_piece(void *data, struct bytes piece)
{
	struct poll *poll = data;

	buffer_put(&poll->body, piece.data, piece.size);
	return !poll->body.error;
}

/* Stores the body of an answer, and passes on a new root. */
static void take_body(struct poll *poll, const char *etag)
{
	struct known *known = known_of_stage(poll);
	bool same = bytes_equal(buffer_bytes(&known->file), buffer_bytes(&poll->body));

	/* Roots are requested without an ETag. An attacker who can forge an answer can also forge
	 * its ETag, and would make the server answer "not modified" for a root that we never
	 * received. */
	if (poll->stage != STAGE_ROOT && !is_tuf(poll))
		snprintf(known->etag, sizeof(known->etag), "%s", etag);
	if (same || poll->body.size == 0)
		return;
	buffer_clear(&known->file);
	buffer_put(&known->file, poll->body.data, poll->body.size);
	if (known->file.error)
		known->etag[0] = '\0'; /* "not modified" would leave us without it */
	if (poll->stage == STAGE_ROOT) {
		poll->stage = STAGE_VERDICT;
		poll->verdict_ms = clock_now_ms() + VERDICT_MS;
		pass_on(poll, META_ROOT, poll->root_version + 1, known);
	}
}

static void pause_round(struct poll *poll, int64_t pause_ms)
{
	poll->stage = STAGE_IDLE;
	poll->next_ms = clock_now_ms() + pause_ms;
}

static int64_t period_ms(const struct poll *poll)
{
	int64_t period = (int64_t)poll->options.period_s * 1000;

	return period - period / 10 + random() % (period / 5 + 1);
}

/* Logs only the first time, because the next round will fail in the same way. */
static void note_refusal(struct poll *poll, const char *path, const char *why)
{
	if (!poll->logged_refusal)
		log_warn("net", "content bug: cannot get %s: %s", path, why);
	poll->logged_refusal = true;
	metrics_refusal_note(poll->options.link->refusal, path, why);
}

static void request_file(struct poll *poll);

static void on_done(void *data, const struct http_result *result)
{
	struct poll *poll = data;
	int rc = result->rc ? result->rc : poll->body.error;
	char path[PATH_BYTES];

	poll->request = NULL;
	poll->options.link->in_flight--;
	if (rc == -EHOSTUNREACH) {
		link_failed(poll->options.link, http_url(poll->options.http), result->why);
		poll->failures++;
		pause_round(poll, link_pause_ms(poll->failures));
		return;
	}
	link_answered(poll->options.link);
	poll->failures = 0;
	if (rc == 0 && !result->not_modified)
		take_body(poll, result->etag);
	else if (rc == -EFBIG || rc == -EBADMSG)
		note_refusal(poll, path_of_stage(poll, path),
			     "larger than the limit for such a file");
	else if (rc < 0 && poll->stage != STAGE_ROOT) /* usually there is no newer root */
		note_refusal(poll, path_of_stage(poll, path), result->why);
	/* Passed on in every round, as a release: the kiosk may have had no memory for it. */
	if (rc == 0 && poll->stage == STAGE_TIMESTAMP)
		pass_on(poll, META_TIMESTAMP, 0, &poll->timestamp);
	if (poll->stage == STAGE_RELEASE) {
		/* Passed on in every round, because what was missing may be there by now: the
		 * timestamp that names this release, or the root of The Update Framework that it
		 * promises. */
		if (rc == 0)
			pass_on(poll, META_RELEASE, 0, &poll->release);
		pause_round(poll, period_ms(poll));
		return;
	}
	if (is_tuf(poll)) {
		pause_round(poll, period_ms(poll));
		return;
	}
	if (poll->stage == STAGE_VERDICT) /* new root: wait for the kiosk's verdict */
		return;
	poll->stage = poll->stage == STAGE_ROOT ? STAGE_TIMESTAMP : STAGE_RELEASE;
	request_file(poll);
}

/* ---- requests */

static void request_file(struct poll *poll)
{
	const struct known *known = known_of_stage(poll);
	char path[PATH_BYTES];
	struct http_get get = { .path = path_of_stage(poll, path),
				.ceiling = MESSAGE_META_BYTES_MAX,
				.etag = known->file.size ? known->etag : NULL,
				.receive = on_piece,
				.done = on_done,
				.data = poll };

	buffer_clear(&poll->body);
	if (http_get(poll->options.http, &get, &poll->request) < 0)
		pause_round(poll, 1000);
	else
		poll->options.link->in_flight++;
}

void poll_work(struct poll *poll)
{
	if (poll->stage == STAGE_VERDICT && clock_now_ms() >= poll->verdict_ms) {
		poll->stage = STAGE_TIMESTAMP;
		request_file(poll);
		return;
	}
	if (!poll->running || poll->stage != STAGE_IDLE || clock_now_ms() < poll->next_ms ||
	    !link_may_request(poll->options.link))
		return;
	poll->stage = is_tuf(poll) ? STAGE_TIMESTAMP : STAGE_ROOT;
	request_file(poll);
}

int64_t poll_due_ms(const struct poll *poll)
{
	const struct link *link = poll->options.link;

	if (poll->stage == STAGE_VERDICT)
		return poll->verdict_ms;
	if (!poll->running || poll->stage != STAGE_IDLE)
		return INT64_MAX;
	if (link->failures > 0 && link->in_flight > 0)
		return INT64_MAX;
	return poll->next_ms > link->retry_at_ms ? poll->next_ms : link->retry_at_ms;
}
