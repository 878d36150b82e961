/* Labels for the little release: one part, by a region, on every patch; and the root page that
 * names them. */
#ifndef GOPURA_TESTS_RENDER_SCENE_LITTLE_LABELS_H
#define GOPURA_TESTS_RENDER_SCENE_LITTLE_LABELS_H

#include "format/label.h"
#include "geometry/region.h"
#include "geometry/vec.h"
#include "tests/render/scene/little_release.h"

enum { LITTLE_LABEL_LEVEL = 4, LITTLE_BORDERS_MAX = 4000 };

/* What a group's labels are made in. */
struct little_labels {
	struct label_group group;
	struct label_part part;
	struct label_set sets[2];
	uint16_t member, in[GROUP_PATCHES_MAX][PATCH_TRIANGLES_MAX];
	struct label_patch patches[GROUP_PATCHES_MAX];
	struct label_border borders[LITTLE_BORDERS_MAX];
	int8_t values[LITTLE_BORDERS_MAX * 200];
};

static inline struct bytes little_bytes(const struct little_release *r, struct hash hash)
{
	for (uint32_t i = 0; i < r->object_count; i++)
		if (hash_equal(r->objects[i].hash, hash))
			return (struct bytes){ r->objects[i].bytes, r->objects[i].size };
	fail_msg("the little release lacks an object");
	return (struct bytes){ 0 };
}

static inline void little_label_triangle(struct little_labels *l, uint32_t p, uint32_t t,
					 const struct patch_mesh *mesh, const struct region *region)
{
	const int n = 1 << LITTLE_LABEL_LEVEL;
	int8_t *values = &l->values[l->group.value_count];
	float corner[3][3], longest = 0;
	uint32_t count = label_values(LITTLE_LABEL_LEVEL), within = 0;

	for (uint32_t k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			corner[k][i] = (float)(little_lattice.origin_m[i] +
					       little_lattice.step_m *
						       mesh->vertices[mesh->indices[3 * t + k]]
							       .position[i]);
	for (int k = 0; k < 3; k++)
		longest = fmaxf(longest, vec_distance(corner[k], corner[(k + 1) % 3]));
	for (int i = 0; i <= n; i++)
		for (int j = 0; j <= n - i; j++) {
			float at[3], steps;

			for (int x = 0; x < 3; x++)
				at[x] = ((float)(n - i - j) * corner[0][x] +
					 (float)i * corner[1][x] + (float)j * corner[2][x]) /
					(float)n;
			steps = floorf(-region_distance(region, at) / longest * (float)n * 3.5f);
			steps = fminf(fmaxf(steps, -4), 3);
			values[label_value_at(LITTLE_LABEL_LEVEL, i, j)] = (int8_t)(2 * steps + 1);
			within += steps >= 0;
		}
	l->in[p][t] = within == count;
	if (within == 0 || within == count)
		return;
	CHECK(l->patches[p].border_count < LITTLE_BORDERS_MAX);
	l->patches[p].borders[l->patches[p].border_count++] = (struct label_border){
		.triangle = (uint16_t)t, .level = LITTLE_LABEL_LEVEL, .first = l->group.value_count
	};
	l->group.value_count += count;
}

static inline struct page_child little_label_group(struct little_release *r, struct hash hash,
						   const char *part, const struct region *region)
{
	static struct little_labels l;
	struct patch_mesh meshes[GROUP_PATCHES_MAX];
	struct page_child child;
	struct buffer out;
	uint32_t count, used = 0;

	memset(&l, 0, sizeof(l));
	CHECK(patch_group_decode(meshes, &count, little_bytes(r, hash)) == 0);
	snprintf(l.part.id, sizeof(l.part.id), "%s", part);
	l.part.area_m2 = 1;
	l.sets[1].count = 1;
	l.group = (struct label_group){ 1,       2,      1,         count,     0,
					&l.part, l.sets, &l.member, l.patches, l.values };
	for (uint32_t p = 0; p < count; p++) {
		l.patches[p] = (struct label_patch){ meshes[p].triangle_count, l.in[p], 0,
						     &l.borders[used] };
		for (uint32_t t = 0; t < meshes[p].triangle_count; t++)
			little_label_triangle(&l, p, t, &meshes[p], region);
		used += l.patches[p].border_count;
		patch_mesh_finish(&meshes[p]);
	}
	buffer_init(&out, OBJECT_BYTES_MAX);
	CHECK(label_group_encode(&out, &l.group) == 0);
	child = little_add(r, &out, false);
	buffer_finish(&out);
	return child;
}

/* Another root page: the same with labels. spoiled: their objects are none. */
static inline void little_label(struct little_release *r, const char *part,
				const struct region *region, bool spoiled)
{
	struct page root, hierarchy;
	struct page_child children[ROOT_CHILDREN_MAX], groups[8], child;
	uint32_t of_group[8];
	struct buffer payload;

	buffer_init(&payload, PAGE_BYTES_MAX);
	CHECK(page_decode(&root, little_bytes(r, r->root)) == 0);
	memcpy(children, root.children, ROOT_CHILD_COUNT * sizeof(*children));
	CHECK(page_decode(&hierarchy, little_bytes(r, children[ROOT_CHILD_HIERARCHY].hash)) == 0);
	CHECK(hierarchy.child_count <= 8);
	for (uint32_t g = 0; g < hierarchy.child_count; g++) {
		of_group[g] = g;
		if (spoiled) {
			buffer_put_u32(&payload, g);
			groups[g] = little_add(r, &payload, false);
		} else {
			groups[g] = little_label_group(r, hierarchy.children[g].hash, part, region);
		}
	}
	label_page_encode(&payload, of_group, hierarchy.child_count);
	children[ROOT_CHILD_LABELS] =
		little_page(r, PAGE_LABELS, groups, hierarchy.child_count, &payload);
	buffer_put(&payload, root.payload.data, root.payload.size);
	child = little_page(r, PAGE_ROOT, children, ROOT_CHILD_LABELS + 1, &payload);
	r->root = child.hash;
	r->root_bytes = child.size;
	buffer_finish(&payload);
	page_finish(&root);
	page_finish(&hierarchy);
}

#endif
