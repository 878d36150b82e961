/* The patches that are loaded: on the GPU for drawing, in memory for rays, and what each piece of
 * them is coloured by. Counted in bytes of both; past the budget the groups that were of no use
 * for longest go, finest first, never one that a shown or wanted cut stands on. */
#ifndef GOPURA_RENDER_PATCHES_PATCH_BUFFERS_H
#define GOPURA_RENDER_PATCHES_PATCH_BUFFERS_H

#include "format/hierarchy.h"
#include "render/display/gl.h"
#include "render/patches/cut.h"
#include "render/patches/outline_lines.h"
#include "render/patches/pool.h"
#include "render/plan/plan.h"

/* One of the faces blended on a piece, fading in and out. */
struct blend {
	face_key face;
	float half_px;
	float weight, target; /* 0..1 */
	bool held;
};

struct piece_state {
	struct plan_choice choice;
	struct blend blend[PLAN_ENTRIES];
	float seen_px; /* of the screen, by the last census that had it in the frustum */
	struct piece_probe probe[PIECE_PROBES]; /* move to where it shows */
	float weight[PIECE_PROBES];
	float stray_m[3], stray_off_m; /* what shows farthest from any probe */
	bool counted;                  /* by any census */
	bool planned, orphan;          /* orphan: a face it was blended from is gone */
	uint32_t planned_epoch;        /* of the world, when it was */
	uint32_t planned_versions;     /* sum over the faces it wants */
	float planned_eye_m[3];
};

/* Which sides of a patch's triangles have been seen to show. */
enum geometry_sides {
	SIDES_UNKNOWN, /* nobody looked */
	SIDES_FRONT,
	SIDES_BOTH, /* a back, through a scan's rim: this stays */
};

struct geometry_patch {
	GLuint vertices, indices;
	struct pool_patch content;
	struct piece_state *pieces; /* owned; one per content.solid.pieces */
	enum geometry_sides sides;
	struct outline_lines lines; /* the outline of the part that was marked last */
};

struct geometry {
	const struct hierarchy *hierarchy; /* borrowed */
	struct geometry_patch *patches;    /* per patch of the hierarchy; owned, as all below */
	uint8_t *loaded;                   /* per group */
	struct label_group *labels;        /* per group; without patches: not here */
	uint64_t *group_bytes;
	uint32_t *group_stamp; /* last frame it was of use */
	uint64_t bytes;
	uint64_t changes; /* of what is loaded, so far */
	uint32_t stamp;
};

must_check int geometry_init(struct geometry *geometry, const struct hierarchy *hierarchy);
void geometry_finish(struct geometry *geometry);

/* Takes the answer's patches. -EBADMSG: they are not what the hierarchy says; -ENOMEM. On failure
 * nothing is taken. */
must_check int geometry_put(struct geometry *geometry, uint32_t group, struct pool_answer *answer);
/* Takes the labels of a group; of one that was dropped meanwhile they are dropped too. -EBADMSG:
 * they are not of its patches. */
must_check int geometry_label(struct geometry *geometry, uint32_t group,
			      struct label_group *labels);
/* Marks what a cut stands on, then drops groups until the budget holds. */
void geometry_evict(struct geometry *geometry, const struct cut *cut, uint64_t budget_bytes);

/* Binds buffers; attribute 0 position, 1 normal (raw octahedral), 2 colour. */
void geometry_bind(const struct geometry *geometry, uint32_t patch);
/* Backs are not drawn where only fronts show: half of a closed model's triangles. Otherwise, and
 * when the last patch is drawn (geometry_cull_none), both are. */
void geometry_cull(const struct geometry *geometry, uint32_t patch);
void geometry_cull_none(void);
/* A run of a bound patch's triangles. */
void geometry_draw(uint32_t first_triangle, uint32_t triangle_count);

struct geometry_hit {
	uint32_t patch;
	struct patch_bvh_hit on;
};

/* Nearest hit among the listed patches between least_m and *distance_m, which becomes it; *hit (may
 * be NULL) says where. */
bool geometry_ray(const struct geometry *geometry, const struct cut *cut, const float from_m[3],
		  const float direction[3], float least_m, float *distance_m,
		  struct geometry_hit *hit);
/* Whether any of them is met before most_m. */
bool geometry_blocks(const struct geometry *geometry, const struct cut *cut, const float from_m[3],
		     const float direction[3], float most_m);

#endif
