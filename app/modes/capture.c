/* Writes pictures for --views and --shots: sets the camera for each listed view, waits until its
 * picture has settled, and writes a PNG and a line of measurements; or writes PNGs at given times
 * of a replay. */
#include "app/modes/capture.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/clock.h"
#include "base/log.h"
#include "format/picture.h"

enum {
	VIEWS_MAX = 10000,
	SHOTS_MAX = 200,
	SHOT_NAME_BYTES = 64,
	VIEW_MOST_MS = 120000, /* longest wait for a view; then it is written with a warning */
	QUIET_MS = 1200,       /* without a byte received; longer than the status interval */
	FILM_FIRST_MS = 50,    /* between two pictures of a view while it loads, at least, */
	FILM_SHARE = 40,       /* and this part of the time that it has been loading */
	FRAMES_MAX = 4096,
	LOOK_MS = 20, /* interval of frames that are drawn to see whether all is quiet */
};

struct view {
	float eye_m[3], target_m[3], fov_deg;
};

struct shot {
	int64_t at_ms; /* since the first frame */
	char name[SHOT_NAME_BYTES];
};

struct capture {
	const char *folder;
	bool overlay; /* draw it on pictures of views too */
	bool film;    /* take pictures of a view while it loads, too */
	struct redraw *redraw;
	struct view *views; /* owned */
	struct shot *shots; /* owned */
	uint32_t count, at;
	FILE *lines; /* views.jsonl */

	int64_t began_ms;       /* start of this view, or of the replay; 0: not yet */
	int64_t first_ms;       /* when its first picture was drawn; 0: not yet */
	int64_t film_ms;        /* of the next picture while it loads, since it began */
	int64_t quiet_since_ms; /* when it became quiet; 0: not settled */
	uint64_t bytes_before;  /* bytes received when this view began */
	uint64_t bytes_seen;
	uint32_t objects;
	uint32_t frame_us[FRAMES_MAX];
	uint32_t frames;
};

/* ---- lists of views and shots */

static bool parse_view(const char *line, struct view *view)
{
	char rest;

	return sscanf(line, "%f %f %f %f %f %f %f %c", &view->eye_m[0], &view->eye_m[1],
		      &view->eye_m[2], &view->target_m[0], &view->target_m[1], &view->target_m[2],
		      &view->fov_deg, &rest) == 7 &&
	       view->fov_deg >= 1 && view->fov_deg <= 150 &&
	       memcmp(view->eye_m, view->target_m, sizeof(view->eye_m)) != 0;
}

static bool parse_shot(const char *line, struct shot *shot)
{
	long ms;
	char rest;

	if (sscanf(line, "%ld %63[a-zA-Z0-9_-] %c", &ms, shot->name, &rest) != 2 || ms < 0)
		return false;
	shot->at_ms = ms;
	return true;
}

static int read_lines(struct capture *capture, const char *path, bool views)
{
	const uint32_t most = views ? VIEWS_MAX : SHOTS_MAX;
	FILE *file = fopen(path, "re");
	char line[512];
	unsigned number = 0;
	int rc = 0;

	if (!file) {
		rc = -errno;
		log_error("app", "%s: %s", path, strerror(-rc));
		return rc;
	}
	while (rc == 0 && fgets(line, sizeof(line), file)) {
		number++;
		if (line[strspn(line, " \t\r\n")] == '\0' || line[0] == '#')
			continue;
		if (capture->count == most ||
		    !(views ? parse_view(line, &capture->views[capture->count])
			    : parse_shot(line, &capture->shots[capture->count]))) {
			log_error("app", "%s, line %u: expected %s", path, number,
				  views ? "eye x y z, target x y z, field of view in degrees"
					: "milliseconds and a name of letters, digits, - and _");
			rc = -EINVAL;
		}
		capture->count++;
	}
	fclose(file);
	if (rc == 0 && capture->count == 0) {
		log_error("app", "%s: the file has no entries", path);
		rc = -EINVAL;
	}
	return rc;
}

