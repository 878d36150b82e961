#include "tests/bench/stage.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "format/picture.h"
#include "geometry/vec.h"
#include "render/scene/scene_objects.h"
#include "render/scene/scene_parts.h"
#include "tests/silhouette.h"

/* ---- clock: the linker wraps base/clock's in these (Makefile) */

enum {
	LOOK_US = 100, /* a look at the clock takes so long, so budgets of time end */
	FRAME_US = 16667,
	WINDOW_BYTES = 64 << 10, /* asked for ahead: what comes first can still change */
};

static bool is_virtual;
static int64_t virtual_us = 1000000000;
/* Within a frame of the work clock: this thread's processor time at its begin. */
static int64_t work_from_us = -1;
static float work_slowness = 1;

int64_t __real_clock_now_us(void);
int64_t __wrap_clock_now_us(void);
int64_t __wrap_clock_now_ms(void);

int64_t __wrap_clock_now_us(void)
{
	if (!is_virtual)
		return __real_clock_now_us();
	if (work_from_us >= 0)
		return virtual_us +
		       (int64_t)((float)(clock_thread_us() - work_from_us) * work_slowness);
	return virtual_us += LOOK_US;
}

int64_t __wrap_clock_now_ms(void)
{
	return __wrap_clock_now_us() / 1000;
}

/* ---- life */

void stage_die(const char *what, int rc)
{
	fprintf(stderr, "bench: %s: %s\n", what, strerror(-rc));
	exit(1);
}

void stage_must(int rc, const char *what)
{
	if (rc < 0)
		stage_die(what, rc);
}

uint32_t stage_read_views(struct camera *cameras, uint32_t most, const char *path, int width_px,
			  int height_px)
{
	FILE *file = fopen(path, "re");
	char line[256];
	uint32_t count = 0;

	if (!file)
		stage_die(path, -errno);
	while (count < most && fgets(line, sizeof(line), file)) {
		struct camera c = { .up = { 0, 0, 1 },
				    .far_m = 2000,
				    .width_px = width_px,
				    .height_px = height_px };

		if (sscanf(line, "%f %f %f %f %f %f %f", &c.eye_m[0], &c.eye_m[1], &c.eye_m[2],
			   &c.target_m[0], &c.target_m[1], &c.target_m[2], &c.fov_deg) != 7)
			continue;
		/* Models may be a hand wide, or a temple's length. */
		c.near_m = fminf(0.1f, vec_distance(c.eye_m, c.target_m) / 100);
		cameras[count++] = c;
	}
	fclose(file);
	if (count == 0)
		stage_die(path, -EINVAL);
	return count;
}

/* The newest file of locator/ names the root. */
static void find_root(struct stage *stage, char path[512])
{
	char newest[HASH_HEX_BYTES] = "";
	time_t when = 0;
	DIR *folder;

	snprintf(path, 512, "%s/locator", stage->options.release);
	folder = opendir(path);
	if (!folder)
		stage_die(path, -errno);
	for (struct dirent *entry; (entry = readdir(folder));) {
		struct stat info;

		snprintf(path, 512, "%s/locator/%.200s", stage->options.release, entry->d_name);
		if (strlen(entry->d_name) != HASH_HEX_BYTES - 1 || stat(path, &info) < 0 ||
		    info.st_mtime < when)
			continue;
		when = info.st_mtime;
		snprintf(newest, sizeof(newest), "%.32s", entry->d_name);
	}
	closedir(folder);
	stage_must(hash_from_hex(&stage->root, newest), "no locator");
	snprintf(path, 512, "locator/%s", newest);
}

static void open_release(struct stage *stage)
{
	const struct release_reader_options options = { .place = stage->options.release };
	const struct locator_block *block;
	struct buffer file;
	char path[512];

	find_root(stage, path);
	stage_must(release_reader_create(&stage->reader, &options), stage->options.release);
	buffer_init(&file, 256 << 20);
	stage_must(release_reader_file(stage->reader, path, &file), path);
	stage_must(locator_decode(&stage->locator, buffer_bytes(&file)), path);
	buffer_finish(&file);
	block = locator_find(&stage->locator,
			     (struct hash){ 0 }); /* the root page is its block alone */
	stage_must(block ? 0 : -ENOENT, "the root page");
	stage->root_bytes = block->size;
}

void stage_begin(struct stage *stage, const struct scene_options *options)
{
	struct scene_options chosen = *options;

	if (!stage->options.wall_clock)
		chosen.worker_count = 0;
	scene_destroy(stage->scene);
	stage->flights = 0;
	stage->bytes = stage->objects = 0;
	stage->bytes_most = UINT64_MAX;
	map_clear(&stage->had);
	map_clear(&stage->asked);
	stage_must(scene_create(&stage->scene, &chosen), "scene");
	stage_must(scene_open(stage->scene, stage->root, stage->root_bytes), "scene");
}

