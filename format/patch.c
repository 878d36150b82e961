/* Encodes and decodes the geometry of a patch group as zstd streams of indices and predicted
 * vertices. */
#include "format/patch.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <meshoptimizer.h>
#include <zstd.h>

#include "format/predict.h"

/* docs/patch.md describes the bytes. Each stream holds one kind of number of all patches of the
 * group. So zstd sees uniform statistics in each stream, and a small patch needs no stream
 * headers. */
enum stream {
	STREAM_INDICES, /* meshoptimizer's index codec, patch after patch */
	STREAM_POSITION_LOW,
	STREAM_POSITION_HIGH,
	STREAM_NORMAL,
	STREAM_GREEN,
	STREAM_TINT, /* red - green, blue - green */
	STREAM_OPEN,
	STREAM_POSITION_TOP, /* only in a wide group */
	STREAM_COUNT
};

enum {
	VERSION = 2,
	INDEX_BYTES_MAX = 8 * PATCH_TRIANGLES_MAX,
	NORMAL_ZEROS_MAX = 6,
	BITS_MIN = 4, /* fewer bits cannot fill eight by one repetition */
	PLACED = 0x80 /* beside the number of patches: a range follows */
};

static const int zstd_levels[] = { [PATCH_FAST] = 2, [PATCH_SMALL] = 12 };
static const uint8_t magic[4] = { 'G', 'P', 'p', 'g' };
static const uint8_t bytes_a_vertex[STREAM_COUNT] = { 0, 3, 3, 2, 1, 2, 1, 3 };

/* The fewest bits that express every vertex of a group without loss. */
struct precision {
	uint8_t normal_zeros; /* low bits that are zero in every normal */
	uint8_t colour_bits, open_bits;
	struct predict_range range;
};

static const struct predict_range narrow = { .most = UINT16_MAX };
static const int32_t wide_most = LATTICE_PLACES_MAX - 1;

static bool is_wide(const struct predict_range *range)
{
	return range->most > UINT16_MAX;
}

struct streams {
	uint8_t *data[STREAM_COUNT]; /* owned */
	size_t size[STREAM_COUNT];
	size_t at[STREAM_COUNT];
	int count; /* of streams that there are */
};

static int streams_init(struct streams *streams, size_t index_bytes, size_t vertex_count, bool wide)
{
	*streams = (struct streams){ .count = wide ? STREAM_COUNT : STREAM_POSITION_TOP };
	for (int i = 0; i < streams->count; i++) {
		streams->size[i] =
			i == STREAM_INDICES ? index_bytes : bytes_a_vertex[i] * vertex_count;
		streams->data[i] = malloc(streams->size[i]);
		if (!streams->data[i])
			return -ENOMEM;
	}
	return 0;
}

static void streams_finish(struct streams *streams)
{
	for (int i = 0; i < STREAM_COUNT; i++)
		free(streams->data[i]);
}

static void put(struct streams *streams, enum stream stream, uint8_t value)
{
	streams->data[stream][streams->at[stream]++] = value;
}

static uint8_t get(struct streams *streams, enum stream stream)
{
	return streams->data[stream][streams->at[stream]++];
}

/* Maps small differences of either sign to small numbers (zigzag). Differences wrap around. */
static uint32_t fold_place(int32_t difference, int32_t most)
{
	uint32_t wrapped = (uint32_t)difference & (uint32_t)most;

	return (wrapped << 1 & (uint32_t)most) ^
	       (wrapped > (uint32_t)most / 2 ? (uint32_t)most : 0);
}

static int32_t unfold_place(uint32_t folded, int32_t most)
{
	return (int32_t)(folded >> 1) ^ (folded & 1 ? most : 0);
}

static uint8_t fold8(uint8_t difference)
{
	return (uint8_t)(difference << 1 ^ (difference & 0x80 ? 0xff : 0));
}

static uint8_t unfold8(uint8_t folded)
{
	return (uint8_t)(folded >> 1 ^ (folded & 1 ? 0xff : 0));
}

/* Widens a value of bits bits to eight by repeating its bits, so that all zeros and all ones stay
 * so. */
static uint8_t widen(uint8_t value, int bits)
{
	return bits == 8 ? value : (uint8_t)(value << (8 - bits) | value >> (2 * bits - 8));
}

uint8_t patch_round_colour(uint8_t value, int bits)
{
	int most = (1 << bits) - 1;

	return widen((uint8_t)((value * most + 127) / 255), bits);
}

