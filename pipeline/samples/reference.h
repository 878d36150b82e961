/* Reference pictures: the scan itself, at its finest, from given views. What the kiosk's pictures
 * are measured against. docs/render.md. */
#ifndef GOPURA_PIPELINE_SAMPLES_REFERENCE_H
#define GOPURA_PIPELINE_SAMPLES_REFERENCE_H

#include "base/bytes.h"
#include "geometry/camera.h"
#include "pipeline/content/content.h"

enum { REFERENCE_VIEWS_MAX = 100000, REFERENCE_SIDE_PX_MAX = 4096, REFERENCE_SUPERSAMPLE_MAX = 16 };

struct reference_options {
	int width_px, height_px; /* 1 .. REFERENCE_SIDE_PX_MAX */
	uint32_t supersample;    /* N x N samples a pixel, 1 .. REFERENCE_SUPERSAMPLE_MAX */
	const char *out_dir;     /* made where it is missing; borrowed */
};

struct reference_report {
	uint32_t drawn, kept; /* kept: there already, from the same scan, view and options */
};

/* Views from text: a view a line, "eye x y z  target x y z  vertical field of view in degrees",
 * the words eye and target may be left out; # starts a comment. *out is owned by the caller (free);
 * size, near and far are not set. name is for complaints. */
must_check int reference_views(struct camera **out, uint32_t *count, struct bytes text,
			       const char *name, struct fault *fault);

/* Writes OUT_DIR/view-0000.png and so on: sRGB, straight alpha that is coverage, colour 0 where
 * alpha is 0. A box filter over the samples, in sRGB as everything here. */
must_check int reference_draw(const struct content *content, const struct camera *views,
			      uint32_t count, const struct reference_options *options,
			      struct reference_report *report, struct fault *fault);

#endif