void stage_open(struct stage *stage, const struct stage_options *options)
{
	memset(stage, 0, sizeof(*stage));
	stage->options = *options;
	if (stage->options.frame_us == 0)
		stage->options.frame_us = FRAME_US;
	stage->cores = 2;
	stage->slowness = 1;
	is_virtual = !options->wall_clock;
	open_release(stage);
	stage_must(headless_create(&stage->headless), "no GL");
	stage_must(headless_panel(stage->headless, &stage->target, options->width_px,
				  options->height_px),
		   "target");
	stage_begin(stage, &options->scene);
}

void stage_close(struct stage *stage)
{
	scene_destroy(stage->scene);
	map_finish(&stage->had);
	map_finish(&stage->asked);
	gl_target_destroy(&stage->target);
	headless_destroy(stage->headless);
	locator_finish(&stage->locator);
	release_reader_destroy(stage->reader);
}

/* ---- the link */

static bool was_had(const struct stage *stage, struct hash hash)
{
	return map_get(&stage->had, hash_key(hash)) != MAP_NONE;
}

static void land(struct stage *stage, const struct message_want *want)
{
	const struct page_child child = { .hash = want->hash, .size = want->size };
	struct bytes bytes;
	int rc = release_reader_child(stage->reader, &stage->locator, want->page, want->offset,
				      &child, &bytes);

	if (rc < 0)
		stage_die(release_reader_why(stage->reader), rc);
	if (!was_had(stage, want->hash)) {
		const struct object *object = scene_object(stage->scene, want->hash);

		if (object)
			stage->bytes_of[object->kind] += bytes.size;
		stage->objects++;
		stage_must(map_set(&stage->had, hash_key(want->hash), 1), "memory");
	}
	map_remove(&stage->asked, hash_key(want->hash));
	scene_give(stage->scene, want->hash, bytes);
}

/* As the fetcher: what takes more than half a turn comes in segments of a quarter. */
static uint32_t segment_bytes(const struct stage *stage, uint64_t left, uint64_t turn)
{
	if (stage->options.bits_a_second == 0 || left <= turn / 2)
		return (uint32_t)left;
	return (uint32_t)(turn / 4);
}

static uint64_t turn_bytes(const struct stage *stage)
{
	uint64_t turn = stage->options.window_bytes ? stage->options.window_bytes : WINDOW_BYTES;

	/* A fetcher does not wait for frames: in a long one the line carries more. */
	if (stage->options.work_clock)
		turn += stage->options.bits_a_second / 8 * (uint64_t)stage->passed_us / 1000000;
	return turn;
}

/* Returns the bytes on their way of what is at least as urgent. */
static uint64_t ahead_of(const struct stage *stage, uint32_t priority)
{
	uint64_t ahead = 0;

	for (uint32_t i = 0; i < stage->flights; i++)
		if (stage->flight[i].want.priority >= priority)
			ahead += stage->flight[i].bytes;
	return ahead;
}

/* Returns what an object or segment is on the line. Neighbours share a range of a quarter of a
 * turn. */
static uint32_t bytes_on_line(struct stage *stage, uint32_t bytes, uint64_t turn)
{
	uint32_t headers = bytes * STAGE_PACKET_BYTES / STAGE_BYTES_A_PACKET;

	if (bytes > stage->range_left) {
		headers += STAGE_RANGE_BYTES + STAGE_PACKET_BYTES;
		stage->range_left = turn / 4;
	}
	stage->range_left -= bytes < stage->range_left ? bytes : stage->range_left;
	return bytes + headers;
}

/* Returns when so many bytes have come over the line. */
static int64_t carry(struct stage *stage, int64_t now_us, uint32_t bytes)
{
	int64_t from_us = now_us + stage->options.latency_us;

	from_us = from_us > stage->link_free_us ? from_us : stage->link_free_us;
	stage->link_free_us =
		from_us + (int64_t)(bytes * 8000000ull / stage->options.bits_a_second);
	return stage->link_free_us;
}

/* Sends for an object that a cache would have. Returns false if it has to wait. */
static bool send_to_cache(struct stage *stage, const struct message_want *want, int64_t now_us)
{
	const map_key key = hash_key(want->hash);

	if (map_get(&stage->asked, key) != MAP_NONE)
		return true;
	if (stage->flights == STAGE_IN_FLIGHT)
		return false;
	stage->flight[stage->flights++] =
		(struct stage_flight){ .want = *want, .last = true, .due_us = now_us };
	stage_must(map_set(&stage->asked, key, want->size), "memory");
	return true;
}

