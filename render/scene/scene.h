/* What the kiosk draws: view-dependent sparse patches, coloured by the Grid-Lumigraph.
 *
 * The scene knows pages, patch groups and tiles; it knows no network. It says what it wants, with
 * priorities (scene_wants), is given objects (scene_give), and draws what it has. Decoding runs on
 * its own worker threads, which answer through scene_fd. Every call is from the thread that owns
 * the GL context. GLES2 only. */
#ifndef GOPURA_RENDER_SCENE_SCENE_H
#define GOPURA_RENDER_SCENE_SCENE_H

#include "format/message.h"
#include "format/root_page.h"
#include "geometry/camera.h"
#include "geometry/region.h"
#include "geometry/section.h"
#include "render/lumigraph/raking_light.h"

enum scene_mode {
	SCENE_POLYGONS,  /* patches with their own colours */
	SCENE_CORNERS,   /* the paper's form: the eight sampling points around the eye */
	SCENE_LUMIGRAPH, /* lazy reuse, best three samples, occlusion (docs/lumigraph.md) */
};

struct scene_options {
	enum scene_mode mode;
	uint64_t texture_budget_bytes; /* tiles and disparity together */
	uint64_t geometry_budget_bytes;
	uint32_t triangle_budget;  /* drawn in a frame */
	float patch_error_px;      /* refine while a group's error is larger on the screen */
	float price_px_per_kb;     /* what mends fewer pixels a kilobyte is not fetched */
	uint32_t upload_budget_us; /* of a frame */
	uint32_t worker_count;     /* 0: what comes is decoded by who gives it */
};

struct scene;

/* Needs a current GL context, as drawing does; starts the workers. *out is owned by the caller; on
 * failure it is NULL. */
must_check int scene_create(struct scene **out, const struct scene_options *options);
void scene_destroy(struct scene *scene);

/* Shows another release, at once and whole: everything of the one before is forgotten. */
must_check int scene_open(struct scene *scene, struct hash root, uint32_t root_bytes);
/* The release's root page once it arrived, else NULL. Borrowed until scene_open. */
const struct root_page *scene_root(const struct scene *scene);

/* A verified object that was wanted. Unknown ones are ignored; one that does not decode is logged
 * as a content bug and not wanted again. */
void scene_give(struct scene *scene, struct hash hash, struct bytes object);
/* Objects of this release that did not decode, so far. */
uint32_t scene_refused(const struct scene *scene);
/* Readable when scene_dispatch has something to do: a worker finished. */
int scene_fd(const struct scene *scene);
/* Only quiets the descriptor: the next frame takes the answers, within its time. */
must_check int scene_dispatch(struct scene *scene);

/* Most wanted first, at most `most`; those not listed any more are no longer wanted. Valid for the
 * camera of the last scene_draw. */
size_t scene_wants(struct scene *scene, struct message_want *wants, size_t most);

struct scene_frame {
	bool moving;  /* a fade runs or an upload waits: draw again soon */
	bool settled; /* nothing wanted, nothing decoding, no fade running */
	uint32_t triangles, patches, tiles_uploaded, depth_faces_drawn;
	float image_share; /* of the model's pixels, settled frames only; else -1 */
};

/* The part whose border is drawn in bold. */
struct scene_mark {
	const char *part;     /* its id, by which the release's labels know its outline; borrowed */
	struct region region; /* where those are not here; REGION_POINT: nothing then */
};

/* Draws into the framebuffer that is bound, on the release's background; alpha is coverage.
 * mark may be NULL. */
void scene_draw(struct scene *scene, const struct camera *camera, const struct scene_mark *mark,
		struct scene_frame *out);

/* How it is looked at from now on, in pictures and by rays; at first neither. */
struct scene_tools {
	struct rake rake;
	struct section section;
};
void scene_use(struct scene *scene, const struct scene_tools *tools);

/* What is held of the budgets. */
struct scene_memory {
	uint64_t texture_bytes;  /* of tiles and depths that hold something */
	uint64_t geometry_bytes; /* of patches, GPU and memory together */
};
void scene_memory(const struct scene *scene, struct scene_memory *out);

/* Takes the background out of pixels that were read back: straight alpha, 0 where nothing is. */
void scene_unmix(const struct scene *scene, uint8_t *rgba, size_t pixel_count);

/* The surface point under a pixel (x right, y down, panel pixels) of the camera given, by the
 * patches shown. false: nothing there. */
bool scene_pick(struct scene *scene, const struct camera *camera, float x_px, float y_px,
		float point_m[3]);
/* The id of the smallest part there by the release's labels, "" where it is none's; borrowed until
 * the next scene_draw. NULL: nothing there, the labels are not here yet, or the release has none.
 */
const char *scene_part(struct scene *scene, const struct camera *camera, float x_px, float y_px);
/* Distance from a point to the nearest surface along a direction, metres; INFINITY: free. Used to
 * keep the eye out of solid matter. */
float scene_clearance(struct scene *scene, const float from_m[3], const float direction[3],
		      float most_m);

#endif
