/* Messages of a kiosk and answers of a server, in any order: the bytes are a sequence of both, for
 * the fetcher's downloader with the server of tests/net/fake_http.h. What is passed on has the
 * right hash, requests stay within their number, and none is left at the end. */
#include "format/locator.h"
#include "net/downloader.h"
#include "tests/net/fake_http.h"

/* The last object is the whole pack, and comes in segments. */
enum { OBJECTS = 6, WHOLE = OBJECTS - 1, OBJECT_BYTES = 3000, ROOTS = 3, EVENTS_MAX = 60 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static struct {
	bool is_full;
	bool cached[OBJECTS], locator_cached; /* what the cache has */
	struct link link;
	struct metrics_refusal refusal;
} world;

static uint8_t pack[WHOLE * OBJECT_BYTES];
static struct hash names[OBJECTS];
static const struct hash page = { { 9 } }, pack_name = { { 0xaa } };
static struct buffer locator;

static struct bytes object_bytes(int n)
{
	if (n == WHOLE)
		return (struct bytes){ pack, sizeof(pack) };
	return (struct bytes){ pack + n * OBJECT_BYTES, OBJECT_BYTES };
}

/* ---- in place of storage/cache.c: a SQLite file each time would be all that is done */

/* Which of our objects; -1: none. */
static int object_named(struct hash name)
{
	for (int i = 0; i < OBJECTS; i++)
		if (hash_equal(names[i], name))
			return i;
	return -1;
}

int cache_get(struct cache *cache, struct hash hash, uint32_t priority, struct buffer *out)
{
	const int n = object_named(hash);

	(void)cache, (void)priority;
	buffer_clear(out);
	if (n < 0 || !world.cached[n])
		return -ENOENT;
	buffer_put(out, object_bytes(n).data, object_bytes(n).size);
	return out->error;
}

int cache_put(struct cache *cache, struct hash hash, struct bytes object, uint32_t priority)
{
	const int n = object_named(hash);

	(void)cache, (void)priority;
	if (!hash_equal(hash_of(object), hash))
		abort();
	if (n >= 0)
		world.cached[n] = true;
	return 0;
}

int cache_keep(struct cache *cache, struct hash hash)
{
	(void)cache, (void)hash;
	return 0;
}

int cache_use_release(struct cache *cache, struct hash root)
{
	(void)cache, (void)root;
	return 0;
}

int cache_get_file(struct cache *cache, struct hash name, struct buffer *out)
{
	(void)cache, (void)name;
	buffer_clear(out);
	if (!world.locator_cached)
		return -ENOENT;
	buffer_put(out, locator.data, locator.size);
	return out->error;
}

int cache_put_file(struct cache *cache, struct hash name, struct bytes file)
{
	(void)cache, (void)name, (void)file;
	return 0;
}

/* ---- the server answers */

static size_t open_requests(void)
{
	size_t count = 0;

	for (size_t i = 0; i < server.count; i++)
		count += server.asked[i].open;
	return count;
}

/* The n-th of the open ones; NULL: none. */
static struct http_request *open_request(uint8_t n)
{
	const size_t open = open_requests();
	size_t skip = open ? n % open : 0;

