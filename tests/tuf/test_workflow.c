/* A repository in memory, honest or not, and a client with its store in memory: what is accepted,
 * and each attack of the specification (TUF 1.0.34, section 1.5.2) by its name. */
#include "tuf/targets.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "tests/check.h"
#include "tuf/sign.h"

enum { FILES = 64, NOW = 1800000000 };

struct file {
	char name[80];
	struct buffer bytes;
};

struct shelf {
	struct file file[FILES];
	int count;
};

static struct tuf_signer keys[8];
static struct shelf server, stored;
static int fetched; /* since the refresh began */

/* ---- shelves */

static struct file *find(struct shelf *shelf, const char *name)
{
	for (int i = 0; i < shelf->count; i++)
		if (strcmp(shelf->file[i].name, name) == 0)
			return &shelf->file[i];
	return NULL;
}

static void put(struct shelf *shelf, const char *name, struct bytes bytes)
{
	struct file *file = find(shelf, name);

	if (!file) {
		CHECK(shelf->count < FILES);
		file = &shelf->file[shelf->count++];
		snprintf(file->name, sizeof(file->name), "%s", name);
		buffer_init(&file->bytes, 1 << 24);
	}
	buffer_clear(&file->bytes);
	buffer_put(&file->bytes, bytes.data, bytes.size);
}

static void drop(struct shelf *shelf, const char *name)
{
	struct file *file = find(shelf, name);

	CHECK(file != NULL);
	file->name[0] = 0;
}

static void empty(struct shelf *shelf)
{
	for (int i = 0; i < shelf->count; i++)
		buffer_finish(&shelf->file[i].bytes);
	shelf->count = 0;
}

static int take(struct shelf *shelf, const char *name, struct buffer *out)
{
	const struct file *file = find(shelf, name);

	if (!file)
		return -ENOENT;
	buffer_put(out, file->bytes.data, file->bytes.size);
	return out->error;
}

static int fetch(void *context, const char *name, struct buffer *out)
{
	(void)context;
	fetched++;
	return take(&server, name, out);
}

static const char *unreadable; /* a stored file; NULL: none */

static int load(void *context, const char *name, struct buffer *out)
{
	(void)context;
	if (unreadable && strcmp(name, unreadable) == 0)
		return -EIO;
	return take(&stored, name, out);
}

static int store(void *context, const char *name, struct bytes file)
{
	(void)context;
	put(&stored, name, file);
	return 0;
}

/* ---- the repository: a root of keys 0 and 1, both needed; then one key for each role */

static cJSON *begin(const char *type, int version, const char *expires)
{
	cJSON *content = cJSON_CreateObject();

	cJSON_AddStringToObject(content, "_type", type);
	cJSON_AddStringToObject(content, "spec_version", "1.0.31");
	cJSON_AddNumberToObject(content, "version", version);
	cJSON_AddStringToObject(content, "expires", expires);
	return content;
}

static const char *const later = "2050-01-01T00:00:00Z", *const before = "2020-01-01T00:00:00Z";

static void publish(const char *name, cJSON *content, const struct tuf_signer *signers, int count)
{
	struct buffer file;

	buffer_init(&file, 1 << 24);
	CHECK(tuf_sign(&file, content, signers, (uint32_t)count) == 0);
	put(&server, name, buffer_bytes(&file));
	buffer_finish(&file);
	cJSON_Delete(content);
}

static void add_role(cJSON *roles, const char *name, int threshold, int first, int count)
{
	cJSON *role = cJSON_AddObjectToObject(roles, name);
	cJSON *ids = cJSON_AddArrayToObject(role, "keyids");

	for (int i = first; i < first + count; i++)
		cJSON_AddItemToArray(ids, cJSON_CreateString(keys[i].id));
	cJSON_AddNumberToObject(role, "threshold", threshold);
}

/* timestamp: the key that signs it */
static cJSON *root_content(int version, int timestamp)
{
	cJSON *content = begin("root", version, later);
	cJSON *all = cJSON_AddObjectToObject(content, "keys");
	cJSON *roles = cJSON_AddObjectToObject(content, "roles");

	for (int i = 0; i < 8; i++)
		cJSON_AddItemToObject(all, keys[i].id, tuf_signer_key(&keys[i]));
	cJSON_AddTrueToObject(content, "consistent_snapshot");
	add_role(roles, "root", 2, 0, 2);
	add_role(roles, "timestamp", 1, timestamp, 1);
	add_role(roles, "snapshot", 1, 3, 1);
	add_role(roles, "targets", 1, 4, 1);
	return content;
}

