/* Encodes and decodes scenery: a header and one zstd frame. */
#include "format/scenery_code.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <zstd.h>

#include "format/scenery_motion_code.h"
#include "format/scenery_texture_code.h"
#include "format/unpack.h"

enum {
	VERSION = 6,
	VERSION_SIGHTLESS = 5,   /* without sights; what has none is written so */
	VERSION_COLOURS = 4,     /* without normal maps; likewise */
	VERSION_NO_TEXTURES = 3, /* without pictures; likewise */
	VERSION_STIFF = 2,       /* without shapes and drags */
	VERSION_PLAIN = 1, /* without materials and fog; a mesh said whether it has two sides */
	ZSTD_LEVEL = 19,
	HEADER_BYTES = 9,
	RAW_BYTES_MAX = 32 << 20,
	OBJECT_MAX = 16 << 20,
	/* the bytes of one: */
	NODE_BYTES = 2 * 4 + 17 * 4,
	MATERIAL_BYTES = 1 + 4 + 3 + 3 + 4 + 1 + 4 + 4 + 3 * 4,
	MESH_BYTES = 4 + 4 * 4 + 1 + 4 + 4, /* at least */
	VERTEX_BYTES = 11,
	TRIANGLE_BYTES = 6,
	BEND_BYTES = 4 + 4, /* at least */
	SHAPE_VERTEX_BYTES = 8,
	LAYER_BYTES = 1,
	TITLE_BYTES = 4,
	SIGHT_BYTES = 4 + 1 + 5 * 4,
};

static const char magic[4] = { 'G', 'P', 's', 'y' };

/* ---- numbers, in the same order both ways */

/* Reads a count; more than `most`, or more than the bytes that are left can hold, is a failure. */
static uint32_t get_count(struct reader *in, uint32_t most, size_t bytes_each)
{
	uint32_t count = reader_u32(in);

	if (count > most || count > reader_left(in) / bytes_each)
		in->failed = true;
	return in->failed ? 0 : count;
}

static void put_node(struct buffer *out, const struct scenery_node *node)
{
	buffer_put_u32(out, node->parent);
	buffer_put_u32(out, node->layer);
	scenery_put_floats(out, node->place.move_m, 3);
	scenery_put_floats(out, node->place.turn, 4);
	scenery_put_floats(out, node->place.scale, 3);
	scenery_put_floats(out, node->place.centre_m, 3);
	scenery_put_floats(out, node->place.stretch, 4);
}

static void get_node(struct reader *in, struct scenery_node *node)
{
	node->parent = reader_u32(in);
	node->layer = reader_u32(in);
	scenery_get_floats(in, node->place.move_m, 3);
	scenery_get_floats(in, node->place.turn, 4);
	scenery_get_floats(in, node->place.scale, 3);
	scenery_get_floats(in, node->place.centre_m, 3);
	scenery_get_floats(in, node->place.stretch, 4);
}

enum { TWO_SIDES = 1, BY_PIXEL = 2, MATERIAL_FLAGS = 3 };

static void put_material(struct buffer *out, const struct scenery_material *material)
{
	buffer_put_u8(out, (uint8_t)(material->has_two_sides * TWO_SIDES +
				     material->by_pixel * BY_PIXEL));
	buffer_put_f32(out, material->opacity);
	buffer_put(out, material->emissive, 3);
	buffer_put(out, material->specular, 3);
	buffer_put_f32(out, material->shininess);
	buffer_put_u8(out, material->substance);
	buffer_put_f32(out, material->relief_m);
	buffer_put_f32(out, material->mirror);
	scenery_put_floats(out, material->grain, 3);
}

static void get_rgb(struct reader *in, uint8_t rgb[3])
{
	for (int k = 0; k < 3; k++)
		rgb[k] = reader_u8(in);
}

static void get_material(struct reader *in, struct scenery_material *material)
{
	const uint8_t flags = reader_u8(in);

	in->failed = in->failed || flags > MATERIAL_FLAGS;
	material->has_two_sides = flags & TWO_SIDES;
	material->by_pixel = (flags & BY_PIXEL) != 0;
	material->opacity = reader_f32(in);
	get_rgb(in, material->emissive);
	get_rgb(in, material->specular);
	material->shininess = reader_f32(in);
	material->substance = reader_u8(in);
	material->relief_m = reader_f32(in);
	material->mirror = reader_f32(in);
	scenery_get_floats(in, material->grain, 3);
}

