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
	/* As received: the signature is not checked yet. After a root the fetcher is told the
	 * version that net_client_trust said last. */
	void (*meta)(void *data, enum meta_role role, uint32_t version, struct bytes bytes,
		     enum meta_source source);
	/* Of net_client_sync; done: all that came before it survives a power cut. */
	void (*synced)(void *data, bool done);
	void (*status)(void *data, const struct message_status *status);
};

struct net_client_options {
	const char *socket_path; /* copied; of a fetcher that runs already; NULL: start one */
	const char *program;     /* copied; path of gopura-fetch, for starting it */
	const char *release_url; /* copied; https://..., http://... or a folder */
	const char *stick_path;  /* copied; for a fetcher that is started; NULL: none */
	const char *cache_path;  /* copied; the fetcher's cache.db */
	uint64_t cache_budget_bytes;
	uint32_t poll_s;       /* between looks for a new release; 0: the fetcher's default */
	uint32_t root_version; /* of the trust root that the kiosk has; 0: none */
	const char *ca_file;   /* copied; certificate authority for https; NULL: the system's */
	const char *redirect_hosts; /* copied; for a fetcher that is started; NULL: none */
	struct net_client_events events;
	void *data;
};

/* *out is owned by the caller; on failure it is NULL. A fetcher that is not there is no failure: it
 * is tried again. -EINVAL: options are missing; -ENOMEM. */
must_check int net_client_create(struct net_client **out, const struct net_client_options *options);
void net_client_destroy(struct net_client *client); /* ends a fetcher it started */

/* Readable when net_client_dispatch has something to do (an epoll descriptor of its own). */
int net_client_fd(const struct net_client *client);
/* Calls events. Negative errno only where waiting itself is broken. */
must_check int net_client_dispatch(struct net_client *client);

/* From now on this release alone: every want is dropped, every keep forgotten; say anew what is
 * wanted of it. The release that is in use already: nothing happens. */
void net_client_use_release(struct net_client *client, struct hash root, uint32_t root_bytes);
/* Also this release, beside the one in use, so that the next one comes while this one is shown:
 * wants and keeps of both are served. net_client_use_release ends it. At most
 * MESSAGE_RELEASES_MAX in use; the oldest added goes. */
void net_client_add_release(struct net_client *client, struct hash root, uint32_t root_bytes);
/* Said again with another priority, only that changes. Forgotten once the object event came. */
void net_client_want(struct net_client *client, const struct message_want *want);
/* What is not wanted is ignored. */
void net_client_drop(struct net_client *client, struct hash hash);
/* Has what came so far written durably. The answer is lost with the fetcher: ask again then. */
void net_client_sync(struct net_client *client);
/* The kiosk has a later trust root now: to be called from the meta event, so that the fetcher looks
 * for the one after it. */
void net_client_trust(struct net_client *client, uint32_t root_version);
/* Remembered until net_client_use_release, and said again when the fetcher was restarted. The cache
 * keeps up to three quarters of its budget this way. */
void net_client_keep(struct net_client *client, struct hash hash);

#endif
