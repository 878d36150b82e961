/* What is known of the sampling repository: its grid, and the pages of bricks and faces as they
 * arrive, from which the hash and location of a tile follow. Pure; no GL. */
#ifndef GOPURA_RENDER_PLAN_REPOSITORY_H
#define GOPURA_RENDER_PLAN_REPOSITORY_H

#include "base/map.h"
#include "format/message.h"
#include "format/samples.h"

/* A face_key is a face of a sampling point: point * CUBE_FACES + face, with point = (z * count_y +
 * y) * count_x + x; vantage points come after those of the grid. A tile is named by the face's key,
 * level, row and column. */
typedef uint32_t face_key;
struct tile_name {
	face_key face;
	uint8_t level, row, column;
};
/* The name packed into a number below 2^48. */
uint64_t tile_name_pack(struct tile_name name);
/* The name that was packed into this number. */
struct tile_name tile_name_unpack(uint64_t packed);

enum repository_state {
	REPOSITORY_EMPTY,   /* nothing of the model is visible there */
	REPOSITORY_UNKNOWN, /* the page of its brick is needed first: *want */
	REPOSITORY_PAGE,    /* the face has content; its page is needed: *want */
	REPOSITORY_READY,   /* its page is here: tiles can be looked up */
};

struct repository {
	bool ready; /* the samples page has arrived */
	struct samples_page grid;
	uint32_t point_count; /* of the grid, and vantage points */
	/* Private. */
	struct page page; /* the samples page; page_bytes holds its bytes */
	uint8_t *page_bytes;
	struct hash page_hash;
	struct brick_entry **bricks; /* per child of the page; NULL: not here. Owned. */
	struct face_entry **faces;   /* owned */
	uint32_t face_count, face_room;
	struct map face_of; /* face_key -> index of faces */
};

/* Frees everything and leaves it empty. */
void repository_finish(struct repository *repository);
/* Replaces everything with a new samples page. The object is copied. -EBADMSG, -ENOMEM; then it is
 * empty. */
must_check int repository_open(struct repository *repository, struct hash hash,
			       struct bytes object);
/* Adds the page of a brick; child is its index among the children of the samples page. A page that
 * is here already is ignored. -EBADMSG, -ENOMEM. */
must_check int repository_give_brick(struct repository *repository, uint32_t child,
				     struct bytes object);
/* Adds the page of a face whose brick is here; otherwise, or the second time, it is ignored.
 * -EBADMSG, -ENOMEM. */
must_check int repository_give_face(struct repository *repository, face_key face,
				    struct bytes object);

/* Writes the position of a sampling point in metres. */
void repository_point_m(const struct repository *repository, uint32_t point, float out[3]);
/* Returns what is known of a face. *want is set as the state says; want may be NULL. For
 * REPOSITORY_UNKNOWN *brick_child is set too (may be NULL). */
enum repository_state repository_face(const struct repository *repository, face_key face,
				      struct message_want *want, uint32_t *brick_child);
/* Writes how to fetch the page of a brick. Returns false where it is here already, or no brick has
 * this child index. */
bool repository_brick(const struct repository *repository, uint32_t child,
		      struct message_want *want);
/* Returns whether anything is visible in the given sixteenths of the face (bits as in brick_page);
 * true while unknown. */
bool repository_covers(const struct repository *repository, face_key face, uint16_t sixteenths);
/* Returns the number of levels of every face, 1 .. SAMPLE_LEVELS_MAX. */
uint32_t repository_levels(const struct repository *repository);
/* Writes how to fetch a tile. Returns false where the tile does not exist, or its face's page is
 * not here. want may be NULL. */
bool repository_tile(const struct repository *repository, struct tile_name name,
		     struct message_want *want);

#endif