static void add_meta(cJSON *content, const char *name, int version, const char *file)
{
	cJSON *all = cJSON_GetObjectItem(content, "meta");
	cJSON *meta =
		cJSON_AddObjectToObject(all ? all : cJSON_AddObjectToObject(content, "meta"), name);
	struct file *of = file ? find(&server, file) : NULL;
	uint8_t hash[crypto_hash_sha256_BYTES];
	char hex[2 * sizeof(hash) + 1];

	cJSON_AddNumberToObject(meta, "version", version);
	if (!of)
		return;
	crypto_hash_sha256(hash, of->bytes.data, of->bytes.size);
	sodium_bin2hex(hex, sizeof(hex), hash, sizeof(hash));
	cJSON_AddNumberToObject(meta, "length", (double)of->bytes.size);
	cJSON_AddStringToObject(cJSON_AddObjectToObject(meta, "hashes"), "sha256", hex);
}

static void add_target(cJSON *content, const char *path, const char *text)
{
	cJSON *all = cJSON_GetObjectItem(content, "targets");
	cJSON *target = cJSON_AddObjectToObject(
		all ? all : cJSON_AddObjectToObject(content, "targets"), path);
	uint8_t hash[crypto_hash_sha512_BYTES];
	char hex[2 * sizeof(hash) + 1];

	crypto_hash_sha512(hash, (const uint8_t *)text, strlen(text));
	sodium_bin2hex(hex, sizeof(hex), hash, sizeof(hash));
	cJSON_AddNumberToObject(target, "length", (double)strlen(text));
	cJSON_AddStringToObject(cJSON_AddObjectToObject(target, "hashes"), "sha512", hex);
}

static void publish_targets(int version)
{
	char name[32];
	cJSON *content = begin("targets", version, later);

	add_target(content, "temple/release.json", "the temple");
	snprintf(name, sizeof(name), "%d.targets.json", version);
	publish(name, content, &keys[4], 1);
}

static void publish_snapshot(int version, int targets, const char *expires)
{
	char name[32], of[32];
	cJSON *content = begin("snapshot", version, expires);

	snprintf(of, sizeof(of), "%d.targets.json", targets);
	add_meta(content, "targets.json", targets, of);
	snprintf(name, sizeof(name), "%d.snapshot.json", version);
	publish(name, content, &keys[3], 1);
}

static void publish_timestamp(int version, int snapshot, const char *expires, int key)
{
	char of[32];
	cJSON *content = begin("timestamp", version, expires);

	snprintf(of, sizeof(of), "%d.snapshot.json", snapshot);
	add_meta(content, "snapshot.json", snapshot, of);
	publish("timestamp.json", content, &keys[key], 1);
}

/* The whole repository at that version, under the root of version 1. */
static void publish_all(int version)
{
	publish_targets(version);
	publish_snapshot(version, version, later);
	publish_timestamp(version, version, later, 2);
}

static int prepare(void **state)
{
	(void)state;
	if (sodium_init() < 0)
		return -1;
	empty(&server);
	empty(&stored);
	for (int i = 0; i < 8; i++) {
		const uint8_t seed[32] = { (uint8_t)(i + 1) };

		if (tuf_signer_init(&keys[i], seed) < 0)
			return -1;
	}
	publish("root.json", root_content(1, 2), keys, 2);
	put(&stored, "root.json", buffer_bytes(&find(&server, "root.json")->bytes));
	publish_all(1);
	return 0;
}

static int clear(void **state)
{
	(void)state;
	empty(&server);
	empty(&stored);
	return 0;
}

static const struct tuf_io io = { NULL, fetch, load, store };

/* Refreshes and says what came of it; the version of the targets that are then trusted goes to
 * *targets, 0: none. */
static int refresh_at(int64_t now_s, uint32_t *targets)
{
	struct tuf_client client;
	int rc;

	fetched = 0;
	rc = tuf_client_refresh(&client, &io, now_s);
	CHECK((rc == 0) == (client.why[0] == 0) || rc == 0);
	if (targets)
		*targets = client.targets.version;
	tuf_client_finish(&client);
	return rc;
}

static int refresh(void)
{
	return refresh_at(NOW, NULL);
}

/* ---- tests */

static void an_honest_repository_is_followed(void **state)
{
	uint32_t targets;

	(void)state;
	CHECK(refresh_at(NOW, &targets) == 0 && targets == 1);
	CHECK(fetched == 4); /* root 2, which is not there; timestamp, snapshot, targets */
	CHECK(refresh_at(NOW, &targets) == 0 && targets == 1 && fetched == 2);
	publish_all(2);
	CHECK(refresh_at(NOW, &targets) == 0 && targets == 2);
}

