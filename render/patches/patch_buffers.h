/* The loaded patches: in GPU buffers for drawing, in memory for rays, and the state of what colours
 * each of their pieces. Both kinds of memory count. Over the budget, the groups that were desired
 * longest ago are dropped, the finest first among equals; never one that the present cut desires,
 * nor the root group. One thread, with a current GL context. */
#ifndef GOPURA_RENDER_PATCHES_PATCH_BUFFERS_H
#define GOPURA_RENDER_PATCHES_PATCH_BUFFERS_H

#include "format/hierarchy.h"
#include "render/display/gl.h"
#include "render/display/throttle.h"
#include "render/patches/cut.h"
#include "render/patches/part_buffers.h"
#include "render/patches/pool.h"
#include "render/plan/plan.h"

/* One of the faces blended on a piece, while it fades in or out. */
struct blend {
	face_key face;
	float half_px;
	float weight, target; /* 0..1 */
	bool held;
};

struct piece_state {
	struct plan_choice choice;
	struct blend blend[PLAN_ENTRIES];
	/* visible pixels on the screen, from the last visibility pass that had it in the frustum */
	float seen_px;
	struct piece_probe probe[PIECE_PROBES]; /* they move to where the piece is visible */
	float weight[PIECE_PROBES];
	/* the visible point farthest from any probe, and its distance */
	float stray_m[3], stray_off_m;
	bool counted;              /* by any visibility pass */
	bool planned, orphan;      /* orphan: a face it was blended from has been dropped */
	uint32_t planned_epoch;    /* epoch of the world when it was planned */
	uint32_t planned_versions; /* sum of the versions of the faces it wants */
	float planned_eye_m[3];
};

/* Which sides of a patch's triangles have been found visible. */
enum geometry_sides {
	SIDES_UNKNOWN, /* no visibility pass has counted it */
	SIDES_FRONT,
	SIDES_BOTH, /* a back was visible, through an open border of the scan; this is final */
};

struct geometry_patch {
	GLuint vertices, indices;
	GLuint wide; /* positions as floats, of a wide patch (struct packed_vertex); mostly 0 */
	struct pool_patch content;
	struct piece_state *pieces; /* owned; one for each of content.bvh.pieces */
	enum geometry_sides sides;
	struct part_buffers part; /* the area of the part marked last */
};

struct geometry {
	const struct hierarchy *hierarchy; /* borrowed */
	struct geometry_patch *patches;    /* per patch of the hierarchy; owned, as all below */
	uint8_t *loaded;                   /* per group */
	struct label_group *labels;        /* per group; not here where patch_count is 0 */
	uint64_t *group_bytes;
	uint32_t *group_stamp; /* the last round (stamp) in which it was desired */
	uint64_t bytes;
	uint64_t changes; /* counts loads and drops of groups */
	uint32_t stamp;
	struct throttle throttle;
};

/* Initialises it with nothing loaded. The hierarchy is borrowed and must outlive it. -ENOMEM. */
must_check int geometry_init(struct geometry *geometry, const struct hierarchy *hierarchy);
/* Frees everything. */
void geometry_finish(struct geometry *geometry);

/* Takes the patches of the answer and uploads them. A group that is loaded already is ignored.
 * -EBADMSG: they do not match the hierarchy; nothing is taken. -ENOMEM, or as gl_check: the group
 * is not loaded, and patches may have been taken and freed. */
must_check int geometry_put(struct geometry *geometry, uint32_t group, struct pool_answer *answer);
/* Takes the labels of a group. They are ignored where the group is not loaded (any more) or has
 * labels. -EBADMSG: they do not match its patches. */
must_check int geometry_label(struct geometry *geometry, uint32_t group,
			      struct label_group *labels);
/* Marks the groups that the cut desires, then drops others until the budget holds. */
void geometry_evict(struct geometry *geometry, const struct cut *cut, uint64_t budget_bytes);

/* Binds the buffers of a patch. Attribute 0 is the position from the base, 1 the normal
 * (octahedral, unconverted), 2 the colour, 3 the base, which all vertices of a patch share. The sum
 * of position and base is a place of the lattice, exact as a float, so vertices that patches share
 * are drawn at equal bits. */
void geometry_bind(const struct geometry *geometry, uint32_t patch);
/* Sets face culling for a patch: back faces are culled where only front faces were found visible,
 * which halves the triangles of a closed model. Otherwise both sides are drawn. */
void geometry_cull(const struct geometry *geometry, uint32_t patch);
/* Ends culling, after the last patch was drawn. */
void geometry_cull_none(void);
/* Draws a range of triangles of the bound patch, or of other buffers that are bound, for which the
 * geometry may be zeroed; may wait for earlier triangles (struct throttle). */
void geometry_draw(struct geometry *geometry, uint32_t first_triangle, uint32_t triangle_count);

struct geometry_hit {
	uint32_t patch;
	struct patch_bvh_hit on;
};

/* Finds the nearest hit among the shown patches of the cut, farther than least_m and nearer than
 * *distance_m. On a hit it returns true, sets *distance_m, and fills *hit (which may be NULL).
 * direction is a unit vector. */
bool geometry_ray(const struct geometry *geometry, const struct cut *cut, const float from_m[3],
		  const float direction[3], float least_m, float *distance_m,
		  struct geometry_hit *hit);
/* Returns whether any shown patch is hit before most_m. */
bool geometry_blocks(const struct geometry *geometry, const struct cut *cut, const float from_m[3],
		     const float direction[3], float most_m);

#endif
