/* Encodes, decodes and checks the labels of a patch group, and answers which part lies at a point
 * of a triangle. */
#include "format/label.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <zstd.h>

#include "format/unpack.h"

enum {
	VERSION = 1,
	PAGE_VERSION = 1,
	ZSTD_LEVEL = 19,
	HEADER_BYTES = 10,
	RAW_BYTES_MAX = 16 << 20,
	OBJECT_MAX = 16 << 20,
};

static const char magic[4] = { 'G', 'P', 'l', 'b' };

/* ---- a divided triangle */

uint32_t label_values(int level)
{
	uint32_t n = 1u << level;

	return (n + 1) * (n + 2) / 2;
}

uint32_t label_value_at(int level, int i, int j)
{
	int n = 1 << level;

	return (uint32_t)(i * (n + 1) - i * (i - 1) / 2 + j);
}

/* ---- rules that encoder and decoder check */

static bool is_id(const char *id)
{
	size_t size = strnlen(id, LABEL_ID_BYTES);

	return size > 0 && size < LABEL_ID_BYTES &&
	       strspn(id, "abcdefghijklmnopqrstuvwxyz0123456789-_") == size;
}

static bool parts_are_sane(const struct label_group *group)
{
	if (group->part_count < 1 || group->part_count > LABEL_PARTS_MAX)
		return false;
	for (uint32_t p = 0; p < group->part_count; p++)
		if (!is_id(group->parts[p].id) || !isfinite(group->parts[p].area_m2) ||
		    group->parts[p].area_m2 < 0)
			return false;
	return true;
}

static bool sets_are_sane(const struct label_group *group)
{
	uint32_t next = 0;

	if (group->set_count < 1 || group->set_count > LABEL_SETS_MAX || group->sets[0].count > 0)
		return false;
	for (uint32_t s = 0; s < group->set_count; s++) {
		const struct label_set *set = &group->sets[s];

		if (set->first != next || set->count > group->member_count - next ||
		    (s > 0 && set->count == 0))
			return false;
		for (uint32_t m = next; m < next + set->count; m++)
			if (group->members[m] >= group->part_count ||
			    (m > next && group->members[m] <= group->members[m - 1]))
				return false;
		next += set->count;
	}
	return next == group->member_count;
}

static bool values_are_sane(const int8_t *values, uint32_t count)
{
	bool within = false, without = false;

	for (uint32_t i = 0; i < count; i++) {
		if (values[i] % 2 == 0 || abs(values[i]) > LABEL_VALUE_MAX)
			return false;
		within = within || values[i] > 0;
		without = without || values[i] < 0;
	}
	return within && without;
}

static bool set_has(const struct label_group *group, uint32_t set, uint32_t part)
{
	const struct label_set *s = &group->sets[set];

	for (uint32_t m = s->first; m < s->first + s->count; m++)
		if (group->members[m] == part)
			return true;
	return false;
}

static bool borders_are_sane(const struct label_group *group, const struct label_patch *patch,
			     uint32_t *next)
{
	for (uint32_t b = 0; b < patch->border_count; b++) {
		const struct label_border *border = &patch->borders[b], *before = border - 1;

		if (border->triangle >= patch->triangle_count ||
		    border->part >= group->part_count || border->level < LABEL_LEVEL_MIN ||
		    border->level > LABEL_LEVEL_MAX || border->first != *next ||
		    label_values(border->level) > group->value_count - *next ||
		    set_has(group, patch->sets[border->triangle], border->part))
			return false;
		if (b > 0 &&
		    (border->triangle < before->triangle ||
		     (border->triangle == before->triangle && border->part <= before->part)))
			return false;
		if (!values_are_sane(&group->values[*next], label_values(border->level)))
			return false;
		*next += label_values(border->level);
	}
	return true;
}

static bool patches_are_sane(const struct label_group *group)
{
	uint32_t values = 0;

	if (group->patch_count < 1 || group->patch_count > GROUP_PATCHES_MAX)
		return false;
	for (uint32_t p = 0; p < group->patch_count; p++) {
		const struct label_patch *patch = &group->patches[p];

		if (patch->triangle_count > PATCH_TRIANGLES_MAX)
			return false;
		for (uint32_t t = 0; t < patch->triangle_count; t++)
			if (patch->sets[t] >= group->set_count)
				return false;
		if (!borders_are_sane(group, patch, &values))
			return false;
	}
	return values == group->value_count;
}

static bool is_sane(const struct label_group *group)
{
	return parts_are_sane(group) && sets_are_sane(group) && patches_are_sane(group);
}

/* ---- bytes */

