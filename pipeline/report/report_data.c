/* Reads the index of the master, the samples' store and the import's counts, and draws three small
 * pictures. */
#include "pipeline/report/report_data.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/array.h"
#include "base/log.h"
#include "geometry/vec.h"
#include "pipeline/samples/sampler.h"

/* ---- the hierarchy */

static void add_costly(struct report_data *data, const struct report_costly *costly)
{
	uint32_t at = data->costly_count;

	while (at > 0 && data->costly[at - 1].bytes < costly->bytes)
		at--;
	if (at == REPORT_COSTLY_MAX)
		return;
	if (data->costly_count < REPORT_COSTLY_MAX)
		data->costly_count++;
	memmove(&data->costly[at + 1], &data->costly[at],
		(data->costly_count - 1 - at) * sizeof(*costly));
	data->costly[at] = *costly;
}

/* A group is one level finer than the finest of the groups whose patches it replaces; these come
 * before it. */
static void find_levels(const struct hierarchy *hierarchy, uint8_t *level_of)
{
	for (uint32_t g = 0; g < hierarchy->group_count; g++) {
		const struct hierarchy_group *group = &hierarchy->groups[g];

		for (uint32_t p = 0; p < group->patch_count; p++) {
			uint32_t finer = hierarchy->patches[group->first_patch + p].finer;

			if (finer != HIERARCHY_NONE && level_of[finer] <= level_of[g] &&
			    level_of[g] + 1 < REPORT_LEVELS_MAX)
				level_of[finer] = (uint8_t)(level_of[g] + 1);
		}
	}
}

static void sum_levels(struct report_data *data, const uint8_t *level_of)
{
	const struct hierarchy *hierarchy = &data->master->hierarchy;

	for (uint32_t g = 0; g < hierarchy->group_count; g++) {
		const struct hierarchy_group *group = &hierarchy->groups[g];
		struct report_level *level = &data->levels[level_of[g]];

		if (level_of[g] + 1u > data->level_count)
			data->level_count = level_of[g] + 1u;
		level->group_count++;
		level->patch_count += group->patch_count;
		level->bytes += data->master->sizes[g];
		for (uint32_t p = 0; p < group->patch_count; p++)
			level->triangle_count +=
				hierarchy->patches[group->first_patch + p].triangle_count;
		if (level_of[g] > 0) { /* what is wrong without this group */
			struct report_level *coarser = level - 1;

			coarser->error_m = fmax(coarser->error_m, (double)group->error_m);
			coarser->mean_error_m += (double)group->error_m;
		}
	}
	for (uint32_t i = 0; i + 1 < data->level_count; i++)
		data->levels[i].mean_error_m /= data->levels[i + 1].group_count;
}

static int read_published(struct report_data *data, const uint8_t *level_of)
{
	struct master_cut cut;
	int rc = master_cut_create(&cut, data->master, data->content->publish_share);

	if (rc == -ERANGE) { /* then the coarsest group is published alone */
		data->levels[0].published_group_count = 1;
		return 0;
	}
	if (rc < 0)
		return rc;
	for (uint32_t i = 0; i < cut.hierarchy.group_count; i++) {
		const struct hierarchy_group *group = &cut.hierarchy.groups[i];
		struct report_costly costly = { .bytes = data->master->sizes[cut.groups[i]],
						.count = group->patch_count };

		data->levels[level_of[cut.groups[i]]].published_group_count++;
		memcpy(costly.centre_m, group->centre_m, sizeof(costly.centre_m));
		add_costly(data, &costly);
	}
	master_cut_finish(&cut);
	return 0;
}

static int read_hierarchy(struct report_data *data)
{
	char folder[CONTENT_PATH_BYTES];
	uint8_t *level_of;
	int rc = content_work_path(data->content, "master", folder);

	if (rc == 0)
		rc = master_open(&data->master, folder, NULL);
	if (rc < 0)
		return rc;
	level_of = calloc(data->master->hierarchy.group_count, 1);
	if (!level_of)
		return -ENOMEM;
	find_levels(&data->master->hierarchy, level_of);
	sum_levels(data, level_of);
	rc = read_published(data, level_of);
	free(level_of);
	return rc;
}

