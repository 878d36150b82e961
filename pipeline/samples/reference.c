/* Parses lists of views and draws supersampled reference pictures, skipping those that are up to
 * date. */
#include "pipeline/samples/reference.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/array.h"
#include "base/progress.h"
#include "format/picture.h"
#include "pipeline/samples/chunks.h"
#include "pipeline/samples/drawing.h"
#include "render/display/gl.h"
#include "render/display/headless.h"

enum { REFERENCE_VERSION = 2, LINE_BYTES = 512, PNG_BYTES_MAX = 256 << 20, NUMBERS = 7 };

/* Everything that one run shares. */
struct easel {
	const struct reference_options *options;
	struct headless *headless;
	struct model *model; /* owned */
	struct drawing *drawing;
	struct gl_target target;
	uint32_t block;      /* samples per pixel and side in one frame */
	uint32_t (*sums)[4]; /* red, green, blue and count of covered samples; owned */
	uint8_t *frame;      /* owned */
};

/* Reads the numbers of a line, in order; the words eye, target and fov may stand between them.
 * Returns how many there are, -1 if there is something else or too many. */
static int line_numbers(const char *line, float out[NUMBERS])
{
	int count = 0;

	for (;;) {
		char *end;

		line += strspn(line, " \t\r,");
		if (!*line || *line == '#')
			return count;
		if (strncmp(line, "eye", 3) == 0 || strncmp(line, "fov", 3) == 0) {
			line += 3;
			continue;
		}
		if (strncmp(line, "target", 6) == 0) {
			line += 6;
			continue;
		}
		if (count == NUMBERS)
			return -1;
		out[count] = strtof(line, &end);
		if (end == line || !isfinite(out[count]))
			return -1;
		count++;
		line = end;
	}
}

static bool view_from(struct camera *view, const float numbers[NUMBERS])
{
	float away = 0;

	*view = (struct camera){ .up = { 0, 0, 1 }, .fov_deg = numbers[6] };
	for (int i = 0; i < 3; i++) {
		view->eye_m[i] = numbers[i];
		view->target_m[i] = numbers[3 + i];
		away += fabsf(numbers[3 + i] - numbers[i]);
	}
	return away > 0 && view->fov_deg >= 1 && view->fov_deg <= 170;
}

/* Copies the next line without its end, cut at LINE_BYTES. Returns false if there is none. */
static bool next_line(struct bytes *text, char line[LINE_BYTES])
{
	size_t size = 0;

	if (text->size == 0)
		return false;
	while (size < text->size && text->data[size] != '\n')
		size++;
	snprintf(line, LINE_BYTES, "%.*s", (int)(size < LINE_BYTES ? size : LINE_BYTES - 1),
		 (const char *)text->data);
	size += size < text->size;
	text->data += size;
	text->size -= size;
	return true;
}

int reference_views(struct camera **out, uint32_t *count, struct bytes text, const char *name,
		    struct diagnostics *diagnostics)
{
	struct camera *views = NULL;
	uint32_t room = 0;
	char line[LINE_BYTES];
	int rc = -EINVAL;

	*out = NULL;
	*count = 0;
	for (unsigned number = 1; next_line(&text, line); number++) {
		float numbers[NUMBERS];
		int found = line_numbers(line, numbers);

		if (found == 0)
			continue;
		if (ARRAY_RESERVE(views, room, *count + 1, REFERENCE_VIEWS_MAX + 1) < 0) {
			rc = -ENOMEM;
			goto fail;
		}
		if (found != NUMBERS || *count == REFERENCE_VIEWS_MAX ||
		    !view_from(&views[*count], numbers)) {
			diagnostics_add(
				diagnostics, rc, NULL, 0,
				"%s, line %u: give eye x y z, target x y z (another place) and "
				"the vertical field of view, 1 to 170 degrees",
				name, number);
			goto fail;
		}
		++*count;
	}
	if (*count > 0) {
		*out = views;
		return 0;
	}
	diagnostics_add(diagnostics, rc, name, 0, "the file has no view; write one a line");
fail:
	free(views);
	*count = 0;
	return rc;
}

static int view_key(struct hash *out, const struct content *content, struct hash scans,
		    const struct camera *view, const struct reference_options *options)
{
	struct buffer text;
	int rc;

	buffer_init(&text, 4096);
	buffer_put_u32(&text, REFERENCE_VERSION);
	buffer_put(&text, scans.bytes, HASH_BYTES);
	buffer_put_u32(&text, content->colours);
	buffer_put_u32(&text, content->substance);
	buffer_put_u32(&text, content->lit);
	for (int i = 0; i < 3; i++) {
		buffer_put_f32(&text, content->sun[i]);
		buffer_put_f32(&text, view->eye_m[i]);
		buffer_put_f32(&text, view->target_m[i]);
	}
	buffer_put_f32(&text, view->fov_deg);
	buffer_put_u32(&text, (uint32_t)options->width_px);
	buffer_put_u32(&text, (uint32_t)options->height_px);
	buffer_put_u32(&text, options->supersample);
	rc = text.error;
	*out = hash_of(buffer_bytes(&text));
	buffer_finish(&text);
	return rc;
}

