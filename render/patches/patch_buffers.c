/* Uploads decoded groups, keeps them within a budget, binds and draws them, and runs ray queries
 * over the shown ones. */
#include "render/patches/patch_buffers.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

int geometry_init(struct geometry *geometry, const struct hierarchy *hierarchy)
{
	memset(geometry, 0, sizeof(*geometry));
	geometry->hierarchy = hierarchy;
	size_t groups = hierarchy->group_count + 1;
	geometry->patches = calloc(hierarchy->patch_count + 1, sizeof(*geometry->patches));
	geometry->loaded = calloc(groups, 1);
	geometry->labels = calloc(groups, sizeof(*geometry->labels));
	geometry->group_bytes = calloc(groups, sizeof(*geometry->group_bytes));
	geometry->group_stamp = calloc(groups, sizeof(*geometry->group_stamp));
	if (geometry->patches && geometry->loaded && geometry->labels && geometry->group_bytes &&
	    geometry->group_stamp)
		return 0;
	geometry_finish(geometry);
	return -ENOMEM;
}

static void patch_finish(struct geometry_patch *patch)
{
	if (patch->vertices)
		glDeleteBuffers(1, &patch->vertices);
	if (patch->indices)
		glDeleteBuffers(1, &patch->indices);
	if (patch->wide)
		glDeleteBuffers(1, &patch->wide);
	part_buffers_finish(&patch->part);
	pool_patch_finish(&patch->content);
	free(patch->pieces);
	memset(patch, 0, sizeof(*patch));
}

void geometry_finish(struct geometry *geometry)
{
	for (uint32_t i = 0; geometry->patches && i < geometry->hierarchy->patch_count; i++)
		patch_finish(&geometry->patches[i]);
	for (uint32_t g = 0; geometry->labels && g < geometry->hierarchy->group_count; g++)
		label_group_finish(&geometry->labels[g]);
	free(geometry->patches);
	free(geometry->labels);
	free(geometry->loaded);
	free(geometry->group_bytes);
	free(geometry->group_stamp);
	memset(geometry, 0, sizeof(*geometry));
}

/* ---- loading */

/* Uploads a patch. Afterwards only the GPU holds the vertices; the BVH has its own copy of the
 * positions. */
static int upload(struct geometry_patch *patch)
{
	const struct patch_mesh *mesh = &patch->content.mesh;
	const struct patch_bvh *bvh = &patch->content.bvh;
	glGenBuffers(1, &patch->vertices);
	glBindBuffer(GL_ARRAY_BUFFER, patch->vertices);
	glBufferData(GL_ARRAY_BUFFER,
		     (GLsizeiptr)(mesh->vertex_count * sizeof(*patch->content.vertices)),
		     patch->content.vertices, GL_STATIC_DRAW);
	if (bvh->wide) {
		glGenBuffers(1, &patch->wide);
		glBindBuffer(GL_ARRAY_BUFFER, patch->wide);
		glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(mesh->vertex_count * sizeof(*bvh->wide)),
			     bvh->wide, GL_STATIC_DRAW);
	}
	glGenBuffers(1, &patch->indices);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, patch->indices);
	glBufferData(GL_ELEMENT_ARRAY_BUFFER,
		     (GLsizeiptr)(3 * mesh->triangle_count * sizeof(*mesh->indices)), mesh->indices,
		     GL_STATIC_DRAW);
	free(patch->content.vertices);
	patch->content.vertices = NULL;
	return gl_check("uploading a patch");
}

static size_t patch_bytes(const struct geometry_patch *patch)
{
	const struct patch_mesh *mesh = &patch->content.mesh;
	size_t indices = 3 * mesh->triangle_count * sizeof(*mesh->indices);
	size_t vertex = sizeof(*patch->content.vertices);
	if (patch->content.bvh.wide)
		vertex += sizeof(*patch->content.bvh.wide);
	return mesh->vertex_count * vertex + 2 * indices + patch_bvh_bytes(&patch->content.bvh) +
	       patch->content.bvh.piece_count * sizeof(*patch->pieces);
}

