/* The parts of a model on the surface of its scan: which place of it is in which part, and how far
 * from the part's outline. Patches of any level and size are labelled from it, so that parts
 * outlive every hierarchy. */
#ifndef GOPURA_PIPELINE_RELEASE_LABEL_SOURCE_H
#define GOPURA_PIPELINE_RELEASE_LABEL_SOURCE_H

#include "geometry/region.h"
#include "pipeline/import/mesh.h"
#include "pipeline/release/nearest.h"

/* A part as it is given: a volume, which has the surface within it, or some triangles. */
struct label_source_part {
	const char *id;            /* borrowed while the source lives */
	struct region region;      /* where triangles is NULL */
	const uint32_t *triangles; /* of the mesh, ascending; borrowed likewise */
	uint32_t triangle_count;
	/* Found by label_source_create: */
	float centre_m[3], radius_m; /* a sphere around all of it */
	float area_m2;               /* of its surface */
};

struct label_source;

/* mesh is borrowed while the source lives. *out is owned by the caller; NULL on failure. -ENOMEM.
 */
must_check int label_source_create(struct label_source **out, const struct mesh *mesh,
				   const struct label_source_part *parts, uint32_t part_count);
void label_source_destroy(struct label_source *source); /* NULL is fine */

uint32_t label_source_part_count(const struct label_source *source);
/* The side of a square that two of the scan's triangles would make: as fine as it is. */
float label_source_spacing_m(const struct label_source *source);
const struct label_source_part *label_source_part(const struct label_source *source, uint32_t part);

/* The place of the scan that a point of a simplified surface stands for: the nearest that shows the
 * same side, so that the two sides of a wall are not taken for one another. off_m: simplification
 * may have moved it so far, through a thin wall too. Any thread. */
void label_source_place(const struct label_source *source, const float point_m[3],
			const float normal[3], float off_m, struct nearest_place *out);
/* How far within a part a place of the scan is: metres to its outline, below 0 outside. Exact up
 * to most_m on either side, beyond no less than that. Any thread. */
float label_source_within(const struct label_source *source, uint32_t part,
			  const struct nearest_place *place, float most_m);

#endif
