/* The queues between the server's thread and the session's, and what the latter does. */
#include "curator/session/session.h"

#include <errno.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/log.h"
#include "curator/region/region_smooth.h"
#include "curator/session/answers.h"
#include "curator/session/painter.h"
#include "curator/session/part_store.h"
#include "curator/session/request.h"
#include "curator/session/selection.h"
#include "geometry/vec.h"

enum {
	COMMANDS_MAX = 64,
	TEXTS_MAX = 256,
	FRAMES_UNDERWAY_MAX = 2, /* pictures sent whose arrival is not yet known */
	PREPARE_AFTER_MS = 250,  /* at rest for so long, the tools get ready */
	FRAME_SHARP = 1,
	FRAME_SMOOTH = 2,
};

struct session {
	struct session_options options;
	pthread_t thread;
	/* Of the thread alone. */
	struct region_set set;
	struct painter *painter; /* owned */
	struct selection selection;
	struct open_part open;
	uint32_t sharp_view; /* the number of the sharp view's camera */
	bool region_changed, prepared, smoothed;

	pthread_mutex_t lock;
	pthread_cond_t changed;
	/* Under the lock. */
	bool ending, lost;
	struct request commands[COMMANDS_MAX]; /* a ring */
	uint32_t command_first, command_count;
	struct request camera; /* the newest */
	bool camera_is_new;
	char *texts[TEXTS_MAX]; /* owned; a ring */
	uint32_t text_first, text_count;
	struct buffer frame; /* the one that waits; empty: none */
	uint32_t frames_underway;
};

/* ---- to the browser */

/* text is taken. NULL: there was no memory for it, and the browser would wait for it. */
static void send_text(struct session *session, char *text)
{
	pthread_mutex_lock(&session->lock);
	if (!text || session->text_count == TEXTS_MAX) {
		session->lost = true;
		free(text);
	} else {
		session->texts[(session->text_first + session->text_count++) % TEXTS_MAX] = text;
	}
	pthread_mutex_unlock(&session->lock);
	session->options.wake(session->options.user);
}

static void send_error(struct session *session, const char *text)
{
	send_text(session, answer_error(NULL, NULL, text));
}

/* opened: the part that the region is of since this message, "" if of none; NULL: as before. */
static void send_region(struct session *session, const char *opened)
{
	send_text(session, answer_region(&session->set, session->selection.has_marks, opened));
}

static void say_hello(struct session *session)
{
	send_text(session, answer_hello(session->options.site));
	send_text(session, answer_parts(session->options.site, NULL));
	send_region(session, "");
}

/* ---- what the browser asks for */

static const char *sentence(int rc)
{
	switch (rc) {
	case -ESTALE:
		return "the picture has changed since: wait until it is sharp";
	case -EINVAL:
		return "that marks nothing: mark some of the part, or go around it";
	default:
		return strerror(-rc);
	}
}

static int work_with_tools(struct session *session, const struct request *request)
{
	struct selection *selection = &session->selection;
	float point_m[3];
	bool is_there;

	if (!selection->image || request->view != session->sharp_view)
		return -ESTALE;
	if (request->kind == REQUEST_STROKE)
		return selection_stroke(selection, request);
	if (request->kind == REQUEST_APPLY)
		return selection_apply(selection, request->take, request->through);
	is_there = selection_pick(selection, request->points_px[0], point_m);
	send_text(session, answer_point(is_there ? point_m : NULL));
	return 0;
}

static int change_region(struct session *session, enum request_kind kind)
{
	struct region_set *set = &session->set;

	switch (kind) {
	case REQUEST_UNDO:
		region_set_undo(set); /* false: there was nothing to undo */
		return 0;
	case REQUEST_REDO:
		region_set_redo(set);
		return 0;
	case REQUEST_GROW:
		return region_set_grow(set, session->options.site->mesh);
	case REQUEST_SHRINK:
		return region_set_shrink(set, session->options.site->mesh);
	case REQUEST_SMOOTH:
		return region_set_smooth(set, session->options.site->mesh);
	default:
		region_set_begin(set);
		region_set_put_all(set, false);
		return region_set_commit(set);
	}
}

static int save_part(struct session *session, const struct request *request,
		     struct diagnostics *diagnostics)
{
	const struct caller *caller = &session->options.caller;
	const struct part_to_save save = { .id = request->id,
					   .is_new = request->is_new,
					   .replaces = request->replaces,
					   .title = request->title,
					   .from = request->from,
					   .language = request->language,
					   .author = caller->name };
	int rc;

