/* Runs the stick reader on its own thread, one job at a time: a look for a stick, or a batch of
 * objects. It detects jobs that hang. */
#include "net/stick.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include "base/array.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/thread.h"
#include "format/page.h"
#include "net/stick_reader.h"

enum {
	LOOK_MS = 3000,
	PATIENCE_MS = 10000,
	HANG_PAUSE_MS = 60000, /* pause after a job that hung */
	END_S = 2,             /* how long the thread may take to end; then it is abandoned */
	OBJECTS_MAX = 32,      /* per job */
	JOB_BYTES_MAX = 2 << 20,
};

struct job_object {
	struct message_want want;
	int rc;
	struct buffer bytes;
};

enum job_kind { JOB_LOOK, JOB_OBJECTS, JOB_FILE };

struct job {
	enum job_kind kind;
	bool forgets;
	uint32_t root_version;
	enum stick_change change;
	struct stick_file files[STICK_FILES_MAX];
	size_t file_count;
	struct hash roots[MESSAGE_RELEASES_MAX];
	size_t root_count;
	struct job_object objects[OBJECTS_MAX];
	size_t object_count;
	struct message_file file;
	struct buffer file_bytes;
};

enum worker_state { WORKER_IDLE, WORKER_BUSY, WORKER_DONE };

/* May outlive struct stick if the thread hangs. While state is WORKER_BUSY, only the thread uses
 * job and reader. */
struct worker {
	pthread_mutex_t lock;
	pthread_cond_t changed;
	enum worker_state state;
	bool ends, ended, abandoned; /* abandoned: the thread frees the worker */
	int event_fd;
	struct stick_reader reader;
	struct job job;
};

struct request {
	struct message_want want;
	uint64_t order; /* order of arrival */
};

struct stick {
	struct stick_options options;
	struct worker *worker;
	pthread_t thread;
	int64_t look_ms, began_ms; /* time of the next look; start of the current job */
	bool forgets;              /* report everything again at the next look */
	bool is_here;
	bool hangs; /* the current job took too long and was given up */
	uint32_t root_version;
	struct hash roots[MESSAGE_RELEASES_MAX];
	size_t root_count;
	struct request
		*requests; /* owned; sorted by priority unless requests_changed; the best is last */
	uint32_t request_count, request_room;
	bool requests_changed;
	struct message_file asked; /* the file to read next; no name: none */
	uint64_t orders;
};

/* ---- the thread */

static void run_job(struct worker *worker)
{
	struct job *job = &worker->job;

	if (job->forgets)
		stick_reader_forget(&worker->reader);
	if (job->kind == JOB_LOOK) {
		job->change = stick_reader_look(&worker->reader, job->root_version, job->files,
						&job->file_count);
		return;
	}
	if (job->kind == JOB_FILE) {
		job->file.answer =
			stick_reader_file(&worker->reader, job->file.name, &job->file_bytes);
		return;
	}
	for (size_t i = 0; i < job->object_count; i++) {
		struct job_object *object = &job->objects[i];

		buffer_init(&object->bytes, OBJECT_BYTES_MAX);
		object->rc = stick_reader_get(&worker->reader, job->roots, job->root_count,
					      &object->want, &object->bytes);
	}
}

static void clear_job(struct job *job)
{
	for (size_t i = 0; i < job->file_count; i++)
		buffer_finish(&job->files[i].bytes);
	for (size_t i = 0; i < job->object_count; i++)
		buffer_finish(&job->objects[i].bytes);
	buffer_finish(&job->file_bytes);
	job->file_count = job->object_count = 0;
}

static void worker_free(struct worker *worker)
{
	clear_job(&worker->job);
	stick_reader_finish(&worker->reader);
	if (worker->event_fd >= 0)
		close(worker->event_fd);
	pthread_cond_destroy(&worker->changed);
	pthread_mutex_destroy(&worker->lock);
	free(worker);
}

