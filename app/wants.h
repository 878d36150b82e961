/* What the kiosk wants of the fetcher, as one list a turn: only differences are said. */
#ifndef GOPURA_APP_WANTS_H
#define GOPURA_APP_WANTS_H

#include "net/client.h"

enum { WANTS_MAX = 512 };

struct wants {
	struct message_want said[WANTS_MAX]; /* sorted by hash */
	uint32_t said_count;
	struct message_want next[WANTS_MAX];
	uint32_t next_count;
	bool later;
};

/* A turn: wants_begin, wants_add for each (wants_later between them), wants_say. What was said
 * before and is not added any more is dropped. Past WANTS_MAX, later ones are ignored: add what
 * matters first. */
void wants_begin(struct wants *wants);
void wants_add(struct wants *wants, const struct message_want *want);
/* What is added after this, until the turn ends, is of a release that is not shown yet: its
 * priorities fall below MESSAGE_PRIORITY_PICTURE, their order kept. */
void wants_later(struct wants *wants);
void wants_say(struct wants *wants, struct net_client *client);
/* The object came. */
void wants_arrived(struct wants *wants, struct hash hash);
/* All was forgotten on the other side too: another release. */
void wants_clear(struct wants *wants);

#endif
