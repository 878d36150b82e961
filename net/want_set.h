/* The objects that the kiosk wants, each with its priority and its state, and a queue of those that
 * have not been looked up in the cache yet. It makes no request and reports nothing. One thread. */
#ifndef GOPURA_NET_WANT_SET_H
#define GOPURA_NET_WANT_SET_H

#include "base/map.h"
#include "format/message.h"
#include "net/segments.h"

enum { WANTS_MAX = 1 << 18 };

enum want_state {
	WANT_QUEUED,    /* for its look-up in the cache */
	WANT_WAITING,   /* for a request to the server; not before retry_at_ms */
	WANT_ON_STICK,  /* the stick was asked and will answer */
	WANT_IN_FLIGHT, /* part of a range request; one in segments stays WANT_WAITING */
};

struct want {
	struct message_want asked;
	enum want_state state;
	uint64_t order;          /* order of arrival; a lower one came earlier */
	uint32_t failures;       /* requests in a row without the object, or with wrong bytes */
	uint32_t damages;        /* how many of these had wrong bytes */
	int64_t retry_at_ms;     /* in state WANT_WAITING (clock_now_ms) */
	uint32_t stick_failures; /* how often the stick could not be read for it */
	int64_t stick_at_ms;     /* when the stick is asked again if it still waits; 0: it is not */
	int reported;            /* enum missing_reason that the kiosk knows of; -1: none */
	bool removed;            /* no longer wanted, but still in the queue */
	struct segments *segments; /* owned; NULL: its object is requested as a whole */
	uint32_t in_flight;        /* range requests that carry it, or a segment of it */
};

/* A zeroed struct is a valid empty set. */
struct want_set {
	struct map wants; /* from hash_key to struct want, owned */
	/* Owned array; sorted by priority unless queue_changed. The most urgent one is last. */
	struct want **queue;
	uint32_t queue_count, queue_room;
	bool queue_changed;
	uint64_t orders; /* number of wants so far; gives want.order */
};

/* Frees all wants. The set is empty afterwards. */
void want_set_finish(struct want_set *set);
/* Returns the number of wants, without those that were removed. */
size_t want_set_count(const struct want_set *set);
/* Returns the want, borrowed until it is removed, or NULL. */
struct want *want_set_find(const struct want_set *set, struct hash hash);
/* Iterates over all wants, in no defined order. Start with *at = 0; returns NULL after the last
 * one. The set must not change during the iteration; the queue may. */
struct want *want_set_next(const struct want_set *set, size_t *at);

/* Adds a want, copied from *asked, and puts it into the queue. Its object must not be wanted yet.
 * -ENOSPC: there are WANTS_MAX wants. -ENOMEM. */
must_check int want_set_add(struct want_set *set, const struct message_want *asked);
void want_set_change_priority(struct want_set *set, struct want *want, uint32_t priority);
/* Frees the want, or leaves that to want_set_dequeue while it is queued. It must not be part of a
 * range request. */
void want_set_remove(struct want_set *set, struct want *want);

/* Puts a waiting want into the queue again. -ENOMEM: it keeps waiting. */
must_check int want_set_requeue(struct want_set *set, struct want *want);
/* Takes the most urgent want off the queue; its state becomes WANT_WAITING. Of equal priorities the
 * one that came first is taken. Returns NULL if the queue is empty. */
struct want *want_set_dequeue(struct want_set *set);
/* Returns true if want_set_dequeue has something to do. */
bool want_set_has_queued(const struct want_set *set);

#endif