static void put_fog(struct buffer *out, const struct scenery_fog *fog)
{
	buffer_put_f32(out, fog->range_m);
	buffer_put_u8(out, fog->is_exponential);
	buffer_put(out, fog->rgb, 3);
	buffer_put_u32(out, fog->layer);
}

static void get_fog(struct reader *in, struct scenery_fog *fog)
{
	fog->range_m = reader_f32(in);
	fog->is_exponential = scenery_get_flag(in);
	get_rgb(in, fog->rgb);
	fog->layer = reader_u32(in);
}

/* Numbers of one kind stand together, which compresses better. */
static void put_mesh(struct buffer *out, const struct scenery_mesh *mesh)
{
	const struct scenery_vertex *vertices = mesh->vertices;

	buffer_put_u32(out, mesh->node);
	scenery_put_floats(out, mesh->origin_m, 3);
	buffer_put_f32(out, mesh->step_m);
	buffer_put_u32(out, mesh->material);
	buffer_put_u32(out, mesh->vertex_count);
	buffer_put_u32(out, mesh->triangle_count);
	for (int k = 0; k < 3; k++)
		for (uint32_t v = 0; v < mesh->vertex_count; v++)
			buffer_put_u16(out, vertices[v].place[k]);
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		buffer_put(out, vertices[v].normal, 2);
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		buffer_put(out, vertices[v].rgb, 3);
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		for (int k = 0; k < 3; k++)
			buffer_put_u16(out, mesh->triangles[t][k]);
}

static int get_mesh(struct reader *in, struct scenery_mesh *mesh, uint8_t version)
{
	uint64_t needed;
	struct bytes colours;

	mesh->node = reader_u32(in);
	scenery_get_floats(in, mesh->origin_m, 3);
	mesh->step_m = reader_f32(in);
	/* a plain object's two materials differ in their sides */
	mesh->material = version == VERSION_PLAIN ? scenery_get_flag(in) : reader_u32(in);
	mesh->vertex_count = reader_u32(in);
	mesh->triangle_count = reader_u32(in);
	needed = (uint64_t)mesh->vertex_count * VERTEX_BYTES +
		 (uint64_t)mesh->triangle_count * TRIANGLE_BYTES;
	if (in->failed || needed > reader_left(in))
		return -EBADMSG;
	mesh->vertices = calloc((size_t)mesh->vertex_count + 1, sizeof(*mesh->vertices));
	mesh->triangles = calloc((size_t)mesh->triangle_count + 1, sizeof(*mesh->triangles));
	if (!mesh->vertices || !mesh->triangles)
		return -ENOMEM;
	for (int k = 0; k < 3; k++)
		for (uint32_t v = 0; v < mesh->vertex_count; v++)
			mesh->vertices[v].place[k] = reader_u16(in);
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		for (int k = 0; k < 2; k++)
			mesh->vertices[v].normal[k] = (int8_t)reader_u8(in);
	colours = reader_bytes(in, (size_t)mesh->vertex_count * 3);
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		memcpy(mesh->vertices[v].rgb, &colours.data[3 * v], 3);
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		for (int k = 0; k < 3; k++)
			mesh->triangles[t][k] = reader_u16(in);
	return 0;
}

static void put_layers(struct buffer *out, const struct scenery *scenery)
{
	for (uint32_t i = 0; i < scenery->layer_count; i++)
		buffer_put_u8(out, (uint8_t)scenery->layers[i].title_count);
	for (uint32_t i = 0; i < scenery->title_count; i++) {
		buffer_put_string(out, scenery->titles[i].language);
		buffer_put_string(out, scenery->titles[i].text);
	}
}

static void get_layers(struct reader *in, struct scenery *scenery)
{
	uint32_t next = 0;

	for (uint32_t i = 0; i < scenery->layer_count; i++) {
		scenery->layers[i].first_title = next;
		scenery->layers[i].title_count = reader_u8(in);
		next += scenery->layers[i].title_count;
	}
	for (uint32_t i = 0; i < scenery->title_count; i++) {
		struct scenery_title *title = &scenery->titles[i];

		reader_string(in, title->language, sizeof(title->language));
		reader_string(in, title->text, sizeof(title->text));
	}
}

/* ---- shapes: each number of all vertices of a shape stands together */