static void view_path(char out[PATH_MAX], const struct reference_options *options, uint32_t n,
		      const char *ending)
{
	snprintf(out, PATH_MAX, "%s/view-%04u.%s", options->out_dir, n, ending);
}

/* Returns true if the picture exists and its .key file has the same key. */
static bool is_there(const struct reference_options *options, uint32_t n, struct hash key)
{
	char path[PATH_MAX], hex[HASH_HEX_BYTES];
	struct buffer file;
	struct stat stat_of;
	bool same;

	view_path(path, options, n, "png");
	if (stat(path, &stat_of) < 0 || stat_of.st_size == 0)
		return false;
	view_path(path, options, n, "key");
	buffer_init(&file, 1024);
	hash_to_hex(key, hex);
	same = buffer_read_file(&file, path) == 0 && file.size == HASH_HEX_BYTES - 1 &&
	       memcmp(file.data, hex, HASH_HEX_BYTES - 1) == 0;
	buffer_finish(&file);
	return same;
}

static int set_up(struct easel *easel, struct scans *scans, struct diagnostics *diagnostics)
{
	const struct content *content = scans_content(scans);
	const struct reference_options *options = easel->options;
	struct drawing_options drawing = { .procedural =
						   content->colours == CONTENT_COLOURS_PROCEDURAL,
					   .substance = content->substance };
	size_t pixels = (size_t)options->width_px * (size_t)options->height_px;
	int side = options->width_px > options->height_px ? options->width_px : options->height_px;
	const struct scans_shape *shape;
	const struct mesh *mesh;
	int rc = scans_get_mesh(scans, &mesh, diagnostics);

	if (rc == 0)
		rc = scans_get_shape(scans, &shape, diagnostics);
	if (rc < 0)
		return rc;
	/* The largest frame whose block divides the samples; jitter provides the rest. */
	for (uint32_t k = 1; k <= options->supersample; k++)
		if (options->supersample % k == 0 && side * (int)k <= GL_LIMIT_TEXTURE_PX)
			easel->block = k;
	drawing.lit = content_is_lit(content, shape->had_pictures);
	memcpy(drawing.sun, content->sun, sizeof(drawing.sun));
	easel->sums = malloc(pixels * sizeof(*easel->sums));
	easel->frame = malloc(pixels * easel->block * easel->block * 4);
	if (!easel->sums || !easel->frame)
		return -ENOMEM;
	rc = headless_create(&easel->headless);
	if (rc == 0)
		rc = chunks_create(&easel->model, mesh, content->import.default_colour);
	if (rc == 0)
		rc = drawing_create(&easel->drawing, easel->model, mesh->textures,
				    mesh->uvs ? mesh->texture_count : 0, &drawing);
	if (rc == 0)
		rc = gl_target_create(&easel->target, options->width_px * (int)easel->block,
				      options->height_px * (int)easel->block);
	return rc;
}

static void take_down(struct easel *easel)
{
	if (easel->headless) {
		gl_target_destroy(&easel->target);
		drawing_destroy(easel->drawing);
	}
	headless_destroy(easel->headless);
	model_destroy(easel->model);
	free(easel->sums);
	free(easel->frame);
}

static void add_frame(struct easel *easel)
{
	uint32_t width = (uint32_t)easel->target.width_px,
		 height = (uint32_t)easel->target.height_px;
	const uint8_t *from = easel->frame;

	for (uint32_t y = 0; y < height; y++) {
		uint32_t(*row)[4] = easel->sums +
				    (size_t)(y / easel->block) * (uint32_t)easel->options->width_px;

		for (uint32_t x = 0; x < width; x++, from += 4) {
			uint32_t *sum = row[x / easel->block];

			if (!from[3])
				continue;
			for (int c = 0; c < 3; c++)
				sum[c] += from[c];
			sum[3]++;
		}
	}
}

