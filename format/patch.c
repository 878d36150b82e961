/* Encodes and decodes the geometry of a patch group: connectivity, then the vertices as differences
 * from predictions. docs/patch.md describes the bytes. */
#include "format/patch.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "format/connectivity.h"
#include "format/precision.h"
#include "format/root_page.h"

enum {
	VERSION = 3,
	FLAG_BASE = 1, /* a base follows the precision */
	NARROW_BITS = 16,
	WIDE_BITS = 24
};

static const uint8_t magic[4] = { 'G', 'P', 'p', 'g' };

/* The places of a group: positions count from base and have so many bits. */
struct range {
	int32_t base[3];
	int bits;
};

static const struct range narrow = { .bits = NARROW_BITS };

/* One group while it is coded, in either direction. */
struct group {
	struct symbol_encoder encoder;
	struct symbol_coder coder;
	struct vertex_precision precision;
	struct range range;
	struct connectivity mesh;
	struct patch_vertex *vertices; /* owned; mesh.vertex_count of them */
	struct symbol_model positions[PREDICT_POSITION_MODELS], normals[2];
	struct symbol_model greens[PREDICT_COLOUR_MODELS], tints[2], opens[PREDICT_OPEN_MODELS];
};

uint8_t patch_round_colour(uint8_t value, int bits)
{
	return precision_round_colour(value, bits);
}

int8_t patch_round_normal(int8_t value, int bits)
{
	return precision_round_normal(value, bits);
}

/* ---- vertices, in both directions: what is encoded is in group->vertices already */

/* The largest shortened position on each axis, so that no place lies beyond the lattice. */
static void positions_most(int32_t most[3], const struct group *group)
{
	for (int i = 0; i < 3; i++) {
		int32_t in_range = (1 << group->range.bits) - 1;
		int32_t in_lattice = LATTICE_PLACES_MAX - 1 - group->range.base[i];

		most[i] = (in_range < in_lattice ? in_range : in_lattice) >>
			  group->precision.position_zeros;
	}
}

/* The functions that end in _of are compiled once for each direction. */

static force_inline int code_positions_of(struct group *group, struct symbol_encoder *encoder)
{
	struct symbol_coder coder = { encoder, group->coder.decoder };
	/* differences have a bit more */
	uint32_t bits = (uint32_t)(group->range.bits + 1 - group->precision.position_zeros);
	int32_t most[3];

	positions_most(most, group);
	for (uint32_t v = 0; v < group->mesh.vertex_count; v++) {
		int32_t *position = group->vertices[v].position;
		uint32_t models[3];
		int32_t guess[3], at;

		predict_position(guess, models, &group->mesh.steps[v], group->vertices, most);
		for (int i = 0; i < 3; i++) {
			at = guess[i] + symbol_unfold(symbol_code_number(
						&coder, &group->positions[models[i]],
						symbol_fold(position[i] - guess[i]), bits));
			if (at < 0 || at > most[i])
				return -EBADMSG;
			position[i] = at;
		}
	}
	group->coder.decoder = coder.decoder;
	return 0;
}

static force_inline void code_normals_of(struct group *group, struct symbol_encoder *encoder,
					 const int64_t (*sums)[3])
{
	struct symbol_coder coder = { encoder, group->coder.decoder };
	int bits = group->precision.normal_bits;

	for (uint32_t v = 0; v < group->mesh.vertex_count; v++) {
		int8_t *normal = group->vertices[v].normal, guess[2];

		predict_octahedral(guess, sums[v]);
		for (int i = 0; i < 2; i++) {
			int32_t value = precision_shorten_normal(guess[i], bits);

			value += symbol_code_difference(&coder, &group->normals[i],
							normal[i] - value, bits);
			/* The sign is the highest of the bits. */
			normal[i] = (int8_t)((int8_t)(uint8_t)((uint32_t)value << (8 - bits)) >>
					     (8 - bits));
		}
	}
	group->coder.decoder = coder.decoder;
}