int capture_create(struct capture **out, const struct options *options, struct redraw *redraw)
{
	const bool views = options->views_path != NULL;
	struct capture *capture;
	char path[1024];
	int rc = 0;

	*out = NULL;
	if (!views && !options->shots_path)
		return 0;
	capture = calloc(1, sizeof(*capture));
	if (!capture)
		return -ENOMEM;
	capture->folder = options->capture_dir;
	capture->overlay = options->capture_overlay;
	capture->film = options->capture_film;
	capture->redraw = redraw;
	if (mkdir(capture->folder, 0777) < 0 && errno != EEXIST)
		rc = -errno;
	if (views) {
		capture->views = calloc(VIEWS_MAX, sizeof(*capture->views));
		snprintf(path, sizeof(path), "%s/views.jsonl", capture->folder);
		capture->lines = rc == 0 ? fopen(path, "we") : NULL;
		if (rc == 0 && !capture->lines)
			rc = -errno;
	} else {
		capture->shots = calloc(SHOTS_MAX, sizeof(*capture->shots));
	}
	if (rc < 0)
		log_error("app", "%s: %s", capture->folder, strerror(-rc));
	else if (!capture->views && !capture->shots)
		rc = -ENOMEM;
	else
		rc = read_lines(capture, views ? options->views_path : options->shots_path, views);
	if (rc < 0) {
		capture_destroy(capture);
		return rc;
	}
	*out = capture;
	return 0;
}

void capture_destroy(struct capture *capture)
{
	if (!capture)
		return;
	if (capture->lines)
		fclose(capture->lines);
	free(capture->views);
	free(capture->shots);
	free(capture);
}

/* ---- pictures */

/* Writes the frame as PNG. With coverage, which is for pictures of the scene alone, alpha tells how
 * much of a pixel the model covers, and pixels without it are black, so that equal pictures have
 * equal bytes. Otherwise alpha is 255. */
static int write_picture(const struct capture *capture, const struct capture_frame *frame,
			 const char *name, bool coverage)
{
	struct picture picture = {
		.width = (uint32_t)display_width_px(frame->display),
		.height = (uint32_t)display_height_px(frame->display),
	};
	const size_t count = (size_t)picture.width * picture.height;
	struct buffer file;
	char path[1024];
	int rc = -ENOMEM;

	buffer_init(&file, 256 << 20);
	picture.rgba = malloc(count * 4);
	if (picture.rgba)
		rc = display_read(frame->display, picture.rgba);
	if (rc == 0 && coverage && frame->shown->scene)
		scene_unmix(frame->shown->scene, picture.rgba, count);
	for (size_t i = 0; rc == 0 && !coverage && i < count; i++)
		picture.rgba[4 * i + 3] = 255;
	if (rc == 0)
		rc = picture_encode_png(&file, &picture);
	snprintf(path, sizeof(path), "%s/%s.png", capture->folder, name);
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&file), path);
	if (rc < 0)
		log_error("app", "%s: %s", path, strerror(-rc));
	picture_finish(&picture);
	buffer_finish(&file);
	return rc;
}

static int by_value(const void *a, const void *b)
{
	const uint32_t left = *(const uint32_t *)a, right = *(const uint32_t *)b;

	return left < right ? -1 : left > right;
}

static double median_ms(struct capture *capture)
{
	if (capture->frames == 0)
		return 0;
	qsort(capture->frame_us, capture->frames, sizeof(capture->frame_us[0]), by_value);
	return capture->frame_us[capture->frames / 2] / 1000.0;
}

static void write_line(struct capture *capture, const struct capture_frame *frame, bool settled,
		       int64_t now_ms)
{
	fprintf(capture->lines,
		"{\"view\": %u, \"bytes_fetched\": %llu, \"objects\": %u, \"first_ms\": %lld, "
		"\"settled_ms\": %lld, \"settled\": %s, \"frame_ms\": %.2f, \"triangles\": %u, "
		"\"image_share\": %.4f}\n",
		capture->at, (unsigned long long)(frame->received_bytes - capture->bytes_before),
		capture->objects, (long long)(capture->first_ms - capture->began_ms),
		(long long)((settled ? capture->quiet_since_ms : now_ms) - capture->began_ms),
		settled ? "true" : "false", median_ms(capture), frame->shown->frame.triangles,
		(double)frame->shown->frame.image_share);
	fflush(capture->lines);
}

/* ---- views */

static void begin_view(struct capture *capture, uint64_t received_bytes)
{
	capture->began_ms = clock_now_ms();
	capture->first_ms = capture->quiet_since_ms = 0;
	capture->film_ms = FILM_FIRST_MS;
	capture->bytes_before = capture->at == 0 ? 0 : received_bytes;
	capture->objects = 0;
	capture->frames = 0;
}