static void put_shapes(struct buffer *out, const struct scenery *scenery)
{
	uint32_t bends = 0;

	for (uint32_t i = 0; i < scenery->mesh_count; i++)
		bends += scenery->meshes[i].shape_count > 0;
	buffer_put_u32(out, bends);
	for (uint32_t i = 0; i < scenery->mesh_count; i++) {
		const struct scenery_mesh *mesh = &scenery->meshes[i];

		if (mesh->shape_count == 0)
			continue;
		buffer_put_u32(out, i);
		buffer_put_u32(out, mesh->shape_count);
		for (uint32_t s = 0; s < mesh->shape_count; s++) {
			const struct scenery_shape_vertex *shape =
				&mesh->shapes[(size_t)s * mesh->vertex_count];

			for (int k = 0; k < 3; k++)
				for (uint32_t v = 0; v < mesh->vertex_count; v++)
					buffer_put_u16(out, shape[v].place[k]);
			for (uint32_t v = 0; v < mesh->vertex_count; v++)
				buffer_put(out, shape[v].normal, 2);
		}
	}
}

static void get_shape(struct reader *in, struct scenery_shape_vertex *shape, uint32_t count)
{
	for (int k = 0; k < 3; k++)
		for (uint32_t v = 0; v < count; v++)
			shape[v].place[k] = reader_u16(in);
	for (uint32_t v = 0; v < count; v++)
		for (int k = 0; k < 2; k++)
			shape[v].normal[k] = (int8_t)reader_u8(in);
}

static int get_shapes(struct reader *in, struct scenery *scenery)
{
	const uint32_t bends = get_count(in, SCENERY_MESHES_MAX, BEND_BYTES);
	uint32_t next = 0;

	for (uint32_t i = 0; i < bends; i++) {
		const uint32_t number = reader_u32(in), count = reader_u32(in);
		struct scenery_mesh *mesh;
		size_t vertices;

		if (in->failed || number < next || number >= scenery->mesh_count || count < 1 ||
		    count > SCENERY_SHAPES_MAX)
			return -EBADMSG;
		next = number + 1;
		mesh = &scenery->meshes[number];
		vertices = (size_t)count * mesh->vertex_count;
		if (vertices > reader_left(in) / SHAPE_VERTEX_BYTES)
			return -EBADMSG;
		mesh->shapes = calloc(vertices + 1, sizeof(*mesh->shapes));
		if (!mesh->shapes)
			return -ENOMEM;
		mesh->shape_count = count;
		for (uint32_t s = 0; s < count; s++)
			get_shape(in, &mesh->shapes[(size_t)s * mesh->vertex_count],
				  mesh->vertex_count);
	}
	return 0;
}

/* ---- sights: of the nodes that have one */

static uint32_t count_sights(const struct scenery *scenery)
{
	uint32_t count = 0;

	for (uint32_t i = 0; i < scenery->node_count; i++)
		count += scenery->nodes[i].sight.kind != SCENERY_SIGHT_NONE;
	return count;
}

static void put_sights(struct buffer *out, const struct scenery *scenery)
{
	buffer_put_u32(out, count_sights(scenery));
	for (uint32_t i = 0; i < scenery->node_count; i++) {
		const struct scenery_sight *sight = &scenery->nodes[i].sight;

		if (sight->kind == SCENERY_SIGHT_NONE)
			continue;
		buffer_put_u32(out, i);
		buffer_put_u8(out, (uint8_t)sight->kind);
		scenery_put_floats(out, sight->at, 3);
		buffer_put_f32(out, sight->from);
		buffer_put_f32(out, sight->to);
	}
}

static int get_sights(struct reader *in, struct scenery *scenery)
{
	const uint32_t count = get_count(in, SCENERY_NODES_MAX, SIGHT_BYTES);
	uint32_t next = 0;

	if (count < 1)
		return -EBADMSG;
	for (uint32_t i = 0; i < count; i++) {
		const uint32_t number = reader_u32(in);
		struct scenery_sight *sight;

		if (number < next || number >= scenery->node_count)
			return -EBADMSG;
		next = number + 1;
		sight = &scenery->nodes[number].sight;
		sight->kind = reader_u8(in);
		if (sight->kind == SCENERY_SIGHT_NONE)
			return -EBADMSG;
		scenery_get_floats(in, sight->at, 3);
		sight->from = reader_f32(in);
		sight->to = reader_f32(in);
	}
	return 0;
}