/* Red and blue change with green. */
static force_inline void code_colours_of(struct group *group, struct symbol_encoder *encoder)
{
	struct symbol_coder coder = { encoder, group->coder.decoder };
	int bits = group->precision.colour_bits, open_bits = group->precision.open_bits;
	int32_t mask = (1 << bits) - 1, open_mask = (1 << open_bits) - 1;
	uint8_t grey = (uint8_t)(mask / 2);
	const uint8_t unknown[4] = { grey, grey, grey, (uint8_t)open_mask };

	for (uint32_t v = 0; v < group->mesh.vertex_count; v++) {
		uint8_t *colour = group->vertices[v].colour, guess[4];
		uint32_t colour_model, open_model;
		int32_t green, red, blue, open;

		predict_colour(guess, &colour_model, &open_model, &group->mesh.steps[v],
			       group->vertices, unknown);
		green = symbol_code_difference(&coder, &group->greens[colour_model],
					       colour[1] - guess[1], bits);
		red = green + symbol_code_difference(&coder, &group->tints[0],
						     colour[0] - guess[0] - green, bits);
		blue = green + symbol_code_difference(&coder, &group->tints[1],
						      colour[2] - guess[2] - green, bits);
		open = symbol_code_difference(&coder, &group->opens[open_model],
					      colour[3] - guess[3], open_bits);
		colour[0] = (uint8_t)((guess[0] + red) & mask);
		colour[1] = (uint8_t)((guess[1] + green) & mask);
		colour[2] = (uint8_t)((guess[2] + blue) & mask);
		colour[3] = (uint8_t)((guess[3] + open) & open_mask);
	}
	group->coder.decoder = coder.decoder;
}

static int code_positions(struct group *group)
{
	return group->coder.encoder ? code_positions_of(group, group->coder.encoder)
				    : code_positions_of(group, NULL);
}

static int code_normals(struct group *group)
{
	const struct connectivity *mesh = &group->mesh;
	int64_t(*sums)[3] = calloc(mesh->vertex_count, sizeof(*sums));
	const uint32_t *members = mesh->members;
	const uint16_t *indices = mesh->indices;

	if (!sums)
		return -ENOMEM;
	for (uint32_t p = 0; p < mesh->patch_count; p++) {
		predict_add_normals(sums, group->vertices, members, indices,
				    mesh->patch_triangles[p]);
		members += mesh->patch_vertices[p];
		indices += 3 * (size_t)mesh->patch_triangles[p];
	}
	if (group->coder.encoder)
		code_normals_of(group, group->coder.encoder, (const int64_t(*)[3])sums);
	else
		code_normals_of(group, NULL, (const int64_t(*)[3])sums);
	free(sums);
	return 0;
}

static void code_colours(struct group *group)
{
	if (group->coder.encoder)
		code_colours_of(group, group->coder.encoder);
	else
		code_colours_of(group, NULL);
}

static int code_vertices(struct group *group)
{
	int rc = code_positions(group);

	if (rc == 0)
		rc = code_normals(group);
	if (rc == 0)
		code_colours(group);
	return rc;
}

static void group_destroy(struct group *group)
{
	if (!group)
		return;
	symbol_encoder_finish(&group->encoder);
	connectivity_finish(&group->mesh);
	free(group->vertices);
	free(group);
}

/* ---- encoding */

static bool counts_fit(uint32_t vertex_count, uint32_t triangle_count)
{
	return vertex_count >= 1 && vertex_count <= PATCH_VERTICES_MAX && triangle_count >= 1 &&
	       triangle_count <= PATCH_TRIANGLES_MAX;
}

static bool indices_fit(const struct patch_mesh *mesh)
{
	for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++)
		if (mesh->indices[i] >= mesh->vertex_count)
			return false;
	return true;
}

/* A group near the lattice's origin needs no base, and so no group of a small site. Returns -EINVAL
 * if a place is none of a lattice. */
static int find_range(struct range *out, const struct patch_source *source)
{
	int32_t low[3] = { INT32_MAX, INT32_MAX, INT32_MAX }, high[3] = { 0 };

	for (uint32_t v = 0; v < source->vertex_count; v++)
		for (int i = 0; i < 3; i++) {
			int32_t at = source->vertices[v].position[i];

			if (at < 0 || at >= LATTICE_PLACES_MAX)
				return -EINVAL;
			low[i] = at < low[i] ? at : low[i];
			high[i] = at > high[i] ? at : high[i];
		}
	*out = narrow;
	if (high[0] <= UINT16_MAX && high[1] <= UINT16_MAX && high[2] <= UINT16_MAX)
		return 0;
	memcpy(out->base, low, sizeof(low));
	for (int i = 0; i < 3; i++)
		if (high[i] - low[i] > UINT16_MAX)
			out->bits = WIDE_BITS;
	return 0;
}