static bool is_as_announced(const struct geometry *geometry, uint32_t group,
			    const struct pool_answer *answer)
{
	const struct hierarchy_group *g = &geometry->hierarchy->groups[group];
	if (answer->patch_count != g->patch_count)
		return false;
	for (uint32_t i = 0; i < g->patch_count; i++) {
		const struct patch_mesh *mesh = &answer->patches[i].mesh;
		const struct hierarchy_patch *said =
			&geometry->hierarchy->patches[g->first_patch + i];
		if (mesh->triangle_count != said->triangle_count ||
		    mesh->vertex_count != said->vertex_count)
			return false;
	}
	return true;
}

static void unload(struct geometry *geometry, uint32_t group)
{
	const struct hierarchy_group *g = &geometry->hierarchy->groups[group];
	for (uint32_t i = 0; i < g->patch_count; i++)
		patch_finish(&geometry->patches[g->first_patch + i]);
	label_group_finish(&geometry->labels[group]);
	geometry->bytes -= geometry->group_bytes[group];
	geometry->group_bytes[group] = 0;
	geometry->changes += geometry->loaded[group];
	geometry->loaded[group] = 0;
}

static void init_pieces(struct geometry_patch *patch)
{
	for (uint32_t i = 0; i < patch->content.bvh.piece_count; i++) {
		const struct piece *piece = &patch->content.bvh.pieces[i];
		for (int k = 0; k < PIECE_PROBES; k++)
			patch->pieces[i].probe[k] = patch_bvh_probe(&patch->content.bvh, piece, k);
	}
}

int geometry_put(struct geometry *geometry, uint32_t group, struct pool_answer *answer)
{
	if (group >= geometry->hierarchy->group_count || !is_as_announced(geometry, group, answer))
		return -EBADMSG;
	if (geometry->loaded[group])
		return 0;
	const struct hierarchy_group *g = &geometry->hierarchy->groups[group];
	int rc = 0;
	for (uint32_t i = 0; i < g->patch_count && rc == 0; i++) {
		struct geometry_patch *patch = &geometry->patches[g->first_patch + i];
		patch->content = answer->patches[i];
		memset(&answer->patches[i], 0, sizeof(answer->patches[i]));
		patch->pieces = calloc(patch->content.bvh.piece_count + 1, sizeof(*patch->pieces));
		rc = patch->pieces ? upload(patch) : -ENOMEM;
		if (rc == 0)
			init_pieces(patch);
		geometry->group_bytes[group] += patch_bytes(patch);
	}
	geometry->bytes += geometry->group_bytes[group];
	if (rc < 0) {
		unload(geometry, group);
		return rc;
	}
	geometry->loaded[group] = 1;
	geometry->changes++;
	geometry->group_stamp[group] = geometry->stamp;
	return 0;
}

static bool are_of(const struct geometry *geometry, uint32_t group,
		   const struct label_group *labels)
{
	const struct hierarchy_group *g = &geometry->hierarchy->groups[group];
	if (labels->patch_count != g->patch_count)
		return false;
	for (uint32_t i = 0; i < g->patch_count; i++)
		if (labels->patches[i].triangle_count !=
		    geometry->hierarchy->patches[g->first_patch + i].triangle_count)
			return false;
	return true;
}

int geometry_label(struct geometry *geometry, uint32_t group, struct label_group *labels)
{
	if (group >= geometry->hierarchy->group_count || !are_of(geometry, group, labels))
		return -EBADMSG;
	if (!geometry->loaded[group] || geometry->labels[group].patch_count > 0)
		return 0;
	geometry->labels[group] = *labels;
	*labels = (struct label_group){ 0 };
	geometry->group_bytes[group] += label_group_bytes(&geometry->labels[group]);
	geometry->bytes += label_group_bytes(&geometry->labels[group]);
	return 0;
}

/* ---- budget */

/* Returns the group desired longest ago, on which no loaded group depends. HIERARCHY_NONE: all are
 * desired now. */
