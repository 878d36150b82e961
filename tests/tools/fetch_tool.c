/* Makes releases of nothing but pages and random objects, and walks releases through the fetcher as
 * a kiosk would, for the end-to-end tests and the figures in docs/fetch.md.
 *
 *   fetch_tool make FOLDER PAGES OBJECTS BYTES SEED    prints "ROOTHASH ROOTBYTES"
 *   fetch_tool walk --fetch PROGRAM --release URL --cache FILE --root HASH --bytes N [options]
 *     --ca FILE  --budget MIB  --socket PATH   as gopura-fetch
 *     --every N       want one object of N only, so that there are gaps
 *     --most-s S      give up then (30)
 *     --keep-pages    as the kiosk does
 *     --unseen        as of a release that is not shown yet: --rate-limit holds
 *     --kill          kill the fetcher once, when half has come
 *     --cancel        drop every second object when a quarter has come
 *     --batch N       want N objects, then no more until they came and
 *     --pause-ms MS   so long passed: as a visitor does who looks, and goes on
 *     --brief         ends with the last object, without waiting for the last figures
 *     --latencies FILE  from want to object, milliseconds, a line each
 *   prints one line of JSON; exit 0: all that was wanted came, 1: not. */
#include <errno.h>
#include <getopt.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "format/locator.h"
#include "format/page.h"
#include "net/client.h"

static void die(const char *what, int rc)
{
	fprintf(stderr, "fetch_tool: %s: %s\n", what, strerror(-rc));
	exit(2);
}

static void must(int rc, const char *what)
{
	if (rc < 0)
		die(what, rc);
}

/* ---- make */

static uint32_t random_state;

static uint32_t random_next(void)
{
	random_state ^= random_state << 13;
	random_state ^= random_state >> 17;
	random_state ^= random_state << 5;
	return random_state;
}

struct maker {
	struct buffer pack;
	struct locator locator;
};

static struct hash add_page(struct maker *maker, const struct page *page, uint32_t block_at,
			    struct buffer *encoded)
{
	struct hash hash;

	buffer_clear(encoded);
	page_encode(encoded, page);
	must(encoded->error, "page");
	hash = hash_of(buffer_bytes(encoded));
	maker->locator.blocks[maker->locator.block_count++] =
		(struct locator_block){ hash, 0, block_at, (uint32_t)maker->pack.size - block_at };
	return hash;
}

/* A page of random objects whose sizes vary about bytes. */
static struct hash make_leaf(struct maker *maker, uint32_t objects, uint32_t bytes,
			     struct buffer *encoded)
{
	struct page page = { .kind = PAGE_FACE, .child_count = objects };
	uint32_t block_at = (uint32_t)maker->pack.size;
	struct hash hash;

	page.children = calloc(objects, sizeof(*page.children));
	for (uint32_t i = 0; i < objects; i++) {
		uint32_t size = bytes / 2 + random_next() % (bytes + 1);
		uint8_t *at = buffer_extend(&maker->pack, size + 1);

		must(maker->pack.error, "pack");
		for (uint32_t k = 0; k < size + 1; k++)
			at[k] = (uint8_t)random_next();
		page.children[i].size = size + 1;
		page.children[i].hash = hash_of((struct bytes){ at, size + 1 });
	}
	hash = add_page(maker, &page, block_at, encoded);
	page_finish(&page);
	return hash;
}

static int by_page(const void *a, const void *b)
{
	return hash_compare(((const struct locator_block *)a)->page,
			    ((const struct locator_block *)b)->page);
}

static void write_files(struct maker *maker, const char *folder, struct hash root)
{
	struct hash name = hash_of(buffer_bytes(&maker->pack));
	char path[4096], hex[HASH_HEX_BYTES];
	struct buffer file;

	snprintf(path, sizeof(path), "%s/packs", folder);
	mkdir(folder, 0755);
	mkdir(path, 0755);
	snprintf(path, sizeof(path), "%s/locator", folder);
	mkdir(path, 0755);
	hash_to_hex(name, hex);
	snprintf(path, sizeof(path), "%s/packs/%s", folder, hex);
	must(bytes_write_file(buffer_bytes(&maker->pack), path), path);
	qsort(maker->locator.blocks, maker->locator.block_count, sizeof(struct locator_block),
	      by_page);
	maker->locator.pack_count = 1;
	maker->locator.packs = &name;
	buffer_init(&file, 64 << 20);
	locator_encode(&file, &maker->locator);
	hash_to_hex(root, hex);
	snprintf(path, sizeof(path), "%s/locator/%s", folder, hex);
	must(bytes_write_file(buffer_bytes(&file), path), path);
	buffer_finish(&file);
}

