/* The kiosk's end of the socket to gopura-fetch. Starts the fetcher when asked to, reconnects and
 * says every want again when it died. One thread; nothing here blocks. */
#ifndef GOPURA_NET_CLIENT_H
#define GOPURA_NET_CLIENT_H

#include "format/message.h"

struct net_client;

/* Called from net_client_dispatch. Bytes are borrowed for the call. */
struct net_client_events {
	/* Hashed and found right before it gets here. */
	void (*object)(void *data, struct hash hash, struct bytes bytes);
	void (*missing)(void *data, struct hash hash, enum missing_reason reason);
	/* As received: the signature is not checked yet. */
	void (*meta)(void *data, enum meta_role role, uint32_t version, struct bytes bytes);
	void (*status)(void *data, const struct message_status *status);
};

struct net_client_options {
	const char *socket_path; /* copied; of a fetcher that runs already; NULL: start one */
	const char *program;     /* copied; path of gopura-fetch, for starting it */
	const char *release_url; /* copied; https://..., http://... or a folder */
	const char *cache_path;  /* copied; the fetcher's cache.db */
	uint64_t cache_budget_bytes;
	const char *ca_file; /* copied; certificate authority for https; NULL: the system's */
	struct net_client_events events;
	void *data;
};

must_check int net_client_create(struct net_client **out, const struct net_client_options *options);
void net_client_destroy(struct net_client *client); /* ends a fetcher it started */

/* Readable when net_client_dispatch has something to do (an epoll descriptor of its own). */
int net_client_fd(const struct net_client *client);
must_check int net_client_dispatch(struct net_client *client);

/* Wants of another release are dropped. */
void net_client_use_release(struct net_client *client, struct hash root, uint32_t root_bytes);
/* Said again with another priority, only that changes. Forgotten once the object event came. */
void net_client_want(struct net_client *client, const struct message_want *want);
void net_client_drop(struct net_client *client, struct hash hash);
void net_client_keep(struct net_client *client, struct hash hash);
void net_client_ask_meta(struct net_client *client);

#endif
