/* An exchange of keys: the roots that follow are valid, what fails is gone on with, and what cannot
 * be told is refused. */
#include "pipeline/keys/keys_exchange.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/log.h"
#include "pipeline/keys/keys.h"
#include "pipeline/keys/keys_tuf.h"
#include "pipeline/keys/signing.h"
#include "tests/check.h"
#include "tests/pipeline/keys/failing_disk.h"
#include "tuf/sign.h"

enum {
	ROOT = 1 << EXCHANGE_ROOT,
	RELEASE = 1 << EXCHANGE_RELEASE,
	SNAPSHOT = 1 << EXCHANGE_SNAPSHOT,
	TIMESTAMP = 1 << EXCHANGE_TIMESTAMP,
};

static char top[] = "/tmp/gopura-exchange-XXXXXX", folder[PATH_MAX];

static void run(const char *command)
{
	char line[PATH_MAX];

	snprintf(line, sizeof(line), "cd '%s' && %s", top, command);
	CHECK(system(line) == 0);
}

static int begin(void **state)
{
	struct publisher_keys keys;
	(void)state;

	snprintf(top, sizeof(top), "/tmp/gopura-exchange-XXXXXX");
	CHECK(mkdtemp(top) != NULL);
	snprintf(folder, sizeof(folder), "%s/keys", top);
	CHECK(keys_make(folder) == 0 && keys_load(&keys, folder) == 0);
	CHECK(keys_make_tuf_root(folder, &keys) == 0);
	keys_finish(&keys);
	log_set_level((enum log_level) - 1);
	return 0;
}

static int end(void **state)
{
	char command[PATH_MAX];
	(void)state;

	log_set_level(LOG_LEVEL_ERROR);
	snprintf(command, sizeof(command), "rm -rf '%s'", top);
	return system(command);
}

/* ---- a disk that fails from the n-th call on */

int __wrap_rename(const char *from, const char *to)
{
	return fails_now() ? -1 : __real_rename(from, to);
}

/* ---- what must hold */

/* Reads the newest root after all before it, each signed by the keys of the one before. */
static void read_newest(struct tuf_file *out)
{
	const char *why = "";
	struct buffer file;
	uint32_t last;

	*out = (struct tuf_file){ 0 };
	buffer_init(&file, 64 << 10);
	CHECK(keys_last_tuf_root(&last, folder) == 0);
	for (uint32_t version = 1; version <= last; version++) {
		struct tuf_file next;

		CHECK(keys_read_tuf_root(&file, folder, version) == 0);
		if (tuf_root_first(&next, buffer_bytes(&file), &why) < 0)
			fail_msg("root %u: %s", version, why);
		CHECK(next.version == version);
		if (out->json)
			CHECK(tuf_file_verify(&next, tuf_root_keys(out),
					      tuf_root_role(out, TUF_ROOT)) == 0);
		tuf_file_finish(out);
		*out = next;
	}
	buffer_finish(&file);
}

/* What the folder's keys sign is valid under its newest roots, in both forms. */
static void check_keys(void)
{
	const struct bytes message = { (const uint8_t *)"{}", 2 };
	struct publisher_keys keys;
	struct signing signing;
	struct tuf_file root;

	CHECK(keys_load(&keys, folder) == 0);
	keys_finish(&keys);
	read_newest(&root);
	CHECK(signing_read(&signing, folder) == 0);
	for (int type = TUF_TIMESTAMP; type < TUF_TYPES; type++) {
		cJSON *signatures = cJSON_CreateArray();

		CHECK(signing_sign(&signing, (enum tuf_type)type, "a file", tuf_root_keys(&root),
				   tuf_root_role(&root, (enum tuf_type)type), message,
				   signatures) == 0);
		CHECK(cJSON_GetArraySize(signatures) == 1);
		cJSON_Delete(signatures);
	}
	tuf_file_finish(&root);
}