static int make(const char *folder, uint32_t pages, uint32_t objects, uint32_t bytes)
{
	struct maker maker = { 0 };
	struct page root = { .kind = PAGE_SAMPLES, .child_count = pages };
	struct buffer *encoded = calloc(pages + 1, sizeof(*encoded));
	char hex[HASH_HEX_BYTES];
	uint32_t block_at;
	struct hash hash;

	buffer_init(&maker.pack, UINT32_MAX);
	maker.locator.blocks = calloc(pages + 2, sizeof(struct locator_block));
	root.children = calloc(pages, sizeof(*root.children));
	for (uint32_t i = 0; i <= pages; i++)
		buffer_init(&encoded[i], PAGE_BYTES_MAX);
	for (uint32_t i = 0; i < pages; i++) {
		hash = make_leaf(&maker, objects, bytes, &encoded[i]);
		root.children[i] = (struct page_child){ hash, (uint32_t)encoded[i].size, true };
	}
	block_at = (uint32_t)maker.pack.size;
	for (uint32_t i = 0; i < pages; i++)
		buffer_put(&maker.pack, encoded[i].data, encoded[i].size);
	hash = add_page(&maker, &root, block_at, &encoded[pages]);
	maker.locator.blocks[maker.locator.block_count++] = (struct locator_block){
		{ { 0 } }, 0, (uint32_t)maker.pack.size, (uint32_t)encoded[pages].size
	};
	buffer_put(&maker.pack, encoded[pages].data, encoded[pages].size);
	must(maker.pack.error, "pack");
	write_files(&maker, folder, hash);
	hash_to_hex(hash, hex);
	printf("%s %zu\n", hex, encoded[pages].size);
	for (uint32_t i = 0; i <= pages; i++)
		buffer_finish(&encoded[i]);
	free(encoded);
	free(maker.locator.blocks);
	buffer_finish(&maker.pack);
	page_finish(&root);
	return 0;
}

/* ---- walk */

struct pending {
	struct hash hash;
	bool is_page;
	int64_t since_ms; /* wanted */
};

struct walk {
	struct net_client *client;
	struct hash root;
	uint32_t every, most_s;
	bool keep_pages, unseen, kill, cancel, killed, cancelled, brief;
	struct pending *pending; /* what is to come */
	size_t pending_count, pending_capacity;
	struct message_want *later; /* of batches to come, first come first */
	size_t later_count, later_capacity;
	uint32_t batch; /* 0: all at once */
	int64_t pause_ms, batch_at_ms;
	FILE *latencies;
	uint64_t wanted, came, pages, bytes, dropped, met;
	uint64_t missing[3];
	struct message_status status;
};

static void *grown(void *array, size_t count, size_t *capacity, size_t size)
{
	if (count < *capacity)
		return array;
	*capacity = *capacity * 2 + 64;
	array = realloc(array, *capacity * size);
	if (!array)
		die("what is to come", -ENOMEM);
	return array;
}

static void want_now(struct walk *walk, const struct message_want *message)
{
	const bool is_page = message->priority == MESSAGE_PRIORITY_INDEX;

	walk->pending = grown(walk->pending, walk->pending_count, &walk->pending_capacity,
			      sizeof(*walk->pending));
	walk->pending[walk->pending_count++] =
		(struct pending){ message->hash, is_page, clock_now_ms() };
	if (walk->keep_pages && is_page)
		net_client_keep(walk->client, message->hash);
	must(net_client_want(walk->client, message), "want");
}

static void want(struct walk *walk, struct hash page, const struct page_child *child,
		 uint32_t offset)
{
	struct message_want message = { .hash = child->hash,
					.page = page,
					.offset = offset,
					.size = child->size,
					.priority = child->is_page ? MESSAGE_PRIORITY_INDEX
						    : walk->unseen ? MESSAGE_PRIORITY_LATER
								   : MESSAGE_PRIORITY_PICTURE };

	if (!child->is_page && walk->met++ % walk->every != 0)
		return;
	walk->wanted++;
	if (child->is_page || walk->batch == 0) {
		want_now(walk, &message);
		return;
	}
	walk->later =
		grown(walk->later, walk->later_count, &walk->later_capacity, sizeof(*walk->later));
	walk->later[walk->later_count++] = message;
}

