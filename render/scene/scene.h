/* The scene that the kiosk draws: view-dependent sparse patches, coloured by the Grid-Lumigraph.
 *
 * The scene knows pages, patch groups and tiles; it knows no network. It lists the objects it
 * wants, with priorities (scene_wants), is given objects (scene_give), and draws what it has.
 * Decoding runs on its own worker threads, which report through scene_fd. Every call belongs to the
 * thread that owns the GL context. GLES2 only. */
#ifndef GOPURA_RENDER_SCENE_SCENE_H
#define GOPURA_RENDER_SCENE_SCENE_H

#include "format/message.h"
#include "format/root_page.h"
#include "format/scenery.h"
#include "format/solid.h"
#include "geometry/camera.h"
#include "geometry/region.h"
#include "geometry/section.h"
#include "render/lumigraph/raking_light.h"

enum scene_mode {
	SCENE_POLYGONS,  /* patches with their own colours */
	SCENE_CORNERS,   /* the method of the paper: the eight sampling points around the eye */
	SCENE_LUMIGRAPH, /* reuse of every tile, up to four faces, occlusion (docs/lumigraph.md) */
};

struct scene_options {
	enum scene_mode mode;
	uint64_t texture_budget_bytes; /* tiles and depth maps together */
	uint64_t geometry_budget_bytes;
	uint32_t triangle_budget;  /* most triangles per frame */
	float patch_error_px;      /* refine while a group's error on the screen is larger */
	float price_px_per_kb;     /* what improves fewer pixels per kilobyte is not fetched */
	uint32_t upload_budget_us; /* time for uploads per frame */
	uint32_t worker_count;     /* 0: scene_give decodes on the calling thread */
};

/* What a frame costs while the eye moves (render/scene/governor.h chooses it). At rest everything
 * is drawn at full effort. */
struct scene_effort {
	float scale; /* of the sides of the picture that is drawn and then enlarged; 1: none is */
	uint32_t faces;     /* most that colour a piece */
	uint32_t triangles; /* most that are drawn, besides triangle_budget */
	float budget;       /* share of the time for uploads and planning, 0 to 1 */
	/* Of a picture, how much is drawn in a frame, above 0; below 1, frames show the last
	 * picture, moved to where the eye is (render/lumigraph/image_warp.h). */
	float share;
};
extern const struct scene_effort scene_effort_full;

struct scene;

/* Creates the scene and starts the workers; needs a current GL context, as drawing does. options
 * are copied. The caller owns *out; it is NULL on failure. -ENOMEM, and the errors of the GL
 * helpers and of thread creation. */
must_check int scene_create(struct scene **out, const struct scene_options *options);
/* Stops the workers and frees everything. NULL is fine. */
void scene_destroy(struct scene *scene);

/* Switches to another release at once: everything of the previous one is dropped. root is the hash
 * of its root page, root_bytes its size. Always returns 0. */
must_check int scene_open(struct scene *scene, struct hash root, uint32_t root_bytes);
/* Returns the release's root page once it has arrived, else NULL. Borrowed until scene_open. */
const struct root_page *scene_root(const struct scene *scene);

/* Passes a verified object that was wanted. Unknown objects are ignored. One that does not decode
 * is logged as a content bug and not wanted again. object is borrowed for the call. */
void scene_give(struct scene *scene, struct hash hash, struct bytes object);
/* Returns how many objects could not be used since the scene was created. */
uint32_t scene_refused(const struct scene *scene);
/* Returns a descriptor, borrowed, that is readable when a worker has finished; then call
 * scene_dispatch. */
int scene_fd(const struct scene *scene);
/* Only resets the descriptor: the next frame takes the answers, within its time budget. Returns
 * 0. */
must_check int scene_dispatch(struct scene *scene);

/* Writes what is wanted, most wanted first, at most `most` entries, and returns their number. What
 * is not listed any more is no longer wanted. Valid for the camera of the last scene_draw. */
size_t scene_wants(struct scene *scene, struct message_want *wants, size_t most);
/* Returns whether memory was lacking for that list, or for the last picture: draw again. */
bool scene_lacked_memory(const struct scene *scene);
/* Returns whether the first image is still to come, for half a minute at most. What leads to it
 * gains little by itself, so what is large and not part of the picture should wait for it. */
bool scene_awaits_image(const struct scene *scene);

struct scene_frame {
	bool moved;   /* the view differs from that of the last frame */
	bool moving;  /* a fade is in progress or an upload waits: draw again soon */
	bool sliced;  /* the picture at rest took several frames: none tells its time */
	bool settled; /* nothing is wanted, decoding or fading, and accumulation is complete */
	uint32_t triangles, patches, tiles_uploaded, depth_faces_drawn;
	/* of the streaming mesh, which is shown before there are patches; 0: not shown */
	uint32_t stream_triangles;
	/* share of the model's pixels that images colour; -1 where not settled */
	float image_share;
};