static void put_parts(struct buffer *raw, const struct label_group *group)
{
	buffer_put_u16(raw, (uint16_t)group->part_count);
	for (uint32_t p = 0; p < group->part_count; p++) {
		buffer_put_string(raw, group->parts[p].id);
		buffer_put_f32(raw, group->parts[p].area_m2);
	}
	buffer_put_u16(raw, (uint16_t)group->set_count);
	for (uint32_t s = 1; s < group->set_count; s++) {
		buffer_put_u16(raw, (uint16_t)group->sets[s].count);
		for (uint32_t m = 0; m < group->sets[s].count; m++)
			buffer_put_u16(raw, group->members[group->sets[s].first + m]);
	}
}

/* Numbers of one kind are stored together, low bytes before high ones: they compress better that
 * way. */
static void put_patches(struct buffer *raw, const struct label_group *group)
{
	for (uint32_t p = 0; p < group->patch_count; p++) {
		buffer_put_u16(raw, (uint16_t)group->patches[p].triangle_count);
		buffer_put_u32(raw, group->patches[p].border_count);
	}
	for (int shift = 0; shift < 16; shift += 8)
		for (uint32_t p = 0; p < group->patch_count; p++)
			for (uint32_t t = 0; t < group->patches[p].triangle_count; t++)
				buffer_put_u8(raw, (uint8_t)(group->patches[p].sets[t] >> shift));
	for (uint32_t p = 0; p < group->patch_count; p++) {
		uint16_t before = 0;

		for (uint32_t b = 0; b < group->patches[p].border_count; b++) {
			const struct label_border *border = &group->patches[p].borders[b];

			buffer_put_u16(raw, (uint16_t)(border->triangle - before));
			buffer_put_u16(raw, border->part);
			buffer_put_u8(raw, border->level);
			before = border->triangle;
		}
	}
	buffer_put(raw, group->values, group->value_count);
}

int label_group_encode(struct buffer *out, const struct label_group *group)
{
	struct buffer raw;
	uint8_t *packed = NULL;
	size_t size = 0;
	int rc;

	if (!is_sane(group))
		return -EINVAL;
	buffer_init(&raw, RAW_BYTES_MAX);
	put_parts(&raw, group);
	put_patches(&raw, group);
	rc = raw.error;
	if (rc == 0) {
		packed = malloc(ZSTD_compressBound(raw.size));
		if (packed)
			size = ZSTD_compress(packed, ZSTD_compressBound(raw.size), raw.data,
					     raw.size, ZSTD_LEVEL);
		rc = packed && !ZSTD_isError(size) ? 0 : -ENOMEM;
	}
	if (rc == 0) {
		buffer_put(out, magic, sizeof(magic));
		buffer_put_u8(out, VERSION);
		buffer_put_u8(out, (uint8_t)group->patch_count);
		buffer_put_u32(out, (uint32_t)raw.size);
		buffer_put(out, packed, size);
		rc = out->error;
	}
	free(packed);
	buffer_finish(&raw);
	return rc;
}

static void *take(size_t count, size_t bytes)
{
	return calloc(count + 1, bytes);
}

static int read_parts(struct label_group *out, struct reader *reader)
{
	uint32_t most = (uint32_t)reader_left(reader) / 2;
	void *shrunk;

	out->part_count = reader_u16(reader);
	if (out->part_count > LABEL_PARTS_MAX)
		return -EBADMSG;
	out->parts = take(out->part_count, sizeof(*out->parts));
	if (!out->parts)
		return -ENOMEM;
	for (uint32_t p = 0; p < out->part_count; p++) {
		reader_string(reader, out->parts[p].id, sizeof(out->parts[p].id));
		out->parts[p].area_m2 = reader_f32(reader);
	}
	out->set_count = reader_u16(reader);
	if (reader->failed || out->set_count > LABEL_SETS_MAX)
		return -EBADMSG;
	out->sets = take(out->set_count, sizeof(*out->sets));
	out->members = take(most, sizeof(*out->members));
	if (!out->sets || !out->members)
		return -ENOMEM;
	for (uint32_t s = 1; s < out->set_count; s++) {
		struct label_set *set = &out->sets[s];

		*set = (struct label_set){ out->member_count, reader_u16(reader) };
		if (set->count > reader_left(reader) / 2)
			return -EBADMSG;
		for (uint32_t m = 0; m < set->count; m++)
			out->members[out->member_count++] = reader_u16(reader);
	}
	shrunk = realloc(out->members, (out->member_count + 1) * sizeof(*out->members));
	out->members = shrunk ? shrunk : out->members;
	return reader->failed ? -EBADMSG : 0;
}