/* Sends for an object, or for as many segments of it as fit into the turn. Returns false if more
 * would have to wait. */
static bool send_over_line(struct stage *stage, const struct message_want *want, uint64_t turn,
			   int64_t now_us)
{
	const map_key key = hash_key(want->hash);
	const uint64_t known = map_get(&stage->asked, key);
	uint64_t asked = known == MAP_NONE ? 0 : known;

	while (asked < want->size) {
		struct stage_flight flight = { .want = *want };
		const uint64_t ahead = ahead_of(stage, want->priority);

		flight.bytes = segment_bytes(stage, want->size - asked, turn);
		if (stage->flights == STAGE_IN_FLIGHT || stage->bytes + ahead >= stage->bytes_most)
			return false;
		if (stage->options.bits_a_second > 0 && ahead > 0 && ahead + flight.bytes > turn)
			return false;
		flight.due_us = now_us + stage->options.latency_us;
		flight.line_bytes = bytes_on_line(stage, flight.bytes, turn);
		if (stage->options.bits_a_second > 0)
			flight.due_us = carry(stage, now_us, flight.line_bytes);
		asked += flight.bytes;
		flight.last = asked == want->size;
		stage->flight[stage->flights++] = flight;
		stage_must(map_set(&stage->asked, key, asked), "memory");
	}
	return true;
}

/* Sends for an object from where it is. Returns false if more would have to wait. */
static bool send_for_object(struct stage *stage, const struct message_want *want, uint64_t turn,
			    int64_t now_us)
{
	if (was_had(stage, want->hash))
		return send_to_cache(stage, want, now_us);
	return send_over_line(stage, want, turn, now_us);
}

/* Sends for what is wanted most, as far as a turn goes. */
static void send_for(struct stage *stage, int64_t now_us)
{
	struct message_want wants[2 * STAGE_IN_FLIGHT];
	size_t count = scene_wants(stage->scene, wants, 2 * STAGE_IN_FLIGHT);
	const uint64_t turn = turn_bytes(stage);

	for (size_t i = 0; i < count; i++)
		if (!send_for_object(stage, &wants[i], turn, now_us))
			return;
}

static void pass_link(struct stage *stage)
{
	const int64_t now_us = is_virtual ? virtual_us : clock_now_us();
	uint32_t kept = 0, count;

	send_for(stage, now_us);
	count = stage->flights;
	for (uint32_t i = 0; i < count; i++) {
		const struct stage_flight flight = stage->flight[i];

		if (flight.due_us > now_us) {
			stage->flight[kept++] = flight;
			continue;
		}
		stage->bytes += flight.line_bytes;
		if (flight.last)
			land(stage, &flight.want);
	}
	stage->flights = kept;
}

/* ---- frames */

