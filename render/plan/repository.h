/* What is known of the sampling repository: its grid, and as they arrive the pages of bricks and
 * faces, so that a tile's name and place can be told (pure; no GL). */
#ifndef GOPURA_RENDER_PLAN_REPOSITORY_H
#define GOPURA_RENDER_PLAN_REPOSITORY_H

#include "format/message.h"
#include "format/samples.h"
#include "render/plan/cell_map.h"

/* A face of a sampling point: point * CUBE_FACES + face; point = (z * count_y + y) * count_x + x.
 * A tile of it: the face's key, level, row and column. */
typedef uint32_t face_key;
struct tile_name {
	face_key face;
	uint8_t level, row, column;
};
uint64_t tile_name_pack(struct tile_name name); /* below 2^48 */
struct tile_name tile_name_unpack(uint64_t packed);

enum repository_state {
	REPOSITORY_EMPTY,   /* nothing of the model is seen there */
	REPOSITORY_UNKNOWN, /* the brick's page is needed: *want is it */
	REPOSITORY_PAGE,    /* the face shows something; its page is needed: *want is it */
	REPOSITORY_READY,   /* tiles can be named */
};

struct repository {
	bool ready; /* the samples page is there */
	struct samples_page grid;
	uint32_t point_count;
	/* Private. */
	struct page page; /* of the samples; its bytes are kept */
	uint8_t *page_bytes;
	struct hash page_hash;
	struct brick_entry **bricks; /* per child of the page; NULL: not there. Owned. */
	struct face_entry **faces;   /* owned */
	uint32_t face_count, face_capacity;
	struct map face_of; /* face_key -> index of faces */
};

void repository_finish(struct repository *repository);
/* The samples page. -EBADMSG, -ENOMEM. */
must_check int repository_open(struct repository *repository, struct hash hash,
			       struct bytes object);
/* The page of a brick, by the child of the samples page that it is. */
must_check int repository_give_brick(struct repository *repository, uint32_t child,
				     struct bytes object);
/* The page of a face whose brick is here; a second time it is ignored. -EBADMSG, -ENOMEM. */
must_check int repository_give_face(struct repository *repository, face_key face,
				    struct bytes object);

/* Where a sampling point is, metres. */
void repository_point_m(const struct repository *repository, uint32_t point, float out[3]);
/* want may be NULL. For REPOSITORY_UNKNOWN *brick_child is set too (may be NULL). */
enum repository_state repository_face(const struct repository *repository, face_key face,
				      struct message_want *want, uint32_t *brick_child);
/* Where a brick's page lies; false: it is here already, or none is by that child. */
bool repository_brick(const struct repository *repository, uint32_t child,
		      struct message_want *want);
/* Whether anything is seen in the given sixteenths of the face (bits as in brick_page); true while
 * unknown. */
bool repository_covers(const struct repository *repository, face_key face, uint16_t sixteenths);
/* Levels of every face, 1 .. SAMPLE_LEVELS_MAX. */
uint32_t repository_levels(const struct repository *repository);
/* false: the tile is absent, or the face's page is not there. */
bool repository_tile(const struct repository *repository, struct tile_name name,
		     struct message_want *want);

#endif
