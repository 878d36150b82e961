/* Files of rendered samples: writes one file per sampling point, and gives them in publishing
 * order. `index` keeps what publishing needs of every point, so that their files are read only
 * once. */
#include "pipeline/samples/sample_store.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/log.h"
#include "pipeline/samples/sample_file.h"

enum { GRID_BYTES_MAX = 1 << 20, INDEX_BYTES_MAX = 512 << 20, YOUNG_S = 2 };

static const char grid_magic[4] = "GSgr", point_magic[4] = "GSpt", index_magic[4] = "GSix",
		  chosen_magic[4] = "GSch";

/* A point's file, as far as it is known. */
struct point {
	uint64_t bytes, time_s;
	uint32_t time_ns;
	struct bytes summary; /* in index_file or own; empty: not known */
	uint8_t *own;         /* owned */
};

struct samples_store {
	char dir[PATH_MAX - 64]; /* path of the folder samples */
	struct sample_grid grid;
	struct hash key;
	struct buffer grid_file, index_file, point_file;
	struct point *points; /* owned; in the order of the bricks */
	uint32_t point_count; /* of all bricks, also those outside the grid */
	bool is_changed;      /* a summary was made that index does not have */
	uint32_t states[SAMPLE_STATES];
	uint8_t *choices; /* owned; for each tile, of those of the grid; NULL: the best */
	uint32_t choice_count;
	uint32_t next_point; /* number in the order of the bricks */
	uint32_t next_tile;  /* in the order of samples_store_next */
	uint32_t place[3];   /* of the faces that samples_store_next gives */
	struct sample_summary summary;
	char path[PATH_MAX]; /* of that point's file */
};

static int samples_dir(char *out, size_t size, const char *content_dir)
{
	int n = snprintf(out, size, "%s/.work/samples", content_dir);

	return n < 0 || (size_t)n >= size ? -ENAMETOOLONG : 0;
}

/* The name of a vantage point's file is where it is and before what: one that moved is another, and
 * the others stay. */
static void point_path(char out[PATH_MAX], const char *dir, const struct sample_grid *grid,
		       const uint32_t point[3])
{
	const int vantage = sample_grid_vantage(grid, point);
	const uint8_t *sky = grid->background;
	uint32_t at[3];

	if (vantage < 0) {
		snprintf(out, PATH_MAX, "%s/%02u-%02u-%02u", dir, point[0], point[1], point[2]);
		return;
	}
	memcpy(at, grid->vantage_m[vantage], sizeof(at));
	snprintf(out, PATH_MAX, "%s/at-%08x-%08x-%08x-%02x%02x%02x", dir, at[0], at[1], at[2],
		 sky[0], sky[1], sky[2]);
}

static bool grid_is_sane(const struct sample_grid *grid)
{
	for (int i = 0; i < 3; i++)
		if (grid->count[i] < 1 || grid->count[i] > SAMPLE_GRID_MAX ||
		    !isfinite(grid->origin_m[i]) || !(grid->spacing_m[i] > 0))
			return false;
	for (uint32_t c = 0; c < grid->choice_count && c < SAMPLE_CHOICES_MAX; c++)
		if (grid->qualities[c] < 1 || grid->qualities[c] > 100 ||
		    (c > 0 && grid->qualities[c] <= grid->qualities[c - 1]))
			return false;
	for (uint32_t i = 0; i < grid->vantage_count && i < SAMPLE_VANTAGES_MAX; i++)
		for (int k = 0; k < 3; k++)
			if (!isfinite(grid->vantage_m[i][k]))
				return false;
	return grid->level_count >= 1 && grid->level_count <= SAMPLE_LEVELS_MAX &&
	       grid->vantage_count <= SAMPLE_VANTAGES_MAX &&
	       grid->choice_count <= SAMPLE_CHOICES_MAX && grid->scale_count <= SAMPLE_SCALES_MAX;
}