static int shorten_normal(int guess, int zeros)
{
	return (guess + ((1 << zeros) >> 1)) >> zeros;
}

static void put_vertex(struct streams *streams, const struct patch_mesh *mesh,
		       const struct predict_step *step, const int8_t normal[2],
		       const struct precision *precision)
{
	const struct patch_vertex *vertex = &mesh->vertices[step->vertex];
	int zeros = precision->normal_zeros;
	int32_t position[3];
	uint8_t colour[4], difference[4];

	predict_position(position, step, mesh->vertices, &precision->range);
	predict_colour(colour, step, mesh->vertices);
	for (int i = 0; i < 3; i++) {
		uint32_t folded =
			fold_place(vertex->position[i] - position[i], precision->range.most);

		put(streams, STREAM_POSITION_LOW, (uint8_t)folded);
		put(streams, STREAM_POSITION_HIGH, (uint8_t)(folded >> 8));
		if (is_wide(&precision->range))
			put(streams, STREAM_POSITION_TOP, (uint8_t)(folded >> 16));
	}
	for (int i = 0; i < 2; i++)
		put(streams, STREAM_NORMAL,
		    fold8((uint8_t)((vertex->normal[i] >> zeros) -
				    shorten_normal(normal[i], zeros))));
	for (int i = 0; i < 4; i++) {
		int dropped = 8 - (i < 3 ? precision->colour_bits : precision->open_bits);

		difference[i] = (uint8_t)((vertex->colour[i] >> dropped) - (colour[i] >> dropped));
	}
	put(streams, STREAM_GREEN, fold8(difference[1]));
	put(streams, STREAM_TINT, fold8((uint8_t)(difference[0] - difference[1])));
	put(streams, STREAM_TINT, fold8((uint8_t)(difference[2] - difference[1])));
	put(streams, STREAM_OPEN, fold8(difference[3]));
}

static int get_position(struct streams *streams, struct patch_mesh *mesh,
			const struct predict_step *step, const struct predict_range *range)
{
	struct patch_vertex *vertex = &mesh->vertices[step->vertex];
	int32_t position[3], off;

	predict_position(position, step, mesh->vertices, range);
	for (int i = 0; i < 3; i++) {
		uint32_t folded = get(streams, STREAM_POSITION_LOW);

		folded |= (uint32_t)get(streams, STREAM_POSITION_HIGH) << 8;
		if (is_wide(range))
			folded |= (uint32_t)get(streams, STREAM_POSITION_TOP) << 16;
		off = position[i] - range->base[i] + unfold_place(folded, range->most);
		vertex->position[i] = range->base[i] + (off & range->most);
		if (vertex->position[i] >= LATTICE_PLACES_MAX)
			return -EBADMSG;
	}
	return 0;
}

static uint8_t get_colour(uint8_t guess, uint8_t difference, int bits)
{
	uint8_t value = (uint8_t)((guess >> (8 - bits)) + difference);

	return widen((uint8_t)(value & ((1 << bits) - 1)), bits);
}

static void get_rest(struct streams *streams, struct patch_mesh *mesh,
		     const struct predict_step *step, const int8_t normal[2],
		     const struct precision *precision)
{
	struct patch_vertex *vertex = &mesh->vertices[step->vertex];
	int zeros = precision->normal_zeros, bits = precision->colour_bits;
	uint8_t colour[4], green, red, blue;

	predict_colour(colour, step, mesh->vertices);
	for (int i = 0; i < 2; i++) {
		int value = shorten_normal(normal[i], zeros) + unfold8(get(streams, STREAM_NORMAL));

		vertex->normal[i] = (int8_t)(uint8_t)((uint32_t)value << zeros);
	}
	green = unfold8(get(streams, STREAM_GREEN));
	red = (uint8_t)(green + unfold8(get(streams, STREAM_TINT)));
	blue = (uint8_t)(green + unfold8(get(streams, STREAM_TINT)));
	vertex->colour[0] = get_colour(colour[0], red, bits);
	vertex->colour[1] = get_colour(colour[1], green, bits);
	vertex->colour[2] = get_colour(colour[2], blue, bits);
	vertex->colour[3] =
		get_colour(colour[3], unfold8(get(streams, STREAM_OPEN)), precision->open_bits);
}

/* Writes the vertices of one patch to the streams, or reads them. The indices of the mesh must be
 * in range. */