/* Draws all samples of a view and adds them to the sums. */
static int draw_samples(struct easel *easel, const struct camera *view)
{
	struct camera camera = *view;
	uint32_t jitters = easel->options->supersample / easel->block;
	float forward[3], matrix[16];

	camera_forward(&camera, forward);
	camera.width_px = easel->target.width_px;
	camera.height_px = easel->target.height_px;
	sight_look(drawing_sight(easel->drawing), camera.eye_m, 0);
	if (!sight_range(drawing_sight(easel->drawing), camera.eye_m, forward, &camera.near_m,
			 &camera.far_m))
		return 0; /* everything is behind the eye */
	camera_matrix(&camera, matrix);
	for (uint32_t n = 0; n < jitters * jitters; n++) {
		float shift[2] = { ((float)(n % jitters) + 0.5f) / (float)jitters - 0.5f,
				   ((float)(n / jitters) + 0.5f) / (float)jitters - 0.5f };
		float shifted[16];
		int rc;

		memcpy(shifted, matrix, sizeof(matrix));
		for (int column = 0; column < 4; column++) {
			float w = matrix[4 * column + 3];

			shifted[4 * column] += 2 * shift[0] / (float)camera.width_px * w;
			shifted[4 * column + 1] += 2 * shift[1] / (float)camera.height_px * w;
		}
		gl_target_bind(&easel->target);
		rc = drawing_draw(easel->drawing, shifted, camera.eye_m,
				  1 / camera_px_per_radian(&camera) / (float)jitters);
		if (rc == 0)
			rc = gl_target_read(&easel->target, easel->frame);
		if (rc < 0)
			return rc;
		add_frame(easel);
	}
	return 0;
}

/* A picture without a key is drawn again. */
static int remove_key(const struct reference_options *options, uint32_t n)
{
	char path[PATH_MAX];

	view_path(path, options, n, "key");
	return unlink(path) < 0 && errno != ENOENT ? -errno : 0;
}

/* The key comes last: it tells that the picture is whole. */
static int write_view(const struct easel *easel, uint32_t n, struct hash key)
{
	struct picture picture = { .width = (uint32_t)easel->options->width_px,
				   .height = (uint32_t)easel->options->height_px };
	size_t pixels = (size_t)picture.width * picture.height;
	uint32_t samples = easel->options->supersample * easel->options->supersample;
	char path[PATH_MAX], hex[HASH_HEX_BYTES];
	struct buffer file;
	int rc;

	picture.rgba = malloc(pixels * 4);
	if (!picture.rgba)
		return -ENOMEM;
	for (size_t i = 0; i < pixels; i++) {
		const uint32_t *sum = easel->sums[i];

		for (int c = 0; c < 3; c++)
			picture.rgba[4 * i + (size_t)c] =
				sum[3] ? (uint8_t)((sum[c] + sum[3] / 2) / sum[3]) : 0;
		picture.rgba[4 * i + 3] = (uint8_t)((sum[3] * 255 + samples / 2) / samples);
		if (!picture.rgba[4 * i + 3])
			memset(picture.rgba + 4 * i, 0, 3);
	}
	buffer_init(&file, PNG_BYTES_MAX);
	rc = picture_encode_png(&file, &picture);
	if (rc == 0)
		rc = remove_key(easel->options, n);
	view_path(path, easel->options, n, "png");
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&file), path);
	hash_to_hex(key, hex);
	view_path(path, easel->options, n, "key");
	if (rc == 0)
		rc = bytes_write_file((struct bytes){ (const uint8_t *)hex, HASH_HEX_BYTES - 1 },
				      path);
	buffer_finish(&file);
	picture_finish(&picture);
	return rc;
}

static int draw_view(struct easel *easel, const struct camera *view, uint32_t n, struct hash key)
{
	size_t pixels = (size_t)easel->options->width_px * (size_t)easel->options->height_px;
	int rc;

	memset(easel->sums, 0, pixels * sizeof(*easel->sums));
	rc = draw_samples(easel, view);
	return rc < 0 ? rc : write_view(easel, n, key);
}

int reference_draw(struct scans *scans, const struct camera *views, uint32_t count,
		   const struct reference_options *options, struct reference_report *report,
		   struct diagnostics *diagnostics)
{
	struct easel easel = { .options = options };
	struct progress *progress;
	struct hash scans_hash;
	int rc = scans_key(scans, &scans_hash, diagnostics);

	*report = (struct reference_report){ 0 };
	if (rc < 0)
		return rc;
	if (mkdir(options->out_dir, 0777) < 0 && errno != EEXIST)
		return diagnostics_add(diagnostics, -errno, options->out_dir, 0, "%s",
				       strerror(errno));
	progress = progress_start("rendering", "views", count);
	for (uint32_t n = 0; rc == 0 && n < count; n++) {
		struct hash key;

		rc = view_key(&key, scans_content(scans), scans_hash, &views[n], options);
		if (rc == 0 && is_there(options, n, key)) {
			report->kept++;
		} else if (rc == 0) {
			if (!easel.headless)
				rc = set_up(&easel, scans, diagnostics);
			if (rc == 0)
				rc = draw_view(&easel, &views[n], n, key);
			report->drawn += rc == 0;
		}
		progress_add(progress, 1);
	}
	progress_end(progress);
	take_down(&easel);
	if (rc < 0)
		diagnostics_add(diagnostics, rc, options->out_dir, 0, "rendering failed: %s",
				strerror(-rc));
	return rc;
}