static void *run(void *data)
{
	struct worker *worker = data;
	bool abandoned;

	pthread_mutex_lock(&worker->lock);
	while (!worker->ends) {
		if (worker->state != WORKER_BUSY) {
			pthread_cond_wait(&worker->changed, &worker->lock);
			continue;
		}
		pthread_mutex_unlock(&worker->lock);
		run_job(worker);
		pthread_mutex_lock(&worker->lock);
		worker->state = WORKER_DONE;
		if (eventfd_write(worker->event_fd, 1) < 0)
			log_debug("net", "the loop was not woken up for the stick");
	}
	worker->ended = true;
	abandoned = worker->abandoned;
	pthread_cond_signal(&worker->changed);
	pthread_mutex_unlock(&worker->lock);
	if (abandoned)
		worker_free(worker);
	return NULL;
}

static enum worker_state state_of(struct worker *worker)
{
	enum worker_state state;

	pthread_mutex_lock(&worker->lock);
	state = worker->state;
	pthread_mutex_unlock(&worker->lock);
	return state;
}

static void set_state(struct worker *worker, enum worker_state state)
{
	pthread_mutex_lock(&worker->lock);
	worker->state = state;
	pthread_cond_signal(&worker->changed);
	pthread_mutex_unlock(&worker->lock);
}

/* ---- create, destroy */

static int create_worker(struct worker **out, const char *folder)
{
	struct worker *worker = calloc(1, sizeof(*worker));
	pthread_condattr_t attributes;
	int rc;

	*out = worker;
	if (!worker)
		return -ENOMEM;
	pthread_mutex_init(&worker->lock, NULL);
	pthread_condattr_init(&attributes);
	pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
	pthread_cond_init(&worker->changed, &attributes);
	pthread_condattr_destroy(&attributes);
	worker->event_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	rc = worker->event_fd < 0 ? -errno : 0;
	return rc == 0 ? stick_reader_init(&worker->reader, folder) : rc;
}

int stick_create(struct stick **out, const struct stick_options *options)
{
	struct stick *stick = calloc(1, sizeof(*stick));
	int rc;

	*out = NULL;
	if (!stick)
		return -ENOMEM;
	stick->options = *options;
	stick->options.folder = NULL; /* the reader has its own copy */
	if (stick->options.patience_ms == 0)
		stick->options.patience_ms = PATIENCE_MS;
	rc = create_worker(&stick->worker, options->folder);
	if (rc == 0)
		rc = thread_start(&stick->thread, NULL, run, stick->worker);
	if (rc < 0) {
		if (stick->worker)
			worker_free(stick->worker);
		free(stick);
		return rc;
	}
	*out = stick;
	return 0;
}

/* Ends the thread. A thread that hangs in the device is abandoned, together with its data. */
static void end_thread(struct stick *stick)
{
	struct worker *worker = stick->worker;
	struct timespec until;
	bool ended;
	int rc = 0;

	clock_gettime(CLOCK_MONOTONIC, &until);
	until.tv_sec += END_S;
	pthread_mutex_lock(&worker->lock);
	worker->ends = true;
	pthread_cond_signal(&worker->changed);
	while (!worker->ended && rc == 0)
		rc = pthread_cond_timedwait(&worker->changed, &worker->lock, &until);
	ended = worker->ended;
	worker->abandoned = !ended;
	pthread_mutex_unlock(&worker->lock);
	if (!ended) {
		pthread_detach(stick->thread);
		return;
	}
	pthread_join(stick->thread, NULL);
	worker_free(worker);
}

void stick_destroy(struct stick *stick)
{
	if (!stick)
		return;
	end_thread(stick);
	free(stick->requests);
	free(stick);
}

/* ---- requests */

void stick_forget(struct stick *stick)
{
	if (!stick)
		return;
	stick->forgets = true;
	if (!stick->hangs)
		stick->look_ms = 0;
}

