/* Draws views of a master at twice the size and halves them. */
#include "pipeline/samples/portrait.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/processes.h"
#include "base/shared_memory.h"
#include "format/picture.h"
#include "pipeline/samples/drawing.h"
#include "pipeline/samples/model_master.h"
#include "render/display/gl.h"
#include "render/display/headless.h"

enum { BLOCK = 2, JPEG_QUALITY = 85, JPEG_BYTES_MAX = 2 << 20 };

/* ---- a model whose pieces have one colour each */

struct painted {
	struct model model; /* first; its pieces are those of inner */
	struct model *inner;
	struct model_vertex *vertices; /* owned; of the piece that was loaded last */
	uint32_t room;
};

static uint32_t painted_choose(const struct model *model, const float eye_m[3], float detail_rad,
			       uint32_t *pieces)
{
	return model_choose(((const struct painted *)model)->inner, eye_m, detail_rad, pieces);
}

/* Colours of neighbours differ in hue; all are light enough for the shading to show. */
static void colour_of(uint32_t piece, uint8_t rgb[3])
{
	double hue = fmod(piece * 0.61803398875, 1) * 6;
	double value = 0.75 + 0.25 * fmod(piece * 0.41421356, 1);

	for (int c = 0; c < 3; c++) {
		double away = fabs(fmod(hue + 6 - 2 * c, 6) - 3); /* 3 at the hue itself */
		double share = fmin(1, fmax(0, away - 1));

		rgb[c] = (uint8_t)(255 * value * (0.35 + 0.65 * share));
	}
}

static int painted_load(struct model *model, uint32_t piece, struct model_mesh *out)
{
	struct painted *painted = (struct painted *)model;
	int rc = model_load(painted->inner, piece, out);
	uint8_t rgb[3];

	if (rc == 0 && out->vertex_count > painted->room) {
		free(painted->vertices);
		painted->room = out->vertex_count;
		painted->vertices = malloc(painted->room * sizeof(*painted->vertices));
		rc = painted->vertices ? 0 : -ENOMEM;
	}
	if (rc < 0)
		return rc;
	colour_of(piece, rgb);
	for (uint32_t i = 0; i < out->vertex_count; i++) {
		painted->vertices[i] = out->vertices[i];
		memcpy(painted->vertices[i].colour, rgb, sizeof(rgb));
	}
	out->vertices = painted->vertices;
	return 0;
}

static void painted_destroy(struct model *model)
{
	struct painted *painted = (struct painted *)model;

	model_destroy(painted->inner);
	free(painted->vertices);
	free(painted);
}

/* inner is taken, also on failure. */
static int paint(struct model **out, struct model *inner)
{
	static const struct model_methods methods = { painted_choose, painted_load,
						      painted_destroy };
	struct painted *painted = calloc(1, sizeof(*painted));

	*out = NULL;
	if (!painted) {
		model_destroy(inner);
		return -ENOMEM;
	}
	painted->model = *inner;
	painted->model.methods = &methods;
	painted->inner = inner;
	*out = &painted->model;
	return 0;
}

/* ---- pictures */

/* The results, in memory that is shared with the process. */
struct results {
	uint32_t sizes[PORTRAITS_MAX];
	uint8_t jpegs[PORTRAITS_MAX][JPEG_BYTES_MAX];
};

struct job {
	const struct portrait *portraits;
	uint32_t count;
	int width_px, height_px;
	const struct master *master;
	const struct content *content;
	bool lit;
	struct results *results;
};

/* Averages blocks of samples; what shows nothing is the background. */
static void halve(struct picture *out, const uint8_t *frame, const uint8_t background[3])
{
	size_t stride = (size_t)out->width * BLOCK * 4;

	for (uint32_t y = 0; y < out->height; y++)
		for (uint32_t x = 0; x < out->width; x++) {
			uint8_t *to = out->rgba + 4 * ((size_t)y * out->width + x);
			uint32_t sum[3] = { 0 };

			for (uint32_t i = 0; i < BLOCK * BLOCK; i++) {
				const uint8_t *from = frame + (y * BLOCK + i / BLOCK) * stride +
						      4 * (x * BLOCK + i % BLOCK);

				for (int c = 0; c < 3; c++)
					sum[c] += from[3] ? from[c] : background[c];
			}
			for (int c = 0; c < 3; c++)
				to[c] = (uint8_t)(sum[c] / (BLOCK * BLOCK));
			to[3] = 255;
		}
}