static bool read_grid(struct samples_store *store)
{
	struct reader reader;

	if (!sample_file_open(&reader, buffer_bytes(&store->grid_file), grid_magic, &store->key))
		return false;
	for (int i = 0; i < 3; i++)
		store->grid.origin_m[i] = reader_f32(&reader);
	for (int i = 0; i < 3; i++)
		store->grid.spacing_m[i] = reader_f32(&reader);
	for (int i = 0; i < 3; i++)
		store->grid.count[i] = reader_u32(&reader);
	store->grid.level_count = reader_u32(&reader);
	if (reader_left(&reader) > 0) {
		store->grid.choice_count = reader_u8(&reader);
		store->grid.scale_count = reader_u8(&reader);
		for (uint32_t c = 0; c < store->grid.choice_count && c < SAMPLE_CHOICES_MAX; c++)
			store->grid.qualities[c] = reader_u8(&reader);
	}
	if (reader_left(&reader) > 0) {
		store->grid.vantage_count = reader_u8(&reader);
		for (uint32_t i = 0; i < store->grid.vantage_count && i < SAMPLE_VANTAGES_MAX; i++)
			for (int k = 0; k < 3; k++)
				store->grid.vantage_m[i][k] = reader_f32(&reader);
		for (int k = 0; k < 3; k++)
			store->grid.background[k] = reader_u8(&reader);
	}
	return !reader.failed && !reader_left(&reader) && grid_is_sane(&store->grid);
}

/* ---- points by number */

static void count_bricks(const struct sample_grid *grid, uint32_t bricks[3])
{
	for (int i = 0; i < 3; i++)
		bricks[i] = (grid->count[i] + BRICK_SIDE - 1) / BRICK_SIDE;
}

/* Sets the n-th point, counted brick by brick. It may lie outside the grid. */
static void point_in_order(const struct sample_grid *grid, uint32_t n, uint32_t point[3])
{
	uint32_t brick = n / BRICK_POINTS, in = n % BRICK_POINTS, bricks[3];

	count_bricks(grid, bricks);
	point[0] = brick % bricks[0] * BRICK_SIDE + in % BRICK_SIDE;
	point[1] = brick / bricks[0] % bricks[1] * BRICK_SIDE + in / BRICK_SIDE % BRICK_SIDE;
	point[2] = brick / bricks[0] / bricks[1] * BRICK_SIDE + in / BRICK_SIDE / BRICK_SIDE;
}

static uint32_t number_of(const struct sample_grid *grid, const uint32_t point[3])
{
	uint32_t bricks[3], brick = 0, in = 0;

	count_bricks(grid, bricks);
	for (int i = 2; i >= 0; i--) {
		brick = brick * bricks[i] + point[i] / BRICK_SIDE;
		in = in * BRICK_SIDE + point[i] % BRICK_SIDE;
	}
	return brick * BRICK_POINTS + in;
}

static bool is_on_grid(const struct sample_grid *grid, const uint32_t point[3])
{
	return point[0] < grid->count[0] && point[1] < grid->count[1] && point[2] < grid->count[2];
}

static bool point_exists(const struct sample_grid *grid, const uint32_t point[3])
{
	const int vantage = sample_grid_vantage(grid, point);

	return is_on_grid(grid, point) || (vantage >= 0 && (uint32_t)vantage < grid->vantage_count);
}

/* The height of the brick of the vantage points, in points. */
static uint32_t vantage_layer(const struct sample_grid *grid)
{
	return (grid->count[2] + BRICK_SIDE - 1) / BRICK_SIDE * BRICK_SIDE;
}

int sample_grid_vantage(const struct sample_grid *grid, const uint32_t point[3])
{
	const uint32_t layer = vantage_layer(grid);

	if (point[0] >= BRICK_SIDE || point[1] >= BRICK_SIDE || point[2] < layer ||
	    point[2] >= layer + BRICK_SIDE)
		return -1;
	return (int)(((point[2] - layer) * BRICK_SIDE + point[1]) * BRICK_SIDE + point[0]);
}

static uint32_t points_on_grid(const struct sample_grid *grid)
{
	return grid->count[0] * grid->count[1] * grid->count[2];
}

uint32_t sample_grid_points(const struct sample_grid *grid)
{
	return points_on_grid(grid) + grid->vantage_count;
}

void sample_grid_point(const struct sample_grid *grid, uint32_t n, uint32_t out[3])
{
	const uint32_t *count = grid->count, on_grid = points_on_grid(grid);
	const uint32_t brick[3] = { BRICK_SIDE, BRICK_SIDE, BRICK_SIDE };
	uint32_t layer = 0;

	if (n >= on_grid) {
		n -= on_grid;
		count = brick;
		layer = vantage_layer(grid);
	}
	out[0] = n % count[0];
	out[1] = n / count[0] % count[1];
	out[2] = layer + n / count[0] / count[1];
}