static int64_t process_us(void)
{
	struct timespec now;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

static void draw(struct stage *stage, const struct camera *camera, struct scene_frame *out)
{
	const int64_t work_us = clock_thread_us(), all_us = process_us(),
		      wall_us = __real_clock_now_us();
	int64_t beside_us;

	if (stage->options.work_clock) {
		work_from_us = work_us;
		work_slowness = stage->slowness;
	}
	gl_target_bind(&stage->target);
	stage_must(scene_dispatch(stage->scene), "scene");
	scene_draw(stage->scene, camera, NULL, out);
	glFinish();
	work_from_us = -1;
	stage->wall_us = __real_clock_now_us() - wall_us;
	stage->work_us = clock_thread_us() - work_us;
	beside_us = process_us() - all_us - stage->work_us;
	stage->spent_us =
		(int64_t)((float)(stage->work_us + beside_us / stage->cores) * stage->slowness);
}

/* Takes up to so much from the time that workers still need for decoding. Returns how much. */
static int64_t work_off(struct stage *stage, int64_t most_us)
{
	const int64_t us = stage->decoding_us < most_us ? stage->decoding_us : most_us;

	stage->decoding_us -= us;
	return us;
}

/* Workers decode beside the frame: first on the cores that are idle while the drawing thread works
 * alone, then on half of all cores, which makes the frame longer, and at last in the time that is
 * left until the next frame. */
static void let_workers_decode(struct stage *stage)
{
	work_off(stage, stage->work_us * (stage->cores - 1));
	stage->spent_us += work_off(stage, stage->spent_us * stage->cores) / stage->cores;
	if (stage->options.frame_us > stage->spent_us)
		work_off(stage, (stage->options.frame_us - stage->spent_us) * stage->cores);
}

void stage_frame(struct stage *stage, const struct camera *camera, struct scene_frame *out)
{
	const int64_t began_us = virtual_us;
	int64_t work_us;

	draw(stage, camera, out);
	if (stage->options.work_clock) {
		let_workers_decode(stage);
		virtual_us = began_us + stage->spent_us;
	}
	if (is_virtual) {
		const int64_t next_us = began_us + stage->options.frame_us;

		virtual_us = next_us > virtual_us ? next_us : virtual_us;
	}
	stage->passed_us = virtual_us - began_us;
	work_us = clock_thread_us();
	pass_link(stage);
	stage->decoding_us += clock_thread_us() - work_us;
}

int64_t stage_now_us(void)
{
	return is_virtual ? virtual_us : __real_clock_now_us();
}

uint32_t stage_settle(struct stage *stage, const struct camera *camera, int64_t most_ms,
		      struct scene_frame *out)
{
	const int64_t until_ms = clock_now_ms() + most_ms;
	uint32_t frames = 0;

	do {
		stage_frame(stage, camera, out);
		frames++;
		if (!is_virtual && !out->moving)
			usleep(2000); /* the workers decode */
	} while ((!out->settled || stage->flights > 0) && clock_now_ms() < until_ms);
	return frames;
}

static size_t pixel_count(const struct stage *stage)
{
	return (size_t)stage->target.width_px * (size_t)stage->target.height_px;
}

static uint8_t *read_target(const struct stage *stage)
{
	uint8_t *rgba = malloc(4 * pixel_count(stage));

	if (!rgba || gl_target_read(&stage->target, rgba) < 0)
		stage_die("reading the picture", -EIO);
	return rgba;
}

uint8_t *stage_read(struct stage *stage)
{
	uint8_t *rgba = read_target(stage);

	scene_unmix(stage->scene, rgba, pixel_count(stage));
	return rgba;
}

uint8_t *stage_read_panel(struct stage *stage)
{
	uint8_t *rgba = read_target(stage);

	silhouette_mark(rgba, pixel_count(stage), stage->scene->root.background);
	return rgba;
}

/* ---- quality */

const uint8_t stage_grey[3] = { 96, 96, 96 };

static double over(const uint8_t pixel[4], const uint8_t ground[3], int channel)
{
	return (pixel[channel] * pixel[3] + (double)ground[channel] * (255 - pixel[3])) / 255;
}

static double psnr_of(const struct picture *a, const uint8_t *b, const uint8_t ground[3])
{
	double sum = 0, count = 0;

	for (size_t i = 0; i < (size_t)a->width * a->height; i++) {
		const uint8_t *p = a->rgba + 4 * i, *q = b + 4 * i;

		if (p[3] == 0 && q[3] == 0)
			continue;
		for (int k = 0; k < 3; k++) {
			const double d = over(p, ground, k) - over(q, ground, k);

			sum += d * d;
		}
		count += 3;
	}
	return count > 0 ? 10 * log10(255.0 * 255.0 * count / (sum + 1e-3)) : 99;
}

double stage_psnr(const struct stage *stage, const uint8_t *rgba, const uint8_t ground[3],
		  const char *folder, uint32_t view)
{
	struct picture truth = { 0 };
	struct buffer file;
	double psnr = NAN;
	char path[512];

	snprintf(path, sizeof(path), "%s/view-%04u.png", folder, view);
	buffer_init(&file, 256 << 20);
	if (buffer_read_file(&file, path) == 0 &&
	    picture_decode(&truth, buffer_bytes(&file)) == 0 &&
	    (int)truth.width == stage->target.width_px &&
	    (int)truth.height == stage->target.height_px)
		psnr = psnr_of(&truth, rgba, ground);
	picture_finish(&truth);
	buffer_finish(&file);
	return psnr;
}

void stage_keep(const struct stage *stage, uint8_t *rgba, const char *folder, uint32_t view)
{
	const struct picture picture = { (uint32_t)stage->target.width_px,
					 (uint32_t)stage->target.height_px, rgba };
	struct buffer file;
	char path[512];

	mkdir(folder, 0777);
	snprintf(path, sizeof(path), "%s/view-%04u.png", folder, view);
	buffer_init(&file, 256 << 20);
	stage_must(picture_encode_png(&file, &picture), path);
	stage_must(bytes_write_file(buffer_bytes(&file), path), path);
	buffer_finish(&file);
}

static int by_value(const void *a, const void *b)
{
	const double left = *(const double *)a, right = *(const double *)b;

	return left < right ? -1 : left > right;
}

double stage_median(double *values, uint32_t count)
{
	qsort(values, count, sizeof(values[0]), by_value);
	return values[count / 2];
}