static int draw_frame(struct drawing *drawing, const struct gl_target *target, struct camera camera,
		      uint8_t *frame)
{
	float forward[3], matrix[16];
	int rc;

	camera.width_px = target->width_px;
	camera.height_px = target->height_px;
	camera_forward(&camera, forward);
	sight_look(drawing_sight(drawing), camera.eye_m, BLOCK / camera_px_per_radian(&camera));
	if (!sight_range(drawing_sight(drawing), camera.eye_m, forward, &camera.near_m,
			 &camera.far_m))
		return -EINVAL;
	camera_matrix(&camera, matrix);
	gl_target_bind(target);
	rc = drawing_draw(drawing, matrix, camera.eye_m, 1 / camera_px_per_radian(&camera));
	return rc == 0 ? gl_target_read(target, frame) : rc;
}

static int draw_one(const struct job *job, const struct gl_target *target, uint32_t n,
		    uint8_t *frame)
{
	const struct portrait *portrait = &job->portraits[n];
	struct drawing_options options = { .lit = job->lit || portrait->patches_coloured };
	struct picture picture = { .width = (uint32_t)job->width_px,
				   .height = (uint32_t)job->height_px };
	struct drawing *drawing = NULL;
	struct model *model;
	struct buffer jpeg;
	int rc = model_of_master(&model, job->master);

	memcpy(options.sun, job->content->sun, sizeof(options.sun));
	if (portrait->patches_coloured && rc == 0)
		rc = paint(&model, model);
	else
		options.procedural = job->content->colours == CONTENT_COLOURS_PROCEDURAL;
	options.substance = job->content->substance;
	buffer_init(&jpeg, JPEG_BYTES_MAX);
	picture.rgba = malloc((size_t)picture.width * picture.height * 4);
	if (rc == 0 && !picture.rgba)
		rc = -ENOMEM;
	if (rc == 0)
		rc = drawing_create(&drawing, model, NULL, 0, &options);
	if (rc == 0)
		rc = draw_frame(drawing, target, portrait->camera, frame);
	if (rc == 0) {
		halve(&picture, frame, job->content->background);
		rc = picture_encode_jpeg(&jpeg, &picture, JPEG_QUALITY);
	}
	if (rc == 0) {
		memcpy(job->results->jpegs[n], jpeg.data, jpeg.size);
		job->results->sizes[n] = (uint32_t)jpeg.size;
	}
	buffer_finish(&jpeg);
	picture_finish(&picture);
	drawing_destroy(drawing);
	model_destroy(model);
	return rc;
}

static int work(void *user, uint32_t piece)
{
	const struct job *job = user;
	struct headless *headless = NULL;
	struct gl_target target = { 0 };
	uint8_t *frame = malloc((size_t)job->width_px * (size_t)job->height_px * BLOCK * BLOCK * 4);
	int rc = frame ? headless_create(&headless) : -ENOMEM;

	(void)piece;
	if (rc == 0)
		rc = gl_target_create(&target, job->width_px * BLOCK, job->height_px * BLOCK);
	for (uint32_t n = 0; rc == 0 && n < job->count; n++)
		rc = draw_one(job, &target, n, frame);
	if (headless)
		gl_target_destroy(&target);
	headless_destroy(headless);
	free(frame);
	return rc;
}

int portraits_draw(struct buffer *jpegs, const struct portrait *portraits, uint32_t count,
		   int width_px, int height_px, const struct master *master,
		   const struct content *content, bool lit)
{
	struct job job = { portraits, count,
			   width_px,  height_px,
			   master,    content,
			   lit,       shared_memory_create(sizeof(struct results)) };
	const struct processes processes = {
		.worker_count = 1, .piece_count = 1, .work = work, .user = &job
	};
	int rc;

	if (!job.results)
		return -ENOMEM;
	rc = count <= PORTRAITS_MAX ? processes_run(&processes) : -EINVAL;
	for (uint32_t n = 0; rc == 0 && n < count; n++) {
		buffer_put(&jpegs[n], job.results->jpegs[n], job.results->sizes[n]);
		rc = jpegs[n].error;
	}
	shared_memory_destroy(job.results, sizeof(struct results));
	return rc;
}
