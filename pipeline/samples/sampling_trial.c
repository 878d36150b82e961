/* Draws three faces: few triangles far away, many triangles far away, and few that fill the face.
 * Their differences are the costs of a face, a triangle and a tile. */
#include "pipeline/samples/sampling_trial.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/processes.h"
#include "base/resource_usage.h"
#include "base/shared_memory.h"
#include "pipeline/samples/chunks.h"
#include "pipeline/samples/face_renderer.h"
#include "pipeline/samples/sampler.h"

/* Faces of more levels are not drawn: their cost grows with their pixels. With fewer, the ball is
 * in as many tiles from afar as from near. */
enum { TRIAL_LEVELS_MIN = 2, TRIAL_LEVELS_MAX = 4, FEW = 24, MANY = 128, BATCHES = 3, REPEATS = 4 };

/* Seen from afar, it lies within one tile of the finest level. */
static const float near_m[3] = { -1.6f, 0, 0 }, far_m[3] = { -14, 4, 4 };

int sampling_trial_mesh(struct mesh *out, uint32_t n)
{
	uint32_t round = 2 * n;

	*out = (struct mesh){ .vertex_count = round * (n + 1), .triangle_count = 4 * n * n };
	out->positions = calloc(out->vertex_count, sizeof(*out->positions));
	out->colours = calloc(out->vertex_count, sizeof(*out->colours));
	out->triangles = calloc(out->triangle_count, sizeof(*out->triangles));
	if (!out->positions || !out->colours || !out->triangles) {
		mesh_finish(out);
		return -ENOMEM;
	}
	for (uint32_t i = 0; i < out->vertex_count; i++) {
		double down = M_PI * (i / round + 0.5) / (n + 1);
		double turn = 2 * M_PI * (i % round) / round;
		double r = 1 + 0.03 * sin(11 * turn) * sin(9 * down) +
			   0.01 * sin(41 * turn + 31 * down);
		double shade = 128 + 50 * sin(60 * turn + 50 * down);

		out->positions[i][0] = (float)(r * sin(down) * cos(turn));
		out->positions[i][1] = (float)(r * sin(down) * sin(turn));
		out->positions[i][2] = (float)(r * cos(down));
		for (int c = 0; c < 3; c++)
			out->colours[i][c] = (uint8_t)shade;
		out->colours[i][3] = 255;
	}
	for (uint32_t y = 0; y < n; y++)
		for (uint32_t x = 0; x < round; x++) {
			uint32_t a = y * round + x, b = y * round + (x + 1) % round;
			uint32_t *t = out->triangles[2 * a];

			t[0] = a;
			t[1] = a + round;
			t[2] = b;
			t[3] = b;
			t[4] = a + round;
			t[5] = b + round;
		}
	return 0;
}

/* What is drawn with, and the costs of one face. */
struct stand {
	struct model *model;
	struct face_renderer *renderer;
	struct shot shot;
	double seconds;
};

static double processor_s(void)
{
	struct resource_usage usage;

	resource_usage_now(&usage);
	return (double)usage.processor_us / 1e6;
}

static int stand_init(struct stand *stand, struct face_renderer_options options, uint32_t n)
{
	static const uint8_t colour[3] = { 128, 128, 128 };
	struct mesh mesh;
	int rc = sampling_trial_mesh(&mesh, n);

	*stand = (struct stand){ 0 };
	shot_init(&stand->shot);
	if (rc == 0)
		rc = chunks_create(&stand->model, &mesh, colour);
	mesh_finish(&mesh);
	options.model = stand->model;
	if (rc == 0)
		rc = face_renderer_create(&stand->renderer, &options);
	return rc;
}

static void stand_finish(struct stand *stand)
{
	face_renderer_destroy(stand->renderer);
	model_destroy(stand->model);
	shot_finish(&stand->shot);
}

/* Draws the face +x and sets stand->seconds to the mean of the fastest batch of repeats, after a
 * first one, which uploads. */