/* The next batch, once the one before has come and was looked at. */
static void want_batch(struct walk *walk)
{
	uint32_t count = 0;

	if (walk->pending_count > 0 || walk->later_count == 0)
		return;
	if (walk->batch_at_ms == 0)
		walk->batch_at_ms = clock_now_ms() + walk->pause_ms;
	if (clock_now_ms() < walk->batch_at_ms)
		return;
	walk->batch_at_ms = 0;
	while (count < walk->batch && count < walk->later_count)
		want_now(walk, &walk->later[count++]);
	walk->later_count -= count;
	memmove(walk->later, walk->later + count, walk->later_count * sizeof(*walk->later));
}

static void on_object(void *data, struct hash hash, struct bytes bytes)
{
	struct walk *walk = data;
	struct page page;
	bool is_page = false;

	for (size_t i = 0; i < walk->pending_count; i++) {
		if (!hash_equal(walk->pending[i].hash, hash))
			continue;
		is_page = walk->pending[i].is_page;
		if (walk->latencies)
			fprintf(walk->latencies, "%lld\n",
				(long long)(clock_now_ms() - walk->pending[i].since_ms));
		walk->pending[i] = walk->pending[--walk->pending_count];
		break;
	}
	if (!hash_equal(hash_of(bytes), hash))
		die("the client passed wrong bytes", -EBADMSG);
	walk->came++;
	walk->bytes += bytes.size;
	if (!is_page)
		return;
	walk->pages++;
	must(page_decode(&page, bytes), "a page");
	for (uint32_t i = 0; i < page.child_count; i++)
		want(walk, hash, &page.children[i], (uint32_t)page_child_offset(&page, i));
	page_finish(&page);
}

static void on_missing(void *data, struct hash hash, enum missing_reason reason)
{
	struct walk *walk = data;

	(void)hash;
	walk->missing[reason]++;
}

static void on_status(void *data, const struct message_status *status)
{
	struct walk *walk = data;

	walk->status = *status;
}

/* The fetcher is our only child. */
static void kill_fetcher(void)
{
	char path[64], text[64] = "";
	FILE *file;

	snprintf(path, sizeof(path), "/proc/self/task/%d/children", (int)getpid());
	file = fopen(path, "r");
	if (file && fgets(text, sizeof(text), file) && strtol(text, NULL, 10) > 1)
		kill((pid_t)strtol(text, NULL, 10), SIGKILL);
	if (file)
		fclose(file);
}

static void drop_every_second(struct walk *walk)
{
	for (size_t i = 0; i < walk->pending_count; i++) {
		if (walk->pending[i].is_page || i % 2)
			continue;
		net_client_drop(walk->client, walk->pending[i].hash);
		walk->pending[i--] = walk->pending[--walk->pending_count];
		walk->wanted--;
		walk->dropped++;
	}
}

static void make_mischief(struct walk *walk)
{
	if (walk->kill && !walk->killed && walk->came * 2 > walk->wanted && walk->pages > 1) {
		walk->killed = true;
		kill_fetcher();
	}
	if (walk->cancel && !walk->cancelled && walk->came * 4 > walk->wanted && walk->pages > 1) {
		walk->cancelled = true;
		drop_every_second(walk);
	}
}

static int run_walk(struct walk *walk, uint32_t root_bytes)
{
	struct page_child root = { walk->root, root_bytes, true };
	int64_t began_ms = clock_now_ms(), first_ms = -1, took_ms;

	net_client_use_release(walk->client, walk->root, root_bytes);
	want(walk, (struct hash){ { 0 } }, &root, 0);
	while (walk->pending_count + walk->later_count > 0 &&
	       clock_now_ms() - began_ms < walk->most_s * 1000) {
		struct pollfd ready = { .fd = net_client_fd(walk->client), .events = POLLIN };

		want_batch(walk);
		if (poll(&ready, 1, 100) > 0)
			must(net_client_dispatch(walk->client), "dispatch");
		if (first_ms < 0 && walk->came > 0)
			first_ms = clock_now_ms() - began_ms;
		make_mischief(walk);
	}
	took_ms = clock_now_ms() - began_ms;
	/* The last figures come within a second of the last object. */
	for (int64_t until_ms = clock_now_ms() + (walk->brief ? 0 : 1300);
	     clock_now_ms() < until_ms;) {
		struct pollfd ready = { .fd = net_client_fd(walk->client), .events = POLLIN };

		if (poll(&ready, 1, 100) > 0)
			must(net_client_dispatch(walk->client), "dispatch");
	}
	printf("{\"wanted\":%llu,\"came\":%llu,\"pages\":%llu,\"bytes\":%llu,\"received\":%llu,"
	       "\"dropped\":%llu,\"offline\":%llu,\"not_found\":%llu,\"damaged\":%llu,"
	       "\"cache_bytes\":%llu,\"online\":%d,\"first_ms\":%lld,\"ms\":%lld}\n",
	       (unsigned long long)walk->wanted, (unsigned long long)walk->came,
	       (unsigned long long)walk->pages, (unsigned long long)walk->bytes,
	       (unsigned long long)walk->status.received_bytes, (unsigned long long)walk->dropped,
	       (unsigned long long)walk->missing[MISSING_OFFLINE],
	       (unsigned long long)walk->missing[MISSING_NOT_FOUND],
	       (unsigned long long)walk->missing[MISSING_DAMAGED],
	       (unsigned long long)walk->status.cache_bytes, walk->status.online,
	       (long long)first_ms, (long long)took_ms);
	return walk->pending_count + walk->later_count > 0;
}

