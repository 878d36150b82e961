/* Collects the blocks of a stream, decodes them in order, and moves new vertices to their
 * places. */
#include "render/patches/stream_growth.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "format/normal.h"

static int make_room(struct stream_growth *growth)
{
	const struct stream_mesh *mesh = stream_decoder_mesh(growth->decoder);
	const size_t vertices = (size_t)mesh->vertex_room + 1;

	if (mesh->vertex_count == 0 || mesh->vertex_room > STREAM_PAGE_VERTICES_MAX)
		return -EBADMSG;
	growth->from = calloc(vertices, sizeof(*growth->from));
	growth->shown = calloc(vertices, sizeof(*growth->shown));
	growth->indices = calloc(3 * (size_t)mesh->triangle_room + 1, sizeof(*growth->indices));
	return growth->from && growth->shown && growth->indices ? 0 : -ENOMEM;
}

int stream_growth_open(struct stream_growth *growth, struct bytes object)
{
	int rc;

	*growth = (struct stream_growth){ 0 };
	buffer_init(&growth->object, PAGE_BYTES_MAX);
	buffer_init(&growth->bytes, OBJECT_BYTES_MAX);
	buffer_put(&growth->object, object.data, object.size);
	rc = growth->object.error;
	if (rc == 0)
		rc = page_decode(&growth->page, buffer_bytes(&growth->object));
	if (rc == 0 && growth->page.kind != PAGE_STREAM)
		rc = -EBADMSG;
	if (rc == 0)
		rc = stream_page_decode(&growth->start, growth->page.payload,
					growth->page.child_count);
	if (rc == 0) {
		growth->early =
			calloc((size_t)growth->page.child_count + 1, sizeof(*growth->early));
		growth->has = calloc((size_t)growth->page.child_count + 1, 1);
		rc = growth->early && growth->has ? stream_decoder_create(&growth->decoder)
						  : -ENOMEM;
	}
	if (rc == 0) {
		buffer_put(&growth->bytes, growth->start.start.data, growth->start.start.size);
		rc = growth->bytes.error ? growth->bytes.error
					 : stream_decoder_advance(growth->decoder,
								  buffer_bytes(&growth->bytes));
	}
	if (rc == 0)
		rc = make_room(growth);
	if (rc < 0)
		stream_growth_finish(growth);
	return rc;
}

void stream_growth_finish(struct stream_growth *growth)
{
	for (uint32_t i = 0; growth->early && i < growth->page.child_count; i++)
		buffer_finish(&growth->early[i]);
	page_finish(&growth->page);
	buffer_finish(&growth->object);
	buffer_finish(&growth->bytes);
	stream_decoder_destroy(growth->decoder);
	free(growth->early);
	free(growth->has);
	free(growth->from);
	free(growth->shown);
	free(growth->indices);
	*growth = (struct stream_growth){ 0 };
}

int stream_growth_give(struct stream_growth *growth, uint32_t block, struct bytes object)
{
	struct buffer *early;
	int rc = 0;

	if (!growth->decoder || growth->damaged || block >= growth->page.child_count ||
	    growth->has[block])
		return 0;
	early = &growth->early[block];
	buffer_init(early, OBJECT_BYTES_MAX);
	buffer_put(early, object.data, object.size);
	if (early->error) {
		rc = early->error;
		buffer_finish(early);
		return rc;
	}
	growth->has[block] = 1;
	while (rc == 0 && growth->block_count < growth->page.child_count &&
	       growth->has[growth->block_count]) {
		early = &growth->early[growth->block_count];
		buffer_put(&growth->bytes, early->data, early->size);
		buffer_finish(early);
		rc = growth->bytes.error ? growth->bytes.error
					 : stream_decoder_advance(growth->decoder,
								  buffer_bytes(&growth->bytes));
		growth->block_count += rc == 0;
	}
	growth->damaged = rc < 0;
	return rc;
}

/* ---- growing */

static struct stream_vertex vertex_of(const struct patch_vertex *vertex)
{
	struct stream_vertex out = { .normal = { vertex->normal[0], vertex->normal[1] } };

	for (int i = 0; i < 3; i++)
		out.place[i] = (float)vertex->position[i];
	memcpy(out.colour, vertex->colour, sizeof(out.colour));
	return out;
}