static int take(struct stand *stand, const float point_m[3])
{
	int rc;

	sight_look(face_renderer_sight(stand->renderer), point_m, 0);
	rc = face_renderer_take(stand->renderer, &stand->shot, point_m, 0, NULL);
	stand->seconds = INFINITY;
	for (int batch = 0; batch < BATCHES; batch++) {
		double start = processor_s();

		for (int i = 0; rc == 0 && i < REPEATS; i++)
			rc = face_renderer_take(stand->renderer, &stand->shot, point_m, 0, NULL);
		stand->seconds = fmin(stand->seconds, (processor_s() - start) / REPEATS);
	}
	return rc;
}

static int measure(struct sampling_trial *out, const struct face_renderer_options *options)
{
	struct stand few, many = { 0 };
	double far_s;
	uint32_t far_tiles;
	int rc = stand_init(&few, *options, FEW);

	if (rc == 0)
		rc = face_renderer_take(few.renderer, &few.shot, far_m, 0, NULL);
	out->start_s = processor_s();
	if (rc == 0)
		rc = take(&few, far_m);
	far_s = few.seconds;
	far_tiles = few.shot.tile_count;
	if (rc == 0)
		rc = take(&few, near_m);
	if (rc == 0 && few.shot.tile_count <= far_tiles)
		rc = -EIO;
	if (rc == 0) {
		out->tile_s =
			fmax(0, few.seconds - far_s) / (double)(few.shot.tile_count - far_tiles);
		out->face_s = fmax(0, far_s - out->tile_s * far_tiles);
		out->tile_bytes = (double)few.shot.objects.size / few.shot.tile_count;
		rc = stand_init(&many, *options, MANY);
	}
	if (rc == 0)
		rc = take(&many, far_m);
	if (rc == 0)
		out->triangle_s = fmax(0, many.seconds - far_s) / (4.0 * (MANY * MANY - FEW * FEW));
	stand_finish(&many);
	stand_finish(&few);
	return rc;
}

struct job {
	const struct content *content;
	bool lit;
	struct sampling_trial *out; /* shared with the process */
};

/* What a process keeps of a face: its samples and its pyramid. */
static uint64_t face_bytes(uint32_t level_count, bool procedural)
{
	uint64_t side_px = (uint64_t)SAMPLE_IMAGE_PX << (level_count - 1);
	uint64_t samples = level_count < SAMPLE_LEVELS_MAX ? 4 : 1;

	return side_px * side_px * (samples * (procedural ? 8 : 12) + 5);
}

static int work(void *user, uint32_t piece)
{
	const struct job *job = user;
	struct face_renderer_options options = { .quality = (int)job->content->quality,
						 .effort = job->content->effort };
	struct resource_usage usage;
	uint32_t level_count = sampler_levels(job->content->face_px);
	double extra = 1;
	int rc;

	(void)piece;
	options.drawn.lit = job->lit;
	options.drawn.procedural = job->content->colours == CONTENT_COLOURS_PROCEDURAL;
	options.drawn.substance = job->content->substance;
	memcpy(options.drawn.sun, job->content->sun, sizeof(options.drawn.sun));
	options.level_count = level_count;
	for (; options.level_count > TRIAL_LEVELS_MAX; options.level_count--)
		extra *= 4;
	for (; options.level_count < TRIAL_LEVELS_MIN; options.level_count++)
		extra /= 4;
	rc = measure(job->out, &options);
	job->out->face_s *= extra;
	resource_usage_now(&usage);
	job->out->process_bytes = usage.own_bytes;
	if (level_count > options.level_count)
		job->out->process_bytes +=
			face_bytes(level_count, options.drawn.procedural) -
			face_bytes(options.level_count, options.drawn.procedural);
	return rc;
}

int sampling_trial(struct sampling_trial *out, const struct content *content, bool lit)
{
	struct job job = { content, lit, shared_memory_create(sizeof(*out)) };
	const struct processes processes = {
		.worker_count = 1, .piece_count = 1, .work = work, .user = &job
	};
	int rc = job.out ? processes_run(&processes) : -ENOMEM;

	*out = rc == 0 ? *job.out : (struct sampling_trial){ 0 };
	shared_memory_destroy(job.out, sizeof(*out));
	return rc;
}