static int code_vertices(struct streams *streams, struct patch_mesh *mesh,
			 const struct precision *precision, bool encoding)
{
	struct predict_step *steps = malloc(mesh->vertex_count * sizeof(*steps));
	int8_t(*normals)[2] = malloc(mesh->vertex_count * sizeof(*normals));
	int rc = steps && normals ? predict_steps(steps, mesh) : -ENOMEM;

	for (uint32_t i = 0; rc == 0 && !encoding && i < mesh->vertex_count; i++)
		rc = get_position(streams, mesh, &steps[i], &precision->range);
	if (rc == 0)
		rc = predict_normals(normals, mesh);
	for (uint32_t i = 0; rc == 0 && i < mesh->vertex_count; i++) {
		if (encoding)
			put_vertex(streams, mesh, &steps[i], normals[steps[i].vertex], precision);
		else
			get_rest(streams, mesh, &steps[i], normals[steps[i].vertex], precision);
	}
	free(steps);
	free(normals);
	return rc;
}

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

/* The index codec may rotate the corners of a triangle. The encoder must predict vertices from the
 * same triangles as the decoder. So *decoded is the patch with its indices as the decoder will see
 * them; these are owned by the caller. */
static int encode_indices(struct buffer *out, struct patch_mesh *decoded,
			  const struct patch_mesh *mesh)
{
	size_t count = 3 * (size_t)mesh->triangle_count, size;
	uint32_t wide[3 * PATCH_TRIANGLES_MAX];
	uint8_t *packed;

	for (size_t i = 0; i < count; i++)
		wide[i] = mesh->indices[i];
	size = meshopt_encodeIndexBufferBound(count, mesh->vertex_count);
	packed = malloc(size);
	if (!packed)
		return -ENOMEM;
	size = meshopt_encodeIndexBuffer(packed, size, wide, count);
	buffer_put(out, packed, size);
	*decoded = *mesh;
	decoded->indices = malloc(count * sizeof(*decoded->indices));
	if (!decoded->indices ||
	    meshopt_decodeIndexBuffer(decoded->indices, count, 2, packed, size) != 0) {
		free(decoded->indices);
		decoded->indices = NULL;
		free(packed);
		return -ENOMEM;
	}
	free(packed);
	return out->error;
}

static int put_streams(struct buffer *out, const struct streams *streams, enum patch_effort effort)
{
	for (int i = 0; i < streams->count; i++) {
		size_t bound = ZSTD_compressBound(streams->size[i]);
		uint8_t *packed = malloc(bound);
		size_t size = packed ? ZSTD_compress(packed, bound, streams->data[i],
						     streams->size[i], zstd_levels[effort])
				     : 0;

		if (!packed || ZSTD_isError(size)) {
			free(packed);
			return -ENOMEM;
		}
		buffer_put_u32(out, (uint32_t)size);
		buffer_put(out, packed, size);
		free(packed);
	}
	return out->error;
}

static uint8_t bits_of(uint8_t value, uint8_t bits)
{
	while (widen((uint8_t)(value >> (8 - bits)), bits) != value)
		bits++;
	return bits;
}

static void tell_vertex(struct precision *precision, const struct patch_vertex *vertex)
{
	int digits = vertex->normal[0] | vertex->normal[1];

	while (digits & ((1 << precision->normal_zeros) - 1))
		precision->normal_zeros--;
	for (int i = 0; i < 3; i++)
		precision->colour_bits = bits_of(vertex->colour[i], precision->colour_bits);
	precision->open_bits = bits_of(vertex->colour[3], precision->open_bits);
}

static struct precision precision_of(const struct patch_mesh *patches, uint32_t patch_count)
{
	struct precision precision = { NORMAL_ZEROS_MAX, BITS_MIN, BITS_MIN, narrow };

	for (uint32_t p = 0; p < patch_count; p++)
		for (uint32_t v = 0; v < patches[p].vertex_count; v++)
			tell_vertex(&precision, &patches[p].vertices[v]);
	return precision;
}

/* Returns -EINVAL if a place is none of a lattice. A group near the lattice's origin needs no base,
 * and so no group of a small site. */
