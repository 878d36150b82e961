/* Places sampling points and renders them in child processes, which take points from a shared
 * counter. */
#include "pipeline/samples/sampler.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/log.h"
#include "base/progress.h"
#include "format/tile.h"
#include "pipeline/content/start_view.h"
#include "pipeline/samples/chunks.h"
#include "pipeline/samples/face_renderer.h"
#include "pipeline/samples/model_master.h"
#include "render/display/headless.h"

enum { SAMPLER_VERSION = 10, CHOICES_VERSION = 2, JOBS_MAX = 64 };

/* Size of the grid's box, in multiples of the model's: docs/samples.md. */
static const float grid_reach = 1.5f;
/* No side of it is shorter, in distances of points. */
static const float least_side = 0.5f;
/* A point is inside solid matter if its winding number is above winding_solid. For scans that are
 * open towards the point: if more than the share backs_solid of what it sees are back faces. */
static const double winding_solid = 0.5, backs_solid = 0.5;
/* What a face shows may be as coarse as this many of its texels: docs/samples.md. */
static const float detail_texels = 1;

/* Number of the next point; shared memory of the child processes. */
struct queue {
	atomic_uint next;
};

struct sampling {
	const struct content *content;
	struct model *model; /* owned */
	const struct mesh_texture *textures;
	uint32_t texture_count;
	struct sample_grid grid;
	struct drawing_options drawing;
	struct hash key;
	bool below_ground;
	uint32_t (*points)[3]; /* owned; points that are still missing */
	uint32_t point_count;
	struct queue *queue;
};

uint32_t sampler_levels(uint32_t face_px)
{
	uint32_t count = 0;

	while (((uint32_t)SAMPLE_TILE_PX << count) <= face_px)
		count++;
	return count;
}

void sampler_grid(struct sample_grid *out, const float low_m[3], const float high_m[3],
		  uint32_t points, uint32_t face_px, bool below_ground)
{
	float longest = 0, spacing;

	for (int i = 0; i < 3; i++)
		longest = fmaxf(longest, grid_reach * (high_m[i] - low_m[i]));
	spacing = longest / (float)(points - 1);
	*out = (struct sample_grid){ .level_count = sampler_levels(face_px) };
	for (int i = 0; i < 3; i++) {
		const bool on_ground = i == 2 && !below_ground;
		float middle = (low_m[i] + high_m[i]) / 2,
		      half = grid_reach / 2 * (high_m[i] - low_m[i]);
		/* From its own plane nobody sees a flat wall. */
		float side = fmaxf(on_ground ? middle + half - low_m[i] : 2 * half,
				   least_side * spacing);
		uint32_t steps = (uint32_t)lrintf(side / spacing);

		steps = steps < 1 ? 1 : steps;
		out->spacing_m[i] = side / (float)steps;
		/* The lowest layer is half a step above the ground, where visitors' eyes would
		 * be. */
		out->origin_m[i] = on_ground ? low_m[i] + out->spacing_m[i] / 2 : middle - side / 2;
		out->count[i] = on_ground ? steps : steps + 1;
	}
}

void sampler_point(float out[3], const struct sample_grid *grid, const uint32_t point[3])
{
	const int vantage = sample_grid_vantage(grid, point);

	if (vantage >= 0) {
		memcpy(out, grid->vantage_m[vantage], sizeof(grid->vantage_m[0]));
		return;
	}
	for (int i = 0; i < 3; i++)
		out[i] = grid->origin_m[i] + grid->spacing_m[i] * (float)point[i];
}

/* Vantage points do not count: where one is its file says. master: NULL if the mesh itself is
 * drawn. */
