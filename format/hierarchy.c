/* Encodes, decodes and checks the hierarchy of patch groups. Numbers are stored as byte columns
 * under one zstd frame. */
#include "format/hierarchy.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <zstd.h>

#include "format/patch.h"
#include "format/unpack.h"

enum {
	VERSION = 1,
	ZSTD_LEVEL = 19,
	GROUP_BYTES = 1 + 5 * 4,
	PATCH_BYTES = 4 + 2 + 2 + 8 * 4,
	PATCHES_MAX = 1 << 20
};

static bool numbers_are_finite(const float *numbers, int count)
{
	for (int i = 0; i < count; i++)
		if (!isfinite(numbers[i]))
			return false;
	return true;
}

static bool group_is_sane(const struct hierarchy_group *group, uint32_t index)
{
	bool error_fits = index == 0 ? isinf(group->error_m) && group->error_m > 0.0f
				     : isfinite(group->error_m) && group->error_m >= 0.0f;

	return error_fits && group->patch_count >= 1 && group->patch_count <= GROUP_PATCHES_MAX &&
	       numbers_are_finite(group->centre_m, 3) && isfinite(group->radius_m) &&
	       group->radius_m >= 0.0f;
}

static bool patch_is_sane(const struct hierarchy_patch *patch)
{
	return patch->triangle_count >= 1 && patch->triangle_count <= PATCH_TRIANGLES_MAX &&
	       patch->vertex_count >= 1 && patch->vertex_count <= PATCH_VERTICES_MAX &&
	       numbers_are_finite(patch->centre_m, 3) && isfinite(patch->radius_m) &&
	       patch->radius_m >= 0.0f && numbers_are_finite(patch->cone_axis, 3) &&
	       patch->cone_cos >= -1.0f && patch->cone_cos <= 1.0f;
}

static bool sphere_within(const struct hierarchy_group *inner, const struct hierarchy_group *outer)
{
	double square = 0.0;

	for (int i = 0; i < 3; i++) {
		double difference = (double)inner->centre_m[i] - outer->centre_m[i];

		square += difference * difference;
	}
	return sqrt(square) + inner->radius_m <= outer->radius_m * (1.0 + 1e-5);
}

static bool group_holds(const struct hierarchy *hierarchy, uint32_t index, bool *replaces)
{
	const struct hierarchy_group *group = &hierarchy->groups[index];

	for (uint32_t p = group->first_patch; p < group->first_patch + group->patch_count; p++) {
		const struct hierarchy_patch *patch = &hierarchy->patches[p];

		if (patch->group != index || !patch_is_sane(patch))
			return false;
		if (patch->finer == HIERARCHY_NONE)
			continue;
		if (patch->finer <= index || patch->finer >= hierarchy->group_count ||
		    hierarchy->groups[patch->finer].error_m > group->error_m ||
		    !sphere_within(&hierarchy->groups[patch->finer], group))
			return false;
		replaces[patch->finer] = true;
	}
	return index == 0 || replaces[index];
}

int hierarchy_check(const struct hierarchy *hierarchy)
{
	uint32_t patch = 0;
	bool *replaces;
	int rc = 0;

	if (hierarchy->group_count < 1 || hierarchy->group_count > HIERARCHY_GROUPS_MAX ||
	    hierarchy->patch_count > PATCHES_MAX)
		return -EINVAL;
	replaces = calloc(hierarchy->group_count, sizeof(*replaces));
	if (!replaces)
		return -ENOMEM;
	for (uint32_t g = 0; rc == 0 && g < hierarchy->group_count; g++) {
		const struct hierarchy_group *group = &hierarchy->groups[g];

		if (!group_is_sane(group, g) || group->first_patch != patch ||
		    group->patch_count > hierarchy->patch_count - patch)
			rc = -EINVAL;
		patch += group->patch_count;
	}
	if (patch != hierarchy->patch_count)
		rc = -EINVAL;
	/* In order, so that all patches that group g replaces have been seen before g is
	 * checked. */
	for (uint32_t g = 0; rc == 0 && g < hierarchy->group_count; g++)
		if (!group_holds(hierarchy, g, replaces))
			rc = -EINVAL;
	free(replaces);
	return rc;
}

/* Turns rows of width bytes into columns of bytes, which compress better. */
static void transpose(uint8_t *out, const uint8_t *in, size_t rows, size_t width)
{
	for (size_t row = 0; row < rows; row++)
		for (size_t column = 0; column < width; column++)
			out[column * rows + row] = in[row * width + column];
}

void hierarchy_patch_put(struct buffer *out, const struct hierarchy_patch *patch)
{
	buffer_put_u32(out, patch->finer);
	buffer_put_u16(out, patch->triangle_count);
	buffer_put_u16(out, patch->vertex_count);
	for (int i = 0; i < 3; i++)
		buffer_put_f32(out, patch->centre_m[i]);
	buffer_put_f32(out, patch->radius_m);
	for (int i = 0; i < 3; i++)
		buffer_put_f32(out, patch->cone_axis[i]);
	buffer_put_f32(out, patch->cone_cos);
}

void hierarchy_patch_get(struct hierarchy_patch *out, struct reader *reader)
{
	out->finer = reader_u32(reader);
	out->triangle_count = reader_u16(reader);
	out->vertex_count = reader_u16(reader);
	for (int i = 0; i < 3; i++)
		out->centre_m[i] = reader_f32(reader);
	out->radius_m = reader_f32(reader);
	for (int i = 0; i < 3; i++)
		out->cone_axis[i] = reader_f32(reader);
	out->cone_cos = reader_f32(reader);
}

