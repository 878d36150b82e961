#include "app/release/state_writer.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/log.h"

/* What is asked for; the buffers change hands with it. */
struct wish {
	bool release_wanted, trust_wanted;
	bool proof_wanted, return_wanted;
	struct state_release release;      /* its file: release_file */
	struct buffer release_file, trust; /* owned */
	enum state_clear clear;            /* with the trust root */
	int64_t time_floor_s;              /* 0: none */
};

struct keeper {
	struct state *state; /* the thread's */
	pthread_t thread;
	bool has_thread;
	int fd;

	pthread_mutex_t lock;
	pthread_cond_t asked;
	struct wish wish; /* under lock, as all below */
	bool ends, answered;
	struct keeper_answer answer;
};

static void wish_init(struct wish *wish)
{
	*wish = (struct wish){ 0 };
	buffer_init(&wish->release_file, STATE_FILE_BYTES_MOST);
	buffer_init(&wish->trust, STATE_FILE_BYTES_MOST);
}

static void wish_finish(struct wish *wish)
{
	buffer_finish(&wish->release_file);
	buffer_finish(&wish->trust);
}

static bool is_something(const struct wish *wish)
{
	return wish->release_wanted || wish->trust_wanted || wish->time_floor_s > 0 ||
	       wish->proof_wanted || wish->return_wanted;
}

/* ---- on the thread */

static void answer(struct keeper *keeper, const struct state_release *release, int rc)
{
	const uint64_t one = 1;

	pthread_mutex_lock(&keeper->lock);
	keeper->answer =
		(struct keeper_answer){ release->root, release->root_bytes, release->sequence, rc };
	keeper->answered = true;
	pthread_mutex_unlock(&keeper->lock);
	if (write(keeper->fd, &one, sizeof(one)) < 0)
		log_error("app", "kiosk bug: the keeper cannot answer");
}

/* The trust root first: the release may be signed by its keys. */
static void fulfil(struct keeper *keeper, struct wish *wish)
{
	if (wish->trust_wanted &&
	    state_set_trust(keeper->state, buffer_bytes(&wish->trust), wish->clear) < 0)
		log_warn("app", "the trust root could not be remembered");
	/* Both are about the release before the one that is wanted now. */
	if (wish->proof_wanted && state_prove(keeper->state) < 0)
		log_warn("app", "that the release works could not be remembered");
	if (wish->return_wanted && state_fall_back(keeper->state) < 0)
		log_warn("app", "the return to the release before could not be remembered");
	if (wish->time_floor_s > 0 && state_raise_time_floor(keeper->state, wish->time_floor_s) < 0)
		log_debug("app", "the time floor could not be written");
	if (wish->release_wanted) {
		wish->release.file = buffer_bytes(&wish->release_file);
		answer(keeper, &wish->release, state_activate(keeper->state, &wish->release));
	}
}

static void *run(void *data)
{
	struct keeper *keeper = data;

	pthread_mutex_lock(&keeper->lock);
	while (!keeper->ends || is_something(&keeper->wish)) {
		struct wish wish = keeper->wish;

		if (!is_something(&wish)) {
			pthread_cond_wait(&keeper->asked, &keeper->lock);
			continue;
		}
		wish_init(&keeper->wish);
		pthread_mutex_unlock(&keeper->lock);
		fulfil(keeper, &wish);
		wish_finish(&wish);
		pthread_mutex_lock(&keeper->lock);
	}
	pthread_mutex_unlock(&keeper->lock);
	return NULL;
}

/* ---- on the owner's thread */

/* Signals are the loop's: the thread is born with all of them blocked. */
static int start_thread(struct keeper *keeper)
{
	sigset_t all, before;
	int rc;

	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	rc = -pthread_create(&keeper->thread, NULL, run, keeper);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	keeper->has_thread = rc == 0;
	return rc;
}

