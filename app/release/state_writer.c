/* The thread that writes state.db. Callers leave requests under a lock; the thread takes them all
 * at once, writes them in a safe order, and answers through an eventfd. */
#include "app/release/state_writer.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/log.h"
#include "base/thread.h"

/* The changes that are requested. The thread takes the struct over, with its buffers. */
struct wish {
	bool release_wanted, trust_wanted, tuf_wanted;
	bool proof_wanted, return_wanted;
	struct state_release release;      /* its file is in release_file */
	struct buffer release_file, trust; /* owned */
	enum state_clear clear;            /* cleared together with storing the trust root */
	struct buffer tuf[4];              /* in the order of struct state_tuf; owned */
	enum state_clear tuf_clear;        /* cleared together with storing these */
	int64_t time_floor_s;              /* 0: no change requested */
};

struct state_writer {
	struct state *state; /* used by the thread only */
	pthread_t thread;
	bool has_thread;
	int fd;

	pthread_mutex_t lock;
	pthread_cond_t asked;
	struct wish wish; /* guarded by lock, as are the fields below */
	bool ends, answered;
	struct state_writer_answer answer;
};

static void wish_init(struct wish *wish)
{
	*wish = (struct wish){ 0 };
	buffer_init(&wish->release_file, STATE_FILE_BYTES_MAX);
	buffer_init(&wish->trust, STATE_FILE_BYTES_MAX);
	for (size_t i = 0; i < ARRAY_COUNT(wish->tuf); i++)
		buffer_init(&wish->tuf[i], STATE_FILE_BYTES_MAX);
}

static void wish_finish(struct wish *wish)
{
	buffer_finish(&wish->release_file);
	buffer_finish(&wish->trust);
	for (size_t i = 0; i < ARRAY_COUNT(wish->tuf); i++)
		buffer_finish(&wish->tuf[i]);
}

static bool is_something(const struct wish *wish)
{
	return wish->release_wanted || wish->trust_wanted || wish->tuf_wanted ||
	       wish->time_floor_s > 0 || wish->proof_wanted || wish->return_wanted;
}

/* ---- on the thread */

static void answer(struct state_writer *writer, const struct state_release *release, int rc)
{
	const uint64_t one = 1;

	pthread_mutex_lock(&writer->lock);
	writer->answer = (struct state_writer_answer){ release->root, release->root_bytes,
						       release->sequence, rc };
	writer->answered = true;
	pthread_mutex_unlock(&writer->lock);
	if (write(writer->fd, &one, sizeof(one)) < 0)
		log_error("app", "kiosk bug: the state writer cannot report its result");
}

static void set_tuf(struct state_writer *writer, const struct wish *wish)
{
	const struct state_tuf tuf = { buffer_bytes(&wish->tuf[0]), buffer_bytes(&wish->tuf[1]),
				       buffer_bytes(&wish->tuf[2]), buffer_bytes(&wish->tuf[3]) };

	if (state_set_tuf(writer->state, &tuf, wish->tuf_clear) < 0)
		log_warn("app", "the trusted metadata could not be stored");
}

/* Writes the requested changes. The trust root comes first, because the release may be signed by
 * its keys. */
static void fulfil(struct state_writer *writer, struct wish *wish)
{
	if (wish->trust_wanted &&
	    state_set_trust(writer->state, buffer_bytes(&wish->trust), wish->clear) < 0)
		log_warn("app", "the trust root could not be stored");
	if (wish->tuf_wanted)
		set_tuf(writer, wish);
	/* These two concern the release in use, not the one stored below. */
	if (wish->proof_wanted && state_prove(writer->state) < 0)
		log_warn("app", "the end of the release's trial could not be stored");
	if (wish->return_wanted && state_fall_back(writer->state) < 0)
		log_warn("app", "the return to the previous release could not be stored");
	if (wish->time_floor_s > 0 && state_raise_time_floor(writer->state, wish->time_floor_s) < 0)
		log_debug("app", "the time floor could not be stored");
	if (wish->release_wanted) {
		wish->release.file = buffer_bytes(&wish->release_file);
		answer(writer, &wish->release, state_activate(writer->state, &wish->release));
	}
}

static void *run(void *data)
{
	struct state_writer *writer = data;

	pthread_mutex_lock(&writer->lock);
	while (!writer->ends || is_something(&writer->wish)) {
		struct wish wish = writer->wish;

		if (!is_something(&wish)) {
			pthread_cond_wait(&writer->asked, &writer->lock);
			continue;
		}
		wish_init(&writer->wish);
		pthread_mutex_unlock(&writer->lock);
		fulfil(writer, &wish);
		wish_finish(&wish);
		pthread_mutex_lock(&writer->lock);
	}
	pthread_mutex_unlock(&writer->lock);
	return NULL;
}

