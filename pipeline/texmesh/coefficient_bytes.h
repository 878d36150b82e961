/* Estimates how many bytes each fragment of a JPEG picture takes at each quality. Private to this
 * room. */
#ifndef GOPURA_PIPELINE_TEXMESH_COEFFICIENT_BYTES_H
#define GOPURA_PIPELINE_TEXMESH_COEFFICIENT_BYTES_H

#include "pipeline/texmesh/coefficients.h"

enum { COEFFICIENT_KNOTS = 22 /* qualities that are computed; between them it is interpolated */ };

/* Fills a table [fragment][knot] of bytes, at *out, owned by the caller. Never fewer at a higher
 * quality. -ENOMEM: *out is NULL. */
must_check int coefficient_bytes(uint32_t **out, const struct coefficients *coefficients);
/* Returns the bytes at a quality of 1..FRAGMENT_JPEG_QUALITY_MOST from a fragment's row. */
uint32_t coefficient_bytes_at(const uint32_t bytes[COEFFICIENT_KNOTS], uint32_t quality);

#endif