/* ---- the whole */

static void put_raw(struct buffer *out, const struct scenery *scenery, uint8_t version)
{
	buffer_put_u32(out, scenery->node_count);
	buffer_put_u32(out, scenery->mesh_count);
	buffer_put_u32(out, scenery->motion_count);
	buffer_put_u32(out, scenery->touch_count);
	buffer_put_u32(out, scenery->track_count);
	buffer_put_u32(out, scenery->number_count);
	buffer_put_u32(out, scenery->layer_count);
	buffer_put_u32(out, scenery->title_count);
	buffer_put_u32(out, scenery->material_count);
	buffer_put_u32(out, scenery->drag_count);
	for (uint32_t i = 0; i < scenery->material_count; i++)
		put_material(out, &scenery->materials[i]);
	put_fog(out, &scenery->fog);
	for (uint32_t i = 0; i < scenery->node_count; i++)
		put_node(out, &scenery->nodes[i]);
	for (uint32_t i = 0; i < scenery->mesh_count; i++)
		put_mesh(out, &scenery->meshes[i]);
	scenery_put_motions(out, scenery);
	put_layers(out, scenery);
	scenery_put_drags(out, scenery);
	put_shapes(out, scenery);
	if (version > VERSION_NO_TEXTURES)
		scenery_put_textures(out, scenery, version > VERSION_COLOURS);
	if (version > VERSION_SIGHTLESS)
		put_sights(out, scenery);
}

/* The oldest version that says it all, so that older terminals read it. */
static uint8_t version_of(const struct scenery *scenery)
{
	if (count_sights(scenery) > 0)
		return VERSION;
	for (uint32_t i = 0; i < scenery->material_count; i++)
		if (scenery->materials[i].normals > 0)
			return VERSION_SIGHTLESS;
	return scenery->texture_count > 0 ? VERSION_COLOURS : VERSION_NO_TEXTURES;
}

int scenery_encode(struct buffer *out, const struct scenery *scenery)
{
	const uint8_t version = version_of(scenery);
	struct buffer raw;
	uint8_t *packed = NULL;
	size_t size = 0, room;
	int rc;

	if (!scenery_is_sane(scenery))
		return -EINVAL;
	buffer_init(&raw, RAW_BYTES_MAX);
	put_raw(&raw, scenery, version);
	rc = raw.error;
	room = ZSTD_compressBound(raw.size);
	if (rc == 0)
		packed = malloc(room);
	if (packed)
		size = ZSTD_compress(packed, room, raw.data, raw.size, ZSTD_LEVEL);
	if (rc == 0 && (!packed || ZSTD_isError(size)))
		rc = -ENOMEM;
	if (rc == 0 && size + HEADER_BYTES > OBJECT_MAX)
		rc = -EFBIG;
	if (rc == 0) {
		buffer_put(out, magic, sizeof(magic));
		buffer_put_u8(out, version);
		buffer_put_u32(out, (uint32_t)raw.size);
		buffer_put(out, packed, size);
		rc = out->error;
	}
	free(packed);
	buffer_finish(&raw);
	return rc;
}

enum { PLAIN_MATERIALS = 2 };

static void get_looks(struct reader *in, struct scenery *out, uint8_t version)
{
	if (version != VERSION_PLAIN) {
		for (uint32_t i = 0; i < out->material_count; i++)
			get_material(in, &out->materials[i]);
		get_fog(in, &out->fog);
		return;
	}
	for (uint32_t i = 0; i < PLAIN_MATERIALS; i++)
		out->materials[i] = (struct scenery_material){ .has_two_sides = i,
							       .opacity = 1,
							       .grain = { 0, 0, 1 } };
	out->fog.layer = SCENERY_NONE;
}

