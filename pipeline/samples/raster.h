/* A software rasteriser for surfaces whose triangles are about as small as a sample. It writes, for
 * each sample of a square frame, how near the surface is, its normal, its share of open sky and its
 * colour; resolve.h makes a picture of them. Triangles cover the samples that GL's rules say, with
 * places rounded to 1/256 of a sample, and every processor gets the same bits.
 *
 * Samples are stored in blocks of 8 x 8. Blocks that show nothing cost nothing. */
#ifndef GOPURA_PIPELINE_SAMPLES_RASTER_H
#define GOPURA_PIPELINE_SAMPLES_RASTER_H

#include "geometry/camera.h"
#include "pipeline/samples/model.h"

enum {
	RASTER_BLOCK_PX = 8,
	RASTER_BLOCK_SAMPLES = RASTER_BLOCK_PX * RASTER_BLOCK_PX,
	RASTER_THREADS_MAX = 8
};

struct raster;

/* The samples of a block, row by row, row 0 on top. */
struct raster_block {
	const float
		*inverse_m; /* one over the distance along the line of sight; 0: nothing shows */
	/* The normal, each axis in a byte (x lowest) as 127.5 n + 127.5, and in the highest byte
	 * the share of open sky: 1 + 126 share for a back, 128 + 127 share for a front. */
	const uint32_t *surface;
	const uint32_t
		*colour; /* sRGB, red in the lowest byte; NULL if the raster has no colours */
};

/* side_px: of the frame, a multiple of 8 up to 4096. *out is owned by the caller; NULL on failure.
 * Returns -ENOMEM. */
must_check int raster_create(struct raster **out, uint32_t side_px, bool colours);
void raster_destroy(struct raster *raster); /* NULL is fine */

/* Clears the frame and sets the camera: its width and height are the frame's, and nothing nearer
 * than its near plane is drawn. far_m is ignored. */
void raster_begin(struct raster *raster, const struct camera *camera);
/* Draws triangles, both sides of them. A sample shows the nearest, and of equals the first. */
void raster_draw(struct raster *raster, const struct model_mesh *mesh);
/* Draws meshes one after the other, to the same bits, with so many threads: a power of two up to
 * RASTER_THREADS_MAX. Returns -ENOMEM; then it drew nothing. */
must_check int raster_draw_meshes(struct raster *raster, const struct model_mesh *meshes,
				  uint32_t count, uint32_t threads);
/* Returns true if nothing in the box can be seen, whatever it is: all of it is behind what was
 * drawn, or outside the frame. */
bool raster_hides(struct raster *raster, const float low_m[3], const float high_m[3]);

/* Sets the range of distances along the line of sight of what the frame shows, rounded outwards.
 * Returns false if it shows nothing. */
bool raster_range(const struct raster *raster, float *near_m, float *far_m);
/* Gets the block of a column and row. Returns false if it shows nothing. */
bool raster_get_block(const struct raster *raster, uint32_t column, uint32_t row,
		      struct raster_block *out);

#endif
