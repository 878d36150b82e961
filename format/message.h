/* Messages between kiosk and fetcher over a Unix SOCK_SEQPACKET socket, one message per packet.
 *
 * Kiosk to fetcher
 *   MESSAGE_RELEASE  use this release (its locator is named by its root's hash). Without `also`:
 *                    drop every want and forget other releases. With `also`: beside those in use,
 *                    so that the next release is downloaded while this one is shown
 *   MESSAGE_WANT     download an object (sent again with another priority: only that changes)
 *   MESSAGE_DROP     an object is no longer wanted
 *   MESSAGE_KEEP     an object that must not leave the cache while its release is in use
 *   MESSAGE_ASK_META fetch the signed metadata now, and from now on with this period
 *   MESSAGE_SYNC     make what was downloaded so far survive a power cut; the fetcher answers
 *                    with MESSAGE_SYNCED
 *   MESSAGE_TRUST    the version of the trust root that the kiosk has, on connecting and in answer
 *                    to every root: the fetcher looks for the next one. MESSAGE_TRUST_TUF: the
 *                    kiosk follows The Update Framework; the fetcher brings tuf/timestamp.json
 *                    alone, in every period, and the kiosk asks for all else
 *   MESSAGE_ASK_FILE bring a file of tuf/ by its name; another one ends an earlier request to the
 *                    same source
 *
 * Fetcher to kiosk
 *   MESSAGE_OBJECT   the object's bytes: inline up to MESSAGE_INLINE_MAX, else a sealed memfd
 *   MESSAGE_MISSING  not available now (offline, or the server does not have it, or it is damaged);
 *                    the fetcher keeps trying while it is wanted
 *   MESSAGE_META     a signed metadata file, bytes as received; the kiosk checks signatures itself
 *   MESSAGE_FILE     answers MESSAGE_ASK_FILE, once the source has answered
 *   MESSAGE_SYNCED   answers MESSAGE_SYNC: true if the data is safe, false if the disk failed now
 *                    or refused something since the last answer
 *   MESSAGE_STATUS   figures, once a second while they change, else twice a minute; also the sign
 *                    of life by which the kiosk detects that the fetcher hangs
 *
 * The kiosk hashes every object it receives. A message that does not decode closes the socket. */
#ifndef GOPURA_FORMAT_MESSAGE_H
#define GOPURA_FORMAT_MESSAGE_H

#include "format/hash.h"

enum message_kind {
	MESSAGE_RELEASE = 1,
	MESSAGE_WANT,
	MESSAGE_DROP,
	MESSAGE_KEEP,
	MESSAGE_ASK_META,
	MESSAGE_SYNC,
	MESSAGE_TRUST,
	MESSAGE_ASK_FILE,
	MESSAGE_OBJECT = 64,
	MESSAGE_MISSING,
	MESSAGE_META,
	MESSAGE_STATUS,
	MESSAGE_SYNCED,
	MESSAGE_FILE,
};

enum {
	MESSAGE_INLINE_MAX = 96 * 1024,
	MESSAGE_BYTES_MAX = MESSAGE_INLINE_MAX + 1024,
	MESSAGE_META_BYTES_MAX = 64 * 1024,
	MESSAGE_RELEASES_MAX = 4, /* releases in use at once */
	MESSAGE_PERIOD_S_MAX = 86400,
	MESSAGE_NAME_MAX = 200, /* characters of a file's name */
};

/* In place of the version of a trust root. */
#define MESSAGE_TRUST_TUF UINT32_MAX

enum meta_role { META_ROOT, META_RELEASE, META_TIMESTAMP };
enum meta_source { META_FROM_SERVER, META_FROM_STICK };
enum file_answer { FILE_IS_HERE, FILE_NOT_THERE, FILE_TOO_LARGE };
enum missing_reason { MISSING_OFFLINE, MISSING_NOT_FOUND, MISSING_DAMAGED };

struct message_want {
	struct hash hash;
	struct hash page;  /* the page whose child it is; zero for a root page */
	uint32_t offset;   /* in the page's block, bytes */
	uint32_t size;     /* bytes */
	uint32_t priority; /* higher first; MESSAGE_PRIORITY_* mark the ranges */
};

enum {
	MESSAGE_PRIORITY_LATER = 0,       /* for a release that is not shown yet: 0 .. 999 */
	MESSAGE_PRIORITY_PICTURE = 1000,  /* tiles and patches: 1000 .. 999999, by gain */
	MESSAGE_PRIORITY_INDEX = 1000000, /* pages: nothing can be planned without them */
};

struct message_status {
	uint8_t online;          /* the last request was answered */
	uint32_t wanted;         /* objects not yet downloaded */
	uint64_t received_bytes; /* from the network since start, TLS and headers included */
	uint64_t cache_bytes, cache_budget_bytes;
	uint64_t offline_since_s; /* wall clock, seconds since 1970; 0 while online */
};

/* Letters, digits and . _ - ~ %, and slashes between parts that do not begin with a dot. */
struct message_file {
	char name[MESSAGE_NAME_MAX + 1];
	enum meta_source source;
	uint32_t bytes_max;      /* when it is asked for: the size beyond which it is not wanted */
	enum file_answer answer; /* when it is answered */
	struct bytes bytes;      /* borrowed; empty unless the answer is FILE_IS_HERE */
};

struct message {
	enum message_kind kind;
	union {
		struct {
			struct hash root;
			uint32_t root_bytes;
			bool also; /* use it beside the releases in use */
		} release;
		struct message_want want;
		struct hash drop;
		struct hash keep;
		uint32_t period_s;     /* of MESSAGE_ASK_META; 0: the fetcher's own period */
		uint32_t root_version; /* of MESSAGE_TRUST; 0: the kiosk has no trust root */
		bool synced;
		struct {
			struct hash hash;
			struct bytes bytes; /* borrowed; empty if a descriptor holds them */
			uint32_t size;
		} object;
		struct {
			struct hash hash;
			enum missing_reason reason;
		} missing;
		struct {
			enum meta_role role;
			uint32_t version;   /* for META_ROOT: N of root/N.json */
			struct bytes bytes; /* borrowed */
			enum meta_source source;
		} meta;
		struct message_status status;
		struct message_file file; /* of MESSAGE_ASK_FILE and MESSAGE_FILE */
	};
};

/* Returns whether a name is one that struct message_file may hold. */
bool message_name_is_fine(const char *name);

/* Appends one packet. A message that exceeds the limits above (an inline object larger than
 * MESSAGE_INLINE_MAX) sets the error of out to -EFBIG; other fields are not checked. */
void message_encode(struct buffer *out, const struct message *message);
/* Decodes one packet. Bytes in *out are borrowed from packet. Returns -EBADMSG if the packet is
 * truncated, has trailing bytes or an unknown kind, or if a hash, size, role or reason is out of
 * range. The caller checks whether a descriptor came along: MESSAGE_OBJECT with empty bytes needs
 * exactly one, every other message none. */
must_check int message_decode(struct message *out, struct bytes packet);

#endif