/* ---- the samples */

uint32_t report_data_point(const struct report_data *data, const uint32_t point[3])
{
	return sample_grid_number(samples_store_grid(data->store), point);
}

/* What a face shows is taken to lie in its middle, between its nearest and farthest. */
static void centre_of(const struct report_data *data, const struct sample_face *face, float out[3])
{
	float depth_m = (face->near_m + face->far_m) / 2;

	sampler_point(out, samples_store_grid(data->store), face->point);
	vec_add_scaled(out, out, depth_m, cube_axes[face->face].forward);
}

static int add_face(struct report_data *data, const struct sample_face *face)
{
	struct report_costly costly = { .is_face = true,
					.face = face->face,
					.count = face->tile_count };
	struct report_face *kept;
	int rc = ARRAY_RESERVE(data->faces, data->face_room, data->face_count + 1, UINT32_MAX);

	if (rc < 0)
		return rc;
	for (uint32_t i = 0; i < face->tile_count; i++)
		costly.bytes += face->sizes[i];
	memcpy(costly.point, face->point, sizeof(costly.point));
	centre_of(data, face, costly.centre_m);
	add_costly(data, &costly);
	data->tile_bytes += costly.bytes;
	data->tile_count += face->tile_count;
	kept = &data->faces[data->face_count++];
	*kept = (struct report_face){ .face = face->face,
				      .coverage = face->coverage,
				      .tile_count = face->tile_count,
				      .bytes = costly.bytes };
	memcpy(kept->point, face->point, sizeof(kept->point));
	data->face_at[report_data_point(data, face->point)][face->face] = data->face_count;
	return 0;
}

/* The coarsest tile, in the container that browsers read: a WebP file with one lossy frame. */
static void take_thumbnail(struct report_face *face, const struct sample_face *sample)
{
	uint32_t size = sample->sizes[0], padded = size + size % 2;
	struct buffer *out = &face->thumbnail;
	uint8_t *frame;
	int fd;

	if (sample->tiles[0] != 0)
		return;
	fd = open(sample->path, O_RDONLY | O_CLOEXEC);
	buffer_init(out, 1 << 20);
	buffer_put(out, "RIFF", 4);
	buffer_put_u32(out, 12 + padded);
	buffer_put(out, "WEBPVP8 ", 8);
	buffer_put_u32(out, size);
	frame = buffer_extend(out, padded);
	if (frame)
		frame[padded - 1] = 0;
	if (fd < 0 || !frame || bytes_read_at(fd, frame, size, sample->offsets[0]) < 0)
		buffer_clear(out);
	if (fd >= 0)
		close(fd);
}

/* Takes thumbnails of faces that are spread over all. */
static int take_thumbnails(struct report_data *data)
{
	struct sample_face face;
	uint32_t n = 0, taken = 0;
	int rc;

	samples_store_rewind(data->store);
	while ((rc = samples_store_next(data->store, &face)) == 1 && n < data->face_count) {
		uint64_t next = (uint64_t)taken * data->face_count / REPORT_THUMBNAILS_MAX;

		if (n >= next && taken < REPORT_THUMBNAILS_MAX) {
			take_thumbnail(&data->faces[n], &face);
			taken++;
		}
		n++;
	}
	return rc;
}

static int read_samples(struct report_data *data)
{
	const struct sample_grid *grid;
	struct sample_face face;
	int rc = samples_store_open(&data->store, data->content->folder);

	if (rc < 0)
		return rc;
	samples_store_states(data->store, data->states);
	grid = samples_store_grid(data->store);
	data->face_at = calloc(sample_grid_points(grid), sizeof(*data->face_at));
	if (!data->face_at)
		return -ENOMEM;
	while ((rc = samples_store_next(data->store, &face)) == 1) {
		rc = add_face(data, &face);
		if (rc < 0)
			return rc;
	}
	return rc < 0 ? rc : take_thumbnails(data);
}

/* ---- import and information */

static int read_imports(struct report_data *data)
{
	int count;

	data->imports = calloc(CONTENT_SCANS_MAX, sizeof(*data->imports));
	if (!data->imports)
		return -ENOMEM;
	count = scans_get_reports(sources_scans(data->options->sources), data->imports);
	data->import_count = count > 0 ? (uint32_t)count : 0;
	return 0;
}