uint32_t sample_grid_number(const struct sample_grid *grid, const uint32_t point[3])
{
	if (is_on_grid(grid, point))
		return (point[2] * grid->count[1] + point[1]) * grid->count[0] + point[0];
	return points_on_grid(grid) + (uint32_t)sample_grid_vantage(grid, point);
}

/* ---- the index */

static bool is_file_of(const struct point *point, const struct stat *status)
{
	return point->summary.size > 0 && point->bytes == (uint64_t)status->st_size &&
	       point->time_s == (uint64_t)status->st_mtim.tv_sec &&
	       point->time_ns == (uint32_t)status->st_mtim.tv_nsec;
}

/* Takes the entries of the index. Files that were nearly as young as the index when it was written
 * could have changed since without another time: they are read again. */
static void take_index(struct samples_store *store, const char *path)
{
	struct reader reader;
	struct stat status;
	struct hash key;

	if (buffer_read_file(&store->index_file, path) < 0 || stat(path, &status) < 0 ||
	    !sample_file_open(&reader, buffer_bytes(&store->index_file), index_magic, &key) ||
	    !hash_equal(key, store->key))
		return;
	while (reader_left(&reader) > 0) {
		uint32_t n = reader_u32(&reader);
		struct point point = { .bytes = reader_u64(&reader) };

		point.time_s = reader_u64(&reader);
		point.time_ns = reader_u32(&reader);
		point.summary = reader_bytes(&reader, reader_u32(&reader));
		if (reader.failed || n >= store->point_count)
			return;
		if (point.time_s + YOUNG_S < (uint64_t)status.st_mtim.tv_sec)
			store->points[n] = point;
	}
}

static int write_index(const struct samples_store *store)
{
	char path[PATH_MAX];
	struct buffer file;
	int rc;

	buffer_init(&file, INDEX_BYTES_MAX);
	sample_file_begin(&file, index_magic, store->key);
	for (uint32_t n = 0; n < store->point_count; n++) {
		const struct point *point = &store->points[n];

		if (point->summary.size == 0)
			continue;
		buffer_put_u32(&file, n);
		buffer_put_u64(&file, point->bytes);
		buffer_put_u64(&file, point->time_s);
		buffer_put_u32(&file, point->time_ns);
		buffer_put_u32(&file, (uint32_t)point->summary.size);
		buffer_put(&file, point->summary.data, point->summary.size);
	}
	sample_file_seal(&file);
	snprintf(path, sizeof(path), "%s/index", store->dir);
	rc = file.error ? file.error : bytes_write_file(buffer_bytes(&file), path);
	buffer_finish(&file);
	return rc;
}

/* ---- looking at a point */

/* Reads a point's file and makes its summary. Returns -ENOENT if the key differs. */
static int summarize(struct samples_store *store, struct point *point, const char *path)
{
	struct reader reader;
	struct buffer summary;
	struct hash key;
	int rc = buffer_read_file(&store->point_file, path);

	if (rc < 0)
		return rc;
	if (!sample_file_open(&reader, buffer_bytes(&store->point_file), point_magic, &key))
		return -EBADMSG;
	if (!hash_equal(key, store->key))
		return -ENOENT;
	buffer_init(&summary, SAMPLE_FILE_BYTES_MAX);
	rc = sample_file_summarize(&summary, &reader, &store->grid);
	if (rc < 0) {
		buffer_finish(&summary);
		return rc;
	}
	free(point->own);
	point->own = summary.data; /* taken */
	point->summary = buffer_bytes(&summary);
	store->is_changed = true;
	return 0;
}

/* Makes sure that the summary is that of the file. Returns -ENOENT or -EBADMSG if the point has to
 * be rendered, or the errors of the disk. */
static int look_at(struct samples_store *store, uint32_t n, const uint32_t place[3])
{
	struct point *point = &store->points[n];
	struct stat status;
	char path[PATH_MAX];
	int rc;

	point_path(path, store->dir, &store->grid, place);
	if (stat(path, &status) < 0)
		return -errno;
	if (is_file_of(point, &status))
		return 0;
	rc = summarize(store, point, path);
	if (rc < 0)
		point->summary = (struct bytes){ 0 };
	point->bytes = (uint64_t)status.st_size;
	point->time_s = (uint64_t)status.st_mtim.tv_sec;
	point->time_ns = (uint32_t)status.st_mtim.tv_nsec;
	return rc;
}