/* Sets where the vertices of a piece start: all in the middle of it. */
static void start_piece(struct stream_growth *growth, const struct stream_mesh *mesh,
			uint32_t first, uint32_t count)
{
	float middle[3] = { 0 };

	for (uint32_t v = first; v < first + count; v++)
		for (int i = 0; i < 3; i++)
			middle[i] += (float)mesh->vertices[v].position[i] / (float)count;
	for (uint32_t v = first; v < first + count; v++) {
		growth->from[v] = vertex_of(&mesh->vertices[v]);
		memcpy(growth->from[v].place, middle, sizeof(middle));
	}
}

static void take_triangles(struct stream_growth *growth, const struct stream_mesh *mesh)
{
	growth->triangle_count = mesh->triangle_count;
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		for (uint32_t c = 0; c < 3; c++)
			growth->indices[3 * t + c] = (uint16_t)mesh->triangles[t][c];
}

/* Shows the base, whole. */
static void begin_base(struct stream_growth *growth, const struct stream_mesh *mesh)
{
	stream_decoder_show(growth->decoder, 0);
	growth->vertex_count = growth->first_moving = mesh->vertex_count;
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		growth->shown[v] = vertex_of(&mesh->vertices[v]);
	growth->share = 1;
}

/* Takes all that has been decoded; its vertices start where they change nothing. */
static void begin_records(struct stream_growth *growth, const struct stream_mesh *mesh)
{
	const struct stream_record *records = stream_decoder_list(growth->decoder);
	const uint32_t count = stream_decoder_records(growth->decoder);
	uint32_t vertex = growth->vertex_count;

	stream_decoder_show(growth->decoder, count);
	for (uint32_t v = 0; v < vertex; v++)
		growth->from[v] = growth->shown[v];
	for (uint32_t r = growth->record_count; r < count; r++) {
		const struct stream_record *record = &records[r];

		if (record->target == STREAM_NONE) {
			start_piece(growth, mesh, vertex, record->moved);
			vertex += record->moved;
		} else {
			growth->from[vertex++] = growth->from[record->target];
		}
	}
	growth->first_moving = growth->vertex_count;
	growth->vertex_count = mesh->vertex_count;
	growth->record_count = count;
	growth->share = 0;
}

static void mix(struct stream_vertex *out, const struct stream_vertex *from,
		const struct patch_vertex *to, float share)
{
	float normal[3], end[3];

	for (int i = 0; i < 3; i++)
		out->place[i] = from->place[i] + share * ((float)to->position[i] - from->place[i]);
	for (int i = 0; i < 4; i++)
		out->colour[i] = (uint8_t)((float)from->colour[i] +
					   share * (float)(to->colour[i] - from->colour[i]) + 0.5f);
	normal_decode(normal, from->normal);
	normal_decode(end, to->normal);
	for (int i = 0; i < 3; i++)
		normal[i] += share * (end[i] - normal[i]);
	normal_encode(out->normal, normal);
}

static void move(struct stream_growth *growth, const struct stream_mesh *mesh)
{
	for (uint32_t v = growth->first_moving; v < growth->vertex_count; v++)
		if (growth->share < 1)
			mix(&growth->shown[v], &growth->from[v], &mesh->vertices[v], growth->share);
		else
			growth->shown[v] = vertex_of(&mesh->vertices[v]);
}

void stream_growth_step(struct stream_growth *growth, float passed_ms, struct stream_change *out)
{
	const struct stream_mesh *mesh;

	*out = (struct stream_change){ 0 };
	if (!growth->decoder)
		return;
	mesh = stream_decoder_mesh(growth->decoder);
	if (growth->vertex_count == 0) {
		begin_base(growth, mesh);
		out->vertices = growth->vertex_count;
	} else if (growth->share < 1) {
		growth->share += passed_ms / STREAM_GROW_MS;
		growth->share = growth->share < 1 ? growth->share : 1;
		move(growth, mesh);
		out->first_vertex = growth->first_moving;
		out->vertices = growth->vertex_count - growth->first_moving;
		return;
	} else if (growth->record_count < stream_decoder_records(growth->decoder)) {
		begin_records(growth, mesh);
		move(growth, mesh);
		out->vertices = growth->vertex_count;
	} else {
		return;
	}
	take_triangles(growth, mesh);
	out->triangles = true;
}

bool stream_growth_moves(const struct stream_growth *growth)
{
	return growth->decoder && (growth->vertex_count == 0 || growth->share < 1 ||
				   growth->record_count < stream_decoder_records(growth->decoder));
}

float stream_growth_error_m(const struct stream_growth *growth, uint32_t blocks)
{
	return stream_page_error_m(&growth->start, blocks);
}
