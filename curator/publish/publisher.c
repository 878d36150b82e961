/* The loop, one request, and the list of releases. */
#include "curator/publish/publisher.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/service.h"
#include "base/transient.h"
#include "base/utf8.h"
#include "curator/publish/content_run.h"
#include "curator/publish/publish_files.h"
#include "pipeline/content/content.h"
#include "pipeline/release/release_look.h"

enum {
	LOOK_AGAIN_MS = 60 * 1000, /* should a notice be lost */
	/* A build that was killed with us may hold the content's lock a moment longer. */
	TRIES_AFTER_KILL = 5,
	TRY_AGAIN_MS = 1000,
	RENEW_S = 24 * 3600,
	RENEW_AGAIN_MS = 3600 * 1000, /* after one that failed */
};

struct publisher {
	const struct publisher_options *options;
	int stop_fd, notice_fd, lock_fd;
	bool stopped;
	int64_t renew_ms; /* of the next renewal after one that failed; 0: the log tells */
	/* What temple.ini said when it had no faults last: whose releases are the folder's. */
	bool knows_place;
	char target[CONTENT_TARGET_BYTES], role[CONTENT_ROLE_BYTES];
};

/* ---- the releases that there are */

/* -ENODATA: temple.ini has faults, and had them before. Transient errors. */
static int find_place(struct publisher *publisher, struct release_place *out)
{
	struct diagnostics found = { 0 };
	struct content content;
	int rc = content_read(&content, publisher->options->folder, &found);

	if (rc == 0) {
		memcpy(publisher->target, content.tuf_target, sizeof(publisher->target));
		memcpy(publisher->role, content.tuf_role, sizeof(publisher->role));
		publisher->knows_place = true;
		content_release(&content);
	}
	diagnostics_finish(&found);
	*out = (struct release_place){ .folder = publisher->options->release,
				       .target = publisher->target,
				       .role = publisher->role };
	return publisher->knows_place ? 0 : is_transient(rc) ? rc : -ENODATA;
}

/* Who made it and when is not in a release: it is in the list as it was. */
static void remember(struct publish_release *release, const struct publish_releases *before)
{
	for (uint32_t n = 0; n < before->count; n++)
		if (before->list[n].sequence == release->sequence &&
		    strcmp(before->list[n].root, release->root) == 0) {
			memcpy(release->by, before->list[n].by, sizeof(release->by));
			release->at_s = before->list[n].at_s;
		}
}

static void fill(struct publish_release *out, const struct release *release)
{
	*out = (struct publish_release){ .sequence = release->sequence };
	hash_to_hex(release->root, out->root);
	memcpy(out->comment, release->comment, sizeof(out->comment));
	utf8_make_printable(out->comment); /* the command line takes any, also of two lines */
}

/* The newest first. by NULL: nobody has published just now. */
static int collect(struct publish_releases *out, const struct publish_releases *before,
		   const struct release_place *place, const struct publish_state *state)
{
	struct trust_root trust;
	struct release release;
	int rc = release_look_trust(&trust, place->folder);

	if (rc == 0)
		rc = release_look_at(&release, place, &trust, 0);
	if (rc < 0)
		return rc == -ENOENT ? 0 : rc;
	out->list = calloc(PUBLISH_RELEASES_MAX, sizeof(*out->list));
	if (!out->list)
		return -ENOMEM;
	for (uint64_t sequence = release.sequence;
	     sequence > 0 && out->count < PUBLISH_RELEASES_MAX; sequence--) {
		struct publish_release *one = &out->list[out->count];

		rc = release_look_at(&release, place, &trust, sequence);
		if (is_transient(rc))
			return rc;
		if (rc == -EKEYREJECTED)
			break; /* nobody can go back to what keys of earlier days signed */
		if (rc < 0)
			continue; /* numbers may be left out */
		fill(one, &release);
		remember(one, before);
		if (state && sequence > state->before && sequence <= state->after) {
			memcpy(one->by, state->request.by, sizeof(one->by));
			one->at_s = state->ended_s;
		}
		out->count++;
	}
	return 0;
}

/* state NULL: nothing was published just now. */
static int write_releases(struct publisher *publisher, const struct publish_state *state)
{
	struct publish_releases before = { 0 }, now = { 0 };
	const struct publisher_options *options = publisher->options;
	struct release_place place;
	int rc = find_place(publisher, &place);

	if (rc == -ENODATA) {
		log_warn("curator",
			 "temple.ini has faults, so the list of releases stays as it is");
		return 0;
	}
	if (rc == 0)
		rc = publish_releases_read(&before, options->folder);
	if (rc < 0 && !is_transient(rc)) {
		log_warn("curator",
			 "releases.json is damaged: who published is not known any more");
		rc = 0;
	}
	if (rc == 0)
		rc = collect(&now, &before, &place, state);
	if (rc == 0)
		rc = publish_releases_write(&now, options->folder);
	publish_releases_finish(&before);
	publish_releases_finish(&now);
	if (rc < 0)
		log_error("curator", "the list of releases: %s", strerror(-rc));
	return rc;
}