/* Exchanges keys; the files of all others stay as they were. */
static void exchange(unsigned wanted)
{
	struct keys_exchanged exchanged;

	run("rm -rf before && cp -a keys before");
	CHECK(keys_exchange(&exchanged, folder, wanted) == 0);
	CHECK(exchanged.kept == wanted && !exchanged.went_on);
	for (int key = 0; key < EXCHANGE_KEYS; key++) {
		const char *name = exchange_key_names[key];
		char command[256];

		snprintf(command, sizeof(command),
			 wanted & 1u << key
				 ? "cmp before/%s.key keys/%s.key.old && "
				   "! cmp -s before/%s.key keys/%s.key"
				 : "if [ -e keys/%s.key ]; then cmp before/%s.key keys/%s.key && "
				   "[ ! -e keys/%s.key.old ]; fi",
			 name, name, name, name);
		run(command);
	}
	run("[ ! -e keys/exchange ] && [ ! -e keys/exchange.part ]");
	run("[ -z \"$(find keys -name '*.key*' ! -perm 600)\" ]");
	check_keys();
}

static void refuses(unsigned wanted, int error)
{
	struct keys_exchanged exchanged;
	int rc;

	run("rm -rf before && cp -a keys before");
	rc = keys_exchange(&exchanged, folder, wanted);
	if (rc != error)
		fail_msg("%d, not %d", rc, error);
	run("diff -r before keys");
}

/* ---- */

static void any_keys_are_exchanged_and_the_roots_follow(void **state)
{
	(void)state;
	for (unsigned wanted = 1; wanted < 16; wanted++) {
		if (wanted & SNAPSHOT)
			continue; /* not in this folder */
		run("rm -f keys/*.old");
		exchange(wanted);
	}
	run("[ -e keys/root/8.json ] && [ -e keys/tuf/8.root.json ] && [ ! -e keys/tuf/9.root.json ]");
}

static void the_root_has_its_twenty_years_again(void **state)
{
	struct keys_exchanged exchanged;
	struct tuf_file root;
	(void)state;

	CHECK(keys_exchange(&exchanged, folder, TIMESTAMP) == 0);
	read_newest(&root);
	CHECK(root.expires_s == exchanged.expires_s);
	CHECK(exchanged.root == 2 && exchanged.tuf_root == 2);
	tuf_file_finish(&root);
}

static void goes_on_after_a_failure_at_every_step(void **state)
{
	const unsigned wanted = ROOT | RELEASE | TIMESTAMP;
	struct keys_exchanged exchanged;
	struct publisher_keys keys;
	bool went_on = false;
	int steps = 0;
	(void)state;

	run("cp -a keys whole");
	for (bool failed = true; failed; steps++) {
		calls_left = steps + 1;
		failed = keys_exchange(&exchanged, folder, wanted) < 0;
		calls_left = -1;
		if (failed && exchange_going_on(folder)) {
			CHECK(keys_load(&keys, folder) == -EBUSY);
			refuses(ROOT, -EBUSY);
		} else {
			check_keys();
		}
		if (failed && keys_exchange(&exchanged, folder, wanted) < 0)
			fail_msg("step %d: it does not go on", steps);
		went_on = went_on || exchanged.went_on;
		check_keys();
		if (exchanged.went_on)
			run("[ ! -e keys/tuf/3.root.json ] && [ ! -e keys/root/3.json ]");
		run("[ ! -e keys/exchange ] && [ ! -e keys/exchange.part ]");
		run("! cmp -s whole/root.key keys/root.key");
		run("rm -rf keys && cp -a whole keys");
		CHECK(steps < 200);
	}
	CHECK(steps > 20 && went_on);
}

