/* The objects that the kiosk wants from the fetcher. The kiosk rebuilds the list every turn; only
 * the differences are sent. */
#ifndef GOPURA_APP_RELEASE_WANTS_H
#define GOPURA_APP_RELEASE_WANTS_H

#include "app/view/exhibit.h"
#include "net/client.h"

enum { WANTS_MAX = 512 };

struct wants {
	struct net_client *client;           /* borrowed */
	struct message_want said[WANTS_MAX]; /* what the fetcher was told; sorted by hash */
	uint32_t said_count;
	struct message_want next[WANTS_MAX];
	uint32_t next_count;
	bool later;
};

/* One turn: wants_begin, then wants_add for each object (wants_later in between), then wants_say.
 * An object that was sent before and is not added again is dropped. Beyond WANTS_MAX additions are
 * ignored, so add the important ones first. */
/* Nothing is wanted yet. client is borrowed for the life of wants. */
void wants_init(struct wants *wants, struct net_client *client);
/* Starts a new list. */
void wants_begin(struct wants *wants);
/* Adds a copy of *want. One object may be added several times; the highest priority counts. */
void wants_add(struct wants *wants, const struct message_want *want);
/* Objects added after this call, until the turn ends, belong to a release that is not shown yet:
 * their priorities are lowered below MESSAGE_PRIORITY_PICTURE and keep their order. */
void wants_later(struct wants *wants);
/* Sends the differences since the last turn to the fetcher: new objects, dropped ones, and clear
 * changes of priority. Returns false if memory is lacking for some: say them in another turn. */
must_check bool wants_say(struct wants *wants);
/* Removes an object that arrived from the list of what the fetcher was told. */
void wants_arrived(struct wants *wants, struct hash hash);
/* Another release is shown: switches the fetcher to it. The fetcher forgets all wants, so the next
 * turn sends them again. data is the wants. */
void wants_on_release(void *data, const struct exhibit_change *change);

#endif
