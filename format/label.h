/* Labels: which parts of the model the patches of a group belong to. They are an object of their
 * own beside the group's geometry (format/patch.h), so that a change of a region changes no
 * geometry. docs/labels.md describes the bytes and the reasons for them.
 *
 * A triangle belongs completely to the parts of its set. If the outline of a part crosses a
 * triangle, the part is not in that set; the triangle has a border for it instead. A border divides
 * the triangle into 4^level similar triangles and stores at each of their corners how far inside
 * the part it lies. The outline runs where the interpolated value is 0. */
#ifndef GOPURA_FORMAT_LABEL_H
#define GOPURA_FORMAT_LABEL_H

#include "base/bytes.h"
#include "format/patch.h"

enum {
	LABEL_ID_BYTES = 65,    /* of a part's id, with the final zero */
	LABEL_PARTS_MAX = 1000, /* in a group; the same limit holds for a release */
	LABEL_SETS_MAX = 4096,
	LABEL_LEVEL_MIN = 2,
	LABEL_LEVEL_MAX = 5,
	LABEL_VALUE_MAX = 7,
};

struct label_part {
	char id[LABEL_ID_BYTES]; /* as in parts.json */
	float area_m2;           /* of its whole surface; the smallest part answers a touch */
};

/* A set of the group's parts, in ascending order. */
struct label_set {
	uint32_t first, count; /* a range of members */
};

struct label_border {
	uint16_t triangle, part;
	uint8_t level;  /* LABEL_LEVEL_MIN..LABEL_LEVEL_MAX */
	uint32_t first; /* index into values; label_values(level) values follow */
};

struct label_patch {
	uint32_t triangle_count; /* the triangles of patch_group_decode, in the same order */
	uint16_t *sets;          /* the set of each triangle; owned */
	uint32_t border_count;
	struct label_border *borders; /* sorted by triangle, then part; owned */
};

struct label_group {
	uint32_t part_count, set_count, member_count, patch_count, value_count;
	struct label_part *parts;    /* this and the other arrays are owned */
	struct label_set *sets;      /* [0] is empty */
	uint16_t *members;           /* of sets; each is an index into parts */
	struct label_patch *patches; /* one per patch of the geometry */
	int8_t *values;              /* odd, -LABEL_VALUE_MAX..LABEL_VALUE_MAX; above 0 is inside */
};

/* Returns the number of corners in a triangle that is divided into 4^level triangles. */
uint32_t label_values(int level);
/* Returns the index of corner (i, j) among the values of a border. With n = 2^level, the corner
 * lies at ((n - i - j) a + i b + j c) / n, where a, b, c are the corners of the triangle. */
uint32_t label_value_at(int level, int i, int j);

/* Appends the object. Returns -EINVAL if the group breaks a rule above, -EFBIG or -ENOMEM. */
must_check int label_group_encode(struct buffer *out, const struct label_group *group);
/* The caller ends *out with label_group_finish(); it is zeroed on failure. Returns -EBADMSG for
 * anything that the encoder cannot have written, or -ENOMEM. */
must_check int label_group_decode(struct label_group *out, struct bytes object);
void label_group_finish(struct label_group *group); /* NULL and zeroed are fine */
/* Returns the memory that the group's arrays take, in bytes. */
size_t label_group_bytes(const struct label_group *group);

/* Returns true if the triangle belongs completely to the part. All numbers must be in range. */
bool label_holds(const struct label_group *group, uint32_t patch, uint32_t triangle, uint32_t part);
/* Returns the number of borders of the triangle. They start at borders[*first]. */
uint32_t label_borders(const struct label_patch *patch, uint32_t triangle, uint32_t *first);
/* Returns the smallest part, by area, at the point (1 - u - v) a + u b + v c of a triangle. Returns
 * -1 if there is none or the triangle is out of range. patch must be in range. */
int label_part_at(const struct label_group *group, uint32_t patch, uint32_t triangle, float u,
		  float v);
/* Returns the index of the part with that id, or -1. */
int label_find(const struct label_group *group, const char *id);

#define LABEL_NONE UINT32_MAX
/* Payload of PAGE_LABELS: a bit for each group of the hierarchy that has labels. The label objects
 * are the page's children, in the order of the groups. The encoder only tests child_of_group for
 * LABEL_NONE. Failures are out->error. */
void label_page_encode(struct buffer *out, const uint32_t *child_of_group, uint32_t group_count);
/* *child_of_group is owned by the caller (free) and has group_count entries: the child's number, or
 * LABEL_NONE for a group without labels. Returns -EBADMSG if the payload is not made for
 * group_count groups and child_count children, or -ENOMEM. */
must_check int label_page_decode(uint32_t **child_of_group, uint32_t group_count,
				 uint32_t child_count, struct bytes payload);

#endif