/* The part whose outline is drawn in bold. */
struct scene_mark {
	/* its id, by which its outline is found in the release's labels; borrowed */
	const char *part;
	/* used where the labels are not here; REGION_POINT: draw nothing there */
	struct region region;
};

/* Draws into the bound framebuffer, on the background of the release; alpha is coverage. mark may
 * be NULL. It is borrowed for the call. */
void scene_draw(struct scene *scene, const struct camera *camera, const struct scene_mark *mark,
		struct scene_frame *out);

/* Where a picture at rest takes long, waits(data) is asked between parts of it whether something
 * else is to be done first. If so, scene_draw shows what was seen last, and the next call goes on.
 * NULL: nothing ever is. data is borrowed. */
void scene_heed(struct scene *scene, bool (*waits)(void *data), void *data);
/* Sets the effort from the next frame on; initially it is full. *effort is copied. */
void scene_spend(struct scene *scene, const struct scene_effort *effort);

/* The visitor's tools. They apply to pictures and to rays; initially both are off. */
struct scene_tools {
	struct rake rake;
	struct section section;
};
/* Sets the tools from now on; *tools is copied. */
void scene_use(struct scene *scene, const struct scene_tools *tools);

/* What stands beside the scan (format/scenery.h), once it is shown, else NULL. Borrowed until
 * scene_open. */
const struct scenery *scene_scenery(const struct scene *scene);
/* A finger touched a pixel of the given camera. Returns whether scenery in front of all else
 * answers: something begins to move. */
bool scene_touch(struct scene *scene, const struct camera *camera, float x_px, float y_px);
/* A finger begins to drag at a pixel. Returns whether it holds scenery that it may move, in front
 * of all else. */
bool scene_grab(struct scene *scene, const struct camera *camera, float x_px, float y_px);
/* The finger that holds scenery is at a pixel now. */
void scene_drag(struct scene *scene, const struct camera *camera, float x_px, float y_px);
/* The finger lets go; what it moved stays. Nothing held is fine. */
void scene_let_go(struct scene *scene);
/* Returns the chosen layer. */
uint32_t scene_layer(const struct scene *scene);
/* Dissolves to a layer; one that there is not is ignored. */
void scene_choose_layer(struct scene *scene, uint32_t layer);
/* For the next visitor: all is as it was at first. */
void scene_reset_scenery(struct scene *scene);

/* The memory in use out of the budgets. */
struct scene_memory {
	uint64_t texture_bytes; /* of tiles and depth maps in use */
	/* of patches, on the GPU and in memory together, and of scenery's pictures */
	uint64_t geometry_bytes;
};
/* Writes the memory in use. */
void scene_memory(const struct scene *scene, struct scene_memory *out);

/* Removes the background from pixels that were read back, which gives straight alpha; colour is 0
 * where alpha is 0. */
void scene_unmix(const struct scene *scene, uint8_t *rgba, size_t pixel_count);

/* Finds the surface point under a pixel (x right, y down, panel pixels) of the given camera, on the
 * shown patches. Returns false where nothing is there. */
bool scene_pick(struct scene *scene, const struct camera *camera, float x_px, float y_px,
		float point_m[3]);
/* The same, and how far the shown surface is from the scan's there, in metres: an estimate of the
 * root mean square by the size of the triangles. */
bool scene_pick_surface(struct scene *scene, const struct camera *camera, float x_px, float y_px,
			float point_m[3], float *error_m);
/* Returns the id of the smallest part under the pixel by the release's labels, or "" where it
 * belongs to no part; borrowed until the next scene_draw. NULL: nothing is there, the labels are
 * not here yet, or the release has none. */
const char *scene_part(struct scene *scene, const struct camera *camera, float x_px, float y_px);
/* Returns the distance in metres from a point to the nearest surface along a direction (of any
 * length); INFINITY: nothing within most_m. */
float scene_clearance(struct scene *scene, const float from_m[3], const float direction[3],
		      float most_m);
/* Returns the octree of where an eye may be, borrowed until another release is opened. NULL: it is
 * not here yet, or the release has none (docs/solid.md). */
const struct solid *scene_solid(const struct scene *scene);
/* Returns how far an eye may go from a point along a direction, a unit vector; 0: no farther,
 * INFINITY: at least most_m. By the octree, but for the stone that the section cuts away; without
 * one up to room_m before the shown surface. *axis becomes the axis that is perpendicular to the
 * side of the cell that holds the eye up; -1: unknown, or the eye is within stone. */
float scene_reach(struct scene *scene, const float from_m[3], const float direction[3],
		  float most_m, float room_m, int *axis);

#endif