static int get_counts(struct reader *in, struct scenery *out, uint8_t version)
{
	uint32_t meshes;

	out->node_count = get_count(in, SCENERY_NODES_MAX, NODE_BYTES);
	meshes = get_count(in, SCENERY_MESHES_MAX, MESH_BYTES);
	out->motion_count = get_count(in, SCENERY_MOTIONS_MAX, SCENERY_MOTION_BYTES);
	out->touch_count = get_count(in, SCENERY_TOUCHES_MAX, SCENERY_TOUCH_BYTES);
	out->track_count = get_count(in, SCENERY_TRACKS_MAX, SCENERY_TRACK_BYTES);
	out->number_count = get_count(in, SCENERY_NUMBERS_MAX, 4);
	out->layer_count = get_count(in, SCENERY_LAYERS_MAX, LAYER_BYTES);
	out->title_count = get_count(in, SCENERY_TITLES_MAX, TITLE_BYTES);
	if (version != VERSION_PLAIN)
		out->material_count = get_count(in, SCENERY_MATERIALS_MAX, MATERIAL_BYTES);
	else
		out->material_count = PLAIN_MATERIALS;
	if (version > VERSION_STIFF)
		out->drag_count = get_count(in, SCENERY_DRAGS_MAX, SCENERY_DRAG_BYTES);
	if (in->failed)
		return -EBADMSG;
	out->materials = calloc(out->material_count + 1, sizeof(*out->materials));
	out->nodes = calloc(out->node_count + 1, sizeof(*out->nodes));
	out->meshes = calloc(meshes + 1, sizeof(*out->meshes));
	out->motions = calloc(out->motion_count + 1, sizeof(*out->motions));
	out->touches = calloc(out->touch_count + 1, sizeof(*out->touches));
	out->drags = calloc(out->drag_count + 1, sizeof(*out->drags));
	out->tracks = calloc(out->track_count + 1, sizeof(*out->tracks));
	out->numbers = calloc(out->number_count + 1, sizeof(*out->numbers));
	out->layers = calloc(out->layer_count + 1, sizeof(*out->layers));
	out->titles = calloc(out->title_count + 1, sizeof(*out->titles));
	if (!out->materials || !out->nodes || !out->meshes || !out->motions || !out->touches ||
	    !out->drags || !out->tracks || !out->numbers || !out->layers || !out->titles)
		return -ENOMEM;
	out->mesh_count = meshes;
	return 0;
}

static int get_raw(struct scenery *out, struct bytes raw, uint8_t version)
{
	struct reader in;
	int rc;

	reader_init(&in, raw);
	rc = get_counts(&in, out, version);
	if (rc == 0)
		get_looks(&in, out, version);
	for (uint32_t i = 0; rc == 0 && i < out->node_count; i++)
		get_node(&in, &out->nodes[i]);
	for (uint32_t i = 0; rc == 0 && i < out->mesh_count; i++)
		rc = get_mesh(&in, &out->meshes[i], version);
	if (rc == 0)
		rc = scenery_get_motions(&in, out);
	if (rc == 0)
		get_layers(&in, out);
	if (rc == 0 && version > VERSION_STIFF) {
		scenery_get_drags(&in, out);
		rc = get_shapes(&in, out);
	}
	if (rc == 0 && version > VERSION_NO_TEXTURES)
		rc = scenery_get_textures(&in, out, version > VERSION_COLOURS);
	if (rc == 0 && version > VERSION_SIGHTLESS)
		rc = get_sights(&in, out);
	else if (rc == 0 && version > VERSION_NO_TEXTURES && out->texture_count == 0)
		rc = -EBADMSG;
	if (rc == 0) {
		if (in.failed || reader_left(&in) > 0 || !scenery_is_sane(out))
			rc = -EBADMSG;
	}
	return rc;
}

int scenery_decode(struct scenery *out, struct bytes object)
{
	struct reader in;
	struct bytes packed;
	uint8_t *raw;
	uint32_t raw_bytes;
	int rc = 0;

	*out = (struct scenery){ 0 };
	if (object.size < HEADER_BYTES || object.size > OBJECT_MAX ||
	    memcmp(object.data, magic, sizeof(magic)) != 0 || object.data[4] < VERSION_PLAIN ||
	    object.data[4] > VERSION)
		return -EBADMSG;
	reader_init(&in, object);
	(void)reader_bytes(&in, 5);
	raw_bytes = reader_u32(&in);
	packed = reader_bytes(&in, reader_left(&in));
	if (raw_bytes > RAW_BYTES_MAX || !unpack_zstd_fits(raw_bytes, packed))
		return -EBADMSG;
	raw = malloc((size_t)raw_bytes + 1);
	if (!raw)
		return -ENOMEM;
	rc = unpack_zstd(raw, raw_bytes, packed);
	if (rc == 0)
		rc = get_raw(out, (struct bytes){ raw, raw_bytes }, object.data[4]);
	free(raw);
	if (rc < 0)
		scenery_finish(out);
	return rc;
}
