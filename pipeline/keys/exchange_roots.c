/* Copies the newest root with other keys, and checks the next one as a terminal would. */
#include "pipeline/keys/exchange_roots.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "base/json_tree.h"
#include "base/log.h"
#include "pipeline/keys/keys_tuf.h"
#include "pipeline/keys/signing.h"
#include "tuf/canonical.h"
#include "tuf/key.h"
#include "tuf/sign.h"

static bool has(unsigned set, enum exchange_key key)
{
	return set & 1u << key;
}

static const char earlier_form[] = "the newest root/N.json",
		  tuf_form[] = "the newest tuf/N.root.json";

static const char not_alone[] =
	"root.key alone may not sign the root after this one; let the tools that made it exchange "
	"the key";

/* why NULL: what rc says */
static int complain(const struct exchange *exchange, const char *form, uint32_t version, int rc,
		    const char *why)
{
	log_error("pipeline", "%s: %s, version %" PRIu32 ": %s", exchange->folder, form, version,
		  rc == -EKEYREJECTED ? not_alone
		  : why               ? why
				      : strerror(-rc));
	return rc;
}

static int check_root_key(const struct exchange *exchange)
{
	if (has(exchange->present, EXCHANGE_ROOT))
		return 0;
	log_error("pipeline",
		  "%s/root.key: not here; bring it back for this one command, since it signs who "
		  "may sign",
		  exchange->folder);
	return -ENOENT;
}

static int complain_unknown(const struct exchange *exchange, enum exchange_key key,
			    const char *root)
{
	const char *name = exchange_key_names[key];

	if (has(exchange->present, key))
		log_error("pipeline",
			  "%s/%s.key: %s does not name this key; bring the one that it names, or "
			  "let other tools make the next root",
			  exchange->folder, name, root);
	else
		log_error("pipeline",
			  "%s/%s.key: not here, and %s names other keys than one: bring it back, "
			  "so that it can be told which of them is to go",
			  exchange->folder, name, root);
	return -EKEYREJECTED;
}

/* ---- the earlier form */

static const enum exchange_key key_of[] = { [META_ROOT] = EXCHANGE_ROOT,
					    [META_RELEASE] = EXCHANGE_RELEASE,
					    [META_TIMESTAMP] = EXCHANGE_TIMESTAMP };

/* Returns the place of a key among a role's, or -1. */
static int find(const struct role_keys *role, const struct signing_key *key)
{
	for (uint32_t i = 0; i < role->key_count; i++)
		if (memcmp(role->keys[i], key->public_key, KEY_BYTES) == 0)
			return (int)i;
	return -1;
}

/* Replaces the role's key where it has to be. *changed says whether it had. */
static int replace_earlier(struct role_keys *role, const struct exchange *exchange,
			   enum exchange_key key, bool *changed)
{
	int at = role->key_count == 1 ? 0 : -1;

	if (find(role, &exchange->next[key]) >= 0)
		return 0;
	if (at < 0 && has(exchange->present, key))
		at = find(role, &exchange->old[key]);
	if (at < 0)
		return complain_unknown(exchange, key, earlier_form);
	memcpy(role->keys[at], exchange->next[key].public_key, KEY_BYTES);
	*changed = true;
	return 0;
}

static int sign_earlier(struct buffer *out, const struct exchange *exchange,
			const struct trust_root *before, const struct trust_root *next)
{
	const struct signing_key keys[] = { exchange->old[EXCHANGE_ROOT],
					    exchange->next[EXCHANGE_ROOT] };
	struct trust_root check = *before;
	const char *why = NULL;
	int rc = trust_root_encode(out, next, keys, has(exchange->wanted, EXCHANGE_ROOT) ? 2 : 1);

	if (rc == 0)
		rc = trust_root_next(&check, buffer_bytes(out), &why);
	if (rc < 0)
		complain(exchange, earlier_form, before->version, rc, why);
	return rc;
}

int exchange_earlier_root(struct exchange_root *out, const struct exchange *exchange)
{
	struct trust_root before, next;
	bool changed = false;
	int rc = keys_read_trust(&before, exchange->folder);

	out->version = 0;
	if (rc < 0)
		return rc == -ENOENT ? 0 : rc;
	out->version = before.version;
	next = before;
	next.version++;
	next.expires_s = exchange->expires_s;
	for (int role = META_ROOT; role <= META_TIMESTAMP && rc == 0; role++)
		if (has(exchange->wanted, key_of[role]))
			rc = replace_earlier(&next.roles[role], exchange, key_of[role], &changed);
	if (rc < 0 || !changed)
		return rc;
	rc = check_root_key(exchange);
	return rc < 0 ? rc : sign_earlier(&out->file, exchange, &before, &next);
}

/* ---- The Update Framework */

