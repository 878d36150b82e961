/* The struct of the scene. Private to render/scene. */
#ifndef GOPURA_RENDER_SCENE_SCENE_PARTS_H
#define GOPURA_RENDER_SCENE_SCENE_PARTS_H

#include "base/map.h"
#include "format/hierarchy.h"
#include "render/lumigraph/accumulation.h"
#include "render/lumigraph/backdrop.h"
#include "render/lumigraph/depth.h"
#include "render/lumigraph/enlargement.h"
#include "render/lumigraph/image_warp.h"
#include "render/lumigraph/outline.h"
#include "render/lumigraph/surface.h"
#include "render/lumigraph/tiles.h"
#include "render/lumigraph/visibility.h"
#include "render/patches/cut.h"
#include "render/patches/dissolve.h"
#include "render/patches/mark.h"
#include "render/patches/patch_buffers.h"
#include "render/patches/pool.h"
#include "render/patches/stream_growth.h"
#include "render/plan/plan.h"
#include "render/scene/scene.h"
#include "render/scenery/scenery_picture.h"

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
	OBJECT_STREAM,
	OBJECT_BLOCK, /* id: block of the streaming mesh */
	OBJECT_SCENERY,
	OBJECT_SOLID,
};

enum object_state { OBJECT_WANTED, OBJECT_DECODING, OBJECT_BAD };

/* An object that was wanted at some time, and what it is for. */
struct object {
	struct hash hash;
	uint64_t id;
	enum object_kind kind;
	enum object_state state;
};

/* A piece in the frustum. */
struct visible_piece {
	uint32_t patch, piece;
	float pixels; /* pixels that its bounding sphere covers on the screen */
	int program;  /* program of the surface that draws it in this picture; negative: none */
	struct dissolve_range range;
};

/* Pieces that are drawn a part at a time. */
struct scene_slice {
	struct visible_piece *pieces; /* borrowed */
	uint32_t count;
	uint32_t with[SURFACE_PROGRAMS]; /* how many each program draws */
	int program;                     /* that draws now; negative: all are drawn */
	uint32_t at;                     /* the next piece that may be its */
};

enum reference_kind {
	REFERENCE_PLAIN,
	REFERENCE_WITH_PASS, /* a visibility pass is drawn, read and counted before it */
	REFERENCE_SMALL,     /* for an eye that is too fast for the others */
	REFERENCE_KINDS,
};

/* The pictures that are warped where frames take too long (scene_reference.h). */
struct scene_references {
	struct image_warp warp;
	struct image_warp_reference of[2];
	int shown; /* of the two, if has_shown */
	bool has_shown;
	bool is_begun;            /* the other one is being drawn */
	enum reference_kind kind; /* of it */
	bool is_counted;          /* its visibility pass was, or it has none */
	uint32_t since_pass;      /* pictures since one had a visibility pass */
	float scale;              /* of it, as scene_effort has it */
	uint32_t since_depth;     /* frames since one was left to depths of faces */
	bool is_kept;             /* the one that is shown next was drawn at rest, for this view */
	uint32_t numbered;        /* of its pieces, the first that are in the pass */
	float cost;               /* of it with a pass, in triangles of one */
	float part;               /* what of it is drawn in a frame, in the same */
	struct scene_slice slice; /* of the picture */
	/* How the eye moves, in metres and parts of a direction for each millisecond. */
	float eye_speed[3], turn_speed[3];
	uint32_t moving_frames;         /* since it began to */
	float begun_ms;                 /* time since the coming one was begun */
	float took_ms[REFERENCE_KINDS]; /* from begin to end, of the last one of each kind */
};

/* The picture at rest that is drawn, and the sum of those before (scene_still.h). */
struct scene_still {
	bool is_begun;
	bool changed;     /* the scene is not as it was in the picture before */
	bool sum_is_seen; /* the sum is of what the eye sees, or saw before a part was marked */
	struct view view; /* shifted by a part of a pixel */
	struct scene_slice slice;
	float passed_ms;           /* since the scene was last prepared */
	bool (*waits)(void *data); /* as scene_heed has it */
	void *data;                /* borrowed */
};

/* A face whose depths are being drawn from the patches of scene.around. */
struct depth_task {
	bool is_begun; /* and not complete */
	int slot;
	face_key face;
	float sample_m[3];
	uint32_t drawn; /* of the patches, the first that are */
	uint64_t cut;   /* cut_signature when it began */
};

/* The streaming mesh, until patches are shown. */
struct scene_stream {
	struct stream_growth growth;
	GLuint vertices, indices;
	bool over; /* patches are shown: it is not wanted any more */
};

/* The making of what mirrors show. */
struct scene_around {
	GLuint coming; /* cube map that is being made; 0: none. Owned */
	int face;      /* of it, the next to draw */
	uint64_t cut;  /* state of the cut when it was begun, or when the last one was; 0: never */
};

enum { BACKDROP_LOOKS = 32 * 18 };

/* Where a part of the picture is in the images of a vantage point. */
struct backdrop_look {
	face_key face;
	float u, v;
	uint8_t level; /* as fine as the screen */
};