static void a_target_is_found_and_known_by_its_bytes(void **state)
{
	const struct bytes right = { (const uint8_t *)"the temple", 10 };
	const struct bytes wrong = { (const uint8_t *)"the Temple", 10 };
	struct tuf_client client;
	struct tuf_target target;

	(void)state;
	CHECK(tuf_client_refresh(&client, &io, NOW) == 0);
	CHECK(tuf_client_find(&client, "temple/release.json", &target) == 0);
	CHECK(strncmp(target.file, "temple/", 7) == 0 && strstr(target.file, ".release.json"));
	CHECK(target.length == 10 && tuf_target_is(&target, right));
	CHECK(!tuf_target_is(&target, wrong));
	tuf_target_finish(&target);
	CHECK(tuf_client_find(&client, "temple/other.json", &target) == -ENOENT);
	CHECK(target.entry == NULL && client.why[0]);
	tuf_client_finish(&client);
}

/* Or a disk that fails for a moment would let an older release in. */
static void what_was_stored_counts_where_it_cannot_be_read(void **state)
{
	struct buffer old;

	(void)state;
	buffer_init(&old, 1 << 16);
	CHECK(take(&server, "timestamp.json", &old) == 0);
	publish_all(2);
	CHECK(refresh() == 0);
	put(&server, "timestamp.json", buffer_bytes(&old));
	CHECK(refresh() == -ESTALE);
	unreadable = "timestamp.json";
	CHECK(refresh() == -EIO);
	unreadable = "snapshot.json";
	CHECK(refresh() == -ESTALE); /* the timestamp comes first */
	publish_all(3);
	CHECK(refresh() == -EIO);
	unreadable = NULL;
	CHECK(refresh() == 0);
	buffer_finish(&old);
}

static void arbitrary_installation(void **state)
{
	(void)state;
	/* Who has only the timestamp's key makes all files. */
	publish_targets(2);
	publish("2.targets.json", begin("targets", 2, later), &keys[2], 1);
	CHECK(refresh() == 0); /* nothing names it yet */
	publish_snapshot(2, 2, later);
	publish_timestamp(2, 2, later, 2);
	CHECK(refresh() == -EBADMSG); /* no targets in it */
	cJSON *content = begin("targets", 2, later);

	add_target(content, "temple/release.json", "another temple");
	publish("2.targets.json", content, &keys[2], 1);
	publish_snapshot(2, 2, later);
	publish_timestamp(3, 2, later, 2);
	CHECK(refresh() < 0);
}

static void endless_data(void **state)
{
	static uint8_t much[6 << 20];

	(void)state;
	put(&server, "timestamp.json", (struct bytes){ much, sizeof(much) });
	CHECK(refresh() == -EFBIG);
	publish_timestamp(1, 1, later, 2);
	put(&server, "1.snapshot.json", (struct bytes){ much, sizeof(much) });
	CHECK(refresh() == -EFBIG); /* beyond the length that the timestamp names */
}

static void rollback(void **state)
{
	uint32_t targets;

	(void)state;
	publish_all(2);
	CHECK(refresh() == 0);
	publish_timestamp(1, 1, later, 2); /* all of version 1 again */
	CHECK(refresh() == -ESTALE);
	publish_timestamp(3, 1, later, 2); /* a newer timestamp, an older snapshot */
	CHECK(refresh() == -ESTALE);
	publish_snapshot(3, 1, later); /* a newer snapshot, older targets */
	publish_timestamp(3, 3, later, 2);
	CHECK(refresh_at(NOW, &targets) == -ESTALE && targets == 0);
}

static void fast_forward_and_its_recovery(void **state)
{
	(void)state;
	publish_timestamp(2000000000, 1, later, 2); /* by who stole that key */
	CHECK(refresh() == 0);
	publish_timestamp(2, 1, later, 2);
	CHECK(refresh() == -ESTALE);
	publish("2.root.json", root_content(2, 5), keys, 2); /* the museum gives it another key */
	publish_timestamp(2, 1, later, 5);
	CHECK(refresh() == 0);
}

static void indefinite_freeze(void **state)
{
	(void)state;
	CHECK(refresh() == 0);
	CHECK(refresh_at((int64_t)4102444800, NULL) == -ETIME); /* 2100 */
	publish_timestamp(2, 1, before, 2);
	CHECK(refresh() == -ETIME);
	publish_snapshot(2, 1, before);
	publish_timestamp(3, 2, later, 2);
	CHECK(refresh() == -ETIME);
}

static void mix_and_match(void **state)
{
	(void)state;
	publish_all(2);
	publish_targets(1); /* the targets of one moment under the snapshot of another */
	put(&server, "2.targets.json", buffer_bytes(&find(&server, "1.targets.json")->bytes));
	CHECK(refresh() == -EBADMSG);
	put(&server, "2.snapshot.json", buffer_bytes(&find(&server, "1.snapshot.json")->bytes));
	CHECK(refresh() == -EBADMSG);
}

