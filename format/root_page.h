/* Payload of PAGE_ROOT: what a kiosk must know about a release before it fetches anything else.
 * Children, in this order: the hierarchy page, the samples page, the info page, the labels page if
 * any part has a region, the stream page if has_stream is set, the scenery (format/scenery_code.h,
 * no page) if has_scenery is set, and the octree of where an eye may be (format/solid.h, no page)
 * if has_solid is set. */
#ifndef GOPURA_FORMAT_ROOT_PAGE_H
#define GOPURA_FORMAT_ROOT_PAGE_H

#include "format/page.h"

enum {
	ROOT_CHILD_HIERARCHY,
	ROOT_CHILD_SAMPLES,
	ROOT_CHILD_INFO,
	ROOT_CHILD_COUNT, /* the children that every root page has */
	ROOT_CHILD_LABELS = ROOT_CHILD_COUNT,
	ROOT_CHILDREN_MAX = ROOT_CHILD_COUNT + 4 /* with labels, stream, scenery and octree */
};

enum { ROOT_CUT_MAX = 4 };

enum {
	LATTICE_BITS = 16, /* the longest side of most models has 2 to this power of steps */
	LATTICE_FINE_BITS_MAX = 8, /* and a place is exact as a float */
	LATTICE_PLACES_MAX = 1 << (LATTICE_BITS + LATTICE_FINE_BITS_MAX)
};

/* The single quantisation lattice of a model: metres = origin + step * place, with place in
 * 0..(65536 << fine_bits) - 1 on each axis. So a border shared by two patches is equal bit for bit
 * at every level. */
struct lattice {
	double origin_m[3];
	double step_m;
	uint8_t fine_bits; /* 0 to LATTICE_FINE_BITS_MAX; above 0 on large sites */
};

/* Sets fine_bits to what a model with that box needs. Formats do not store it. */
void lattice_fit(struct lattice *lattice, const float box_min_m[3], const float box_max_m[3]);
/* Sets out to the position of a place, in metres. */
static inline void lattice_metres(double out[3], const struct lattice *lattice,
				  const int32_t place[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = lattice->origin_m[i] + lattice->step_m * place[i];
}

struct root_page {
	char name[128]; /* the model's name, UTF-8 */
	struct lattice lattice;
	float box_min_m[3], box_max_m[3]; /* bounding box of the model; z is up */
	float start_eye_m[3], start_target_m[3];
	float sun[3]; /* unit vector towards the light */
	uint8_t lit;  /* 1: colour times light (geometry/light.h); 0: the scan's own colours */
	uint8_t background[3]; /* sRGB behind the model */
	/* What a section shows where it cuts solid matter: enum substance_kind of
	 * geometry/substance.h, 0: the section's red; at most ROOT_CUT_MAX. */
	uint8_t cut;
	uint64_t source_triangles; /* of the original scan */
	uint64_t published_triangles;
	/* 1: there is a stream page (format/stream_page.h), scenery, or an octree of where an eye
	 * may be. On the wire they are bits 0 to 2 of one byte, and cut is bits 3 to 5; releases
	 * with none of them do not have the byte. A program from before there was one of them
	 * refuses a release with it.
	 */
	uint8_t has_stream, has_scenery, has_solid;
};

/* Returns the number of the first child after those for hierarchy, samples, information and labels;
 * child_count is that of the page. */
static inline uint32_t root_page_plain(const struct root_page *root, uint32_t child_count)
{
	const uint32_t more = (uint32_t)root->has_stream + root->has_scenery + root->has_solid;

	return child_count > more ? child_count - more : 0;
}

/* Returns the number of the scenery, if has_scenery is set. */
static inline uint32_t root_page_scenery(const struct root_page *root, uint32_t child_count)
{
	return root_page_plain(root, child_count) + root->has_stream;
}

/* Appends the payload, for page.payload. Failures are out->error. */
void root_page_encode(struct buffer *out, const struct root_page *root);
/* Returns -EBADMSG if the payload is truncated, has bytes left over, or holds numbers that are not
 * finite or not plausible. *out is then zeroed. Nothing is allocated. */
must_check int root_page_decode(struct root_page *out, struct bytes payload);

#endif