static struct hash make_key(const struct sampling *sampling, struct hash mesh_key,
			    const struct master *master)
{
	const struct drawing_options *drawing = &sampling->drawing;
	const struct sample_grid *grid = &sampling->grid;
	struct buffer text;
	struct hash key;

	buffer_init(&text, 4096);
	buffer_put_u32(&text, SAMPLER_VERSION);
	buffer_put(&text, mesh_key.bytes, HASH_BYTES);
	if (master)
		buffer_put(&text, master->stamp.bytes, HASH_BYTES);
	buffer_put_u8(&text, drawing->lit);
	buffer_put_u8(&text, drawing->procedural ? (uint8_t)(1 + drawing->substance) : 0);
	for (int i = 0; i < 3; i++) {
		buffer_put_f32(&text, drawing->lit ? drawing->sun[i] : 0);
		buffer_put_f32(&text, grid->origin_m[i]);
		buffer_put_f32(&text, grid->spacing_m[i]);
		buffer_put_u32(&text, grid->count[i]);
	}
	buffer_put_u32(&text, grid->level_count);
	if (grid->choice_count > 1) {
		buffer_put_u8(&text, CHOICES_VERSION);
		buffer_put(&text, grid->qualities, grid->choice_count);
		buffer_put_u8(&text, (uint8_t)grid->scale_count);
	}
	buffer_put_u32(&text, grid->choice_count > 1 ? 0 : sampling->content->quality);
	if (sampling->content->effort != TILE_THOROUGH)
		buffer_put_u8(&text, (uint8_t)sampling->content->effort);
	key = hash_of(buffer_bytes(&text));
	buffer_finish(&text);
	return key;
}

/* Lists the points of the shard that are still missing. */
static int list_points(struct sampling *sampling, const struct sampler_options *options)
{
	const uint32_t total = sample_grid_points(&sampling->grid);
	const struct shard shard = options->shard;
	struct samples_store *store;
	int rc = samples_store_look(&store, sampling->content->folder);

	if (rc < 0)
		return rc;
	sampling->points = malloc(total * sizeof(*sampling->points));
	for (uint32_t n = 0; sampling->points && n < total; n++) {
		uint32_t *point = sampling->points[sampling->point_count];

		if (shard.count > 1 && n % shard.count != shard.number)
			continue;
		sample_grid_point(&sampling->grid, n, point);
		if (!samples_store_has(store, point))
			sampling->point_count++;
	}
	samples_store_close(store);
	return sampling->points ? 0 : -ENOMEM;
}

/* Sets *state to SAMPLE_GROUND or SAMPLE_INSIDE if the point can be skipped before anything is
 * rendered; otherwise it stays. sight_look was called. */
static int judge_point(const struct sampling *sampling, const struct sight *sight,
		       const float point_m[3], enum sample_state *state)
{
	const uint32_t *pieces;
	uint32_t count;
	double winding;
	int rc;

	if (!sampling->below_ground && point_m[2] < sampling->model->low_m[2]) {
		*state = SAMPLE_GROUND;
		return 0;
	}
	pieces = sight_pieces(sight, &count);
	rc = model_winding(sampling->model, pieces, count, point_m, &winding);
	if (rc == 0 && winding > winding_solid)
		*state = SAMPLE_INSIDE;
	return rc;
}

/* The six faces of a point, in the form that the store takes. */
struct taken {
	struct shot shots[CUBE_FACES];
	struct sample_face faces[CUBE_FACES];
	struct bytes objects[CUBE_FACES][FACE_TILES_MAX * SAMPLE_CHOICES_MAX];
};

static void describe_face(struct taken *taken, uint32_t n, int face, const struct sample_grid *grid)
{
	const struct shot *shot = &taken->shots[face];
	const uint32_t choices = grid->choice_count > 1 ? grid->choice_count : 1;
	uint32_t start = 0;

	for (uint32_t i = 0; i < shot->tile_count * choices; i++) {
		taken->objects[face][i] =
			(struct bytes){ shot->objects.data + start, shot->end_of[i] - start };
		start = shot->end_of[i];
	}
	taken->faces[n] = (struct sample_face){
		.face = face,
		.level_count = grid->level_count,
		.coverage = shot->coverage,
		.near_m = shot->near_m,
		.far_m = shot->far_m,
		.tile_count = shot->tile_count,
		.tiles = shot->tiles,
		.objects = taken->objects[face],
		.features = (const uint32_t(*)[SAMPLE_SCALES_MAX])shot->features,
		.windows = shot->windows,
		.losses = shot->losses,
	};
}

