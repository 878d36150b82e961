/* Labels: which parts of the model the patches of a group belong to. An object of its own beside
 * the group's geometry (format/patch.h), so that another region changes no geometry.
 * docs/labels.md has the bytes and why they are so.
 *
 * A triangle belongs wholly to the parts of its set. A part whose outline runs through it is no
 * member of the set but a border: its triangle is divided into 4^level like ones, and each of their
 * corners says how far within the part it lies. The outline is where that is 0 between them. */
#ifndef GOPURA_FORMAT_LABEL_H
#define GOPURA_FORMAT_LABEL_H

#include "base/bytes.h"
#include "format/patch.h"

enum {
	LABEL_ID_BYTES = 65,    /* of a part, the zero at its end included */
	LABEL_PARTS_MAX = 1000, /* in a group, as in a release */
	LABEL_SETS_MAX = 4096,
	LABEL_LEVEL_MIN = 2,
	LABEL_LEVEL_MAX = 5,
	LABEL_VALUE_MAX = 7,
};

struct label_part {
	char id[LABEL_ID_BYTES]; /* as in parts.json */
	float area_m2;           /* of all its surface: the smallest part answers a touch */
};

/* Some of the group's parts, ascending. */
struct label_set {
	uint32_t first, count; /* in members */
};

struct label_border {
	uint16_t triangle, part;
	uint8_t level;  /* LABEL_LEVEL_MIN..LABEL_LEVEL_MAX */
	uint32_t first; /* in values: label_values(level) of them */
};

struct label_patch {
	uint32_t triangle_count; /* as patch_group_decode gives them, in that order */
	uint16_t *sets;          /* of each triangle; owned */
	uint32_t border_count;
	struct label_border *borders; /* by triangle, then part, ascending; owned */
};

struct label_group {
	uint32_t part_count, set_count, member_count, patch_count, value_count;
	struct label_part *parts;    /* owned, like all here */
	struct label_set *sets;      /* [0] is empty */
	uint16_t *members;           /* of sets: index of a part */
	struct label_patch *patches; /* as many as the group has */
	int8_t *values;              /* odd, -LABEL_VALUE_MAX..LABEL_VALUE_MAX; above 0 is within */
};

/* Corners of a triangle that is divided so often. */
uint32_t label_values(int level);
/* The corner (i, j) of n = 2^level steps lies at ((n - i - j) a + i b + j c) / n. */
uint32_t label_value_at(int level, int i, int j);

/* Appends the object. -EINVAL: breaks a rule above; -EFBIG, -ENOMEM. */
must_check int label_group_encode(struct buffer *out, const struct label_group *group);
/* *out is finished by the caller; zeroed on failure. -EBADMSG for anything that encode cannot have
 * written; -ENOMEM. */
must_check int label_group_decode(struct label_group *out, struct bytes object);
void label_group_finish(struct label_group *group); /* NULL and zeroed are fine */
/* Of memory. */
size_t label_group_bytes(const struct label_group *group);

/* Whether a part has that triangle wholly. */
bool label_holds(const struct label_group *group, uint32_t patch, uint32_t triangle, uint32_t part);
/* The triangle's borders are borders[first..]; their number. */
uint32_t label_borders(const struct label_patch *patch, uint32_t triangle, uint32_t *first);
/* The smallest part at a place of a triangle: (1 - u - v) a + u b + v c; or -1. */
int label_part_at(const struct label_group *group, uint32_t patch, uint32_t triangle, float u,
		  float v);
/* The group's number of a part, or -1. */
int label_find(const struct label_group *group, const char *id);

#define LABEL_NONE UINT32_MAX
/* Payload of PAGE_LABELS: which groups of the hierarchy have labels; their objects are the page's
 * children, in order. */
void label_page_encode(struct buffer *out, const uint32_t *child_of_group, uint32_t group_count);
/* *child_of_group is the caller's (free): LABEL_NONE for a group without labels. -EBADMSG: not one
 * for group_count groups, or with another number of children; -ENOMEM. */
must_check int label_page_decode(uint32_t **child_of_group, uint32_t group_count,
				 uint32_t child_count, struct bytes payload);

#endif