/* ---- on the caller's thread */

int state_writer_create(struct state_writer **out, struct state *state)
{
	struct state_writer *writer = calloc(1, sizeof(*writer));
	int rc;

	*out = NULL;
	if (!writer) {
		state_destroy(state);
		return -ENOMEM;
	}
	writer->state = state;
	wish_init(&writer->wish);
	pthread_mutex_init(&writer->lock, NULL);
	pthread_cond_init(&writer->asked, NULL);
	writer->fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	rc = writer->fd < 0 ? -errno : thread_start(&writer->thread, NULL, run, writer);
	writer->has_thread = rc == 0;
	if (rc < 0) {
		state_writer_destroy(writer);
		return rc;
	}
	*out = writer;
	return 0;
}

void state_writer_destroy(struct state_writer *writer)
{
	if (!writer)
		return;
	pthread_mutex_lock(&writer->lock);
	writer->ends = true;
	pthread_cond_signal(&writer->asked);
	pthread_mutex_unlock(&writer->lock);
	if (writer->has_thread)
		pthread_join(writer->thread, NULL);
	pthread_cond_destroy(&writer->asked);
	pthread_mutex_destroy(&writer->lock);
	wish_finish(&writer->wish);
	if (writer->fd >= 0)
		close(writer->fd);
	state_destroy(writer->state);
	free(writer);
}

static int copy_file(struct buffer *out, struct bytes file)
{
	buffer_clear(out);
	buffer_put(out, file.data, file.size);
	return out->error;
}

int state_writer_activate(struct state_writer *writer, const struct state_release *release)
{
	struct wish *wish = &writer->wish;
	int rc;

	pthread_mutex_lock(&writer->lock);
	rc = copy_file(&wish->release_file, release->file);
	wish->release = *release;
	wish->release_wanted = rc == 0;
	pthread_cond_signal(&writer->asked);
	pthread_mutex_unlock(&writer->lock);
	return rc;
}

int state_writer_set_trust(struct state_writer *writer, struct bytes file, enum state_clear clear)
{
	struct wish *wish = &writer->wish;
	int rc;

	pthread_mutex_lock(&writer->lock);
	rc = copy_file(&wish->trust, file);
	wish->trust_wanted = rc == 0;
	wish->clear |= clear;
	if (clear & STATE_CLEAR_TIME_FLOOR)
		wish->time_floor_s = 0; /* it was requested under the old key */
	pthread_cond_signal(&writer->asked);
	pthread_mutex_unlock(&writer->lock);
	return rc;
}

int state_writer_set_tuf(struct state_writer *writer, const struct state_tuf *tuf,
			 enum state_clear clear)
{
	const struct bytes files[] = { tuf->root, tuf->timestamp, tuf->snapshot, tuf->targets };
	struct wish *wish = &writer->wish;
	int rc = 0;

	pthread_mutex_lock(&writer->lock);
	for (size_t i = 0; i < ARRAY_COUNT(files) && rc == 0; i++)
		rc = copy_file(&wish->tuf[i], files[i]);
	wish->tuf_wanted = rc == 0;
	wish->tuf_clear |= clear;
	if (clear & STATE_CLEAR_TIME_FLOOR)
		wish->time_floor_s = 0; /* it was requested under the old key */
	pthread_cond_signal(&writer->asked);
	pthread_mutex_unlock(&writer->lock);
	return rc;
}

void state_writer_prove(struct state_writer *writer)
{
	pthread_mutex_lock(&writer->lock);
	writer->wish.proof_wanted = true;
	pthread_cond_signal(&writer->asked);
	pthread_mutex_unlock(&writer->lock);
}

void state_writer_fall_back(struct state_writer *writer)
{
	pthread_mutex_lock(&writer->lock);
	writer->wish.return_wanted = true;
	writer->wish.proof_wanted = false;
	pthread_cond_signal(&writer->asked);
	pthread_mutex_unlock(&writer->lock);
}

void state_writer_raise_time_floor(struct state_writer *writer, int64_t at_least_s)
{
	pthread_mutex_lock(&writer->lock);
	if (at_least_s > writer->wish.time_floor_s)
		writer->wish.time_floor_s = at_least_s;
	pthread_cond_signal(&writer->asked);
	pthread_mutex_unlock(&writer->lock);
}

int state_writer_fd(const struct state_writer *writer)
{
	return writer->fd;
}

bool state_writer_take(struct state_writer *writer, struct state_writer_answer *out)
{
	uint64_t count;
	bool answered;

	if (read(writer->fd, &count, sizeof(count)) < 0)
		return false;
	pthread_mutex_lock(&writer->lock);
	answered = writer->answered;
	*out = writer->answer;
	writer->answered = false;
	pthread_mutex_unlock(&writer->lock);
	return answered;
}