static bool has_base(const struct range *range)
{
	return range->base[0] != 0 || range->base[1] != 0 || range->base[2] != 0 ||
	       range->bits != NARROW_BITS;
}

static void put_header(struct buffer *out, const struct group *group)
{
	buffer_put(out, magic, sizeof(magic));
	buffer_put_u8(out, VERSION);
	buffer_put_u8(out, has_base(&group->range) ? FLAG_BASE : 0);
	buffer_put_u8(out, (uint8_t)group->mesh.patch_count);
	precision_put(out, &group->precision);
	if (has_base(&group->range)) {
		buffer_put_u8(out, (uint8_t)(group->range.bits / 8));
		for (int i = 0; i < 3; i++)
			buffer_put_u32(out, (uint32_t)group->range.base[i]);
	}
	for (uint32_t p = 0; p < group->mesh.patch_count; p++) {
		buffer_put_u16(out, (uint16_t)group->mesh.patch_vertices[p]);
		buffer_put_u16(out, (uint16_t)group->mesh.patch_triangles[p]);
	}
}

/* Puts the vertices in the order in which they are coded, shortened. */
static int take_vertices(struct group *group, const struct patch_source *source)
{
	group->vertices = malloc(group->mesh.vertex_count * sizeof(*group->vertices));
	if (!group->vertices)
		return -ENOMEM;
	for (uint32_t v = 0; v < group->mesh.vertex_count; v++)
		group->vertices[v] = precision_shorten(&group->precision, group->range.base,
						       &source->vertices[group->mesh.sources[v]]);
	return 0;
}

static int encode_source(struct buffer *out, struct group *group, struct patch_source *source)
{
	int rc = find_range(&group->range, source);

	if (rc < 0)
		return rc;
	group->precision = precision_of(source->vertices, source->vertex_count);
	rc = connectivity_code(&group->mesh, &group->coder, source);
	if (rc == 0)
		rc = take_vertices(group, source);
	if (rc == 0)
		rc = code_vertices(group);
	if (rc < 0)
		return rc;
	put_header(out, group);
	return symbol_encoder_put(&group->encoder, out);
}

int patch_group_encode(struct buffer *out, const struct patch_mesh *patches, uint32_t patch_count)
{
	struct patch_source source = { 0 };
	struct group *group;
	int rc;

	if (patch_count < 1 || patch_count > GROUP_PATCHES_MAX)
		return -EINVAL;
	for (uint32_t p = 0; p < patch_count; p++)
		if (!counts_fit(patches[p].vertex_count, patches[p].triangle_count) ||
		    !indices_fit(&patches[p]))
			return -EINVAL;
	group = calloc(1, sizeof(*group));
	if (!group)
		return -ENOMEM;
	symbol_encoder_init(&group->encoder);
	group->coder.encoder = &group->encoder;
	group->mesh.patch_count = patch_count;
	for (uint32_t p = 0; p < patch_count; p++) {
		group->mesh.patch_vertices[p] = patches[p].vertex_count;
		group->mesh.patch_triangles[p] = patches[p].triangle_count;
	}
	rc = patch_source_init(&source, patches, patch_count);
	if (rc == 0)
		rc = encode_source(out, group, &source);
	patch_source_finish(&source);
	group_destroy(group);
	return rc;
}

/* ---- decoding */

static bool get_range(struct reader *reader, struct range *out)
{
	uint8_t bytes = reader_u8(reader);
	bool good = bytes == NARROW_BITS / 8 || bytes == WIDE_BITS / 8;

	out->bits = 8 * bytes;
	for (int i = 0; i < 3; i++) {
		uint32_t base = reader_u32(reader);

		good = good && base < LATTICE_PLACES_MAX;
		out->base[i] = (int32_t)(base % LATTICE_PLACES_MAX);
	}
	return good;
}