	for (size_t i = 0; i < server.count; i++)
		if (server.asked[i].open && skip-- == 0)
			return &server.asked[i];
	return NULL;
}

/* The bytes at the place that was requested. */
static void give_right(struct http_request *request, size_t size)
{
	const bool is_locator = strncmp(request->path, "locator/", 8) == 0;
	struct bytes from = buffer_bytes(&locator);
	const uint64_t at = is_locator ? request->given : request->get.first + request->given;

	if (!is_locator)
		from = (struct bytes){ pack, sizeof(pack) };
	if (at < from.size)
		give(request, (struct bytes){ from.data + at,
					      size < from.size - at ? size : from.size - at });
}

static void end_somehow(struct http_request *request, uint8_t how)
{
	static const int results[] = { 0, 0, 0, -ENOENT, -EBADMSG, -EHOSTUNREACH };

	end(request, results[how % ARRAY_COUNT(results)]);
}

static void answer(struct reader *in)
{
	struct http_request *request = open_request(reader_u8(in));
	const uint8_t what = reader_u8(in), size = reader_u8(in);

	if (!request)
		return;
	switch (what % 4) {
	case 0:
		give_right(request, (size_t)size * 64);
		break;
	case 1:
		give(request, reader_bytes(in, size < reader_left(in) ? size : reader_left(in)));
		break;
	case 2:
		give_right(request, SIZE_MAX);
		end(request, 0);
		break;
	case 3:
		end_somehow(request, size);
		break;
	}
}

/* ---- the kiosk says */

static void on_object(void *data, struct hash hash, struct bytes bytes)
{
	(void)data;
	if (!hash_equal(hash_of(bytes), hash))
		abort();
}

static void on_missing(void *data, struct hash hash, enum missing_reason reason)
{
	(void)data, (void)hash;
	if (reason < MISSING_OFFLINE || reason > MISSING_DAMAGED)
		abort();
}

static bool has_room(void *data)
{
	(void)data;
	return !world.is_full;
}

/* As a message can say it (format/message.h): one of our objects, or one at any place. */
static void want(struct downloader *downloader, struct reader *in)
{
	const uint8_t n = reader_u8(in);
	const struct bytes object = object_bytes(n % OBJECTS);
	struct message_want want = { .hash = names[n % OBJECTS],
				     .page = page,
				     .offset = (uint32_t)(object.data - pack),
				     .size = (uint32_t)object.size,
				     .priority = reader_u16(in) * 20u };

	if (n & 0x80) {
		want.hash.bytes[0] ^= n;
		want.offset = reader_u16(in);
		want.size = 1 + reader_u16(in) % (OBJECT_BYTES * 4);
	}
	if ((n & 0xc0) == 0x40)
		want.page = (struct hash){ { 0 } };
	if (downloader_want(downloader, &want) < 0)
		abort(); /* memory does not fail here */
}

static void event(struct downloader *downloader, struct reader *in)
{
	const uint8_t what = reader_u8(in);

	switch (what % 10) {
	case 0:
		if (downloader_use_release(downloader,
					   (struct hash){ { (uint8_t)(1 + what / 10 % ROOTS) } },
					   what & 0x80) < 0)
			abort();
		break;
	case 1:
	case 2:
		want(downloader, in);
		break;
	case 3:
		downloader_drop(downloader, names[what / 10 % OBJECTS]);
		break;
	case 4:
		downloader_keep(downloader, names[what / 10 % OBJECTS]);
		break;
	case 5:
	case 6:
		answer(in);
		break;
	case 7:
		server.now_ms += (int64_t)reader_u16(in) * 10;
		break;
	case 8:
		world.is_full = what & 0x80;
		downloader_look_up_again(downloader);
		break;
	case 9:
		if (what & 0x80)
			downloader_clear(downloader);
		else
			world.locator_cached = what & 0x40;
		break;
	}
	downloader_work(downloader);
	(void)downloader_due_ms(downloader);
}

static void begin(void)
{
	struct locator_block block = { page, 0, 0, sizeof(pack) };
	struct hash pack_hash = pack_name;
	struct locator about = { 1, 1, &pack_hash, &block, HASH_BYTES };

	if (locator.size)
		return;
	for (size_t i = 0; i < sizeof(pack); i++)
		pack[i] = (uint8_t)(i * i / 7 + i / OBJECT_BYTES);
	for (int i = 0; i < OBJECTS; i++)
		names[i] = hash_of(object_bytes(i));
	buffer_init(&locator, 1 << 20);
	locator_encode(&locator, &about);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct downloader_options options = { .link = &world.link,
					      .wait_ms = 1,
					      .events = { on_object, on_missing, has_room } };
	struct downloader *downloader;
	struct reader in;

	begin();
	memset(&world, 0, sizeof(world));
	memset(&server, 0, sizeof(server));
	server.now_ms = 1000;
	link_init(&world.link);
	world.link.refusal = &world.refusal;
	if (downloader_create(&downloader, &options) < 0)
		abort();
	reader_init(&in, (struct bytes){ data, size });
	for (int i = 0; i < EVENTS_MAX && reader_left(&in) > 0; i++)
		event(downloader, &in);
	downloader_destroy(downloader);
	if (open_requests() > 0 || world.link.in_flight > 0)
		abort();
	return 0;
}