static int read_sets(struct label_group *out, struct reader *reader)
{
	for (uint32_t p = 0; p < out->patch_count; p++) {
		struct label_patch *patch = &out->patches[p];

		patch->triangle_count = reader_u16(reader);
		patch->border_count = reader_u32(reader);
		/* Refuse counts that the remaining bytes cannot hold, before allocating for
		 * them. */
		if (reader->failed || patch->triangle_count > PATCH_TRIANGLES_MAX ||
		    patch->border_count > reader_left(reader) / 5)
			return -EBADMSG;
		patch->sets = take(patch->triangle_count, sizeof(*patch->sets));
		patch->borders = take(patch->border_count, sizeof(*patch->borders));
		if (!patch->sets || !patch->borders)
			return -ENOMEM;
	}
	for (int shift = 0; shift < 16; shift += 8)
		for (uint32_t p = 0; p < out->patch_count; p++)
			for (uint32_t t = 0; t < out->patches[p].triangle_count; t++)
				out->patches[p].sets[t] |= (uint16_t)(reader_u8(reader) << shift);
	return reader->failed ? -EBADMSG : 0;
}

static int read_borders(struct label_group *out, struct reader *reader)
{
	struct bytes values;

	for (uint32_t p = 0; p < out->patch_count; p++) {
		uint32_t triangle = 0;

		for (uint32_t b = 0; b < out->patches[p].border_count; b++) {
			struct label_border *border = &out->patches[p].borders[b];

			triangle += reader_u16(reader);
			border->triangle = (uint16_t)triangle;
			border->part = reader_u16(reader);
			border->level = reader_u8(reader);
			if (reader->failed || triangle >= out->patches[p].triangle_count ||
			    border->level > LABEL_LEVEL_MAX)
				return -EBADMSG;
			border->first = out->value_count;
			out->value_count += label_values(border->level);
		}
	}
	if (out->value_count != reader_left(reader))
		return -EBADMSG;
	out->values = take(out->value_count, 1);
	if (!out->values)
		return -ENOMEM;
	values = reader_bytes(reader, out->value_count);
	if (values.size > 0)
		memcpy(out->values, values.data, values.size);
	return 0;
}

static int read_raw(struct label_group *out, struct bytes raw)
{
	struct reader reader;
	int rc;

	reader_init(&reader, raw);
	rc = read_parts(out, &reader);
	if (rc == 0)
		rc = read_sets(out, &reader);
	if (rc == 0)
		rc = read_borders(out, &reader);
	if (rc == 0 && !is_sane(out))
		rc = -EBADMSG;
	return rc;
}

int label_group_decode(struct label_group *out, struct bytes object)
{
	struct reader reader;
	struct bytes head, packed;
	uint32_t raw_size;
	uint8_t version, *raw;
	int rc;

	*out = (struct label_group){ 0 };
	reader_init(&reader, object);
	head = reader_bytes(&reader, sizeof(magic));
	version = reader_u8(&reader);
	out->patch_count = reader_u8(&reader);
	raw_size = reader_u32(&reader);
	packed = reader_bytes(&reader, reader_left(&reader));
	if (reader.failed || memcmp(head.data, magic, sizeof(magic)) != 0 || version != VERSION ||
	    out->patch_count > GROUP_PATCHES_MAX || raw_size > RAW_BYTES_MAX ||
	    !unpack_zstd_fits(raw_size, packed)) {
		out->patch_count = 0;
		return -EBADMSG;
	}
	raw = malloc((size_t)raw_size + 1);
	out->patches = take(out->patch_count, sizeof(*out->patches));
	rc = raw && out->patches ? 0 : -ENOMEM;
	if (rc == 0)
		rc = unpack_zstd(raw, raw_size, packed);
	if (rc == 0)
		rc = read_raw(out, (struct bytes){ raw, raw_size });
	free(raw);
	if (rc < 0)
		label_group_finish(out);
	return rc;
}

void label_group_finish(struct label_group *group)
{
	if (!group)
		return;
	for (uint32_t p = 0; group->patches && p < group->patch_count; p++) {
		free(group->patches[p].sets);
		free(group->patches[p].borders);
	}
	free(group->patches);
	free(group->parts);
	free(group->sets);
	free(group->members);
	free(group->values);
	*group = (struct label_group){ 0 };
}

size_t label_group_bytes(const struct label_group *group)
{
	size_t bytes = group->part_count * sizeof(*group->parts) +
		       group->set_count * sizeof(*group->sets) +
		       group->member_count * sizeof(*group->members) + group->value_count;

	for (uint32_t p = 0; p < group->patch_count; p++)
		bytes += group->patches[p].triangle_count * sizeof(uint16_t) +
			 group->patches[p].border_count * sizeof(struct label_border);
	return bytes;
}

