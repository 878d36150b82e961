/* The surface of a scan in pieces that are drawn, culled and summed one by one. It comes from the
 * whole mesh cut into chunks (chunks.h), which scans with pictures need, or from the patches of the
 * master (model_master.h), where few triangles stand for what is far away. A piece's triangles
 * are only in memory while they are used, so a surface may be larger than memory.
 *
 * One thread; processes that are forked may each use theirs. */
#ifndef GOPURA_PIPELINE_SAMPLES_MODEL_H
#define GOPURA_PIPELINE_SAMPLES_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"

/* As uploaded: 20 bytes. */
struct model_vertex {
	float position_m[3];
	int8_t normal[4];  /* unit vector times 127; area-weighted mean of the adjacent triangles */
	uint8_t colour[4]; /* sRGB; [3] is the share of open sky */
};

struct model_piece {
	float low_m[3], high_m[3]; /* encloses its vertices */
	uint16_t texture;          /* index into the mesh's textures */
	/* For the winding number at a distance: the sum of the triangles' areas times their
	 * normals, the area-weighted centre, and the radius around it; radius_m < 0: not summed
	 * yet. */
	float area_m2[3], middle_m[3], radius_m;
};

/* The triangles of a piece. */
struct model_mesh {
	uint32_t vertex_count, index_count; /* 3 indices per triangle */
	const struct model_vertex *vertices;
	const float (*uvs)[2]; /* NULL: no texture coordinates */
	const uint16_t *indices;
};

struct model;

/* What a source of surfaces does. */
struct model_methods {
	/* As model_choose. */
	uint32_t (*choose)(const struct model *model, const float eye_m[3], float detail_rad,
			   uint32_t *pieces);
	/* As model_load. */
	int (*load)(struct model *model, uint32_t piece, struct model_mesh *out);
	/* Frees the model. */
	void (*destroy)(struct model *model);
};

/* The first member of what a source makes. */
struct model {
	const struct model_methods *methods;
	uint32_t piece_count;
	struct model_piece *pieces; /* owned by the source */
	float low_m[3], high_m[3];  /* bounding box of all pieces */
};

/* Chooses the pieces that show the surface to an eye: together they cover it exactly once. Where
 * detail_rad is above 0, their vertices are mostly no farther apart, and their places no farther
 * from the scan's than half of that, than detail_rad seen from the eye; 0: the finest. pieces has
 * room for piece_count numbers. Returns how many were chosen, in ascending order. */
uint32_t model_choose(const struct model *model, const float eye_m[3], float detail_rad,
		      uint32_t *pieces);

/* Gets the triangles of a piece. *out is borrowed until the next call on the model. Returns
 * -EBADMSG if the master is damaged, -ENOMEM, or an error of the disk. */
must_check int model_load(struct model *model, uint32_t piece, struct model_mesh *out);

/* Computes the generalised winding number of a point from the chosen pieces (Jacobson et al. 2013;
 * distant pieces are dipoles, as in Barill et al. 2018). It is about 0 outside, 1 inside, and more
 * where layers overlap. It stays meaningful for open and self-intersecting scans. Errors as
 * model_load. */
must_check int model_winding(struct model *model, const uint32_t *pieces, uint32_t count,
			     const float point_m[3], double *out);

void model_destroy(struct model *model); /* NULL is fine */

/* For sources: sets the box of a piece. */
void model_bound(struct model_piece *piece, const struct model_mesh *mesh);
/* For sources: sets the sums of a piece for winding numbers. */
void model_sum(struct model_piece *piece, const struct model_mesh *mesh);

#endif