static void a_museum_exchanges_the_snapshot_key_of_its_teams(void **state)
{
	struct signing_key old, new;
	struct publisher_keys keys;
	struct tuf_signer signers[2] = { 0 };
	struct tuf_file root;
	(void)state;

	CHECK(keys_load(&keys, folder) == 0 && keys_make_museum_root(folder, &keys) == 0);
	keys_finish(&keys);
	CHECK(keys_read_key(&old, folder, "snapshot") == 0);
	exchange(SNAPSHOT | RELEASE);
	CHECK(keys_read_key(&new, folder, "snapshot") == 0);
	CHECK(tuf_signer_init(&signers[0], old.secret) == 0);
	CHECK(tuf_signer_init(&signers[1], new.secret) == 0);
	read_newest(&root);
	CHECK(!tuf_role_names(tuf_root_role(&root, TUF_SNAPSHOT), signers[0].id));
	CHECK(tuf_role_names(tuf_root_role(&root, TUF_SNAPSHOT), signers[1].id));
	CHECK(!tuf_role_names(tuf_root_role(&root, TUF_TARGETS), signers[1].id));
	tuf_file_finish(&root);
	/* There is no such key in the earlier form, and no root after it was asked for. */
	run("[ -e keys/root/2.json ] && rm -rf keys/root/2.json keys/tuf");
	refuses(SNAPSHOT, -ENOENT);
}

static void a_lost_key_is_exchanged_if_it_is_clear_which(void **state)
{
	struct keys_exchanged exchanged;
	(void)state;

	run("rm keys/timestamp.key keys/release.key");
	CHECK(keys_exchange(&exchanged, folder, TIMESTAMP | RELEASE) == 0);
	CHECK(exchanged.kept == 0);
	check_keys();
	run("cp keys/timestamp.key timestamp.key && rm keys/timestamp.key");
	run("printf '[keys]\\ntimestamp = token.sh\\n' >keys/signing.ini");
	refuses(TIMESTAMP, -EKEYREJECTED);
	run("cp timestamp.key keys"); /* which the root names, whoever else may sign */
	CHECK(keys_exchange(&exchanged, folder, TIMESTAMP) == 0);
}

/* Edits the newest root as other tools might have made it. root.key and timestamp.key sign it. */
static void edit_root(void (*edit)(cJSON *content))
{
	struct tuf_signer signers[2] = { 0 };
	struct signing_key key;
	struct tuf_file root;
	struct buffer file;
	char path[PATH_MAX + 32];

	read_newest(&root);
	CHECK(keys_read_key(&key, folder, "root") == 0);
	CHECK(tuf_signer_init(&signers[0], key.secret) == 0);
	CHECK(keys_read_key(&key, folder, "timestamp") == 0);
	CHECK(tuf_signer_init(&signers[1], key.secret) == 0);
	edit((cJSON *)root.content);
	buffer_init(&file, 64 << 10);
	CHECK(tuf_sign(&file, root.content, signers, 2) == 0);
	snprintf(path, sizeof(path), "%s/tuf/%u.root.json", folder, root.version);
	CHECK(bytes_write_file(buffer_bytes(&file), path) == 0);
	buffer_finish(&file);
	tuf_file_finish(&root);
}

static cJSON *ids_of(cJSON *content, const char *role)
{
	return cJSON_GetObjectItem(cJSON_GetObjectItem(cJSON_GetObjectItem(content, "roles"), role),
				   "keyids");
}

static void name_by_another_id(cJSON *content)
{
	cJSON *keys = cJSON_GetObjectItem(content, "keys");
	cJSON *ids = ids_of(content, "timestamp");
	const char *id = cJSON_GetArrayItem(ids, 0)->valuestring;

	cJSON_AddItemToObject(keys, "07", cJSON_DetachItemFromObjectCaseSensitive(keys, id));
	cJSON_ReplaceItemInArray(ids, 0, cJSON_CreateString("07"));
}

static void a_key_is_known_whatever_id_others_gave_it(void **state)
{
	struct tuf_file root;
	(void)state;

	edit_root(name_by_another_id);
	exchange(TIMESTAMP);
	read_newest(&root);
	CHECK(!tuf_role_names(tuf_root_role(&root, TUF_TIMESTAMP), "07"));
	CHECK(!cJSON_GetObjectItem(tuf_root_keys(&root), "07"));
	tuf_file_finish(&root);
}