static int find_range(struct predict_range *out, const struct patch_mesh *patches,
		      uint32_t patch_count)
{
	int32_t low[3] = { INT32_MAX, INT32_MAX, INT32_MAX }, high[3] = { 0 };

	for (uint32_t p = 0; p < patch_count; p++)
		for (uint32_t v = 0; v < patches[p].vertex_count; v++)
			for (int i = 0; i < 3; i++) {
				int32_t at = patches[p].vertices[v].position[i];

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
			out->most = wide_most;
	return 0;
}

static bool has_base(const struct predict_range *range)
{
	return range->base[0] != 0 || range->base[1] != 0 || range->base[2] != 0 || is_wide(range);
}

static void put_range(struct buffer *out, const struct predict_range *range)
{
	buffer_put_u8(out, is_wide(range) ? 3 : 2);
	for (int i = 0; i < 3; i++)
		buffer_put_u32(out, (uint32_t)range->base[i]);
}

/* Writes header and streams of patches whose indices are already packed. */
static int put_group(struct buffer *out, struct patch_mesh *decoded, uint32_t patch_count,
		     const uint32_t *index_bytes, struct bytes indices, enum patch_effort effort)
{
	struct precision precision = precision_of(decoded, patch_count);
	struct streams streams;
	size_t vertex_count = 0;
	int rc = find_range(&precision.range, decoded, patch_count);
	bool placed = rc == 0 && has_base(&precision.range);

	if (rc < 0)
		return rc;
	buffer_put(out, magic, sizeof(magic));
	buffer_put_u8(out, VERSION);
	buffer_put_u8(out, (uint8_t)(patch_count | (placed ? PLACED : 0)));
	buffer_put_u8(out, precision.normal_zeros);
	buffer_put_u8(out, precision.colour_bits);
	buffer_put_u8(out, precision.open_bits);
	if (placed)
		put_range(out, &precision.range);
	for (uint32_t p = 0; p < patch_count; p++) {
		buffer_put_u16(out, (uint16_t)decoded[p].vertex_count);
		buffer_put_u16(out, (uint16_t)decoded[p].triangle_count);
		buffer_put_u16(out, (uint16_t)index_bytes[p]);
		vertex_count += decoded[p].vertex_count;
	}
	rc = streams_init(&streams, indices.size, vertex_count, is_wide(&precision.range));
	if (rc == 0)
		memcpy(streams.data[STREAM_INDICES], indices.data, indices.size);
	for (uint32_t p = 0; rc == 0 && p < patch_count; p++)
		rc = code_vertices(&streams, &decoded[p], &precision, true);
	if (rc == 0)
		rc = put_streams(out, &streams, effort);
	streams_finish(&streams);
	return rc;
}

int patch_group_encode(struct buffer *out, const struct patch_mesh *patches, uint32_t patch_count,
		       enum patch_effort effort)
{
	struct patch_mesh decoded[GROUP_PATCHES_MAX] = { 0 };
	uint32_t index_bytes[GROUP_PATCHES_MAX];
	struct buffer indices;
	int rc = 0;

	if (patch_count < 1 || patch_count > GROUP_PATCHES_MAX)
		return -EINVAL;
	for (uint32_t p = 0; p < patch_count; p++)
		if (!counts_fit(patches[p].vertex_count, patches[p].triangle_count) ||
		    !indices_fit(&patches[p]))
			return -EINVAL;
	buffer_init(&indices, GROUP_PATCHES_MAX * INDEX_BYTES_MAX);
	for (uint32_t p = 0; rc == 0 && p < patch_count; p++) {
		size_t before = indices.size;

		rc = encode_indices(&indices, &decoded[p], &patches[p]);
		index_bytes[p] = (uint32_t)(indices.size - before);
		if (rc == 0 && index_bytes[p] > UINT16_MAX)
			rc = -EINVAL;
	}
	if (rc == 0)
		rc = put_group(out, decoded, patch_count, index_bytes, buffer_bytes(&indices),
			       effort);
	for (uint32_t p = 0; p < patch_count; p++)
		free(decoded[p].indices);
	buffer_finish(&indices);
	return rc;
}

static bool get_precision(struct reader *reader, struct precision *out)
{
	out->normal_zeros = reader_u8(reader);
	out->colour_bits = reader_u8(reader);
	out->open_bits = reader_u8(reader);
	return out->normal_zeros <= NORMAL_ZEROS_MAX && out->colour_bits >= BITS_MIN &&
	       out->colour_bits <= 8 && out->open_bits >= BITS_MIN && out->open_bits <= 8;
}

static bool get_range(struct reader *reader, struct predict_range *out)
{
	uint8_t bytes = reader_u8(reader);
	bool good = bytes == 2 || bytes == 3;

	out->most = bytes == 3 ? wide_most : UINT16_MAX;
	for (int i = 0; i < 3; i++) {
		uint32_t base = reader_u32(reader);

		good = good && base < LATTICE_PLACES_MAX;
		out->base[i] = (int32_t)(base % LATTICE_PLACES_MAX);
	}
	return good;
}

static int get_header(struct reader *reader, struct patch_mesh *patches, uint32_t *patch_count,
		      uint32_t *index_bytes, struct precision *precision)
{
	struct bytes start = reader_bytes(reader, sizeof(magic));
	bool placed;

	if (reader->failed || memcmp(start.data, magic, sizeof(magic)) != 0 ||
	    reader_u8(reader) != VERSION)
		return -EBADMSG;
	*patch_count = reader_u8(reader);
	placed = *patch_count & PLACED;
	*patch_count &= ~(uint32_t)PLACED;
	precision->range = narrow;
	if (*patch_count < 1 || *patch_count > GROUP_PATCHES_MAX ||
	    !get_precision(reader, precision) || (placed && !get_range(reader, &precision->range)))
		return -EBADMSG;
	for (uint32_t p = 0; p < *patch_count; p++) {
		patches[p].vertex_count = reader_u16(reader);
		patches[p].triangle_count = reader_u16(reader);
		index_bytes[p] = reader_u16(reader);
		if (!counts_fit(patches[p].vertex_count, patches[p].triangle_count))
			return -EBADMSG;
	}
	return reader->failed ? -EBADMSG : 0;
}

static int get_streams(struct reader *reader, struct streams *streams)
{
	for (int i = 0; i < streams->count; i++) {
		struct bytes packed = reader_bytes(reader, reader_u32(reader));

		if (reader->failed ||
		    ZSTD_getFrameContentSize(packed.data, packed.size) != streams->size[i])
			return -EBADMSG;
		if (ZSTD_decompress(streams->data[i], streams->size[i], packed.data, packed.size) !=
		    streams->size[i])
			return -EBADMSG;
	}
	return reader_left(reader) == 0 ? 0 : -EBADMSG;
}

static int decode_patch(struct patch_mesh *mesh, struct streams *streams, uint32_t index_bytes,
			const struct precision *precision)
{
	const uint8_t *packed = streams->data[STREAM_INDICES] + streams->at[STREAM_INDICES];

	mesh->vertices = calloc(mesh->vertex_count, sizeof(*mesh->vertices));
	mesh->indices = calloc(3 * (size_t)mesh->triangle_count, sizeof(*mesh->indices));
	if (!mesh->vertices || !mesh->indices)
		return -ENOMEM;
	streams->at[STREAM_INDICES] += index_bytes;
	if (meshopt_decodeIndexBuffer(mesh->indices, 3 * (size_t)mesh->triangle_count, 2, packed,
				      index_bytes) != 0 ||
	    !indices_fit(mesh))
		return -EBADMSG;
	return code_vertices(streams, mesh, precision, false);
}

int patch_group_decode(struct patch_mesh patches[GROUP_PATCHES_MAX], uint32_t *patch_count,
		       struct bytes object)
{
	uint32_t index_bytes[GROUP_PATCHES_MAX];
	size_t index_total = 0, vertex_total = 0;
	struct precision precision = { 0 };
	struct streams streams = { 0 };
	struct reader reader;
	int rc;

	memset(patches, 0, GROUP_PATCHES_MAX * sizeof(*patches));
	reader_init(&reader, object);
	rc = get_header(&reader, patches, patch_count, index_bytes, &precision);
	for (uint32_t p = 0; rc == 0 && p < *patch_count; p++) {
		index_total += index_bytes[p];
		vertex_total += patches[p].vertex_count;
	}
	if (rc == 0)
		rc = streams_init(&streams, index_total, vertex_total, is_wide(&precision.range));
	if (rc == 0)
		rc = get_streams(&reader, &streams);
	for (uint32_t p = 0; rc == 0 && p < *patch_count; p++)
		rc = decode_patch(&patches[p], &streams, index_bytes[p], &precision);
	streams_finish(&streams);
	if (rc < 0) {
		for (uint32_t p = 0; p < GROUP_PATCHES_MAX; p++)
			patch_mesh_finish(&patches[p]);
		*patch_count = 0;
	}
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