	if (caller->role < ROLE_EDITOR)
		return diagnostics_add(diagnostics, -EPERM, NULL, 0,
				       "a reader cannot save: whoever administers gopura-curator "
				       "can make you an editor");
	rc = part_store_save(session->options.site, &session->set, &save, &session->open,
			     diagnostics);
	if (rc < 0)
		return rc;
	log_info("curator", "%s saved part %s with %" PRIu32 " triangles", caller->name,
		 session->open.id, session->set.count);
	send_text(session, answer_parts(session->options.site, session->open.id));
	return 0;
}

/* Works on a part, or on a new one. What was marked before is not of it, so no undoing leads
 * there. */
static int begin_part(struct session *session, const struct request *request,
		      struct diagnostics *diagnostics)
{
	int rc;

	if (request->kind == REQUEST_OPEN)
		rc = part_store_open(session->options.site, &session->set, request->id,
				     &session->open, diagnostics);
	else
		rc = change_region(session, REQUEST_EMPTY);
	if (rc < 0)
		return rc;
	if (request->kind == REQUEST_EMPTY)
		session->open = (struct open_part){ 0 };
	region_set_forget(&session->set);
	session->region_changed = true;
	send_region(session, session->open.id);
	return 0;
}

static void answer_failure(struct session *session, enum request_kind kind, int rc,
			   const struct diagnostics *diagnostics)
{
	const char *conflict = NULL;

	if (kind == REQUEST_SAVE && rc == -ESTALE)
		conflict = "changed";
	else if (kind == REQUEST_SAVE && rc == -ENOENT)
		conflict = "removed";
	send_text(session, answer_error(request_type(kind), conflict,
					diagnostics_total(diagnostics) > 0
						? diagnostics_cause(diagnostics, rc)
						: sentence(rc)));
}

/* Every message has one answer: an error, what was asked for, or the state of the region. */
static void carry_out(struct session *session, const struct request *request)
{
	const uint32_t steps = session->set.done_count, triangles = session->set.count;
	struct diagnostics diagnostics = { 0 };
	bool answered = true;
	int rc = 0;

	switch (request->kind) {
	case REQUEST_PICK:
		rc = work_with_tools(session, request);
		break;
	case REQUEST_SAVE:
		rc = save_part(session, request, &diagnostics);
		break;
	case REQUEST_OPEN:
	case REQUEST_EMPTY:
		rc = begin_part(session, request, &diagnostics);
		break;
	case REQUEST_STROKE:
	case REQUEST_APPLY:
		rc = work_with_tools(session, request);
		answered = false;
		break;
	case REQUEST_CLEAR:
		selection_clear(&session->selection);
		answered = false;
		break;
	default:
		rc = change_region(session, request->kind);
		answered = false;
	}
	if (session->set.done_count != steps || session->set.count != triangles)
		session->region_changed = true;
	if (rc < 0)
		answer_failure(session, request->kind, rc, &diagnostics);
	else if (!answered)
		send_region(session, NULL);
}

/* ---- pictures */

/* Begins a picture: the number of its camera, and what it is. */
static void begin_frame(struct buffer *frame, uint32_t view, unsigned flags)
{
	buffer_init(frame, SESSION_MESSAGE_BYTES_MAX);
	buffer_put_u32(frame, view);
	buffer_put_u32(frame, flags);
}

/* frame is taken. */
static void send_frame(struct session *session, struct buffer *frame, int rc)
{
	if (rc == 0)
		rc = frame->error;
	if (rc < 0) {
		log_error("curator", "a picture cannot be drawn: %s", strerror(-rc));
		send_error(session, "the picture cannot be drawn");
		buffer_finish(frame);
		return;
	}
	pthread_mutex_lock(&session->lock);
	session->frame = *frame;
	session->frames_underway++;
	pthread_mutex_unlock(&session->lock);
	session->options.wake(session->options.user);
}

static void set_depths(const struct site *site, struct camera *camera)
{
	float size_m[3];

	vec_sub(size_m, site->master->box_max_m, site->master->box_min_m);
	camera->near_m = vec_length(size_m) / 5000;
	camera->far_m = vec_length(size_m) * 100;
}