/* Renders the six faces. Returns how many show anything, or a negative errno; *state is
 * SAMPLE_RENDERED, SAMPLE_EMPTY or SAMPLE_INSIDE. */
static int take_faces(const struct sampling *sampling, struct face_renderer *renderer,
		      struct taken *taken, const float place[3], bool is_vantage,
		      enum sample_state *state)
{
	const uint8_t *background = is_vantage ? sampling->grid.background : NULL;
	uint64_t covered = 0, backs = 0;
	uint32_t count = 0;

	for (int face = 0; face < CUBE_FACES; face++) {
		int rc = face_renderer_take(renderer, &taken->shots[face], place, face, background);

		if (rc < 0)
			return rc;
		covered += taken->shots[face].covered;
		backs += taken->shots[face].backs;
		if (taken->shots[face].tile_count)
			describe_face(taken, count++, face, &sampling->grid);
	}
	*state = count ? SAMPLE_RENDERED : SAMPLE_EMPTY;
	if ((double)backs <= backs_solid * (double)covered)
		return (int)count;
	*state = SAMPLE_INSIDE;
	return 0;
}

static int take_point(const struct sampling *sampling, struct face_renderer *renderer,
		      struct taken *taken, const uint32_t point[3])
{
	struct sight *sight = face_renderer_sight(renderer);
	uint32_t face_px = (uint32_t)SAMPLE_TILE_PX << (sampling->grid.level_count - 1);
	enum sample_state state = SAMPLE_RENDERED;
	float place[3];
	int rc, count = 0;

	sampler_point(place, &sampling->grid, point);
	sight_look(sight, place, detail_texels * 2 / (float)face_px);
	rc = judge_point(sampling, sight, place, &state);
	if (rc == 0 && state == SAMPLE_RENDERED) {
		count = take_faces(sampling, renderer, taken, place,
				   sample_grid_vantage(&sampling->grid, point) >= 0, &state);
		rc = count < 0 ? count : 0;
	}
	if (rc < 0)
		return rc;
	return samples_store_put(sampling->content->folder, sampling->key, &sampling->grid, state,
				 point, taken->faces, (uint32_t)count);
}

/* Processes points until none is left, and writes a byte into the pipe for each. */
static int work(const struct sampling *sampling, struct face_renderer *renderer, int done_fd)
{
	struct taken *taken = calloc(1, sizeof(*taken));
	int rc = 0;

	if (!taken)
		return -ENOMEM;
	for (int face = 0; face < CUBE_FACES; face++)
		shot_init(&taken->shots[face]);
	while (rc == 0) {
		uint32_t n = atomic_fetch_add(&sampling->queue->next, 1);

		if (n >= sampling->point_count)
			break;
		rc = take_point(sampling, renderer, taken, sampling->points[n]);
		if (rc == 0 && write(done_fd, "", 1) != 1)
			rc = -EPIPE;
	}
	for (int face = 0; face < CUBE_FACES; face++)
		shot_finish(&taken->shots[face]);
	free(taken);
	return rc;
}

/* The body of a child process. */
static int run_child(const struct sampling *sampling, uint32_t jobs, int done_fd)
{
	struct face_renderer_options options = { .model = sampling->model,
						 .textures = sampling->textures,
						 .texture_count = sampling->texture_count,
						 .drawn = sampling->drawing,
						 .level_count = sampling->grid.level_count,
						 .quality = (int)sampling->content->quality,
						 .effort = sampling->content->effort,
						 .choice_count = sampling->grid.choice_count,
						 .scale_count = sampling->grid.scale_count };
	long cores = sysconf(_SC_NPROCESSORS_ONLN);
	struct headless *headless = NULL;
	struct face_renderer *renderer = NULL;
	char threads[24];
	int rc = 0;

	memcpy(options.qualities, sampling->grid.qualities, sizeof(options.qualities));
	/* Otherwise a software rasteriser starts one thread per core in every process. */
	snprintf(threads, sizeof(threads), "%ld", cores > (long)jobs ? cores / (long)jobs : 1);
	setenv("LP_NUM_THREADS", threads, 0);
	if (options.texture_count)
		rc = headless_create(&headless);
	if (rc == 0)
		rc = face_renderer_create(&renderer, &options);
	if (rc == 0)
		rc = work(sampling, renderer, done_fd);
	if (rc < 0)
		log_error("pipeline", "a sampler process failed: %s", strerror(-rc));
	face_renderer_destroy(renderer);
	headless_destroy(headless);
	return rc;
}