int keeper_create(struct keeper **out, struct state *state)
{
	struct keeper *keeper = calloc(1, sizeof(*keeper));
	int rc;

	*out = NULL;
	if (!keeper) {
		state_destroy(state);
		return -ENOMEM;
	}
	keeper->state = state;
	wish_init(&keeper->wish);
	pthread_mutex_init(&keeper->lock, NULL);
	pthread_cond_init(&keeper->asked, NULL);
	keeper->fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	rc = keeper->fd < 0 ? -errno : start_thread(keeper);
	if (rc < 0) {
		keeper_destroy(keeper);
		return rc;
	}
	*out = keeper;
	return 0;
}

void keeper_destroy(struct keeper *keeper)
{
	if (!keeper)
		return;
	pthread_mutex_lock(&keeper->lock);
	keeper->ends = true;
	pthread_cond_signal(&keeper->asked);
	pthread_mutex_unlock(&keeper->lock);
	if (keeper->has_thread)
		pthread_join(keeper->thread, NULL);
	pthread_cond_destroy(&keeper->asked);
	pthread_mutex_destroy(&keeper->lock);
	wish_finish(&keeper->wish);
	if (keeper->fd >= 0)
		close(keeper->fd);
	state_destroy(keeper->state);
	free(keeper);
}

static int copy_file(struct buffer *out, struct bytes file)
{
	buffer_clear(out);
	buffer_put(out, file.data, file.size);
	return out->error;
}

int keeper_activate(struct keeper *keeper, const struct state_release *release)
{
	struct wish *wish = &keeper->wish;
	int rc;

	pthread_mutex_lock(&keeper->lock);
	rc = copy_file(&wish->release_file, release->file);
	wish->release = *release;
	wish->release_wanted = rc == 0;
	pthread_cond_signal(&keeper->asked);
	pthread_mutex_unlock(&keeper->lock);
	return rc;
}

int keeper_set_trust(struct keeper *keeper, struct bytes file, enum state_clear clear)
{
	struct wish *wish = &keeper->wish;
	int rc;

	pthread_mutex_lock(&keeper->lock);
	rc = copy_file(&wish->trust, file);
	wish->trust_wanted = rc == 0;
	wish->clear |= clear;
	if (clear & STATE_CLEAR_TIME_FLOOR)
		wish->time_floor_s = 0; /* what was asked for before was an old key's */
	pthread_cond_signal(&keeper->asked);
	pthread_mutex_unlock(&keeper->lock);
	return rc;
}

void keeper_prove(struct keeper *keeper)
{
	pthread_mutex_lock(&keeper->lock);
	keeper->wish.proof_wanted = true;
	pthread_cond_signal(&keeper->asked);
	pthread_mutex_unlock(&keeper->lock);
}

void keeper_fall_back(struct keeper *keeper)
{
	pthread_mutex_lock(&keeper->lock);
	keeper->wish.return_wanted = true;
	keeper->wish.proof_wanted = false;
	pthread_cond_signal(&keeper->asked);
	pthread_mutex_unlock(&keeper->lock);
}

void keeper_raise_time_floor(struct keeper *keeper, int64_t at_least_s)
{
	pthread_mutex_lock(&keeper->lock);
	if (at_least_s > keeper->wish.time_floor_s)
		keeper->wish.time_floor_s = at_least_s;
	pthread_cond_signal(&keeper->asked);
	pthread_mutex_unlock(&keeper->lock);
}

int keeper_fd(const struct keeper *keeper)
{
	return keeper->fd;
}

bool keeper_take(struct keeper *keeper, struct keeper_answer *out)
{
	uint64_t count;
	bool answered;

	if (read(keeper->fd, &count, sizeof(count)) < 0)
		return false;
	pthread_mutex_lock(&keeper->lock);
	answered = keeper->answered;
	*out = keeper->answer;
	keeper->answered = false;
	pthread_mutex_unlock(&keeper->lock);
	return answered;
}