/* Gets 0 if nothing was published yet, or what was cannot be used. Returns transient errors. */
static int current_sequence(struct publisher *publisher, uint64_t *out)
{
	struct release_place place;
	struct trust_root trust;
	struct release release = { 0 };
	int rc = find_place(publisher, &place);

	if (rc == 0)
		rc = release_look_trust(&trust, place.folder);
	if (rc == 0)
		rc = release_look_at(&release, &place, &trust, 0);
	*out = rc == 0 ? release.sequence : 0;
	if (!is_transient(rc))
		return 0;
	log_error("curator", "%s: %s", place.folder, strerror(-rc));
	return rc;
}

/* ---- one request */

/* request NULL: what is published is signed anew. */
static int run_content(struct publisher *publisher, const struct publish_request *request,
		       char message[PUBLISH_MESSAGE_BYTES])
{
	const struct publisher_options *options = publisher->options;
	const struct content_run_options run = { .program = options->program,
						 .folder = options->folder,
						 .release = options->release,
						 .keys = options->keys,
						 .jobs = options->jobs,
						 .renew = !request,
						 .sequence = request ? request->sequence : 0,
						 .comment = request ? request->comment : "",
						 .stop_fd = publisher->stop_fd };

	return content_run(&run, message);
}

/* current: the release before this try. Returns -ECANCELED if the program is to end. */
static int carry_out(struct publisher *publisher, struct publish_state *state, bool was_killed,
		     uint64_t current)
{
	const struct publish_request *request = &state->request;
	int tries = was_killed ? TRIES_AFTER_KILL : 1;
	int rc = 0;

	if (was_killed && request->sequence > 0 && current > state->before)
		return 0; /* it was done before we were killed */
	for (; tries > 0; tries--) {
		struct pollfd stop = { .fd = publisher->stop_fd, .events = POLLIN };

		rc = run_content(publisher, request, state->message);
		if (rc == 0 || rc == -ECANCELED || tries == 1)
			break;
		if (poll(&stop, 1, TRY_AGAIN_MS) > 0)
			return -ECANCELED;
	}
	return rc;
}

static int begin(struct publisher *publisher, struct publish_state *state,
		 const struct publish_request *request, uint64_t current)
{
	const bool was_killed =
		state->step == PUBLISH_RUNNING && state->request.number == request->number;
	int rc;

	if (!was_killed)
		*state = (struct publish_state){
			.request = *request,
			.step = PUBLISH_RUNNING,
			.begun_s = clock_wall_s(),
			.before = current,
		};
	rc = publish_state_write(state, publisher->options->folder);
	if (rc < 0)
		log_error("curator", "state.json: %s", strerror(-rc));
	else
		log_info("curator", "request %" PRIu64 " of %s%s", request->number, request->by,
			 was_killed ? ", again" : "");
	return rc;
}

static int work(struct publisher *publisher, struct publish_state *state,
		const struct publish_request *request)
{
	const bool was_killed =
		state->step == PUBLISH_RUNNING && state->request.number == request->number;
	uint64_t current;
	int done, rc = current_sequence(publisher, &current);

	if (rc == 0)
		rc = begin(publisher, state, request, current);
	if (rc < 0)
		return rc;
	done = carry_out(publisher, state, was_killed, current);
	if (done == -ECANCELED) {
		publisher->stopped = true; /* the next start goes on */
		return 0;
	}
	state->step = done == 0 ? PUBLISH_DONE : PUBLISH_FAILED;
	state->ended_s = clock_wall_s();
	rc = current_sequence(publisher, &state->after);
	if (rc == 0)
		rc = write_releases(publisher, state);
	if (rc == 0)
		rc = publish_state_write(state, publisher->options->folder);
	if (done < 0)
		log_error("curator", "request %" PRIu64 " failed: %s", request->number,
			  state->message);
	else if (rc == 0)
		log_info("curator", "release %" PRIu64 " is the current one", state->after);
	return rc < 0 ? rc : done;
}

/* Nobody knows whether the last request was carried out: nothing is published that nobody asks for
 * now. */
static int begin_state_anew(const struct publish_request *request, const char *folder)
{
	const struct publish_state state = {
		.request = *request,
		.step = PUBLISH_FAILED,
		.ended_s = clock_wall_s(),
		.message = "what became of it is not known, because state.json was damaged: look "
			   "at the releases, and ask again",
	};
	const int rc = publish_state_write(&state, folder);

	if (rc < 0)
		log_error("curator", "state.json: %s", strerror(-rc));
	else
		log_warn("curator", "state.json was damaged, and is begun anew");
	return rc;
}

