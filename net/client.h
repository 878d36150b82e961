/* The kiosk's end of the socket to gopura-fetch. It starts the fetcher if asked to. If the fetcher
 * exits or hangs, it reconnects and repeats every request. One thread; no call blocks, except
 * net_client_destroy, which waits for a fetcher that it started. */
#ifndef GOPURA_NET_CLIENT_H
#define GOPURA_NET_CLIENT_H

#include "format/message.h"

struct net_client;

/* Called from net_client_dispatch. Bytes are borrowed for the call. Only object is mandatory. */
struct net_client_events {
	/* The bytes were checked against the hash before this call. The want is removed. */
	void (*object)(void *data, struct hash hash, struct bytes bytes);
	/* The object cannot be delivered now. The want stays. */
	void (*missing)(void *data, struct hash hash, enum missing_reason reason);
	/* Metadata as received; its signature is not checked yet. After the event for a root, the
	 * fetcher is sent the version that net_client_trust set last. */
	void (*meta)(void *data, enum meta_role role, uint32_t version, struct bytes bytes,
		     enum meta_source source);
	/* The answer to net_client_sync. done: everything received before it survives a power
	 * cut. */
	void (*synced)(void *data, bool done);
	/* Connection and cache figures; received_bytes covers all fetchers since
	 * net_client_create. */
	void (*status)(void *data, const struct message_status *status);
	/* The answer to net_client_ask_file; *file is borrowed and unchecked. */
	void (*file)(void *data, const struct message_file *file);
};

struct net_client_options {
	/* copied; socket of a fetcher that runs already; NULL: start one */
	const char *socket_path;
	const char *program;     /* copied; path of gopura-fetch; required to start one */
	const char *release_url; /* copied; https://..., http://... or a folder */
	const char *stick_path;  /* copied; passed to a fetcher that is started; NULL: none */
	const char *cache_path;  /* copied; the fetcher's cache.db */
	/* at least 4 MiB; smaller values are raised */
	uint64_t cache_budget_bytes;
	uint32_t poll_s; /* seconds between checks for a new release; 0: the fetcher's default */
	uint32_t root_version; /* as for net_client_trust */
	const char *ca_file;   /* copied; certificate authority for https; NULL: the system's */
	const char *redirect_hosts; /* copied; passed to a fetcher that is started; NULL: none */
	struct net_client_events events;
	void *data;
};

/* *out is owned by the caller; it is NULL on failure. A missing fetcher is no failure: the client
 * tries again. -EINVAL: options are missing. -ENOMEM, or another negative errno if epoll or a timer
 * cannot be created. */
must_check int net_client_create(struct net_client **out, const struct net_client_options *options);
/* Also ends a fetcher that the client started; waits up to 2 s for it. NULL is fine. */
void net_client_destroy(struct net_client *client);

/* An epoll descriptor, borrowed. It is readable when net_client_dispatch has work to do. */
int net_client_fd(const struct net_client *client);
/* Calls the events. Handles messages for about 3 ms, the rest in later calls. Returns a negative
 * errno only if epoll_wait fails. */
must_check int net_client_dispatch(struct net_client *client);

/* Makes this the only release in use: drops every want and forgets every keep, so request again
 * what is needed. Does nothing if it is already the only release in use. */
void net_client_use_release(struct net_client *client, struct hash root, uint32_t root_bytes);
/* Adds a release beside the one in use, so that the next release can be loaded while the current
 * one is shown. Wants and keeps of both are served. net_client_use_release ends this. At most
 * MESSAGE_RELEASES_MAX releases are in use; beyond that the oldest added one is removed. */
void net_client_add_release(struct net_client *client, struct hash root, uint32_t root_bytes);
/* Requests an object; *want is copied. If the object is already wanted, only its priority changes.
 * The want is removed after the object event. Without memory the request is lost; ask again. */
must_check int net_client_want(struct net_client *client, const struct message_want *want);
/* Withdraws a request. Ignored if the object is not wanted. */
void net_client_drop(struct net_client *client, struct hash hash);
/* Asks the fetcher to write everything received so far durably; the synced event answers. The
 * answer is lost if the fetcher exits: ask again in that case. */
void net_client_sync(struct net_client *client);
/* Sets the version of the trust root that the kiosk accepted; 0: none; MESSAGE_TRUST_TUF: it
 * follows The Update Framework. Call it from the meta event, so that the fetcher looks for the next
 * root after it. */
void net_client_trust(struct net_client *client, uint32_t root_version);
/* Asks for a file of the folder tuf/ of a source; *file is copied. An earlier request to the same
 * source that was not answered ends. Lost if the fetcher exits: ask again when the timestamp comes
 * anew. A name that a packet cannot hold is our own mistake. */
void net_client_ask_file(struct net_client *client, const struct message_file *file);
/* Asks the cache to keep this object. Remembered until net_client_use_release and repeated after
 * the fetcher restarts. The cache keeps up to three quarters of its budget this way. */
void net_client_keep(struct net_client *client, struct hash hash);

#endif
