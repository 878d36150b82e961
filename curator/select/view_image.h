/* What a view of the model shows at each pixel, as the selection tools need it (P0 section 4.1).
 * Arrays have width_px * height_px items, row 0 on top. */
#ifndef GOPURA_CURATOR_SELECT_VIEW_IMAGE_H
#define GOPURA_CURATOR_SELECT_VIEW_IMAGE_H

#include <stdint.h>

enum { VIEW_SIDE_PX_MAX = 4096 };

struct view_image {
	uint32_t width_px, height_px; /* 1 to VIEW_SIDE_PX_MAX */
	float px_per_radian;          /* of its camera: camera_px_per_radian */
	uint8_t (*colours)[3];        /* sRGB, of the surface itself, without light */
	int8_t (*normals)[3];         /* unit vectors times 127 */
	uint8_t *open; /* share of open sky, 255 for all; for its light alone, may be NULL */
	/* One over the distance along the line of sight. It is linear over a plane, so its second
	 * difference shows where a surface ends. 0: nothing shows. */
	float *inverse_m;
};

#endif