/* Works off what waits. Returns 0 also if there was nothing; -EIO: it failed. */
static int step(struct publisher *publisher)
{
	const char *folder = publisher->options->folder;
	struct publish_request request;
	struct publish_state state;
	const int known = publish_state_read(&state, folder);
	int rc;

	if (is_transient(known)) {
		log_error("curator", "state.json: %s", strerror(-known));
		return known;
	}
	rc = publish_request_read(&request, folder);
	if (known < 0 && !is_transient(rc))
		return begin_state_anew(&request, folder);
	if (rc < 0) {
		log_error("curator", "request.json: %s", strerror(-rc));
		return is_transient(rc) ? rc : 0;
	}
	if (!publish_is_pending(&request, &state))
		return 0;
	/* A request that is missing, or older than the one that runs, was not ours to lose. */
	if (request.number < state.request.number)
		request = state.request;
	return work(publisher, &state, &request);
}

/* ---- when nobody asks for anything */

/* The log of the last renewal tells when that was, also to a publisher that has just started. */
static bool renewal_is_due(const struct publisher *publisher)
{
	char path[PATH_MAX];
	struct stat log;

	if (publisher->renew_ms > 0)
		return clock_now_ms() >= publisher->renew_ms;
	return publish_file_path(path, publisher->options->folder, "renewal.log") == 0 &&
	       (stat(path, &log) < 0 ||
		llabs(clock_wall_s() - (long long)log.st_mtim.tv_sec) > RENEW_S);
}

/* Has gopura-content sign anew what runs out, which publishes nothing that curators work on. */
static void renew(struct publisher *publisher)
{
	char message[PUBLISH_MESSAGE_BYTES];
	uint64_t before, after;
	int rc;

	if (!renewal_is_due(publisher))
		return;
	publisher->renew_ms = clock_now_ms() + RENEW_AGAIN_MS;
	if (current_sequence(publisher, &before) < 0 || before == 0)
		return;
	rc = run_content(publisher, NULL, message);
	if (rc == -ECANCELED) {
		publisher->stopped = true;
		return;
	}
	if (rc < 0) {
		log_error("curator", "what is published cannot be signed anew: %s", message);
		return;
	}
	publisher->renew_ms = 0;
	log_info("curator", "what is published is signed anew");
	if (current_sequence(publisher, &after) == 0 && after != before &&
	    write_releases(publisher, NULL) == 0)
		log_info("curator", "release %" PRIu64 " is the current one", after);
}

/* ---- the loop */

static int start(struct publisher *publisher, struct diagnostics *diagnostics)
{
	const char *folder = publisher->options->folder;
	char path[PATH_MAX];
	int rc = publish_files_make(folder, diagnostics);

	if (rc < 0)
		return rc;
	publisher->stop_fd = service_stop_fd();
	publisher->lock_fd = publish_lock(folder);
	if (publisher->lock_fd == -EBUSY)
		return diagnostics_add(diagnostics, -EBUSY, folder, 0,
				       "has a publisher that runs already");
	rc = publish_file_path(path, folder, "");
	publisher->notice_fd = inotify_init1(IN_CLOEXEC | IN_NONBLOCK);
	if (rc == 0 && publisher->stop_fd < 0)
		rc = publisher->stop_fd;
	if (rc == 0 && publisher->lock_fd < 0)
		rc = publisher->lock_fd;
	if (rc == 0 && (publisher->notice_fd < 0 ||
			inotify_add_watch(publisher->notice_fd, path, IN_MOVED_TO) < 0))
		rc = -errno;
	return rc < 0 ? diagnostics_add(diagnostics, rc, path, 0, "%s", strerror(-rc)) : 0;
}

static void wait_for_notice(struct publisher *publisher)
{
	struct pollfd fds[] = { { .fd = publisher->stop_fd, .events = POLLIN },
				{ .fd = publisher->notice_fd, .events = POLLIN } };
	char notices[4096];

	if (poll(fds, 2, LOOK_AGAIN_MS) <= 0)
		return;
	publisher->stopped = fds[0].revents != 0;
	while (read(publisher->notice_fd, notices, sizeof(notices)) > 0)
		;
}

int publisher_run(const struct publisher_options *options, struct diagnostics *diagnostics)
{
	struct publisher publisher = {
		.options = options, .stop_fd = -1, .notice_fd = -1, .lock_fd = -1
	};
	int rc = start(&publisher, diagnostics), done = 0;

	if (rc == 0) {
		publish_drop_leftovers(options->folder, "state.json");
		publish_drop_leftovers(options->folder, "releases.json");
		rc = write_releases(&publisher, NULL);
		if (rc < 0)
			diagnostics_add(diagnostics, rc, options->release, 0, "%s", strerror(-rc));
		service_ready();
	}
	while (rc == 0 && !publisher.stopped) {
		done = step(&publisher);
		if (options->once)
			break;
		if (done == 0 && !publisher.stopped)
			renew(&publisher);
		if (!publisher.stopped)
			wait_for_notice(&publisher);
	}
	if (publisher.notice_fd >= 0)
		close(publisher.notice_fd);
	if (publisher.stop_fd >= 0)
		close(publisher.stop_fd);
	if (publisher.lock_fd >= 0)
		close(publisher.lock_fd);
	return rc < 0 ? rc : options->once ? done : 0;
}
