/* Files of rendered samples: writes one file per sampling point, and reads them back in publishing
 * order. */
#include "pipeline/samples/sample_store.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/log.h"

enum { VERSION = 1, POINT_BYTES_MAX = 512 << 20, GRID_BYTES_MAX = 1 << 20 };

static const char grid_magic[4] = "GSgr", point_magic[4] = "GSpt";

struct samples_store {
	char dir[PATH_MAX - 64]; /* path of the folder samples */
	struct sample_grid grid;
	struct hash key;
	struct buffer grid_file;
	struct buffer point_file;
	struct reader reader; /* reads point_file */
	uint32_t next_point;  /* number in the order of the bricks */
	uint32_t faces_left;  /* still unread in point_file */
	uint32_t point[3];
	uint32_t states[SAMPLE_STATES];
	uint16_t tiles[FACE_TILES_MAX];
	struct bytes objects[FACE_TILES_MAX];
	uint64_t offsets[FACE_TILES_MAX];
	char path[PATH_MAX]; /* path of point_file */
};

static int samples_dir(char *out, size_t size, const char *content_dir)
{
	int n = snprintf(out, size, "%s/.work/samples", content_dir);

	return n < 0 || (size_t)n >= size ? -ENAMETOOLONG : 0;
}

static void point_path(char out[PATH_MAX], const char *dir, const uint32_t point[3])
{
	snprintf(out, PATH_MAX, "%s/%02u-%02u-%02u", dir, point[0], point[1], point[2]);
}

/* Every file contains: magic, version, key, contents, hash of everything before. */
static void seal(struct buffer *file)
{
	struct hash hash = hash_of(buffer_bytes(file));

	buffer_put(file, hash.bytes, HASH_BYTES);
}

static void put_head(struct buffer *file, const char magic[4], struct hash key)
{
	buffer_put(file, magic, 4);
	buffer_put_u32(file, VERSION);
	buffer_put(file, key.bytes, HASH_BYTES);
}

/* Checks hash, magic and version, and leaves the reader after the head. */
static bool read_head(struct reader *reader, struct bytes file, const char magic[4],
		      struct hash *key)
{
	struct bytes head, body = { file.data, file.size - HASH_BYTES };
	struct hash hash;

	if (file.size < 8 + 2 * HASH_BYTES)
		return false;
	hash = hash_of(body);
	if (memcmp(hash.bytes, file.data + body.size, HASH_BYTES) != 0)
		return false;
	reader_init(reader, body);
	head = reader_bytes(reader, 4);
	if (memcmp(head.data, magic, 4) != 0 || reader_u32(reader) != VERSION)
		return false;
	memcpy(key->bytes, reader_bytes(reader, HASH_BYTES).data, HASH_BYTES);
	return true;
}

static bool grid_is_sane(const struct sample_grid *grid)
{
	for (int i = 0; i < 3; i++)
		if (grid->count[i] < 1 || grid->count[i] > SAMPLE_GRID_MAX ||
		    !isfinite(grid->origin_m[i]) || !(grid->spacing_m[i] > 0))
			return false;
	return grid->level_count >= 1 && grid->level_count <= SAMPLE_LEVELS_MAX;
}

static bool read_grid(struct samples_store *store)
{
	struct reader reader;

	if (!read_head(&reader, buffer_bytes(&store->grid_file), grid_magic, &store->key))
		return false;
	for (int i = 0; i < 3; i++)
		store->grid.origin_m[i] = reader_f32(&reader);
	for (int i = 0; i < 3; i++)
		store->grid.spacing_m[i] = reader_f32(&reader);
	for (int i = 0; i < 3; i++)
		store->grid.count[i] = reader_u32(&reader);
	store->grid.level_count = reader_u32(&reader);
	return !reader.failed && !reader_left(&reader) && grid_is_sane(&store->grid);
}

/* Sets the n-th point, counted brick by brick. Returns false past the last. The point may lie
 * outside the grid. */