static int start_children(const struct sampling *sampling, uint32_t jobs, pid_t *children,
			  const int done[2])
{
	pid_t parent = getpid();

	for (uint32_t i = 0; i < jobs; i++) {
		children[i] = fork();
		if (children[i] < 0)
			return -errno;
		if (children[i] > 0)
			continue;
		prctl(PR_SET_PDEATHSIG, SIGTERM);
		close(done[0]);
		if (getppid() != parent)
			_exit(EIO);
		_exit(-run_child(sampling, jobs, done[1]));
	}
	return 0;
}

/* Shows progress until every child has closed its end of the pipe. */
static void watch(int done_fd, uint32_t total)
{
	struct progress *progress = progress_start("sampling", "points", total);
	char bytes[64];
	ssize_t n;

	while ((n = read(done_fd, bytes, sizeof(bytes))) > 0 || (n < 0 && errno == EINTR))
		progress_add(progress, n > 0 ? (uint64_t)n : 0);
	progress_end(progress);
}

/* Waits for a child and returns what it failed of. SIGKILL is the kernel's, where memory is
 * short. */
static int end_child(pid_t child)
{
	int status = 0;

	while (waitpid(child, &status, 0) < 0)
		if (errno != EINTR)
			return -errno;
	if (WIFEXITED(status))
		return -WEXITSTATUS(status);
	log_error("pipeline", "a sampler process was killed by signal %d", WTERMSIG(status));
	return WTERMSIG(status) == SIGKILL ? -ENOMEM : -EIO;
}

static int run_children(struct sampling *sampling, uint32_t jobs)
{
	pid_t children[JOBS_MAX] = { 0 };
	int done[2], rc;

	if (pipe(done) < 0)
		return -errno;
	fflush(NULL);
	rc = start_children(sampling, jobs, children, done);
	close(done[1]);
	watch(done[0], sampling->point_count);
	close(done[0]);
	for (uint32_t i = 0; i < jobs; i++) {
		int ended = children[i] > 0 ? end_child(children[i]) : 0;

		rc = rc < 0 ? rc : ended;
	}
	return rc;
}

/* Makes the model that is drawn: the master's, or the whole mesh. */
static int make_model(struct sampling *sampling, struct scans *scans, const struct master *master,
		      struct diagnostics *diagnostics)
{
	const struct mesh *mesh;
	int rc;

	if (master)
		return model_of_master(&sampling->model, master);
	rc = scans_get_mesh(scans, &mesh, diagnostics);
	if (rc < 0)
		return rc;
	sampling->textures = mesh->textures;
	if (mesh->uvs && !sampling->drawing.procedural)
		sampling->texture_count = mesh->texture_count;
	return chunks_create(&sampling->model, mesh, sampling->content->import.default_colour);
}