static const enum tuf_type type_of[EXCHANGE_KEYS] = {
	[EXCHANGE_ROOT] = TUF_ROOT,
	[EXCHANGE_RELEASE] = TUF_TARGETS,
	[EXCHANGE_SNAPSHOT] = TUF_SNAPSHOT,
	[EXCHANGE_TIMESTAMP] = TUF_TIMESTAMP,
};

static const cJSON *keyids(const cJSON *role)
{
	return cJSON_GetObjectItemCaseSensitive(role, "keyids");
}

/* Returns under which id the role names this key, borrowed, or NULL. Other tools may have given it
 * another id than ours. */
static const char *id_of(const struct tuf_file *root, enum exchange_key key,
			 const struct signing_key *of)
{
	struct tuf_signer signer = { 0 };
	struct tuf_key_name name, other;
	const char *found = NULL;
	const cJSON *id;
	cJSON *entry = tuf_signer_init(&signer, of->secret) == 0 ? tuf_signer_key(&signer) : NULL;
	const bool is_key = entry && tuf_key_name_of(entry, &name) > 0;

	cJSON_ArrayForEach(id, keyids(tuf_root_role(root, type_of[key])))
	{
		const cJSON *named = cJSON_GetObjectItemCaseSensitive(tuf_root_keys(root),
								      cJSON_GetStringValue(id));

		if (is_key && named && tuf_key_name_of(named, &other) > 0 &&
		    memcmp(name.sha256, other.sha256, sizeof(name.sha256)) == 0)
			found = cJSON_GetStringValue(id);
	}
	cJSON_Delete(entry);
	tuf_signer_finish(&signer);
	return found;
}

/* Returns whether NAME.key is a file that signs, or signed before it was lost, by what signing.ini
 * says. snapshot.key is the teams', so the museum's signing.ini need not name it. */
static bool is_signer(const struct exchange *exchange, enum exchange_key key)
{
	struct signing signing;
	char file[32];

	snprintf(file, sizeof(file), "%s.key", exchange_key_names[key]);
	if (signing_read(&signing, exchange->folder) < 0)
		return false;
	return strstr(signing.signers[type_of[key]], file) ||
	       (key == EXCHANGE_SNAPSHOT &&
		strcmp(signing.signers[TUF_SNAPSHOT], "release.key") == 0);
}

/* Returns the id of the only key that may sign for the role (snapshots: besides those of the
 * targets), borrowed, or NULL. */
static const char *only_id(const struct tuf_file *root, enum exchange_key key)
{
	const cJSON *targets = tuf_root_role(root, TUF_TARGETS), *id;
	const char *found = NULL;
	int count = 0;

	cJSON_ArrayForEach(id, keyids(tuf_root_role(root, type_of[key])))
	{
		if (key == EXCHANGE_SNAPSHOT && tuf_role_names(targets, cJSON_GetStringValue(id)))
			continue;
		found = cJSON_GetStringValue(id);
		count++;
	}
	return count == 1 ? found : NULL;
}

static int find_old(const struct exchange *exchange, const struct tuf_file *root,
		    enum exchange_key key, const char **id)
{
	const char *name = exchange_key_names[key];

	*id = has(exchange->present, key) ? id_of(root, key, &exchange->old[key]) : NULL;
	if (*id)
		return 0;
	if (key == EXCHANGE_SNAPSHOT && !only_id(root, key)) {
		log_error("pipeline",
			  "%s/snapshot.key: no such key may sign, release.key signs snapshots too: "
			  "exchange that one",
			  exchange->folder);
		return -EKEYREJECTED;
	}
	if (!is_signer(exchange, key)) {
		log_error("pipeline",
			  "%s/signing.ini: others sign than %s.key: make their new key where the "
			  "old one is, and the next root with other tools of The Update Framework "
			  "(docs/tuf.md)",
			  exchange->folder, name);
		return -EKEYREJECTED;
	}
	if (!has(exchange->present, key))
		*id = only_id(root, key);
	return *id ? 0 : complain_unknown(exchange, key, tuf_form);
}

/* Exchanges an id for the new key's wherever it stands: a key that was stolen may sign nothing. */
static bool replace_id(cJSON *content, const char *old, const struct signing_key *key)
{
	cJSON *keys = cJSON_GetObjectItemCaseSensitive(content, "keys"), *role, *entry;
	struct tuf_signer signer = { 0 };
	bool done = tuf_signer_init(&signer, key->secret) == 0;

	cJSON_ArrayForEach(role, cJSON_GetObjectItemCaseSensitive(content, "roles"))
	{
		cJSON *ids = cJSON_GetObjectItemCaseSensitive(role, "keyids");

		for (int i = 0; done && i < cJSON_GetArraySize(ids); i++)
			if (strcmp(cJSON_GetStringValue(cJSON_GetArrayItem(ids, i)), old) == 0)
				done = cJSON_ReplaceItemInArray(ids, i,
								cJSON_CreateString(signer.id));
	}
	entry = done ? tuf_signer_key(&signer) : NULL;
	done = json_add(keys, signer.id, entry);
	tuf_signer_finish(&signer);
	return done;
}

