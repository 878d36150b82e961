/* Reference pictures: the scan itself at its finest, from given views. The kiosk's pictures are
 * measured against them. docs/render.md. */
#ifndef GOPURA_PIPELINE_SAMPLES_REFERENCE_H
#define GOPURA_PIPELINE_SAMPLES_REFERENCE_H

#include "base/bytes.h"
#include "geometry/camera.h"
#include "pipeline/content/scans.h"

enum { REFERENCE_VIEWS_MAX = 100000, REFERENCE_SIDE_PX_MAX = 4096, REFERENCE_SUPERSAMPLE_MAX = 16 };

struct reference_options {
	int width_px, height_px; /* 1 .. REFERENCE_SIDE_PX_MAX */
	uint32_t supersample;    /* N x N samples per pixel, 1 .. REFERENCE_SUPERSAMPLE_MAX */
	const char *out_dir;     /* created if missing; borrowed */
};

struct reference_report {
	uint32_t drawn, kept; /* kept: they existed already, from the same scan, view and options */
};

/* Reads views from text, one per line: "eye x y z target x y z vertical field of view in degrees".
 * The words eye and target may be left out; # starts a comment. *out is owned by the caller (free);
 * size, near and far are not set. name is used in error messages. Returns -EINVAL with the line in
 * diagnostic, or -ENOMEM. */
must_check int reference_views(struct camera **out, uint32_t *count, struct bytes text,
			       const char *name, struct diagnostics *diagnostics);

/* Writes OUT_DIR/view-0000.png and so on: sRGB, straight alpha that is coverage, colour 0 where
 * alpha is 0. Samples are averaged with a box filter, in sRGB as everywhere here. Errors are
 * described in diagnostics. */
must_check int reference_draw(struct scans *scans, const struct camera *views, uint32_t count,
			      const struct reference_options *options,
			      struct reference_report *report, struct diagnostics *diagnostics);

#endif