static int walk_main(int argc, char **argv)
{
	static const struct option long_options[] = {
		{ "fetch", 1, NULL, 'f' },
		{ "release", 1, NULL, 'r' },
		{ "cache", 1, NULL, 'c' },
		{ "root", 1, NULL, 'h' },
		{ "bytes", 1, NULL, 'b' },
		{ "ca", 1, NULL, 'a' },
		{ "budget", 1, NULL, 'B' },
		{ "socket", 1, NULL, 's' },
		{ "every", 1, NULL, 'e' },
		{ "most-s", 1, NULL, 'm' },
		{ "kill", 0, NULL, 'k' },
		{ "cancel", 0, NULL, 'C' },
		{ "keep-pages", 0, NULL, 'K' },
		{ "unseen", 0, NULL, 'u' },
		{ "batch", 1, NULL, 'n' },
		{ "pause-ms", 1, NULL, 'p' },
		{ "latencies", 1, NULL, 'l' },
		{ "brief", 0, NULL, 'i' },
		{ 0 },
	};
	struct walk walk = { .every = 1, .most_s = 30 };
	struct net_client_options options = {
		.cache_budget_bytes = 256 << 20,
		.events = { on_object, on_missing, NULL, NULL, on_status },
		.data = &walk,
	};
	uint32_t root_bytes = 0;
	int option, rc;

	while ((option = getopt_long(argc, argv, "", long_options, NULL)) != -1) {
		switch (option) {
		case 'f':
			options.program = optarg;
			break;
		case 'r':
			options.release_url = optarg;
			break;
		case 'c':
			options.cache_path = optarg;
			break;
		case 'h':
			must(hash_from_hex(&walk.root, optarg), "--root");
			break;
		case 'b':
			root_bytes = (uint32_t)strtoul(optarg, NULL, 10);
			break;
		case 'a':
			options.ca_file = optarg;
			break;
		case 'B':
			options.cache_budget_bytes = strtoull(optarg, NULL, 10) << 20;
			break;
		case 's':
			options.socket_path = optarg;
			break;
		case 'e':
			walk.every = (uint32_t)strtoul(optarg, NULL, 10);
			break;
		case 'm':
			walk.most_s = (uint32_t)strtoul(optarg, NULL, 10);
			break;
		case 'k':
			walk.kill = true;
			break;
		case 'C':
			walk.cancel = true;
			break;
		case 'K':
			walk.keep_pages = true;
			break;
		case 'u':
			walk.unseen = true;
			break;
		case 'n':
			walk.batch = (uint32_t)strtoul(optarg, NULL, 10);
			break;
		case 'p':
			walk.pause_ms = (int64_t)strtoul(optarg, NULL, 10);
			break;
		case 'i':
			walk.brief = true;
			break;
		case 'l':
			walk.latencies = fopen(optarg, "w");
			if (!walk.latencies)
				die(optarg, -errno);
			break;
		default:
			return 2;
		}
	}
	must(net_client_create(&walk.client, &options), "client");
	rc = run_walk(&walk, root_bytes);
	net_client_destroy(walk.client);
	free(walk.pending);
	free(walk.later);
	if (walk.latencies)
		fclose(walk.latencies);
	return rc;
}

int main(int argc, char **argv)
{
	if (argc == 7 && strcmp(argv[1], "make") == 0) {
		random_state = (uint32_t)strtoul(argv[6], NULL, 10) * 2654435761u + 1;
		return make(argv[2], (uint32_t)strtoul(argv[3], NULL, 10),
			    (uint32_t)strtoul(argv[4], NULL, 10),
			    (uint32_t)strtoul(argv[5], NULL, 10));
	}
	if (argc > 1 && strcmp(argv[1], "walk") == 0)
		return walk_main(argc - 1, argv + 1);
	fprintf(stderr, "fetch_tool: make or walk; see its source\n");
	return 2;
}