void capture_aim(struct capture *capture, struct eye *eye, const struct viewport *viewport,
		 uint64_t received_bytes)
{
	const struct view *view = &capture->views[capture->at];
	struct camera *camera = &eye->camera;

	if (!capture->views || capture->at >= capture->count || !eye->ready)
		return;
	if (!capture->began_ms)
		begin_view(capture, received_bytes);
	navigator_camera(&eye->navigator, camera); /* clip distances */
	viewport_set_camera(viewport, camera);
	memcpy(camera->eye_m, view->eye_m, sizeof(camera->eye_m));
	memcpy(camera->target_m, view->target_m, sizeof(camera->target_m));
	camera->fov_deg = view->fov_deg;
}

/* Returns whether the picture is complete: it has settled, and no byte has arrived for QUIET_MS, so
 * the fetcher's status counts every byte. */
static bool is_quiet(struct capture *capture, const struct capture_frame *frame, int64_t now_ms)
{
	if (!frame->shown->frame.settled || frame->words_move ||
	    frame->received_bytes != capture->bytes_seen) {
		capture->quiet_since_ms = 0;
		capture->bytes_seen = frame->received_bytes;
		return false;
	}
	if (!capture->quiet_since_ms)
		capture->quiet_since_ms = now_ms;
	return now_ms - capture->quiet_since_ms >= QUIET_MS;
}

/* Pictures of a view while it loads. They grow rarer with time, so that they show what changes and
 * delay it little. */
static int film(struct capture *capture, const struct capture_frame *frame, int64_t now_ms)
{
	const int64_t passed_ms = now_ms - capture->began_ms;
	char name[48];

	if (!capture->film || !capture->first_ms || passed_ms < capture->film_ms)
		return 0;
	capture->film_ms = passed_ms + FILM_FIRST_MS + passed_ms / FILM_SHARE;
	snprintf(name, sizeof(name), "view-%04u-%06lld", capture->at, (long long)passed_ms);
	return write_picture(capture, frame, name, !capture->overlay);
}

static int after_view(struct capture *capture, const struct capture_frame *frame)
{
	const int64_t now_ms = clock_now_ms();
	bool quiet, late;
	char name[32];
	int rc;

	if (!capture->began_ms)
		return 0;
	if (frame->shown->frame.patches + frame->shown->frame.stream_triangles > 0 &&
	    !capture->first_ms)
		capture->first_ms = now_ms;
	if (capture->frames < FRAMES_MAX)
		capture->frame_us[capture->frames++] = frame->work_us;
	quiet = is_quiet(capture, frame, now_ms);
	late = now_ms - capture->began_ms > VIEW_MOST_MS;
	if (!quiet && !late)
		return film(capture, frame, now_ms);
	if (late)
		log_warn("app", "view %u did not settle in %d s", capture->at, VIEW_MOST_MS / 1000);
	snprintf(name, sizeof(name), "view-%04u", capture->at);
	rc = write_picture(capture, frame, name, !capture->overlay);
	write_line(capture, frame, quiet, now_ms);
	capture->at++;
	capture->began_ms = 0;
	redraw_ask(capture->redraw);
	return rc == 0 && capture->at == capture->count ? 1 : rc;
}

/* ---- shots */

static int after_replay_frame(struct capture *capture, const struct capture_frame *frame)
{
	const int64_t now_ms = clock_now_ms();
	int rc = 0;

	if (!capture->began_ms)
		capture->began_ms = now_ms;
	while (rc == 0 && capture->at < capture->count &&
	       now_ms - capture->began_ms >= capture->shots[capture->at].at_ms) {
		rc = write_picture(capture, frame, capture->shots[capture->at].name, false);
		capture->at++;
	}
	return rc;
}

int capture_after(struct capture *capture, const struct capture_frame *frame)
{
	return capture->views ? after_view(capture, frame) : after_replay_frame(capture, frame);
}

void capture_object(struct capture *capture)
{
	capture->objects++;
}

int capture_wait_ms(const struct capture *capture, int64_t frame_ms)
{
	int64_t due_ms = frame_ms + LOOK_MS, left_ms;

	if (capture->at >= capture->count)
		return -1;
	if (!capture->views && capture->began_ms)
		due_ms = capture->began_ms + capture->shots[capture->at].at_ms;
	left_ms = due_ms - clock_now_ms();
	return left_ms > 0 ? (int)left_ms : 0;
}