/* ---- queries */

int label_find(const struct label_group *group, const char *id)
{
	for (uint32_t p = 0; p < group->part_count; p++)
		if (strcmp(group->parts[p].id, id) == 0)
			return (int)p;
	return -1;
}

bool label_holds(const struct label_group *group, uint32_t patch, uint32_t triangle, uint32_t part)
{
	return set_has(group, group->patches[patch].sets[triangle], part);
}

uint32_t label_borders(const struct label_patch *patch, uint32_t triangle, uint32_t *first)
{
	uint32_t low = 0, high = patch->border_count, end;

	while (low < high) {
		uint32_t middle = (low + high) / 2;

		if (patch->borders[middle].triangle < triangle)
			low = middle + 1;
		else
			high = middle;
	}
	for (end = low; end < patch->border_count && patch->borders[end].triangle == triangle;)
		end++;
	*first = low;
	return end - low;
}

/* Interpolates linearly between the corners of the small triangle that contains (u, v). */
static float value_between(const int8_t *values, int level, float u, float v)
{
	int n = 1 << level;
	float x = u * (float)n, y = v * (float)n;
	int i = (int)x, j = (int)y;
	float a, b, c;

	i = i < 0 ? 0 : i > n - 1 ? n - 1 : i;
	j = j < 0 ? 0 : j > n - 1 - i ? n - 1 - i : j;
	x -= (float)i;
	y -= (float)j;
	b = values[label_value_at(level, i + 1, j)];
	c = values[label_value_at(level, i, j + 1)];
	if (x + y <= 1 || i + j + 2 > n) {
		a = values[label_value_at(level, i, j)];
		return a + x * (b - a) + y * (c - a);
	}
	a = values[label_value_at(level, i + 1, j + 1)];
	return a + (1 - x) * (c - a) + (1 - y) * (b - a);
}

int label_part_at(const struct label_group *group, uint32_t patch, uint32_t triangle, float u,
		  float v)
{
	const struct label_patch *p = &group->patches[patch];
	const struct label_set *set;
	uint32_t first, count;
	int best = -1;

	if (triangle >= p->triangle_count)
		return -1;
	set = &group->sets[p->sets[triangle]];
	for (uint32_t m = set->first; m < set->first + set->count; m++)
		if (best < 0 ||
		    group->parts[group->members[m]].area_m2 < group->parts[best].area_m2)
			best = group->members[m];
	count = label_borders(p, triangle, &first);
	for (uint32_t b = first; b < first + count; b++) {
		const struct label_border *border = &p->borders[b];

		if (value_between(&group->values[border->first], border->level, u, v) > 0 &&
		    (best < 0 || group->parts[border->part].area_m2 < group->parts[best].area_m2))
			best = border->part;
	}
	return best;
}

/* ---- the page */

void label_page_encode(struct buffer *out, const uint32_t *child_of_group, uint32_t group_count)
{
	buffer_put_u8(out, PAGE_VERSION);
	buffer_put_u32(out, group_count);
	for (uint32_t g = 0; g < group_count; g += 8) {
		uint8_t bits = 0;

		for (uint32_t k = g; k < group_count && k < g + 8; k++)
			if (child_of_group[k] != LABEL_NONE)
				bits |= (uint8_t)(1u << (k - g));
		buffer_put_u8(out, bits);
	}
}

int label_page_decode(uint32_t **child_of_group, uint32_t group_count, uint32_t child_count,
		      struct bytes payload)
{
	struct reader reader;
	uint32_t next = 0, *children;
	uint8_t version, bits = 0;

	*child_of_group = NULL;
	reader_init(&reader, payload);
	version = reader_u8(&reader);
	if (version != PAGE_VERSION || reader_u32(&reader) != group_count ||
	    reader_left(&reader) != ((size_t)group_count + 7) / 8)
		return -EBADMSG;
	children = calloc((size_t)group_count + 1, sizeof(*children));
	if (!children)
		return -ENOMEM;
	for (uint32_t g = 0; g < group_count; g++) {
		bits = g % 8 ? bits >> 1 : reader_u8(&reader);
		children[g] = bits & 1 ? next++ : LABEL_NONE;
	}
	/* The unused bits of the last byte must be zero. */
	if (next != child_count || (group_count % 8 > 0 && bits >> 1)) {
		free(children);
		return -EBADMSG;
	}
	*child_of_group = children;
	return 0;
}