static int read_information(struct report_data *data)
{
	const struct info_built *info;
	int rc = sources_info(data->options->sources, &info);

	if (rc < 0)
		return rc;
	for (uint32_t i = 0; i < info->file_count; i++)
		data->file_bytes += info->files[i].size;
	return 0;
}

/* ---- pictures */

static void aim(struct report_data *data)
{
	const struct publish_content_report *publish = data->options->publish;
	const struct sample_grid *grid = samples_store_grid(data->store);
	struct camera front = { .up = { 0, 0, 1 },
				.fov_deg = 45,
				.width_px = REPORT_PICTURE_WIDTH_PX,
				.height_px = REPORT_PICTURE_HEIGHT_PX },
		      above = front;
	/* From so far above that it is nearly a plan, with room for the glyphs of the outer
	 * points. */
	const float fov_deg = 12, margin = 1.15f;
	float half = 0, aspect = (float)above.width_px / (float)above.height_px;

	memcpy(front.eye_m, publish->start_eye_m, sizeof(front.eye_m));
	memcpy(front.target_m, publish->start_target_m, sizeof(front.target_m));
	/* for camera_pixel, which asks only that they are planes */
	front.near_m = above.near_m = 0.01f;
	front.far_m = above.far_m = 1e6f;
	for (int k = 0; k < 2; k++) {
		float reach = grid->spacing_m[k] * (float)grid->count[k] / 2;
		float from = fminf(grid->origin_m[k], data->master->box_min_m[k]);
		float to =
			fmaxf(grid->origin_m[k] + grid->spacing_m[k] * (float)(grid->count[k] - 1),
			      data->master->box_max_m[k]);

		reach = fmaxf(reach, (to - from) / 2);
		above.target_m[k] = above.eye_m[k] = (from + to) / 2;
		half = fmaxf(half, reach * margin / (k == 0 ? aspect : 1));
	}
	above.fov_deg = fov_deg;
	above.up[1] = 1;
	above.up[2] = 0;
	above.target_m[2] = data->master->box_min_m[2];
	above.eye_m[2] = data->master->box_max_m[2] + half / tanf(fov_deg / 2 * (float)M_PI / 180);
	data->portraits[REPORT_MODEL].camera = front;
	data->portraits[REPORT_PATCHES].camera = front;
	data->portraits[REPORT_PATCHES].patches_coloured = true;
	data->portraits[REPORT_ABOVE].camera = above;
}

static void draw(struct report_data *data)
{
	int rc;

	aim(data);
	rc = portraits_draw(data->pictures, data->portraits, REPORT_PICTURES,
			    REPORT_PICTURE_WIDTH_PX, REPORT_PICTURE_HEIGHT_PX, data->master,
			    data->content, data->options->publish->lit);
	if (rc < 0) {
		log_warn("pipeline", "the report has no pictures of the model: %s", strerror(-rc));
		for (int i = 0; i < REPORT_PICTURES; i++)
			buffer_clear(&data->pictures[i]);
	}
}

int report_data_read(struct report_data *out, const struct report_options *options)
{
	int rc;

	*out = (struct report_data){ .options = options,
				     .patch_bytes = options->publish->patch_bytes,
				     .content = sources_content(options->sources) };
	for (int i = 0; i < REPORT_PICTURES; i++)
		buffer_init(&out->pictures[i], 4 << 20);
	rc = read_imports(out);
	if (rc == 0)
		rc = read_hierarchy(out);
	if (rc == 0)
		rc = read_samples(out);
	if (rc == 0)
		rc = read_information(out);
	if (rc == 0)
		draw(out);
	else
		log_error("pipeline", "the report of the build: %s", strerror(-rc));
	return rc;
}

void report_data_finish(struct report_data *data)
{
	for (uint32_t i = 0; i < data->face_count; i++)
		buffer_finish(&data->faces[i].thumbnail);
	for (int i = 0; i < REPORT_PICTURES; i++)
		buffer_finish(&data->pictures[i]);
	free(data->face_at);
	free(data->faces);
	samples_store_close(data->store);
	master_destroy(data->master);
	free(data->imports);
}