/* The images of a vantage point, shown until the mesh is here (scene_backdrop.h). */
struct scene_backdrop {
	struct backdrop picture;
	int point; /* in the repository; valid if share > 0 or it is wanted */
	/* Of the whole picture, each of as many pixels; none: the eye is elsewhere, or the mesh is
	 * here, so no image of the point is wanted. */
	struct backdrop_look looks[BACKDROP_LOOKS];
	uint32_t look_count;
	float share;      /* 0..1, of the backdrop in the picture */
	bool moves;       /* the picture changes */
	uint32_t version; /* of the tiles in it */
};

/* What stands beside the scan. */
struct scene_scenery {
	struct scenery content;
	struct pose pose;
	struct scenery_picture picture;
	struct scene_around around;
	bool is_here;
	bool is_ready; /* its programs are built, so it appears */
	bool lacks;    /* the last picture had plainer programs */
	bool moves;    /* this frame shows it otherwise than the last one */
};

struct scene {
	struct scene_options options;
	struct pool *pool;
	struct tiles tiles;
	struct depth depth;
	struct depth_task depth_task;
	struct surface surface;
	struct mark mark;
	struct part_renderer part;
	struct outline outline;
	struct accumulation accumulation;
	struct enlargement enlargement;
	struct visibility visibility;
	struct scene_still still;
	struct scene_references references;

	bool programs_wait;     /* new ones for the next picture, pieces have fewer faces */
	uint32_t refused;       /* number of objects that could not be used */
	struct object *objects; /* owned */
	uint32_t object_count, object_room;
	struct map object_of; /* name -> index of objects */
	/* first 8 bytes of a hash -> index of objects: those with the workers */
	struct map decoding;

	struct hash root_hash;
	uint32_t root_bytes;
	bool has_root, has_hierarchy;
	struct root_page root;
	struct page_child root_child[ROOT_CHILDREN_MAX];
	uint32_t root_child_count;
	struct hierarchy hierarchy;
	struct hash hierarchy_hash;
	struct page_child *groups; /* children of the hierarchy page; owned */
	uint32_t *group_offset;    /* owned */
	/* Children of the labels page: */
	struct page_child *labels; /* owned; NULL: not here */
	uint32_t *labels_offset;   /* owned */
	uint32_t *labels_of;       /* per group, index of its child, or LABEL_NONE; owned */
	struct geometry geometry;
	struct cut cut, around;
	struct dissolve dissolve;
	/* visible pixels per patch, from the last visibility pass; owned */
	float *seen_px;
	/* share of the picture that shows the model, from the same pass */
	float filled;
	uint32_t *group_priority; /* used while the wants are listed; owned */
	struct repository repository;
	struct scene_stream stream;
	struct scene_backdrop backdrop;
	struct scene_scenery scenery;
	struct solid solid; /* of where an eye may be; without nodes: not here */

	struct scene_effort effort; /* while the eye moves */
	struct scene_effort used;   /* in this frame */
	uint32_t still_frames;      /* since the eye or scenery last moved */
	uint32_t still_eye_frames;  /* since the eye did */
	struct scene_tools tools;
	bool tools_moved; /* changed since the last frame */
	/* The current frame. */
	struct camera camera;
	struct view view;
	bool has_view;
	bool is_still; /* the last frame left nothing to draw */
	int64_t frame_us;
	/* owned; pieces of the cut, then of the patches it is replacing */
	struct visible_piece *visible;
	uint32_t visible_count, leaving_count, visible_room;
	/* Owned: those numbered in the current visibility pass, then others of the same picture. */
	struct visible_piece *counted;
	uint32_t counted_count, counted_all, counted_room;
	uint64_t counting_cut;  /* cut_signature when the pass began */
	bool counting;          /* a part of the pass is drawn */
	uint32_t counted_drawn; /* that many of its pieces */
	uint32_t epoch;         /* counts changes of what planning depends on: pages */
	int64_t opened_ms;      /* time of scene_open */
	int64_t visibility_us;  /* time of the last visibility pass; 0: none yet */
	int64_t season_us;      /* when the current season of the tiles began */
	bool was_moving;
	bool eye_moves; /* or did in the frame before */
	float visibility_eye_m[3];
	float visibility_forward[3];
	uint64_t visibility_cut;
	float visibility_section[4];
	bool plans_are_stale; /* some visible piece must still be planned */
	bool fading, depth_is_stale, uploads_wait;
	uint64_t cut_signature;
	float image_share;
	struct message_want *wants; /* owned */
	uint32_t want_count, want_room;
	bool groups_are_wanted;
	bool wants_are_stale; /* objects arrived since they were listed */
	bool lacked_memory;   /* for the last picture, or for what it wants */
	uint32_t plan_cursor;
	/* What the last frame marked: */
	bool is_marked;
	char marked_part[LABEL_ID_BYTES];
	struct region marked_region;
	uint32_t mark_serial; /* counts changes of the marked part */
};

/* Whether frames take too long, so that the governor has them drawn smaller: then other work gives
 * way too. */
static inline bool scene_gives_way(const struct scene *scene)
{
	return scene->used.scale < 1;
}

#endif