/* Looks at every point and counts states. */
static int survey(struct samples_store *store)
{
	uint32_t place[3], missing = 0;

	for (uint32_t n = 0; n < store->point_count; n++) {
		int rc;

		point_in_order(&store->grid, n, place);
		if (!point_exists(&store->grid, place))
			continue;
		rc = look_at(store, n, place);
		if (rc == 0 &&
		    !sample_summary_open(&store->summary, store->points[n].summary, &store->grid))
			rc = -EBADMSG;
		if (rc == 0)
			store->states[store->summary.state]++;
		else if (rc == -ENOENT || rc == -EBADMSG)
			missing++;
		else
			return rc;
	}
	if (missing == 0)
		return 0;
	log_error("pipeline",
		  "%s: %u sampling points are missing, stale or damaged: run "
		  "'gopura-content sample' again, it makes only those",
		  store->dir, missing);
	return -ENOENT;
}

/* ---- the store */

static int make_points(struct samples_store *store)
{
	uint32_t bricks[3];
	char path[PATH_MAX];

	count_bricks(&store->grid, bricks);
	store->point_count = (bricks[0] * bricks[1] * bricks[2] + (store->grid.vantage_count > 0)) *
			     BRICK_POINTS;
	store->points = calloc(store->point_count, sizeof(*store->points));
	if (!store->points)
		return -ENOMEM;
	snprintf(path, sizeof(path), "%s/index", store->dir);
	take_index(store, path);
	return 0;
}

int samples_store_look(struct samples_store **out, const char *content_dir)
{
	struct samples_store *store = calloc(1, sizeof(*store));
	char path[PATH_MAX];
	int rc;

	*out = NULL;
	if (!store)
		return -ENOMEM;
	buffer_init(&store->grid_file, GRID_BYTES_MAX);
	buffer_init(&store->index_file, INDEX_BYTES_MAX);
	buffer_init(&store->point_file, SAMPLE_FILE_BYTES_MAX);
	rc = samples_dir(store->dir, sizeof(store->dir), content_dir);
	if (rc == 0) {
		snprintf(path, sizeof(path), "%s/grid", store->dir);
		rc = buffer_read_file(&store->grid_file, path);
		if (rc == 0 && !read_grid(store))
			rc = -EBADMSG;
		if (rc < 0)
			log_error("pipeline", "%s: %s: run 'gopura-content sample' first", path,
				  rc == -EBADMSG ? "damaged" : strerror(-rc));
	}
	if (rc == 0)
		rc = make_points(store);
	if (rc < 0) {
		samples_store_close(store);
		return rc;
	}
	*out = store;
	return 0;
}

/* ---- the choice */

int samples_store_choose(struct samples_store *store, const uint8_t *choices, uint32_t count)
{
	uint8_t *copy = malloc(count + 1);

	if (!copy)
		return -ENOMEM;
	memcpy(copy, choices, count);
	free(store->choices);
	store->choices = copy;
	store->choice_count = count;
	samples_store_rewind(store);
	return 0;
}

int samples_store_keep_choice(const struct samples_store *store)
{
	char path[PATH_MAX];
	struct buffer file;
	int rc;

	buffer_init(&file, INDEX_BYTES_MAX);
	sample_file_begin(&file, chosen_magic, store->key);
	buffer_put(&file, store->choices, store->choice_count);
	sample_file_seal(&file);
	snprintf(path, sizeof(path), "%s/chosen", store->dir);
	rc = file.error ? file.error : bytes_write_file(buffer_bytes(&file), path);
	buffer_finish(&file);
	return rc;
}

/* Takes what was kept, if it is of these samples. */
static void load_choice(struct samples_store *store)
{
	struct reader reader;
	struct bytes choices;
	struct buffer file;
	struct hash key;
	char path[PATH_MAX];

	if (store->grid.choice_count < 2)
		return;
	buffer_init(&file, INDEX_BYTES_MAX);
	snprintf(path, sizeof(path), "%s/chosen", store->dir);
	if (buffer_read_file(&file, path) == 0 &&
	    sample_file_open(&reader, buffer_bytes(&file), chosen_magic, &key) &&
	    hash_equal(key, store->key)) {
		choices = reader_bytes(&reader, reader_left(&reader));
		if (samples_store_choose(store, choices.data, (uint32_t)choices.size) < 0)
			log_warn("pipeline", "%s: no memory; the best tiles are taken", path);
	}
	buffer_finish(&file);
}