/* release.key signs timestamps too. */
static void add_a_second(cJSON *content)
{
	const cJSON *id = cJSON_GetArrayItem(ids_of(content, "targets"), 0);

	cJSON_AddItemToArray(ids_of(content, "timestamp"), cJSON_Duplicate(id, true));
}

static void of_several_keys_that_of_the_file_goes(void **state)
{
	struct tuf_file root;
	(void)state;

	edit_root(add_a_second);
	run("mv keys/timestamp.key .");
	refuses(TIMESTAMP, -EKEYREJECTED);
	run("mv timestamp.key keys");
	exchange(TIMESTAMP);
	run("rm keys/timestamp.key.old");
	exchange(RELEASE); /* in every role that it signs for */
	read_newest(&root);
	CHECK(cJSON_GetArraySize(tuf_root_keys(&root)) == 3);
	CHECK(cJSON_GetArraySize(
		      cJSON_GetObjectItem(tuf_root_role(&root, TUF_TIMESTAMP), "keyids")) == 2);
	tuf_file_finish(&root);
}

static void ask_for_two(cJSON *content)
{
	const cJSON *roles = cJSON_GetObjectItem(content, "roles");
	const cJSON *id = cJSON_GetArrayItem(ids_of(content, "timestamp"), 0);

	cJSON_SetIntValue(cJSON_GetObjectItem(cJSON_GetObjectItem(roles, "root"), "threshold"), 2);
	cJSON_AddItemToArray(ids_of(content, "root"), cJSON_Duplicate(id, true));
}

static void a_root_of_two_signatures_is_left_to_other_tools(void **state)
{
	(void)state;
	edit_root(ask_for_two);
	refuses(TIMESTAMP, -EKEYREJECTED);
	refuses(ROOT, -EKEYREJECTED);
}

static void what_is_missing_is_said_before_anything_is_made(void **state)
{
	(void)state;
	run("mv keys/root.key .");
	refuses(TIMESTAMP, -ENOENT);
	refuses(ROOT, -ENOENT);
	run("mv root.key keys && mv keys/root keys/tuf .");
	refuses(TIMESTAMP, -ENOENT);
	run("mv root keys && : > keys/tuf"); /* not a folder: nobody can say that there is no root
					      */
	refuses(ROOT, -ENOTDIR);
	run("rm keys/tuf && mv tuf keys && chmod 644 keys/timestamp.key");
	refuses(TIMESTAMP, -EPERM);
	run("chmod 600 keys/timestamp.key && cp keys/timestamp.key keys/root.key");
	refuses(TIMESTAMP, -EBADMSG);
}

#define EACH_IN_ITS_FOLDER(test) cmocka_unit_test_setup_teardown(test, begin, end)

int main(void)
{
	const struct CMUnitTest tests[] = {
		EACH_IN_ITS_FOLDER(any_keys_are_exchanged_and_the_roots_follow),
		EACH_IN_ITS_FOLDER(the_root_has_its_twenty_years_again),
		EACH_IN_ITS_FOLDER(goes_on_after_a_failure_at_every_step),
		EACH_IN_ITS_FOLDER(a_museum_exchanges_the_snapshot_key_of_its_teams),
		EACH_IN_ITS_FOLDER(a_lost_key_is_exchanged_if_it_is_clear_which),
		EACH_IN_ITS_FOLDER(a_key_is_known_whatever_id_others_gave_it),
		EACH_IN_ITS_FOLDER(of_several_keys_that_of_the_file_goes),
		EACH_IN_ITS_FOLDER(a_root_of_two_signatures_is_left_to_other_tools),
		EACH_IN_ITS_FOLDER(what_is_missing_is_said_before_anything_is_made),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