void stick_trust(struct stick *stick, uint32_t root_version)
{
	if (!stick || root_version == stick->root_version)
		return;
	stick->root_version = root_version;
	stick_forget(stick);
}

bool stick_request(struct stick *stick, const struct hash *roots, size_t count,
		   const struct message_want *want)
{
	if (!stick || !stick->is_here || stick->hangs)
		return false;
	if (ARRAY_RESERVE(stick->requests, stick->request_room, stick->request_count + 1,
			  UINT32_MAX) < 0) {
		stick->forgets = true; /* the next look reports the stick again */
		return false;
	}
	stick->root_count = count < MESSAGE_RELEASES_MAX ? count : MESSAGE_RELEASES_MAX;
	memcpy(stick->roots, roots, stick->root_count * sizeof(*roots));
	stick->requests[stick->request_count++] = (struct request){ *want, stick->orders++ };
	stick->requests_changed = true;
	return true;
}

void stick_ask_file(struct stick *stick, const struct message_file *file)
{
	if (stick)
		stick->asked = *file;
}

/* Sorts the most urgent request to the end. */
static int by_priority(const void *a, const void *b)
{
	const struct request *left = a, *right = b;

	if (left->want.priority != right->want.priority)
		return left->want.priority < right->want.priority ? -1 : 1;
	return left->order > right->order ? -1 : 1;
}

static void answer(struct stick *stick, struct hash hash, int rc, struct bytes bytes)
{
	stick->options.object(stick->options.data, hash, rc, bytes);
}

/* Answers all requests with -ENOENT, because there is no stick or it does not answer. */
static void refuse_all(struct stick *stick)
{
	const uint32_t count = stick->request_count;

	stick->is_here = false;
	stick->request_count = 0; /* the answer callback may ask for more; that is refused now */
	for (uint32_t i = 0; i < count; i++)
		answer(stick, stick->requests[i].want.hash, -ENOENT, (struct bytes){ NULL, 0 });
}

/* ---- jobs */

static void begin_look(struct stick *stick)
{
	struct job *job = &stick->worker->job;

	job->kind = JOB_LOOK;
	job->forgets = stick->forgets;
	job->root_version = stick->root_version;
	stick->forgets = false;
	stick->began_ms = clock_now_ms();
	stick->look_ms = stick->began_ms + LOOK_MS;
	set_state(stick->worker, WORKER_BUSY);
}

static void begin_read(struct stick *stick)
{
	struct job *job = &stick->worker->job;
	size_t bytes = 0;

	if (stick->requests_changed)
		qsort(stick->requests, stick->request_count, sizeof(stick->requests[0]),
		      by_priority);
	stick->requests_changed = false;
	while (stick->request_count > 0 && job->object_count < OBJECTS_MAX &&
	       bytes < JOB_BYTES_MAX) {
		const struct message_want *want = &stick->requests[--stick->request_count].want;

		if (!stick->options.is_wanted(stick->options.data, want->hash))
			continue;
		job->objects[job->object_count++] = (struct job_object){ .want = *want };
		bytes += want->size;
	}
	if (job->object_count == 0)
		return;
	job->kind = JOB_OBJECTS;
	job->forgets = false;
	memcpy(job->roots, stick->roots, sizeof(job->roots));
	job->root_count = stick->root_count;
	stick->began_ms = clock_now_ms();
	set_state(stick->worker, WORKER_BUSY);
}

static void begin_file(struct stick *stick)
{
	struct job *job = &stick->worker->job;

	job->kind = JOB_FILE;
	job->forgets = false;
	job->file = stick->asked;
	stick->asked.name[0] = '\0';
	buffer_init(&job->file_bytes, job->file.bytes_max);
	stick->began_ms = clock_now_ms();
	set_state(stick->worker, WORKER_BUSY);
}