/* ---- opening */

int samples_store_open(struct samples_store **out, const char *content_dir)
{
	struct samples_store *store;
	int rc = samples_store_look(&store, content_dir);

	*out = NULL;
	if (rc == 0)
		rc = survey(store);
	if (rc < 0) {
		samples_store_close(store);
		return rc;
	}
	if (store->is_changed) {
		rc = write_index(store);
		if (rc < 0)
			log_warn("pipeline", "%s/index: %s: the next build reads all samples again",
				 store->dir, strerror(-rc));
	}
	load_choice(store);
	samples_store_rewind(store);
	*out = store;
	return 0;
}

void samples_store_close(struct samples_store *store)
{
	if (!store)
		return;
	for (uint32_t n = 0; n < store->point_count && store->points; n++)
		free(store->points[n].own);
	free(store->points);
	free(store->choices);
	buffer_finish(&store->grid_file);
	buffer_finish(&store->index_file);
	buffer_finish(&store->point_file);
	free(store);
}

const struct sample_grid *samples_store_grid(const struct samples_store *store)
{
	return &store->grid;
}

struct hash samples_store_key(const struct samples_store *store)
{
	return store->key;
}

void samples_store_rewind(struct samples_store *store)
{
	store->next_point = 0;
	store->next_tile = 0;
	store->summary.faces_left = 0;
}

enum sample_state samples_store_state(const struct samples_store *store, const uint32_t point[3])
{
	struct sample_summary summary;

	if (!point_exists(&store->grid, point) ||
	    !sample_summary_open(&summary, store->points[number_of(&store->grid, point)].summary,
				 &store->grid))
		return SAMPLE_EMPTY; /* not after survey */
	return summary.state;
}

void samples_store_states(const struct samples_store *store, uint32_t counts[SAMPLE_STATES])
{
	memcpy(counts, store->states, sizeof(store->states));
}

/* Goes to the next point with faces. Returns false if there are no more. */
static bool advance(struct samples_store *store)
{
	while (store->next_point < store->point_count) {
		uint32_t n = store->next_point++;

		if (store->points[n].summary.size == 0 ||
		    !sample_summary_open(&store->summary, store->points[n].summary, &store->grid) ||
		    store->summary.faces_left == 0)
			continue;
		point_in_order(&store->grid, n, store->place);
		point_path(store->path, store->dir, &store->grid, store->place);
		return true;
	}
	return false;
}

int samples_store_next(struct samples_store *store, struct sample_face *out)
{
	uint32_t left;

	if (store->summary.faces_left == 0 && !advance(store))
		return 0;
	left = store->choice_count > store->next_tile ? store->choice_count - store->next_tile : 0;
	if (!sample_summary_next(&store->summary, out,
				 left > 0 ? store->choices + store->next_tile : NULL, left))
		return -EBADMSG; /* not after survey, which was content with it */
	store->next_tile += out->tile_count;
	memcpy(out->point, store->place, sizeof(out->point));
	out->path = store->path;
	return 1;
}

bool samples_store_has(struct samples_store *store, const uint32_t point[3])
{
	return point_exists(&store->grid, point) &&
	       look_at(store, number_of(&store->grid, point), point) == 0;
}

/* ---- writing */

int samples_store_stat(const struct samples_store *store, const uint32_t point[3], struct stat *out)
{
	char path[PATH_MAX];

	point_path(path, store->dir, &store->grid, point);
	return stat(path, out) < 0 ? -errno : 0;
}

static int make_dirs(const char *content_dir)
{
	static const char *const below[] = { ".work", ".work/samples" };
	char path[PATH_MAX];

	for (size_t i = 0; i < ARRAY_COUNT(below); i++) {
		int n = snprintf(path, sizeof(path), "%s/%s", content_dir, below[i]);

		if (n < 0 || (size_t)n >= sizeof(path))
			return -ENAMETOOLONG;
		if (mkdir(path, 0777) < 0 && errno != EEXIST)
			return -errno;
	}
	return 0;
}

static void put_choices(struct buffer *file, const struct sample_grid *grid)
{
	const uint32_t count = grid->choice_count > 1 ? grid->choice_count : 0;

	if (count == 0 && grid->vantage_count == 0)
		return;
	buffer_put_u8(file, (uint8_t)count);
	buffer_put_u8(file, (uint8_t)(count > 0 ? grid->scale_count : 0));
	buffer_put(file, grid->qualities, count);
}

