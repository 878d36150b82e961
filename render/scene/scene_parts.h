/* What the sources of the scene share; private to them.
 *   scene_objects.c  life, objects in
 *   scene_wants.c    objects wanted
 *   scene_labels.c   which part a place belongs to
 *   scene_plan.c     what is shown: cut, pieces, blends
 *   scene_census.c   which pieces are in sight
 *   scene_draw.c     the frame
 *   scene_mark.c     the marked part over it */
#ifndef GOPURA_RENDER_SCENE_SCENE_PARTS_H
#define GOPURA_RENDER_SCENE_SCENE_PARTS_H

#include "format/hierarchy.h"
#include "render/lumigraph/accumulation.h"
#include "render/lumigraph/depth.h"
#include "render/lumigraph/surface.h"
#include "render/lumigraph/tiles.h"
#include "render/lumigraph/visibility.h"
#include "render/patches/cut.h"
#include "render/patches/dissolve.h"
#include "render/patches/mark.h"
#include "render/patches/patch_buffers.h"
#include "render/patches/pool.h"
#include "render/plan/cell_map.h"
#include "render/plan/plan.h"
#include "render/scene/scene.h"

enum object_kind {
	OBJECT_ROOT,
	OBJECT_HIERARCHY,
	OBJECT_SAMPLES,
	OBJECT_GROUP, /* id: group */
	OBJECT_BRICK, /* id: child of the samples page */
	OBJECT_FACE,  /* id: face_key */
	OBJECT_TILE,  /* id: packed tile name */
	OBJECT_LABELS_PAGE,
	OBJECT_LABELS, /* id: group */
};

enum object_state { OBJECT_WANTED, OBJECT_DECODING, OBJECT_BAD };

/* An object that was wanted once: what it is for when it comes. */
struct object {
	struct hash hash;
	uint64_t id;
	enum object_kind kind;
	enum object_state state;
};

/* A piece in sight. */
struct visible_piece {
	uint32_t patch, piece;
	float pixels; /* of the screen, as far as known */
	int program;  /* of the surface's, that draws it in this picture; below 0: none */
	struct dissolve_range range;
};

struct scene {
	struct scene_options options;
	struct pool *pool;
	struct tiles tiles;
	struct depth depth;
	struct surface surface;
	struct mark mark;
	struct ribbons ribbons;
	struct accumulation accumulation;
	struct visibility visibility;

	uint32_t refused;       /* objects that could not be used */
	struct object *objects; /* owned */
	uint32_t object_count, object_capacity;
	struct map object_of; /* first 8 bytes of a hash -> index of objects */
	struct map decoding;  /* object_id_key -> index of objects: with the workers */

	struct hash root_hash;
	uint32_t root_bytes;
	bool has_root, has_hierarchy;
	struct root_page root;
	struct page_child root_child[ROOT_CHILDREN_MAX];
	uint32_t root_child_count;
	struct hierarchy hierarchy;
	struct hash hierarchy_hash;
	struct page_child *groups; /* children of the hierarchy's page; owned */
	uint32_t *group_offset;    /* owned */
	/* Children of the labels page: */
	struct page_child *labels; /* owned; NULL: not here */
	uint32_t *labels_offset;   /* owned */
	uint32_t *labels_of;       /* of each group, which, or LABEL_NONE; owned */
	struct geometry geometry;
	struct cut cut, around;
	struct dissolve dissolve;
	float *seen_px;           /* per patch, by the last census; owned */
	float filled;             /* share of the picture that shows the model, likewise */
	uint32_t *group_priority; /* of the list of wants at hand; owned */
	struct repository repository;

	struct scene_tools tools;
	bool tools_moved; /* since the last frame */
	/* The frame at hand. */
	struct view view;
	bool has_view;
	int64_t frame_us;
	struct visible_piece *visible; /* owned; of the cut, then of what it replaced */
	uint32_t visible_count, leaving_count, visible_capacity;
	struct visible_piece *counted; /* those that the census at hand numbers; owned */
	uint32_t counted_count, counted_capacity;
	uint64_t counting_cut; /* cut_signature as it began */
	bool counting;         /* half of it is drawn */
	uint32_t epoch;        /* of what planning looks at: tiles, pages */
	int64_t visibility_us; /* when it was taken */
	int64_t season_us;     /* when the tiles' season began */
	bool was_moving;
	float visibility_eye_m[3];
	float visibility_forward[3];
	uint64_t visibility_cut;
	float visibility_section[4];
	bool plans_are_stale; /* some piece in sight waits to be planned */
	bool fading, depth_is_stale, uploads_wait;
	uint64_t cut_signature;
	float image_share;
	struct message_want *wants; /* owned */
	uint32_t want_count, want_capacity;
	bool wants_are_stale; /* something came since they were listed */
	uint32_t plan_cursor;
	/* What the last frame marked: */
	bool is_marked;
	char marked_part[LABEL_ID_BYTES];
	struct region marked_region;
	uint32_t mark_serial; /* so many parts were */
};

/* scene_objects.c */
struct object *scene_object(struct scene *scene, struct hash hash);
/* Remembers what an object is for; NULL without memory. */
struct object *scene_expect(struct scene *scene, struct hash hash, enum object_kind kind,
			    uint64_t id);
/* Logs a content bug; the object is not wanted again. */
void scene_refuse(struct scene *scene, struct object *object, int error);

/* scene_labels.c: the labels page; once the hierarchy is here. -EBADMSG, -ENOMEM. */
must_check int scene_open_labels(struct scene *scene, struct bytes bytes);
void scene_drop_labels(struct scene *scene);
bool scene_has_labels(const struct scene *scene); /* the release, here or not */
/* A labelled patch has the marked part's outline as ribbon, made where it is not there yet. false:
 * it is not known, or there was no memory. */
bool scene_outline(struct scene *scene, uint32_t patch);

/* scene_wants.c: rebuilds scene->wants, most wanted first. */
void scene_list_wants(struct scene *scene);

/* scene_census.c: whether any of it was drawn. */
bool scene_take_census(struct scene *scene, bool moved);

/* scene_plan.c */
void scene_upload(struct scene *scene, int64_t until_us, struct scene_frame *out);
void scene_update_cut(struct scene *scene, float passed_ms);
void scene_desire(struct scene *scene); /* after the census */
void scene_list_pieces(struct scene *scene);
void scene_plan_pieces(struct scene *scene, int64_t budget_us);
void scene_fade_blends(struct scene *scene, float passed_ms);
void scene_draw_depth(struct scene *scene, int64_t until_us, struct scene_frame *out);
/* scene_mark.c: notes it; whether it is another than in the frame before. */
bool scene_note_mark(struct scene *scene, const struct scene_mark *mark);
void scene_draw_mark(struct scene *scene, const struct view *view);
float scene_patch_error_m(const struct scene *scene, uint32_t patch);

#endif