static bool point_in_order(const struct sample_grid *grid, uint32_t n, uint32_t point[3])
{
	uint32_t bricks[3];
	uint32_t brick = n / BRICK_POINTS, in = n % BRICK_POINTS;

	for (int i = 0; i < 3; i++)
		bricks[i] = (grid->count[i] + BRICK_SIDE - 1) / BRICK_SIDE;
	if (brick >= bricks[0] * bricks[1] * bricks[2])
		return false;
	point[0] = brick % bricks[0] * BRICK_SIDE + in % BRICK_SIDE;
	point[1] = brick / bricks[0] % bricks[1] * BRICK_SIDE + in / BRICK_SIDE % BRICK_SIDE;
	point[2] = brick / bricks[0] / bricks[1] * BRICK_SIDE + in / BRICK_SIDE / BRICK_SIDE;
	return true;
}

static bool point_exists(const struct sample_grid *grid, const uint32_t point[3])
{
	return point[0] < grid->count[0] && point[1] < grid->count[1] && point[2] < grid->count[2];
}

/* Loads a point into point_file, with the reader before its state. Returns -ENOENT if the key
 * differs. */
static int load_point(struct samples_store *store, const uint32_t point[3])
{
	struct hash key;
	int rc;

	point_path(store->path, store->dir, point);
	rc = buffer_read_file(&store->point_file, store->path);
	if (rc < 0)
		return rc;
	if (!read_head(&store->reader, buffer_bytes(&store->point_file), point_magic, &key))
		return -EBADMSG;
	return hash_equal(key, store->key) ? 0 : -ENOENT;
}

static int read_state(struct samples_store *store)
{
	uint8_t state = reader_u8(&store->reader);

	store->faces_left = reader_u8(&store->reader);
	if (store->reader.failed || state >= SAMPLE_STATES || store->faces_left > CUBE_FACES)
		return -EBADMSG;
	return state;
}

/* Checks that every point is there, and counts states. Reads each file, but only its head is
 * decoded. */
