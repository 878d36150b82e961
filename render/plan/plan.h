/* Which sampling points colour a piece of surface, and which tiles would mend it most (pure; no
 * GL, no repository: what is known of the world comes through callbacks).
 *
 * After "Unstructured Lumigraph Rendering" (Buehler et al., 2001): every face of every sampling
 * point may colour any piece. Its quality at a point of the surface falls with
 *   blur      how much coarser its pixels lie on the surface than the screen's
 *   parallax  how many pixels the mesh's own error shifts it, seen from the eye
 *   angle     between the two lines of sight
 * and is nothing where it sees the back, or not at all. The patch's own colours have a quality too,
 * by the distance of their vertices: images are chosen and fetched for what they add to it.
 * docs/lumigraph.md has the formula and the measurements behind its constants; the vertex shader
 * holds its twin. */
#ifndef GOPURA_RENDER_PLAN_PLAN_H
#define GOPURA_RENDER_PLAN_PLAN_H

#include "geometry/patch_bvh.h"
#include "render/plan/repository.h"

enum {
	PLAN_ENTRIES = 4, /* faces blended on a piece */
	PLAN_WANTS = 3,
	PLAN_SIGHTS = 32, /* remembered rays of a piece: sampling points, direct-mapped */
};

struct plan_eye {
	float eye_m[3];
	float focal_px;
	float texels; /* asked for a pixel of the screen: more are sharper, and dearer */
};

/* The constants of the quality; plan_tuning is what the product uses. */
struct plan_tuning {
	float blur, parallax, angle, own;
	float facing_low, facing_high; /* cosine at the surface: nothing below, all above */
};
extern const struct plan_tuning plan_tuning;

/* 0..1 of a sampling point, half_px pixels a unit of tangent, at a point of the surface whose
 * mesh is wrong by error_m. */
float plan_quality(const struct plan_eye *eye, const float point_m[3], const float normal[3],
		   const float sample_m[3], float half_px, float error_m);
/* The same scale for the patch's own colours, whose vertices are spacing_m apart. */
float plan_own_quality(const struct plan_eye *eye, const float point_m[3], float spacing_m);
/* What an image of one quality is worth where something of another would be shown instead, 0..1:
 * octaves of detail, of which a picture has about eight. */
float plan_worth(float quality, float instead);
/* Pixels a unit of tangent that a face must have to be as sharp there as the screen. */
float plan_needed_half_px(const struct plan_eye *eye, const float point_m[3], const float normal[3],
			  const float sample_m[3]);
/* Coarsest level that is sharp enough, or the finest there is. */
uint32_t plan_level(float needed_half_px, uint32_t level_count);
/* Half the side of a face's picture at the level, pixels. */
float plan_level_half_px(uint32_t level);

/* A rectangle of a face, -1..1. */
struct plan_area {
	float u0, v0, u1, v1;
};

/* What a piece covers of a face; false: nothing. */
bool plan_footprint(struct plan_area *out, face_key face, const float sample_m[3],
		    const struct piece *piece);

struct plan_sight {
	uint16_t point;      /* all but its lowest bits, + 1; 0: none */
	uint8_t known, seen; /* bit per probe */
};

struct plan_entry {
	face_key face;
	float half_px; /* of the level that is resident on the piece */
	float share; /* of its weight that it may have, 0..1; below 1 only for the eight corners */
};

struct plan_want {
	face_key face;
	uint8_t level;
	struct plan_area area; /* of the piece on the face */
	float gain;            /* 0..1: what the picture of the piece would win */
};

/* What is chosen for a piece; also remembers what it saw. Zeroed is new. */
struct plan_choice {
	struct plan_entry entry[PLAN_ENTRIES];
	uint32_t entry_count;
	struct plan_want want[PLAN_WANTS];
	uint32_t want_count;
	struct plan_sight sight[PLAN_SIGHTS];
};

struct plan_world {
	const struct repository *repository;
	/* Faces with tiles on the GPU. */
	const face_key *resident;
	uint32_t resident_count;
	/* Finest resident level at a place of a resident face, -1: none. */
	int (*level_at)(void *data, face_key face, float u, float v);
	/* Whether nothing is between a sampling point and a point of the surface. */
	bool (*sees)(void *data, const float sample_m[3], const float point_m[3]);
	void *data;
};

/* A piece as the eye has it before it. */
struct plan_surface {
	const struct piece *piece;
	float error_m;                   /* of the mesh that is shown there */
	const struct piece_probe *probe; /* PIECE_PROBES places of it */
	float weight[PIECE_PROBES];      /* how much of what shows is near each; their sum is 1 */
};

/* Another place is probed: what was known of the old one is forgotten. */
void plan_forget_probe(struct plan_choice *choice, int probe);
/* Entries that are chosen now are kept on a near draw. */
void plan_piece(struct plan_choice *choice, const struct plan_world *world,
		const struct plan_eye *eye, const struct plan_surface *surface);
/* The paper's way instead: the sampling points of the grid cell around the eye, by trilinear
 * weight (which is what entry.share then holds). */
void plan_piece_corners(struct plan_choice *choice, const struct plan_world *world,
			const struct plan_eye *eye, const struct plan_surface *surface);

/* gain: pixels x 0..1 that a fetch of `bytes` mends -> a priority, MESSAGE_PRIORITY_PICTURE and
 * above, below MESSAGE_PRIORITY_INDEX; monotonic in gain per byte. */
uint32_t plan_priority(float gain, uint32_t bytes);

#endif