/* Renders the points of the list. */
static int render(struct sampling *sampling, uint32_t jobs)
{
	int rc;

	jobs = jobs < sampling->point_count ? jobs : sampling->point_count;
	jobs = jobs < JOBS_MAX ? jobs : JOBS_MAX;
	sampling->queue = mmap(NULL, sizeof(*sampling->queue), PROT_READ | PROT_WRITE,
			       MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	if (sampling->queue == MAP_FAILED)
		return -ENOMEM;
	rc = run_children(sampling, jobs);
	munmap(sampling->queue, sizeof(*sampling->queue));
	return rc;
}

static int sample(struct sampling *sampling, struct scans *scans,
		  const struct sampler_options *options, struct diagnostics *diagnostics)
{
	long cores = sysconf(_SC_NPROCESSORS_ONLN);
	uint32_t jobs = options->jobs ? options->jobs : (uint32_t)(cores > 0 ? cores : 1);
	int rc = samples_store_begin(sampling->content->folder, &sampling->grid, sampling->key);

	if (rc == 0)
		rc = list_points(sampling, options);
	if (rc == 0 && sampling->point_count > 0) {
		rc = make_model(sampling, scans, options->master, diagnostics);
		if (rc == 0)
			rc = render(sampling, jobs);
		model_destroy(sampling->model);
	}
	if (rc == 0 && options->shard.count <= 1)
		samples_store_sweep(sampling->content->folder, &sampling->grid);
	free(sampling->points);
	return rc;
}

/* The qualities of which a budget chooses: each takes about half as many bytes again as the one
 * before, or twice as many (docs/quality.md). */
static void set_choices(struct sample_grid *grid, const struct content *content)
{
	static const uint8_t qualities[SAMPLE_CHOICES_MAX] = { 20, 40, 60, 80, 95 };

	memcpy(grid->qualities, qualities, sizeof(qualities));
	grid->choice_count = SAMPLE_CHOICES_MAX;
	grid->scale_count =
		content->quality_rule == CONTENT_QUALITY_FEATURES ? SAMPLE_SCALES_MAX : 0;
}

void sampler_add_first_view(struct sample_grid *grid, const struct content *content,
			    const float low_m[3], const float high_m[3])
{
	float target_m[3];

	start_view(grid->vantage_m[0], target_m, low_m, high_m);
	if (content->has_start)
		memcpy(grid->vantage_m[0], content->start_eye_m, sizeof(grid->vantage_m[0]));
	grid->vantage_count = 1;
	memcpy(grid->background, content->background, sizeof(grid->background));
}

/* Chooses grid and light for the scans' shape, and the key. */
static int prepare(struct sampling *sampling, struct scans *scans, const struct scans_shape *shape,
		   const struct sampler_options *options, struct diagnostics *diagnostics)
{
	const struct content *content = sampling->content;
	struct hash mesh_key;
	int rc = scans_key(scans, &mesh_key, diagnostics);

	if (rc < 0)
		return rc;
	if (content->budget_bytes > 0 && content->quality_rule == CONTENT_QUALITY_FEATURES &&
	    shape->has_textures)
		return diagnostics_add(
			diagnostics, -EINVAL, content->folder, 0,
			"[samples] quality = features counts features of depth, which "
			"faces of scans with pictures do not have; write gain");
	sampling->drawing.lit = content_is_lit(content, shape->had_pictures);
	sampling->drawing.procedural = content->colours == CONTENT_COLOURS_PROCEDURAL;
	sampling->drawing.substance = content->substance;
	memcpy(sampling->drawing.sun, content->sun, sizeof(content->sun));
	sampler_grid(&sampling->grid, shape->low_m, shape->high_m, content->grid_points,
		     content->face_px, options->below_ground);
	sampler_add_first_view(&sampling->grid, content, shape->low_m, shape->high_m);
	if (content->budget_bytes > 0)
		set_choices(&sampling->grid, content);
	sampling->key = make_key(sampling, mesh_key, options->master);
	return 0;
}

/* What to do after that failure. */
static const char *cure_of(int rc)
{
	switch (rc) {
	case -EBADMSG:
		return "; .work/master is damaged: delete it and build again";
	case -ENOMEM:
		return "; run it with fewer --jobs";
	default:
		return "";
	}
}

int sampler_run(struct scans *scans, const struct sampler_options *options,
		struct diagnostics *diagnostics)
{
	const struct content *content = scans_content(scans);
	struct sampling sampling = { .content = content, .below_ground = options->below_ground };
	const struct scans_shape *shape;
	int rc = scans_get_shape(scans, &shape, diagnostics);

	if (rc == 0)
		rc = prepare(&sampling, scans, shape, options, diagnostics);
	if (rc < 0)
		return rc;
	rc = sample(&sampling, scans, options, diagnostics);
	if (rc < 0)
		diagnostics_add(diagnostics, rc, content->folder, 0, "sampling failed: %s%s",
				strerror(-rc), cure_of(rc));
	return rc;
}

/* ---- a look without a run */

static int by_time(const void *a, const void *b)
{
	const double *x = a, *y = b;

	return (*x > *y) - (*x < *y);
}

/* Returns the median of the distances between times; the pauses between runs are few. */
static double median_gap(double *times_s, uint32_t count)
{
	qsort(times_s, count, sizeof(*times_s), by_time);
	for (uint32_t i = 0; i + 1 < count; i++)
		times_s[i] = times_s[i + 1] - times_s[i];
	if (count < 8) /* too few to tell */
		return 0;
	qsort(times_s, count - 1, sizeof(*times_s), by_time);
	return times_s[(count - 1) / 2];
}

static int look_at_points(struct sampler_progress *out, struct samples_store *store)
{
	double *times_s = calloc(out->point_count, sizeof(*times_s));

	if (!times_s)
		return -ENOMEM;
	for (uint32_t n = 0; n < out->point_count; n++) {
		uint32_t point[3];
		struct stat file;

		sample_grid_point(&out->grid, n, point);
		if (!samples_store_has(store, point) || samples_store_stat(store, point, &file) < 0)
			continue;
		out->done_bytes += (uint64_t)file.st_size;
		times_s[out->done_count++] =
			(double)file.st_mtim.tv_sec + 1e-9 * (double)file.st_mtim.tv_nsec;
	}
	out->seconds_a_point = median_gap(times_s, out->done_count);
	free(times_s);
	return 0;
}

/* Opens the samples of a folder. Returns false, silently, if there are none or they are damaged. */
static bool look_into(struct samples_store **store, const struct content *content)
{
	char path[CONTENT_PATH_BYTES + 32];

	snprintf(path, sizeof(path), "%s/.work/samples/grid", content->folder);
	return access(path, R_OK) == 0 && samples_store_look(store, content->folder) == 0;
}

int sampler_look(struct sampler_progress *out, struct scans *scans,
		 const struct sampler_options *options, struct diagnostics *diagnostics)
{
	struct sampling sampling = { .content = scans_content(scans) };
	const struct scans_shape *shape = scans_known_shape(scans);
	struct samples_store *store;
	int rc;

	*out = (struct sampler_progress){ 0 };
	if (!shape)
		return -ENOENT;
	rc = prepare(&sampling, scans, shape, options, diagnostics);
	if (rc < 0)
		return rc;
	out->grid = sampling.grid;
	out->point_count = sample_grid_points(&out->grid);
	if (!look_into(&store, sampling.content))
		return 0; /* nothing was sampled, or it is done again */
	if (hash_equal(samples_store_key(store), sampling.key))
		rc = look_at_points(out, store);
	samples_store_close(store);
	return rc;
}

static bool has_first_view_of(const struct sample_grid *a, const struct sample_grid *b)
{
	return a->vantage_count == b->vantage_count &&
	       memcmp(a->vantage_m, b->vantage_m, a->vantage_count * sizeof(a->vantage_m[0])) ==
		       0 &&
	       memcmp(a->background, b->background, sizeof(a->background)) == 0;
}

bool sampler_is_current(struct scans *scans, const struct master *master)
{
	enum { BELOW_GROUND = 1, WITH_BUDGET = 2, VARIANTS = 4 };
	const struct scans_shape *shape = scans_known_shape(scans);
	struct content content = *scans_content(scans);
	struct samples_store *store;
	bool found = false;

	if (!shape || !look_into(&store, &content))
		return false;
	for (int variant = 0; variant < VARIANTS && !found; variant++) {
		const struct sampler_options options = {
			.master = shape->has_textures ? NULL : master,
			.below_ground = variant & BELOW_GROUND,
		};
		struct sampling sampling = { .content = &content };

		content.budget_bytes = variant & WITH_BUDGET;
		found = prepare(&sampling, scans, shape, &options, NULL) == 0 &&
			hash_equal(samples_store_key(store), sampling.key) &&
			has_first_view_of(samples_store_grid(store), &sampling.grid);
	}
	samples_store_close(store);
	return found;
}