static void wrong_installation(void **state)
{
	struct tuf_client client;
	struct tuf_target target;

	(void)state;
	CHECK(tuf_client_refresh(&client, &io, NOW) == 0);
	/* Another temple's file under this one's path is not the target. */
	CHECK(tuf_client_find(&client, "temple/release.json", &target) == 0);
	CHECK(!tuf_target_is(&target, (struct bytes){ (const uint8_t *)"the stupa", 9 }));
	tuf_target_finish(&target);
	tuf_client_finish(&client);
}

static void a_malicious_mirror_gives_nothing(void **state)
{
	(void)state;
	CHECK(refresh() == 0);
	drop(&server, "timestamp.json");
	CHECK(refresh() == -ENOENT);
	put(&server, "timestamp.json", (struct bytes){ (const uint8_t *)"{", 1 });
	CHECK(refresh() == -EBADMSG);
	publish_all(2);
	drop(&server, "2.targets.json");
	CHECK(refresh() == -ENOENT);
}

static void a_root_needs_the_keys_before_it_and_its_own(void **state)
{
	(void)state;
	publish("2.root.json", root_content(2, 2), keys, 1); /* one of two */
	CHECK(refresh() == -EKEYREJECTED);
	publish("2.root.json", root_content(3, 2), keys, 2);
	CHECK(refresh() == -EBADMSG);
	publish("2.root.json", root_content(2, 2), keys, 2);
	CHECK(refresh() == 0);
}

/* Two ids for one key, and one id with two signatures, are still one key. */
static void one_key_counts_once(void **state)
{
	cJSON *content = root_content(2, 2), *all = cJSON_GetObjectItem(content, "keys");
	cJSON *role = cJSON_GetObjectItem(cJSON_GetObjectItem(content, "roles"), "snapshot");
	struct tuf_signer twins[2] = { keys[3], keys[3] };

	(void)state;
	snprintf(twins[1].id, sizeof(twins[1].id), "another");
	cJSON_AddItemToObject(all, twins[1].id, tuf_signer_key(&twins[1]));
	cJSON_AddItemToArray(cJSON_GetObjectItem(role, "keyids"), cJSON_CreateString("another"));
	cJSON_SetNumberValue(cJSON_GetObjectItem(role, "threshold"), 2);
	publish("2.root.json", content, keys, 2);
	content = begin("snapshot", 2, later);
	add_meta(content, "targets.json", 1, NULL);
	publish("2.snapshot.json", content, twins, 2);
	publish_timestamp(2, 2, later, 2);
	CHECK(refresh() == -EKEYREJECTED);
	twins[1] = twins[0];
	content = begin("snapshot", 2, later);
	add_meta(content, "targets.json", 1, NULL);
	publish("2.snapshot.json", content, twins, 2);
	publish_timestamp(3, 2, later, 2);
	CHECK(refresh() == -EBADMSG);
}

/* No change of a byte in any file is accepted as another content. */
static void no_damage_is_accepted(void **state)
{
	struct file *file = find(&server, "1.targets.json");

	(void)state;
	for (size_t i = 0; i < file->bytes.size; i += 7) {
		uint32_t targets;

		file->bytes.data[i] ^= 1;
		CHECK(refresh_at(NOW, &targets) < 0 && targets == 0);
		file->bytes.data[i] ^= 1;
	}
	file = find(&server, "timestamp.json");
	for (size_t i = 0; i < file->bytes.size; i++) {
		file->bytes.data[i] ^= 4;
		put(&stored, "root.json", buffer_bytes(&find(&server, "root.json")->bytes));
		/* a changed space at the end is none of the content */
		CHECK(refresh() < 0 || i + 1 == file->bytes.size);
		file->bytes.data[i] ^= 4;
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(an_honest_repository_is_followed, prepare, clear),
		cmocka_unit_test_setup_teardown(a_target_is_found_and_known_by_its_bytes, prepare,
						clear),
		cmocka_unit_test_setup_teardown(what_was_stored_counts_where_it_cannot_be_read,
						prepare, clear),
		cmocka_unit_test_setup_teardown(arbitrary_installation, prepare, clear),
		cmocka_unit_test_setup_teardown(endless_data, prepare, clear),
		cmocka_unit_test_setup_teardown(rollback, prepare, clear),
		cmocka_unit_test_setup_teardown(fast_forward_and_its_recovery, prepare, clear),
		cmocka_unit_test_setup_teardown(indefinite_freeze, prepare, clear),
		cmocka_unit_test_setup_teardown(mix_and_match, prepare, clear),
		cmocka_unit_test_setup_teardown(wrong_installation, prepare, clear),
		cmocka_unit_test_setup_teardown(a_malicious_mirror_gives_nothing, prepare, clear),
		cmocka_unit_test_setup_teardown(a_root_needs_the_keys_before_it_and_its_own,
						prepare, clear),
		cmocka_unit_test_setup_teardown(one_key_counts_once, prepare, clear),
		cmocka_unit_test_setup_teardown(no_damage_is_accepted, prepare, clear),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