static uint32_t least_useful(const struct geometry *geometry)
{
	const struct hierarchy *h = geometry->hierarchy;
	uint32_t best = HIERARCHY_NONE;
	for (uint32_t g = h->group_count; g-- > 1;) {
		if (!geometry->loaded[g] || geometry->group_stamp[g] == geometry->stamp)
			continue;
		if (best == HIERARCHY_NONE ||
		    geometry->group_stamp[g] < geometry->group_stamp[best])
			best = g; /* among equals the finest: groups come after those they refine */
	}
	return best;
}

void geometry_evict(struct geometry *geometry, const struct cut *cut, uint64_t budget_bytes)
{
	geometry->stamp++;
	for (uint32_t g = 0; g < geometry->hierarchy->group_count; g++)
		if (cut->desired[g])
			geometry->group_stamp[g] = geometry->stamp;
	while (geometry->bytes > budget_bytes) {
		uint32_t group = least_useful(geometry);
		if (group == HIERARCHY_NONE)
			return;
		unload(geometry, group);
	}
}

/* ---- use */

void geometry_bind(const struct geometry *geometry, uint32_t patch)
{
	const struct geometry_patch *p = &geometry->patches[patch];
	glBindBuffer(GL_ARRAY_BUFFER, p->vertices);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, p->indices);
	GLsizei stride = sizeof(struct packed_vertex);
	glVertexAttribPointer(0, 3, GL_UNSIGNED_SHORT, GL_FALSE, stride,
			      (void *)offsetof(struct packed_vertex, position));
	glVertexAttribPointer(1, 2, GL_BYTE, GL_FALSE, stride,
			      (void *)offsetof(struct packed_vertex, normal));
	glVertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride,
			      (void *)offsetof(struct packed_vertex, colour));
	if (p->wide) {
		glBindBuffer(GL_ARRAY_BUFFER, p->wide);
		glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, NULL);
	}
	const int32_t *base = p->content.bvh.base;
	glVertexAttrib3f(3, (float)base[0], (float)base[1], (float)base[2]);
}

void geometry_cull(const struct geometry *geometry, uint32_t patch)
{
	if (geometry->patches[patch].sides == SIDES_FRONT)
		glEnable(GL_CULL_FACE);
	else
		glDisable(GL_CULL_FACE);
}

void geometry_cull_none(void)
{
	glDisable(GL_CULL_FACE);
}

void geometry_draw(struct geometry *geometry, uint32_t first_triangle, uint32_t triangle_count)
{
	glDrawElements(GL_TRIANGLES, (GLsizei)(3 * triangle_count), GL_UNSIGNED_SHORT,
		       (void *)(uintptr_t)(3 * first_triangle * sizeof(uint16_t)));
	throttle_count(&geometry->throttle, triangle_count);
}

bool geometry_ray(const struct geometry *geometry, const struct cut *cut, const float from_m[3],
		  const float direction[3], float least_m, float *distance_m,
		  struct geometry_hit *hit)
{
	bool found = false;
	for (uint32_t i = 0; i < cut->patch_count; i++) {
		uint32_t p = cut->patches[i];
		const struct hierarchy_patch *patch = &geometry->hierarchy->patches[p];
		if (!ray_meets_sphere(from_m, direction, *distance_m, patch->centre_m,
				      patch->radius_m) ||
		    !patch_bvh_ray(&geometry->patches[p].content.bvh, from_m, direction, least_m,
				   distance_m, hit ? &hit->on : NULL))
			continue;
		found = true;
		if (hit)
			hit->patch = p;
	}
	return found;
}

bool geometry_blocks(const struct geometry *geometry, const struct cut *cut, const float from_m[3],
		     const float direction[3], float most_m)
{
	for (uint32_t i = 0; i < cut->patch_count; i++) {
		uint32_t p = cut->patches[i];
		const struct hierarchy_patch *patch = &geometry->hierarchy->patches[p];
		if (ray_meets_sphere(from_m, direction, most_m, patch->centre_m, patch->radius_m) &&
		    patch_bvh_blocks(&geometry->patches[p].content.bvh, from_m, direction, most_m))
			return true;
	}
	return false;
}