static int replace_tuf(cJSON *content, const struct exchange *exchange, const struct tuf_file *last,
		       bool *changed)
{
	for (int key = 0; key < EXCHANGE_KEYS; key++) {
		const char *old;
		int rc;

		if (!has(exchange->wanted, key) || id_of(last, key, &exchange->next[key]))
			continue;
		rc = find_old(exchange, last, key, &old);
		if (rc == 0 && !replace_id(content, old, &exchange->next[key]))
			rc = complain(exchange, tuf_form, last->version, -ENOMEM, NULL);
		if (rc < 0)
			return rc;
		*changed = true;
	}
	tuf_drop_unused_keys(cJSON_GetObjectItemCaseSensitive(content, "keys"),
			     cJSON_GetObjectItemCaseSensitive(content, "roles"));
	return 0;
}

static int add_signature(cJSON *signatures, const cJSON *root, struct bytes message,
			 const struct signing_key *key)
{
	const cJSON *roles = cJSON_GetObjectItemCaseSensitive(root, "roles");
	uint8_t signature[crypto_sign_BYTES];

	crypto_sign_detached(signature, NULL, message.data, message.size, key->secret);
	return tuf_add_signature(signatures, cJSON_GetObjectItemCaseSensitive(root, "keys"),
				 cJSON_GetObjectItemCaseSensitive(roles, tuf_type_names[TUF_ROOT]),
				 message, (struct bytes){ signature, sizeof(signature) });
}

static int sign_tuf(struct buffer *out, const struct exchange *exchange, const cJSON *content,
		    const struct tuf_file *last)
{
	cJSON *signatures = cJSON_CreateArray();
	struct buffer message;
	int rc = signatures ? 0 : -ENOMEM;

	buffer_init(&message, out->ceiling);
	if (rc == 0)
		rc = canonical_write(&message, content);
	if (rc == 0)
		rc = add_signature(signatures, last->content, buffer_bytes(&message),
				   &exchange->old[EXCHANGE_ROOT]);
	if (rc == 0 && has(exchange->wanted, EXCHANGE_ROOT))
		rc = add_signature(signatures, content, buffer_bytes(&message),
				   &exchange->next[EXCHANGE_ROOT]);
	if (rc == 0)
		rc = tuf_write_signed(out, buffer_bytes(&message), signatures);
	buffer_finish(&message);
	cJSON_Delete(signatures);
	return rc;
}

/* The root before and the new one must both have signatures enough. */
static int check_tuf(const struct buffer *file, const struct tuf_file *last, const char **why)
{
	struct tuf_file next = { 0 };
	int rc = tuf_root_first(&next, buffer_bytes(file), why);

	if (rc == 0)
		rc = tuf_file_verify(&next, tuf_root_keys(last), tuf_root_role(last, TUF_ROOT));
	tuf_file_finish(&next);
	return rc;
}

static int make_tuf(struct exchange_root *out, const struct exchange *exchange,
		    const struct tuf_file *last)
{
	cJSON *content = tuf_next_content(last, TUF_ROOT, last->version + 1, exchange->expires_s);
	const char *why = NULL;
	bool changed = false;
	int rc = content ? replace_tuf(content, exchange, last, &changed)
			 : complain(exchange, tuf_form, last->version, -ENOMEM, NULL);

	if (rc == 0 && changed)
		rc = check_root_key(exchange);
	if (rc == 0 && changed) {
		rc = sign_tuf(&out->file, exchange, content, last);
		if (rc == 0)
			rc = check_tuf(&out->file, last, &why);
		if (rc < 0)
			complain(exchange, tuf_form, last->version, rc, why);
	}
	cJSON_Delete(content);
	return rc;
}

int exchange_tuf_root(struct exchange_root *out, const struct exchange *exchange)
{
	struct tuf_file last = { 0 };
	const char *why = "cannot be read";
	struct buffer file;
	uint32_t version;
	int rc = keys_last_tuf_root(&version, exchange->folder);

	out->version = version;
	if (rc < 0 || version == 0)
		return rc;
	buffer_init(&file, out->file.ceiling);
	rc = keys_read_tuf_root(&file, exchange->folder, version);
	if (rc == 0)
		rc = tuf_root_first(&last, buffer_bytes(&file), &why);
	if (rc == 0 && last.version != version)
		rc = -EBADMSG, why = "says that it is another version";
	if (rc < 0)
		complain(exchange, tuf_form, version, rc, why);
	else
		rc = make_tuf(out, exchange, &last);
	tuf_file_finish(&last);
	buffer_finish(&file);
	return rc;
}