static void put_rows(struct buffer *out, const struct hierarchy *hierarchy)
{
	for (uint32_t g = 0; g < hierarchy->group_count; g++) {
		const struct hierarchy_group *group = &hierarchy->groups[g];

		buffer_put_u8(out, (uint8_t)group->patch_count);
		buffer_put_f32(out, group->error_m);
		for (int i = 0; i < 3; i++)
			buffer_put_f32(out, group->centre_m[i]);
		buffer_put_f32(out, group->radius_m);
	}
	for (uint32_t p = 0; p < hierarchy->patch_count; p++)
		hierarchy_patch_put(out, &hierarchy->patches[p]);
}

static int put_packed(struct buffer *out, struct bytes columns)
{
	size_t bound = ZSTD_compressBound(columns.size);
	uint8_t *packed = malloc(bound);
	size_t size;

	if (!packed)
		return -ENOMEM;
	size = ZSTD_compress(packed, bound, columns.data, columns.size, ZSTD_LEVEL);
	if (!ZSTD_isError(size))
		buffer_put(out, packed, size);
	free(packed);
	return ZSTD_isError(size) ? -ENOMEM : out->error;
}

int hierarchy_encode(struct buffer *out, const struct hierarchy *hierarchy)
{
	size_t group_bytes = hierarchy->group_count * (size_t)GROUP_BYTES;
	struct buffer rows;
	uint8_t *columns;
	int rc = hierarchy_check(hierarchy);

	if (rc < 0)
		return rc;
	buffer_init(&rows, SIZE_MAX);
	put_rows(&rows, hierarchy);
	columns = malloc(rows.size + 1);
	rc = columns ? rows.error : -ENOMEM;
	if (rc == 0) {
		transpose(columns, rows.data, hierarchy->group_count, GROUP_BYTES);
		transpose(columns + group_bytes, rows.data + group_bytes, hierarchy->patch_count,
			  PATCH_BYTES);
		buffer_put_u8(out, VERSION);
		buffer_put_u32(out, hierarchy->group_count);
		buffer_put_u32(out, hierarchy->patch_count);
		rc = put_packed(out, (struct bytes){ columns, rows.size });
	}
	free(columns);
	buffer_finish(&rows);
	return rc;
}

static void get_rows(struct hierarchy *out, struct bytes rows)
{
	struct reader reader;
	uint32_t first = 0;

	reader_init(&reader, rows);
	for (uint32_t g = 0; g < out->group_count; g++) {
		struct hierarchy_group *group = &out->groups[g];

		group->first_patch = first;
		group->patch_count = reader_u8(&reader);
		group->error_m = reader_f32(&reader);
		for (int i = 0; i < 3; i++)
			group->centre_m[i] = reader_f32(&reader);
		group->radius_m = reader_f32(&reader);
		for (uint32_t p = first; p < first + group->patch_count && p < out->patch_count;
		     p++)
			out->patches[p].group = g;
		first += group->patch_count;
	}
	for (uint32_t p = 0; p < out->patch_count; p++)
		hierarchy_patch_get(&out->patches[p], &reader);
}

/* Turns columns of bytes back into rows. The caller owns both and sizes them by the counts of
 * hierarchy. */
static int unpack_rows(uint8_t *rows, uint8_t *columns, const struct hierarchy *hierarchy,
		       struct bytes packed)
{
	size_t group_bytes = hierarchy->group_count * (size_t)GROUP_BYTES;
	size_t patch_bytes = hierarchy->patch_count * (size_t)PATCH_BYTES;
	int rc = unpack_zstd(columns, group_bytes + patch_bytes, packed);

	if (rc < 0)
		return rc;
	transpose(rows, columns, GROUP_BYTES, hierarchy->group_count);
	transpose(rows + group_bytes, columns + group_bytes, PATCH_BYTES, hierarchy->patch_count);
	return 0;
}

static int decode_packed(struct hierarchy *out, struct bytes packed)
{
	size_t size =
		out->group_count * (size_t)GROUP_BYTES + out->patch_count * (size_t)PATCH_BYTES;
	uint8_t *rows, *columns;
	int rc;

	if (!unpack_zstd_fits(size, packed))
		return -EBADMSG;
	rows = malloc(size);
	columns = malloc(size);
	out->groups = calloc(out->group_count, sizeof(*out->groups));
	out->patches = calloc(out->patch_count, sizeof(*out->patches));
	rc = rows && columns && out->groups && out->patches ? 0 : -ENOMEM;
	if (rc == 0)
		rc = unpack_rows(rows, columns, out, packed);
	if (rc == 0)
		get_rows(out, (struct bytes){ rows, size });
	free(rows);
	free(columns);
	if (rc == 0)
		rc = hierarchy_check(out);
	return rc == -EINVAL ? -EBADMSG : rc;
}

int hierarchy_decode(struct hierarchy *out, struct bytes payload)
{
	struct reader reader;
	uint8_t version;
	int rc = -EBADMSG;

	*out = (struct hierarchy){ 0 };
	reader_init(&reader, payload);
	version = reader_u8(&reader);
	out->group_count = reader_u32(&reader);
	out->patch_count = reader_u32(&reader);
	/* A group holds at least one patch, and zstd compresses at most some thousand to one. These
	 * checks limit how much memory a few bytes can make us allocate. */
	if (!reader.failed && version == VERSION && out->group_count >= 1 &&
	    out->group_count <= HIERARCHY_GROUPS_MAX && out->patch_count <= PATCHES_MAX &&
	    out->patch_count >= out->group_count)
		rc = decode_packed(out, reader_bytes(&reader, reader_left(&reader)));
	if (rc < 0)
		hierarchy_finish(out);
	return rc;
}

void hierarchy_finish(struct hierarchy *hierarchy)
{
	if (!hierarchy)
		return;
	free(hierarchy->groups);
	free(hierarchy->patches);
	*hierarchy = (struct hierarchy){ 0 };
}
