/* Bits, and the differences between their states. */
#include "curator/region/region_set.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/spill.h"

static uint32_t word_count(const struct region_set *set)
{
	return set->triangle_count / 64 + 1;
}

int region_set_init(struct region_set *set, uint32_t triangle_count)
{
	*set = (struct region_set){ .triangle_count = triangle_count };
	set->bits = calloc(word_count(set), sizeof(*set->bits));
	set->wanted = calloc(word_count(set), sizeof(*set->wanted));
	if (!set->bits || !set->wanted) {
		region_set_finish(set);
		return -ENOMEM;
	}
	return 0;
}

static void drop_steps(struct region_set *set, uint32_t from)
{
	for (uint32_t n = from; n < set->step_count; n++)
		free(set->steps[n].ranges);
	set->step_count = from;
}

void region_set_finish(struct region_set *set)
{
	if (!set)
		return;
	drop_steps(set, 0);
	free(set->steps);
	free(set->bits);
	free(set->wanted);
	*set = (struct region_set){ 0 };
}

/* ---- a change */

void region_set_begin(struct region_set *set)
{
	memcpy(set->wanted, set->bits, word_count(set) * sizeof(*set->bits));
}

void region_set_put(struct region_set *set, uint32_t triangle, bool in)
{
	const uint64_t bit = (uint64_t)1 << triangle % 64;

	if (in)
		set->wanted[triangle / 64] |= bit;
	else
		set->wanted[triangle / 64] &= ~bit;
}

void region_set_put_all(struct region_set *set, bool in)
{
	memset(set->wanted, in ? 0xff : 0, word_count(set) * sizeof(*set->wanted));
	if (in) /* none beyond the last */
		set->wanted[set->triangle_count / 64] =
			((uint64_t)1 << set->triangle_count % 64) - 1;
}

static int add_to_step(struct region_step *step, uint32_t triangle)
{
	int rc;

	if (step->count > 0 && step->ranges[step->count - 1].last + 1 == triangle) {
		step->ranges[step->count - 1].last = triangle;
		return 0;
	}
	rc = ARRAY_RESERVE(step->ranges, step->room, step->count + 1, UINT32_MAX);
	if (rc == 0)
		step->ranges[step->count++] = (struct face_range){ triangle, triangle };
	return rc;
}

static int find_difference(const struct region_set *set, struct region_step *step)
{
	int rc = 0;

	for (uint32_t w = 0; rc == 0 && w < word_count(set); w++) {
		uint64_t flipped = set->bits[w] ^ set->wanted[w];

		for (; rc == 0 && flipped; flipped &= flipped - 1)
			rc = add_to_step(step, 64 * w + (uint32_t)__builtin_ctzll(flipped));
	}
	return rc;
}

static void flip(struct region_set *set, const struct region_step *step)
{
	for (uint32_t n = 0; n < step->count; n++)
		for (uint32_t t = step->ranges[n].first; t <= step->ranges[n].last; t++) {
			set->bits[t / 64] ^= (uint64_t)1 << t % 64;
			set->count += region_set_has(set, t) ? 1 : UINT32_MAX;
		}
}

int region_set_commit(struct region_set *set)
{
	struct region_step step = { 0 };
	int rc = find_difference(set, &step);

	if (rc == 0 && step.count > 0)
		rc = ARRAY_RESERVE(set->steps, set->step_room, set->done_count + 1, UINT32_MAX);
	if (rc < 0 || step.count == 0) {
		free(step.ranges);
		return rc;
	}
	drop_steps(set, set->done_count);
	set->steps[set->step_count++] = step;
	set->done_count++;
	flip(set, &step);
	return 0;
}

bool region_set_undo(struct region_set *set)
{
	if (set->done_count == 0)
		return false;
	flip(set, &set->steps[--set->done_count]);
	return true;
}

bool region_set_redo(struct region_set *set)
{
	if (set->done_count == set->step_count)
		return false;
	flip(set, &set->steps[set->done_count++]);
	return true;
}

void region_set_forget(struct region_set *set)
{
	drop_steps(set, 0);
	set->done_count = 0;
}

/* ---- rings */

/* Puts every triangle that shares a vertex with one that is (inside) or is not in the region. */
static int put_ring(struct region_set *set, const struct mesh *mesh, bool inside)
{
	uint64_t *touched = calloc(mesh->vertex_count / 64 + 1, sizeof(*touched));

	if (!touched)
		return -ENOMEM;
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		for (int k = 0; region_set_has(set, t) == inside && k < 3; k++)
			touched[mesh->triangles[t][k] / 64] |= (uint64_t)1
							       << mesh->triangles[t][k] % 64;
		spill_pass(t);
	}
	region_set_begin(set);
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		for (int k = 0; k < 3; k++)
			if (touched[mesh->triangles[t][k] / 64] >> mesh->triangles[t][k] % 64 & 1)
				region_set_put(set, t, inside);
		spill_pass(t);
	}
	free(touched);
	return region_set_commit(set);
}

int region_set_grow(struct region_set *set, const struct mesh *mesh)
{
	return put_ring(set, mesh, true);
}

int region_set_shrink(struct region_set *set, const struct mesh *mesh)
{
	return put_ring(set, mesh, false);
}

/* ---- faces */

static void take_face_of(uint64_t *faces, const struct region_set *set, const struct mesh *mesh,
			 uint32_t triangle, uint32_t face_count)
{
	const uint32_t face = mesh->faces[triangle];

	if (face < face_count && region_set_has(set, triangle))
		faces[face / 64] |= (uint64_t)1 << face % 64;
}

int region_set_faces(struct face_list *out, const struct region_set *set, const struct mesh *mesh,
		     uint32_t scan)
{
	const uint32_t face_count = mesh->scans[scan].face_count;
	struct region_step ranges = { 0 };
	uint32_t first = 0;
	uint64_t *faces;
	int rc = 0;

	*out = (struct face_list){ 0 };
	if (!mesh->faces || face_count == 0)
		return 0;
	faces = calloc(face_count / 64 + 1, sizeof(*faces));
	if (!faces)
		return -ENOMEM;
	for (uint32_t s = 0; s < scan; s++)
		first += mesh->scans[s].triangle_count;
	for (uint32_t t = first; t < first + mesh->scans[scan].triangle_count; t++)
		take_face_of(faces, set, mesh, t, face_count);
	for (uint32_t face = 0; rc == 0 && face < face_count; face++)
		if (faces[face / 64] >> face % 64 & 1)
			rc = add_to_step(&ranges, face);
	free(faces);
	if (rc < 0) {
		free(ranges.ranges);
		return rc;
	}
	*out = (struct face_list){ .ranges = ranges.ranges, .count = ranges.count };
	return 0;
}