static int survey(struct samples_store *store)
{
	uint32_t point[3], missing = 0;

	for (uint32_t n = 0; point_in_order(&store->grid, n, point); n++) {
		int rc;

		if (!point_exists(&store->grid, point))
			continue;
		rc = load_point(store, point);
		if (rc == 0)
			rc = read_state(store);
		if (rc >= 0)
			store->states[rc]++;
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

int samples_store_open(struct samples_store **out, const char *content_dir)
{
	struct samples_store *store = calloc(1, sizeof(*store));
	char path[PATH_MAX];
	int rc;

	*out = NULL;
	if (!store)
		return -ENOMEM;
	buffer_init(&store->grid_file, GRID_BYTES_MAX);
	buffer_init(&store->point_file, POINT_BYTES_MAX);
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
		rc = survey(store);
	if (rc < 0) {
		samples_store_close(store);
		return rc;
	}
	samples_store_rewind(store);
	*out = store;
	return 0;
}

void samples_store_close(struct samples_store *store)
{
	if (!store)
		return;
	buffer_finish(&store->grid_file);
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
	store->faces_left = 0;
}

void samples_store_states(const struct samples_store *store, uint32_t counts[SAMPLE_STATES])
{
	memcpy(counts, store->states, sizeof(store->states));
}

static int read_face(struct samples_store *store, struct sample_face *out)
{
	struct reader *reader = &store->reader;

	*out = (struct sample_face){ .tiles = store->tiles,
				     .objects = store->objects,
				     .path = store->path,
				     .offsets = store->offsets };
	memcpy(out->point, store->point, sizeof(out->point));
	out->face = reader_u8(reader);
	out->level_count = reader_u8(reader);
	out->coverage = reader_u16(reader);
	out->near_m = reader_f32(reader);
	out->far_m = reader_f32(reader);
	out->tile_count = reader_u32(reader);
	if (reader->failed || out->face >= CUBE_FACES || out->level_count < 1 ||
	    out->level_count > store->grid.level_count || out->tile_count < 1 ||
	    out->tile_count > face_tile_index(out->level_count, 0, 0))
		return -EBADMSG;
	for (uint32_t i = 0; i < out->tile_count; i++) {
		store->tiles[i] = reader_u16(reader);
		store->objects[i] = reader_bytes(reader, reader_u32(reader));
		store->offsets[i] = reader->at - store->objects[i].size;
		if (store->tiles[i] >= face_tile_index(out->level_count, 0, 0) ||
		    (i > 0 && store->tiles[i] <= store->tiles[i - 1]))
			return -EBADMSG;
	}
	return reader->failed ? -EBADMSG : 0;
}

/* Loads the next point with faces. Returns 1, or 0 if there are no more. */
static int advance(struct samples_store *store)
{
	while (point_in_order(&store->grid, store->next_point, store->point)) {
		int rc;

		store->next_point++;
		if (!point_exists(&store->grid, store->point))
			continue;
		rc = load_point(store, store->point);
		if (rc == 0)
			rc = read_state(store);
		if (rc < 0)
			return rc;
		if (store->faces_left)
			return 1;
	}
	return 0;
}

int samples_store_next(struct samples_store *store, struct sample_face *out)
{
	int rc = 1;

	if (!store->faces_left)
		rc = advance(store);
	if (rc == 0)
		return 0;
	if (rc == 1) {
		store->faces_left--;
		rc = read_face(store, out);
	}
	if (rc < 0) {
		log_error("pipeline", "%s/%02u-%02u-%02u: %s: run 'gopura-content sample' again",
			  store->dir, store->point[0], store->point[1], store->point[2],
			  rc == -EBADMSG ? "damaged" : strerror(-rc));
		return rc;
	}
	return 1;
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

int samples_store_begin(const char *content_dir, const struct sample_grid *grid, struct hash key)
{
	char path[PATH_MAX];
	struct buffer file, old;
	int rc = make_dirs(content_dir);

	if (rc < 0)
		return rc;
	buffer_init(&file, GRID_BYTES_MAX);
	buffer_init(&old, GRID_BYTES_MAX);
	put_head(&file, grid_magic, key);
	for (int i = 0; i < 3; i++)
		buffer_put_f32(&file, grid->origin_m[i]);
	for (int i = 0; i < 3; i++)
		buffer_put_f32(&file, grid->spacing_m[i]);
	for (int i = 0; i < 3; i++)
		buffer_put_u32(&file, grid->count[i]);
	buffer_put_u32(&file, grid->level_count);
	seal(&file);
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

bool samples_store_has(const char *content_dir, const uint32_t point[3], struct hash key)
{
	struct samples_store store = { .key = key };
	int rc;

	buffer_init(&store.point_file, POINT_BYTES_MAX);
	rc = samples_dir(store.dir, sizeof(store.dir), content_dir);
	if (rc == 0)
		rc = load_point(&store, point);
	buffer_finish(&store.point_file);
	return rc == 0;
}

static void put_face(struct buffer *file, const struct sample_face *face)
{
	buffer_put_u8(file, (uint8_t)face->face);
	buffer_put_u8(file, (uint8_t)face->level_count);
	buffer_put_u16(file, face->coverage);
	buffer_put_f32(file, face->near_m);
	buffer_put_f32(file, face->far_m);
	buffer_put_u32(file, face->tile_count);
	for (uint32_t i = 0; i < face->tile_count; i++) {
		buffer_put_u16(file, face->tiles[i]);
		buffer_put_u32(file, (uint32_t)face->objects[i].size);
		buffer_put(file, face->objects[i].data, face->objects[i].size);
	}
}

int samples_store_put(const char *content_dir, struct hash key, enum sample_state state,
		      const uint32_t point[3], const struct sample_face *faces, uint32_t face_count)
{
	char dir[PATH_MAX - 64], path[PATH_MAX];
	struct buffer file;
	int rc = samples_dir(dir, sizeof(dir), content_dir);

	if (rc < 0)
		return rc;
	point_path(path, dir, point);
	buffer_init(&file, POINT_BYTES_MAX);
	put_head(&file, point_magic, key);
	buffer_put_u8(&file, (uint8_t)state);
	buffer_put_u8(&file, (uint8_t)face_count);
	for (uint32_t i = 0; i < face_count; i++)
		put_face(&file, &faces[i]);
	seal(&file);
	rc = file.error ? file.error : bytes_write_file(buffer_bytes(&file), path);
	buffer_finish(&file);
	return rc;
}