static void draw(struct session *session, const struct request *camera)
{
	struct camera eye = camera->camera;
	const struct view_image *image;
	struct buffer frame;
	int rc;

	set_depths(session->options.site, &eye);
	begin_frame(&frame, camera->view, camera->moving ? 0 : FRAME_SHARP);
	if (!camera->moving)
		selection_leave(&session->selection);
	rc = painter_draw(session->painter, &eye, !camera->moving, &frame);
	send_frame(session, &frame, rc);
	session->region_changed = false;
	if (camera->moving || rc < 0)
		return;
	image = painter_view(session->painter, &eye);
	rc = selection_look(&session->selection, image, &eye);
	if (rc < 0)
		send_error(session, strerror(-rc));
	session->sharp_view = camera->view;
	session->prepared = session->smoothed = false;
}

/* Shows the last sharp view with the region as it is now. */
static void draw_again(struct session *session)
{
	struct buffer frame;
	int rc;

	begin_frame(&frame, session->sharp_view, FRAME_SHARP);
	rc = painter_draw_again(session->painter, &frame);
	send_frame(session, &frame, rc);
	session->region_changed = session->smoothed = false;
}

/* A step towards the same picture with smooth edges, which is sent after the last one. */
static void smooth(struct session *session)
{
	struct buffer frame;
	int rc;

	begin_frame(&frame, session->sharp_view, FRAME_SHARP | FRAME_SMOOTH);
	rc = painter_smooth(session->painter, &frame);
	if (rc > 0) {
		buffer_finish(&frame);
		return;
	}
	session->smoothed = true;
	send_frame(session, &frame, rc);
}

/* ---- the thread */

/* What is next; under the lock. */
enum task { TASK_NONE, TASK_END, TASK_COMMAND, TASK_DRAW, TASK_AGAIN, TASK_SMOOTH };

static enum task next_task(const struct session *session)
{
	const bool may_draw =
		session->frame.size == 0 && session->frames_underway < FRAMES_UNDERWAY_MAX;

	if (session->ending)
		return TASK_END;
	if (session->command_count > 0)
		return TASK_COMMAND;
	if (may_draw && session->camera_is_new)
		return TASK_DRAW;
	if (may_draw && session->region_changed && session->selection.image &&
	    !session->camera.moving)
		return TASK_AGAIN;
	if (may_draw && session->prepared && !session->smoothed && session->selection.image &&
	    !session->camera.moving)
		return TASK_SMOOTH;
	return TASK_NONE;
}

/* Returns false after PREPARE_AFTER_MS without news. */
static bool wait_for_news(struct session *session)
{
	struct timespec until;

	if (session->prepared || !session->selection.image) {
		pthread_cond_wait(&session->changed, &session->lock);
		return true;
	}
	clock_gettime(CLOCK_MONOTONIC, &until);
	until.tv_nsec += PREPARE_AFTER_MS * 1000000L;
	until.tv_sec += until.tv_nsec / 1000000000;
	until.tv_nsec %= 1000000000;
	return pthread_cond_timedwait(&session->changed, &session->lock, &until) != ETIMEDOUT;
}

/* Waits for the next task, and takes what it is about. The tools get ready meanwhile. */
static enum task take_task(struct session *session, struct request *about)
{
	enum task task;
	bool idle = false;

	pthread_mutex_lock(&session->lock);
	while ((task = next_task(session)) == TASK_NONE && !idle)
		idle = !wait_for_news(session);
	if (task == TASK_COMMAND) {
		*about = session->commands[session->command_first];
		session->command_first = (session->command_first + 1) % COMMANDS_MAX;
		session->command_count--;
	} else if (task == TASK_DRAW) {
		*about = session->camera;
		session->camera_is_new = false;
	}
	pthread_mutex_unlock(&session->lock);
	return task;
}

static void prepare(struct session *session)
{
	int rc = selection_prepare(&session->selection);

	session->prepared = true;
	if (rc < 0)
		log_warn("curator", "the tools cannot get ready: %s", strerror(-rc));
}

static void *work(void *user)
{
	struct session *session = user;
	struct request about;

	say_hello(session);
	for (;;)
		switch (take_task(session, &about)) {
		case TASK_END:
			return NULL;
		case TASK_COMMAND:
			carry_out(session, &about);
			request_finish(&about);
			break;
		case TASK_DRAW:
			draw(session, &about);
			break;
		case TASK_AGAIN:
			draw_again(session);
			break;
		case TASK_SMOOTH:
			smooth(session);
			break;
		case TASK_NONE:
			prepare(session);
			break;
		}
}

