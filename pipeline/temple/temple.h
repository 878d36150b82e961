/* The demo temple: invented, in Khmer style, 42 m wide and 24 m high, with any number of triangles.
 * docs/temple.md says how it is made. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_H

#include "base/compiler.h"

#include <stdint.h>
#include <stdio.h>

struct progress;

enum { TEMPLE_TRIANGLES_MIN = 10000, TEMPLE_TRIANGLES_MAX = 100000000 };

/* A separate carving, such as a lion: the range of faces of the file that form it. */
struct temple_body {
	char id[16]; /* "lion-4": kind, and its number from 1 */
	uint32_t first_face, face_count;
};

struct temple_bodies {
	struct temple_body
		/* owned by the caller, free(); carvings too small for the number of triangles are
		 * left out */
		*bodies;
	uint32_t count;
};

struct temple_options {
	/* wanted number; the result is within 2 %; see the limits above */
	uint64_t triangles;
	/* varies poses, displaced stones and what has fallen; the plan stays */
	uint32_t seed;
	struct progress *progress;    /* borrowed; counts vertices and triangles; NULL: none */
	struct temple_bodies *bodies; /* filled in; empty on failure; NULL: not wanted */
};

/* Writes the temple as binary PLY: x y z in metres, red green blue, alpha = the share of the sky
 * that is visible; triangles. The same options give the same bytes. Memory does not grow with the
 * number of triangles. Returns 0, -EIO, -ENOMEM, or -ERANGE for a number outside the limits. */
must_check int temple_write(FILE *file, const struct temple_options *options);

#endif