static void put_vantages(struct buffer *file, const struct sample_grid *grid)
{
	if (grid->vantage_count == 0)
		return;
	buffer_put_u8(file, (uint8_t)grid->vantage_count);
	for (uint32_t i = 0; i < grid->vantage_count; i++)
		for (int k = 0; k < 3; k++)
			buffer_put_f32(file, grid->vantage_m[i][k]);
	buffer_put(file, grid->background, sizeof(grid->background));
}

int samples_store_begin(const char *content_dir, const struct sample_grid *grid, struct hash key)
{
	char path[PATH_MAX];
	struct buffer file, old;
	int rc = make_dirs(content_dir);

	if (rc < 0)
		return rc;
	buffer_init(&file, GRID_BYTES_MAX);
	buffer_init(&old, GRID_BYTES_MAX);
	sample_file_begin(&file, grid_magic, key);
	for (int i = 0; i < 3; i++)
		buffer_put_f32(&file, grid->origin_m[i]);
	for (int i = 0; i < 3; i++)
		buffer_put_f32(&file, grid->spacing_m[i]);
	for (int i = 0; i < 3; i++)
		buffer_put_u32(&file, grid->count[i]);
	buffer_put_u32(&file, grid->level_count);
	put_choices(&file, grid);
	put_vantages(&file, grid);
	sample_file_seal(&file);
	rc = file.error;
	if (snprintf(path, sizeof(path), "%s/.work/samples/grid", content_dir) >= PATH_MAX)
		rc = -ENAMETOOLONG;
	if (rc == 0 && (buffer_read_file(&old, path) < 0 || old.size != file.size ||
			memcmp(old.data, file.data, file.size) != 0))
		rc = bytes_write_file(buffer_bytes(&file), path);
	buffer_finish(&file);
	buffer_finish(&old);
	return rc;
}

/* Whether a name is that of some point's file, of this grid or another; not of one half written. */
static bool is_point_name(const char *name)
{
	unsigned number[4];
	int end = 0;

	if (sscanf(name, "%2u-%2u-%2u%n", &number[0], &number[1], &number[2], &end) < 3)
		sscanf(name, "at-%8x-%8x-%8x-%6x%n", &number[0], &number[1], &number[2], &number[3],
		       &end);
	return end > 0 && name[end] == '\0';
}

static bool has_point_named(const char *dir, const struct sample_grid *grid, const char *name)
{
	uint32_t point[3];
	char path[PATH_MAX];

	if (sscanf(name, "%2u-%2u-%2u", &point[0], &point[1], &point[2]) == 3)
		return is_on_grid(grid, point);
	for (uint32_t i = 0; i < grid->vantage_count; i++) {
		sample_grid_point(grid, points_on_grid(grid) + i, point);
		point_path(path, dir, grid, point);
		if (strcmp(strrchr(path, '/') + 1, name) == 0)
			return true;
	}
	return false;
}

void samples_store_sweep(const char *content_dir, const struct sample_grid *grid)
{
	char dir[PATH_MAX - 64];
	struct dirent *entry;
	DIR *entries;

	if (samples_dir(dir, sizeof(dir), content_dir) < 0)
		return;
	entries = opendir(dir);
	while (entries && (entry = readdir(entries)))
		if (is_point_name(entry->d_name) && !has_point_named(dir, grid, entry->d_name))
			unlinkat(dirfd(entries), entry->d_name, 0);
	if (entries)
		closedir(entries);
}

int samples_store_put(const char *content_dir, struct hash key, const struct sample_grid *grid,
		      enum sample_state state, const uint32_t point[3],
		      const struct sample_face *faces, uint32_t face_count)
{
	char dir[PATH_MAX - 64], path[PATH_MAX];
	struct buffer file;
	int rc = samples_dir(dir, sizeof(dir), content_dir);

	if (rc < 0)
		return rc;
	point_path(path, dir, grid, point);
	buffer_init(&file, SAMPLE_FILE_BYTES_MAX);
	sample_file_begin(&file, point_magic, key);
	sample_file_put_point(&file, grid, state, faces, face_count);
	sample_file_seal(&file);
	rc = file.error ? file.error : bytes_write_file(buffer_bytes(&file), path);
	buffer_finish(&file);
	return rc;
}
