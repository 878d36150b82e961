/* Chooses which sampling points colour a piece of surface, and which tiles would improve it most.
 * Pure: no GL; what it needs to know of the world comes through callbacks.
 *
 * After "Unstructured Lumigraph Rendering" (Buehler et al., 2001): every face of every sampling
 * point may colour any piece. Its quality at a point of the surface falls with
 *   blur      how much coarser its pixels lie on the surface than the screen's
 *   parallax  how many pixels the mesh's own error shifts it, seen from the eye
 *   angle     between the two lines of sight
 * and is 0 where it sees the back of the surface, or does not see it. The patch's own colours have
 * a quality too, by the distance of their vertices: images are chosen and fetched for what they add
 * to it. docs/lumigraph.md has the formula and the measurements behind its constants; the vertex
 * shader of render/lumigraph/surface.c computes the same formula. */
#ifndef GOPURA_RENDER_PLAN_PLAN_H
#define GOPURA_RENDER_PLAN_PLAN_H

#include "geometry/patch_bvh.h"
#include "render/plan/plan_quality.h"
#include "render/plan/repository.h"

enum {
	PLAN_ENTRIES = 4, /* faces blended on a piece */
	PLAN_WANTS = 3,
	PLAN_SIGHTS = 32, /* sampling points whose rays a piece remembers; direct-mapped */
};

/* A rectangle of a face, -1..1. */
struct plan_area {
	float u0, v0, u1, v1;
};

/* Writes the area of a face that a piece covers. Returns false where it covers nothing. */
bool plan_footprint(struct plan_area *out, face_key face, const float sample_m[3],
		    const struct piece *piece);

struct plan_sight {
	uint16_t point;      /* the point's number without its lowest bits, + 1; 0: free */
	uint8_t known, seen; /* bit masks of probes: ray was cast, and hit nothing */
};

struct plan_entry {
	face_key face;
	float half_px; /* of the resident level on the piece */
	float share;   /* factor for its weight, 0..1; below 1 only for the eight corners */
};

struct plan_want {
	face_key face;
	uint8_t level;
	struct plan_area area; /* that the piece covers on the face */
	float gain;            /* 0..1: improvement of the picture of the piece */
};

/* What is chosen for a piece; it also caches which points see it. A zeroed one is new. */
struct plan_choice {
	struct plan_entry entry[PLAN_ENTRIES];
	uint32_t entry_count;
	struct plan_want want[PLAN_WANTS];
	uint32_t want_count;
	struct plan_sight sight[PLAN_SIGHTS];
};

struct plan_world {
	const struct repository *repository;
	/* The faces with tiles on the GPU; borrowed. */
	const face_key *resident;
	uint32_t resident_count;
	/* Returns the finest resident level at a place of a resident face, -1: none. */
	int (*level_at)(void *data, face_key face, float u, float v);
	/* Returns whether nothing lies between a sampling point and a point of the surface. */
	bool (*sees)(void *data, const float sample_m[3], const float point_m[3]);
	void *data;
};

/* A piece as seen from the eye. */
struct plan_surface {
	const struct piece *piece;
	float error_m;                   /* of the mesh shown there */
	const struct piece_probe *probe; /* PIECE_PROBES points on it; borrowed */
	/* share of the visible area near each probe; the sum is 1 */
	float weight[PIECE_PROBES];
};

/* Forgets what is known of a probe, because it moved. */
void plan_forget_probe(struct plan_choice *choice, int probe);
/* Chooses entries and wants of a piece. An entry that is chosen already is kept if it is about as
 * good as another. */
void plan_piece(struct plan_choice *choice, const struct plan_world *world,
		const struct plan_eye *eye, const struct plan_surface *surface);
/* The method of the paper instead: the sampling points of the grid cell around the eye, with
 * trilinear weights, which entry.share then holds. */
void plan_piece_corners(struct plan_choice *choice, const struct plan_world *world,
			const struct plan_eye *eye, const struct plan_surface *surface);

#endif