int session_create(struct session **out, const struct session_options *options)
{
	struct session *session = calloc(1, sizeof(*session));
	pthread_condattr_t attributes;
	int rc;

	*out = NULL;
	if (!session)
		return -ENOMEM;
	session->options = *options;
	pthread_mutex_init(&session->lock, NULL);
	pthread_condattr_init(&attributes);
	pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
	pthread_cond_init(&session->changed, &attributes);
	pthread_condattr_destroy(&attributes);
	rc = region_set_init(&session->set, options->site->mesh->triangle_count);
	selection_init(&session->selection, options->site, &session->set);
	if (rc == 0)
		rc = painter_create(&session->painter, options->site, &session->set);
	if (rc == 0)
		rc = -pthread_create(&session->thread, NULL, work, session);
	if (rc < 0) {
		session->ending = true; /* there is no thread */
		session_destroy(session);
		return rc;
	}
	*out = session;
	return 0;
}

static void end_thread(struct session *session)
{
	bool runs;

	pthread_mutex_lock(&session->lock);
	runs = !session->ending;
	session->ending = true;
	pthread_cond_signal(&session->changed);
	pthread_mutex_unlock(&session->lock);
	if (runs)
		pthread_join(session->thread, NULL);
}

void session_destroy(struct session *session)
{
	if (!session)
		return;
	end_thread(session);
	for (uint32_t n = 0; n < session->command_count; n++)
		request_finish(&session->commands[(session->command_first + n) % COMMANDS_MAX]);
	for (uint32_t n = 0; n < session->text_count; n++)
		free(session->texts[(session->text_first + n) % TEXTS_MAX]);
	buffer_finish(&session->frame);
	selection_leave(&session->selection);
	painter_destroy(session->painter);
	region_set_finish(&session->set);
	pthread_cond_destroy(&session->changed);
	pthread_mutex_destroy(&session->lock);
	free(session);
}

/* ---- the server's side */

/* Under the lock. Returns false if the queue is full; otherwise the message is taken. */
static bool enqueue(struct session *session, const struct request *request)
{
	switch (request->kind) {
	case REQUEST_CAMERA:
		session->camera = *request;
		session->camera_is_new = true;
		return true;
	case REQUEST_GOT:
		if (session->frames_underway > 0)
			session->frames_underway--;
		return true;
	default:
		if (session->command_count == COMMANDS_MAX)
			return false;
		session->commands[(session->command_first + session->command_count++) %
				  COMMANDS_MAX] = *request;
		return true;
	}
}

void session_receive(struct session *session, const char *text, size_t bytes)
{
	char problem[REQUEST_PROBLEM_BYTES];
	struct request request;
	enum request_kind kind;
	bool taken;

	if (request_parse(&request, text, bytes, problem) < 0) {
		send_error(session, problem);
		return;
	}
	kind = request.kind;
	pthread_mutex_lock(&session->lock);
	taken = enqueue(session, &request);
	pthread_cond_signal(&session->changed);
	pthread_mutex_unlock(&session->lock);
	if (taken)
		return;
	request_finish(&request);
	send_text(session,
		  answer_error(request_type(kind), NULL, "too much at once: wait for the answers"));
}

bool session_next(struct session *session, struct buffer *out, bool *binary)
{
	bool has = true;

	pthread_mutex_lock(&session->lock);
	if (session->text_count > 0) {
		char *text = session->texts[session->text_first];

		session->text_first = (session->text_first + 1) % TEXTS_MAX;
		session->text_count--;
		buffer_put_text(out, text);
		free(text);
		*binary = false;
	} else if (session->frame.size > 0) {
		buffer_put(out, session->frame.data, session->frame.size);
		buffer_finish(&session->frame);
		session->frame = (struct buffer){ 0 };
		*binary = true;
		pthread_cond_signal(&session->changed);
	} else {
		has = false;
	}
	pthread_mutex_unlock(&session->lock);
	return has;
}

bool session_is_lost(struct session *session)
{
	bool lost;

	pthread_mutex_lock(&session->lock);
	lost = session->lost;
	pthread_mutex_unlock(&session->lock);
	return lost;
}
