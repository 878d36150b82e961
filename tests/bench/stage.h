/* A scene without kiosk and fetcher: a release's folder, a panel nobody sees, a link between them
 * and, unless asked otherwise, a clock of its own, so that the same path gives the same pictures
 * however long a frame takes to draw. */
#ifndef GOPURA_TESTS_BENCH_STAGE_H
#define GOPURA_TESTS_BENCH_STAGE_H

#include "base/map.h"
#include "format/locator.h"
#include "pipeline/release/release_reader.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "render/scene/scene.h"

enum {
	STAGE_IN_FLIGHT = 64,
	STAGE_VIEWS_MAX = 1000,
	STAGE_KINDS = 16, /* at least as many as of enum object_kind */
	/* What a line carries beside objects, in bytes, as measured with the fetcher and nginx over
	 * TLS: the headers of a range, and those of a packet, which has 1448 bytes of a range. */
	STAGE_RANGE_BYTES = 195,
	STAGE_PACKET_BYTES = 52,
	STAGE_BYTES_A_PACKET = 1448,
};

struct stage_options {
	const char *release; /* folder */
	struct scene_options scene;
	int width_px, height_px;
	bool wall_clock;        /* the machine's time and its workers */
	bool work_clock;        /* a frame takes the time that its work takes on `cores` cores */
	uint32_t frame_us;      /* between frames of the stage's clock; 0: 16667 */
	uint64_t bits_a_second; /* 0: what is asked for is there in the next frame */
	uint32_t latency_us;
	uint64_t window_bytes; /* asked for ahead; 0: 64 KiB */
};

/* An object, or a segment of it, asked for and not there yet. */
struct stage_flight {
	struct message_want want;
	uint32_t bytes;
	uint32_t line_bytes; /* with what its transport adds; 0: a cache has it */
	bool last;           /* of its object */
	int64_t due_us;
};

struct stage {
	struct stage_options options;
	struct release_reader *reader;
	struct locator locator;
	struct hash root;
	uint32_t root_bytes;
	struct headless *headless;
	struct gl_target target;
	struct scene *scene;
	struct stage_flight flight[STAGE_IN_FLIGHT];
	uint32_t flights;
	int64_t link_free_us;
	uint64_t range_left;     /* bytes that the last range could still have had */
	struct map had;          /* by hash: what a cache would hold */
	struct map asked;        /* by hash: bytes sent for of what is not there yet */
	uint64_t bytes, objects; /* that came for the first time, with what their transport adds */
	uint64_t bytes_of[STAGE_KINDS]; /* of these, by enum object_kind */
	int64_t work_us;                /* of this thread, for the last frame */
	int64_t wall_us;                /* of the machine's clock, for the last frame */
	/* With work_clock: what the last frame took. The drawing thread's processor time, and its
	 * share of that of the driver's threads, and of decoding what decoding takes from them. */
	int64_t spent_us;
	int64_t passed_us;   /* of the stage's clock in the last frame */
	int64_t decoding_us; /* what workers still have to decode of what has come */
	uint32_t cores;      /* with work_clock: that the process has; 2 from the start */
	float slowness;      /* with work_clock: factor of all times; 1 from the start */
	uint64_t bytes_most; /* nothing is sent for past them; UINT64_MAX from the start */
};

/* Ends the program with a line on standard error. */
void stage_die(const char *what, int rc);
void stage_must(int rc, const char *what); /* dies below 0 */

/* Reads lines "eye x y z, target x y z, vertical field of view in degrees" (# begins a comment)
 * into cameras of that size; at least one, or it dies. */
uint32_t stage_read_views(struct camera *cameras, uint32_t most, const char *path, int width_px,
			  int height_px);

/* The newest release of the folder. Dies with a reason. */
void stage_open(struct stage *stage, const struct stage_options *options);
void stage_close(struct stage *stage);

/* Another scene, with nothing in it. */
void stage_begin(struct stage *stage, const struct scene_options *options);
/* Draws a frame into stage->target, then lets time pass and objects come. */
void stage_frame(struct stage *stage, const struct camera *camera, struct scene_frame *out);
/* The stage's clock, which this call does not advance. */
int64_t stage_now_us(void);
/* Frames until the picture is settled or so much time has passed; frames drawn. */
uint32_t stage_settle(struct stage *stage, const struct camera *camera, int64_t most_ms,
		      struct scene_frame *out);
/* What the target shows, straight alpha, width x height x 4, owned by the caller. */
uint8_t *stage_read(struct stage *stage);

/* The same colours as on a panel, mixed with the background; alpha is 0 where the background is
 * seen, 255 elsewhere. For pictures whose own alpha is a guess (render/lumigraph/backdrop.h). */
uint8_t *stage_read_panel(struct stage *stage);

/* PSNR of the stage's picture against FOLDER/view-NNNN.png over the union of both silhouettes, both
 * on one colour; NAN where there is no such picture. The grey is that of
 * tests/tools/compare_pictures. */
extern const uint8_t stage_grey[3];
double stage_psnr(const struct stage *stage, const uint8_t *rgba, const uint8_t ground[3],
		  const char *folder, uint32_t view);
void stage_keep(const struct stage *stage, uint8_t *rgba, const char *folder, uint32_t view);

double stage_median(double *values, uint32_t count); /* sorts them */

#endif
