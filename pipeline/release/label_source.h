/* The parts of a model on the surface of its scan: which point of the surface is in which part, and
 * how far from the part's outline. Patches of any level and size are labelled from it, so that the
 * definition of parts does not depend on the hierarchy. */
#ifndef GOPURA_PIPELINE_RELEASE_LABEL_SOURCE_H
#define GOPURA_PIPELINE_RELEASE_LABEL_SOURCE_H

#include "format/hash.h"
#include "geometry/region.h"
#include "pipeline/import/mesh.h"
#include "pipeline/release/nearest.h"

/* The definition of a part: either a volume, which contains the surface inside it, or a list of
 * triangles. */
struct label_source_part {
	const char *id;            /* borrowed for the source's lifetime */
	struct region region;      /* used if triangles is NULL */
	bool is_list;              /* a list of triangles */
	struct hash list;          /* what the list is made from; zero if it is none */
	const uint32_t *triangles; /* triangles of the mesh, ascending; borrowed likewise */
	uint32_t triangle_count;
	/* Set by label_source_create: */
	float centre_m[3], radius_m; /* bounding sphere */
	float area_m2;               /* area of its surface */
};

struct label_source;

/* Copies the definitions of the parts and prepares the search structures. mesh is borrowed for the
 * source's lifetime. *out is owned by the caller; NULL on failure. Returns -ENOMEM. */
must_check int label_source_create(struct label_source **out, const struct mesh *mesh,
				   const struct label_source_part *parts, uint32_t part_count);
void label_source_destroy(struct label_source *source); /* NULL is fine */

/* Number of parts. */
uint32_t label_source_part_count(const struct label_source *source);
/* Returns the mean size of the scan's triangles: the side of a square made of two of them,
 * metres. */
float label_source_spacing_m(const struct label_source *source);
/* Returns a part by number; borrowed. */
const struct label_source_part *label_source_part(const struct label_source *source, uint32_t part);

/* Finds the point of the scan that a point of a simplified surface represents: the nearest one
 * whose surface faces the same way as normal, so that the two sides of a wall are not confused.
 * off_m: how far simplification may have moved the point, even through a thin wall; metres. Any
 * thread. */
void label_source_place(const struct label_source *source, const float point_m[3],
			const float normal[3], float off_m, struct nearest_place *out);
/* Returns how far inside a part a point of the scan is: metres to the part's outline, negative
 * outside. It is exact up to most_m on either side, and at least most_m beyond that. Any thread. */
float label_source_within(const struct label_source *source, uint32_t part,
			  const struct nearest_place *place, float most_m);

#endif
