/* The demo temple: invented, Khmer in manner, 42 m wide and 24 m high, any number of triangles.
 * docs/temple.md says how it is made. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_H

#include "base/compiler.h"

#include <stdint.h>
#include <stdio.h>

struct progress;

enum { TEMPLE_TRIANGLES_MIN = 10000, TEMPLE_TRIANGLES_MAX = 100000000 };

/* A carving of its own, such as a lion: the faces of the file that are it. */
struct temple_body {
	char id[16]; /* "lion-4": kind, and which of them from 1 */
	uint32_t first_face, face_count;
};

struct temple_bodies {
	struct temple_body
		*bodies; /* owned, free(); those too small for the triangles are left out */
	uint32_t count;
};

struct temple_options {
	uint64_t triangles;        /* within 2 % of this; see the limits above */
	uint32_t seed;             /* poses, stones out of line, what has fallen; the plan stays */
	struct progress *progress; /* borrowed; counts vertices and triangles; NULL: none */
	struct temple_bodies *bodies; /* filled in; empty on failure; NULL: nobody asks */
};

/* Binary PLY: x y z in metres, red green blue, alpha = the share of the sky that is open;
 * triangles. The same bytes for the same options. Memory does not grow with the number of
 * triangles. Negative errno of the file, -ENOMEM, or -ERANGE for a number out of limits. */
must_check int temple_write(FILE *file, const struct temple_options *options);

#endif