static int get_header(struct reader *reader, struct group *group)
{
	struct connectivity *mesh = &group->mesh;
	struct bytes start = reader_bytes(reader, sizeof(magic));
	uint8_t flags;

	if (reader->failed || memcmp(start.data, magic, sizeof(magic)) != 0 ||
	    reader_u8(reader) != VERSION)
		return -EBADMSG;
	flags = reader_u8(reader);
	if (flags & ~FLAG_BASE)
		return -EBADMSG;
	mesh->patch_count = reader_u8(reader);
	if (mesh->patch_count < 1 || mesh->patch_count > GROUP_PATCHES_MAX ||
	    !precision_get(reader, &group->precision))
		return -EBADMSG;
	group->range = narrow;
	if (flags & FLAG_BASE && !get_range(reader, &group->range))
		return -EBADMSG;
	for (uint32_t p = 0; p < mesh->patch_count; p++) {
		mesh->patch_vertices[p] = reader_u16(reader);
		mesh->patch_triangles[p] = reader_u16(reader);
		if (!counts_fit(mesh->patch_vertices[p], mesh->patch_triangles[p]))
			return -EBADMSG;
	}
	return reader->failed ? -EBADMSG : 0;
}

static int decode_group(struct group *group, struct reader *reader)
{
	int rc = symbol_decoder_init(&group->coder.decoder, reader);

	if (rc == 0 && reader_left(reader) != 0)
		rc = -EBADMSG;
	if (rc == 0)
		rc = connectivity_code(&group->mesh, &group->coder, NULL);
	if (rc < 0)
		return rc;
	group->vertices = calloc(group->mesh.vertex_count, sizeof(*group->vertices));
	if (!group->vertices)
		return -ENOMEM;
	rc = code_vertices(group);
	return rc == 0 && !symbol_decoder_complete(&group->coder.decoder) ? -EBADMSG : rc;
}

/* Fills the patches of a decoded group. */
static int give_patches(struct patch_mesh *patches, const struct group *group)
{
	const uint32_t *members = group->mesh.members;
	const uint16_t *indices = group->mesh.indices;

	for (uint32_t v = 0; v < group->mesh.vertex_count; v++)
		precision_lengthen(&group->precision, group->range.base, &group->vertices[v]);
	for (uint32_t p = 0; p < group->mesh.patch_count; p++) {
		struct patch_mesh *mesh = &patches[p];
		size_t index_count = 3 * (size_t)group->mesh.patch_triangles[p];

		mesh->vertex_count = group->mesh.patch_vertices[p];
		mesh->triangle_count = group->mesh.patch_triangles[p];
		mesh->vertices = malloc(mesh->vertex_count * sizeof(*mesh->vertices));
		mesh->indices = malloc(index_count * sizeof(*mesh->indices));
		if (!mesh->vertices || !mesh->indices)
			return -ENOMEM;
		for (uint32_t v = 0; v < mesh->vertex_count; v++)
			mesh->vertices[v] = group->vertices[members[v]];
		memcpy(mesh->indices, indices, index_count * sizeof(*mesh->indices));
		members += mesh->vertex_count;
		indices += index_count;
	}
	return 0;
}

int patch_group_decode(struct patch_mesh patches[GROUP_PATCHES_MAX], uint32_t *patch_count,
		       struct bytes object)
{
	struct group *group = calloc(1, sizeof(*group));
	struct reader reader;
	int rc = group ? 0 : -ENOMEM;

	memset(patches, 0, GROUP_PATCHES_MAX * sizeof(*patches));
	*patch_count = 0;
	reader_init(&reader, object);
	if (rc == 0)
		rc = get_header(&reader, group);
	if (rc == 0)
		rc = decode_group(group, &reader);
	if (rc == 0)
		rc = give_patches(patches, group);
	if (rc == 0)
		*patch_count = group->mesh.patch_count;
	for (uint32_t p = 0; rc < 0 && p < GROUP_PATCHES_MAX; p++)
		patch_mesh_finish(&patches[p]);
	group_destroy(group);
	return rc;
}

void patch_mesh_finish(struct patch_mesh *mesh)
{
	if (!mesh)
		return;
	free(mesh->vertices);
	free(mesh->indices);
	*mesh = (struct patch_mesh){ 0 };
}