/* Returns true if a stick was plugged in. */
static bool finish_look(struct stick *stick)
{
	const struct job *job = &stick->worker->job;

	if (job->change == STICK_REMOVED) {
		if (stick->is_here)
			log_info("net", "the stick was removed");
		refuse_all(stick);
	}
	if (job->change != STICK_INSERTED)
		return false;
	log_info("net", "found a stick with a release: %s/%s", stick->worker->reader.folder,
		 stick->worker->reader.below);
	stick->is_here = true;
	/* Metadata that was read for another root may be of another form; the next look reads. */
	for (size_t i = 0; i < job->file_count && job->root_version == stick->root_version; i++)
		stick->options.meta(stick->options.data, job->files[i].role, job->files[i].version,
				    buffer_bytes(&job->files[i].bytes));
	return true;
}

static void finish_read(struct stick *stick)
{
	const struct job *job = &stick->worker->job;

	for (size_t i = 0; i < job->object_count; i++) {
		const struct job_object *object = &job->objects[i];

		answer(stick, object->want.hash, object->rc, buffer_bytes(&object->bytes));
	}
}

static void finish_file(struct stick *stick)
{
	struct message_file file = stick->worker->job.file;

	if (file.answer == FILE_IS_HERE)
		file.bytes = buffer_bytes(&stick->worker->job.file_bytes);
	stick->options.file(stick->options.data, &file);
}

/* Handles a finished job; returns true if a stick was plugged in. The result of a job that was
 * given up is discarded, because another stick may be present by now. */
static bool finish_job(struct stick *stick)
{
	bool inserted = false;

	if (stick->hangs) {
		stick->hangs = false;
		stick->forgets = true;
		stick->look_ms = clock_now_ms() + HANG_PAUSE_MS;
	} else if (stick->worker->job.kind == JOB_LOOK) {
		inserted = finish_look(stick);
	} else if (stick->worker->job.kind == JOB_FILE) {
		finish_file(stick);
	} else {
		finish_read(stick);
	}
	clear_job(&stick->worker->job);
	set_state(stick->worker, WORKER_IDLE);
	return inserted;
}

/* Gives up the current job. The thread owns the objects of the job, but it does not change the
 * wants in it, so they may be read here. */
static void give_up_job(struct stick *stick)
{
	const struct job *job = &stick->worker->job;

	log_warn("net", "the stick does not respond and is not used for a while");
	stick->hangs = true;
	for (size_t i = 0; job->kind == JOB_OBJECTS && i < job->object_count; i++)
		answer(stick, job->objects[i].want.hash, -ENOENT, (struct bytes){ NULL, 0 });
	refuse_all(stick);
}

bool stick_work(struct stick *stick, bool has_room)
{
	enum worker_state state;
	bool inserted = false;

	if (!stick)
		return false;
	state = state_of(stick->worker);
	if (state == WORKER_BUSY) {
		if (!stick->hangs && clock_now_ms() >= stick->began_ms + stick->options.patience_ms)
			give_up_job(stick);
		return false;
	}
	if (state == WORKER_DONE)
		inserted = finish_job(stick);
	if (clock_now_ms() >= stick->look_ms)
		begin_look(stick);
	else if (stick->asked.name[0])
		begin_file(stick);
	else if (has_room && stick->request_count > 0)
		begin_read(stick);
	return inserted;
}

void stick_clear_event(struct stick *stick)
{
	eventfd_t count;

	if (stick && eventfd_read(stick->worker->event_fd, &count) < 0)
		log_debug("net", "the stick's thread had no event");
}

int stick_fd(const struct stick *stick)
{
	return stick ? stick->worker->event_fd : -1;
}

int64_t stick_due_ms(const struct stick *stick, bool has_room)
{
	if (!stick)
		return INT64_MAX;
	if (state_of(stick->worker) == WORKER_IDLE)
		return stick->asked.name[0] || (has_room && stick->request_count > 0)
			       ? 0
			       : stick->look_ms;
	/* The event descriptor reports the end of the job. */
	return stick->hangs ? INT64_MAX : stick->began_ms + stick->options.patience_ms;
}
