/* Names, signs, reads and writes one file. */
#include "pipeline/release/tuf_staged.h"

#include <cjson/cJSON.h>
#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/log.h"
#include "tuf/canonical.h"
#include "tuf/sign.h"

enum { SIGNATURE_BYTES_MAX = 1024 };

static int complain(const char *folder, const char *name, int rc, const char *why)
{
	log_error("pipeline", "%s/%s: %s", folder, name, why ? why : strerror(-rc));
	return rc;
}

static void begin(struct tuf_staged *out, const struct tuf_folder *folder, enum tuf_type type,
		  uint32_t version)
{
	const char *const role =
		type == TUF_TARGETS ? tuf_folder_naming_name(folder) : tuf_type_names[type];

	*out = (struct tuf_staged){ .type = type };
	if (type == TUF_TIMESTAMP)
		snprintf(out->name, sizeof(out->name), "timestamp.json");
	else
		snprintf(out->name, sizeof(out->name), "%" PRIu32 ".%.100s.json", version, role);
	buffer_init(&out->message, TUF_FOLDER_FILE_BYTES_MAX);
	buffer_init(&out->file, TUF_FOLDER_FILE_BYTES_MAX);
	if (type == TUF_TARGETS) {
		tuf_folder_naming_keys(folder, &out->keys, &out->role);
	} else {
		out->keys = tuf_root_keys(&folder->root);
		out->role = tuf_root_role(&folder->root, type);
	}
}

int tuf_staged_init(struct tuf_staged *out, const struct tuf_folder *folder, enum tuf_type type,
		    uint32_t version, cJSON *content)
{
	int rc;

	begin(out, folder, type, version);
	out->signatures = cJSON_CreateArray();
	rc = content && out->signatures ? canonical_write(&out->message, content) : -ENOMEM;
	cJSON_Delete(content);
	return rc < 0 ? complain(folder->place.release, out->name, rc, NULL) : 0;
}

void tuf_staged_finish(struct tuf_staged *staged)
{
	buffer_finish(&staged->message);
	buffer_finish(&staged->file);
	cJSON_Delete(staged->signatures);
	*staged = (struct tuf_staged){ 0 };
}

int tuf_staged_sign(struct tuf_staged *staged, const struct signing *signing)
{
	return signing_sign(signing, staged->type, staged->name, staged->keys, staged->role,
			    buffer_bytes(&staged->message), staged->signatures);
}

int tuf_staged_write(struct tuf_staged *staged)
{
	buffer_clear(&staged->file);
	return tuf_write_signed(&staged->file, buffer_bytes(&staged->message), staged->signatures);
}

/* -EKEYREJECTED: too few signatures. *why gets what else is wrong. */
static int verify(const struct tuf_staged *staged, const char **why)
{
	struct tuf_file file = { 0 };
	int rc;

	*why = "no memory";
	rc = tuf_file_parse(&file, buffer_bytes(&staged->file), staged->type, why);
	if (rc == 0)
		rc = tuf_file_verify(&file, staged->keys, staged->role);
	tuf_file_finish(&file);
	return rc;
}

bool tuf_staged_is_signed(const struct tuf_staged *staged)
{
	const char *why;

	return verify(staged, &why) == 0;
}

int tuf_staged_check(const struct tuf_staged *staged)
{
	const char *why;
	const int rc = verify(staged, &why);

	if (rc == -EKEYREJECTED)
		log_error(
			"pipeline",
			"%s: %d signatures, fewer than its threshold of %d; sign it with more keys "
			"(signing.ini), or elsewhere (--write-unsigned, --add-signature)",
			staged->name, cJSON_GetArraySize(staged->signatures),
			cJSON_GetObjectItemCaseSensitive(staged->role, "threshold")->valueint);
	else if (rc < 0)
		log_error("pipeline", "%s: %s", staged->name, why);
	return rc;
}

int tuf_staged_keep(const struct tuf_staged *staged, const char *folder)
{
	char path[PATH_MAX];
	int rc = 0;

	if (mkdir(folder, 0755) < 0 && errno != EEXIST)
		return complain(folder, "", -errno, NULL);
	if (snprintf(path, sizeof(path), "%s/%s.bytes", folder, staged->name) >= (int)sizeof(path))
		return complain(folder, staged->name, -ENAMETOOLONG, NULL);
	rc = bytes_write_file(buffer_bytes(&staged->message), path);
	path[strlen(path) - strlen(".bytes")] = '\0';
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&staged->file), path);
	return rc < 0 ? complain(folder, staged->name, rc, NULL) : 0;
}

/* ---- reading */

/* Parses a file that was staged, and perhaps signed by a tool of The Update Framework. */
static int take_file(struct tuf_staged *out, const char *folder, const struct buffer *file)
{
	struct tuf_file parsed = { 0 };
	const char *why = "no memory";
	int rc = tuf_file_parse(&parsed, buffer_bytes(file), out->type, &why);

	if (rc == 0)
		rc = canonical_write(&out->message, parsed.content);
	if (rc == 0) {
		out->signatures = cJSON_Duplicate(
			cJSON_GetObjectItemCaseSensitive(parsed.json, "signatures"), true);
		rc = out->signatures ? 0 : -ENOMEM;
	}
	tuf_file_finish(&parsed);
	return rc < 0 ? complain(folder, out->name, rc, why) : 0;
}

static bool is_signature_of(const char *entry, const char *name)
{
	const size_t size = strlen(entry), begin_size = strlen(name);

	return size > begin_size + 5 && strncmp(entry, name, begin_size) == 0 &&
	       entry[begin_size] == '.' && strcmp(entry + size - 4, ".sig") == 0;
}

static int add_signature(struct tuf_staged *staged, const char *folder, const char *name)
{
	struct buffer signature;
	int rc;

	buffer_init(&signature, SIGNATURE_BYTES_MAX);
	rc = buffer_read_beneath(&signature, folder, name);
	if (rc == 0)
		rc = tuf_add_signature(staged->signatures, staged->keys, staged->role,
				       buffer_bytes(&staged->message), buffer_bytes(&signature));
	buffer_finish(&signature);
	return rc < 0 ? complain(folder, name, rc,
				 rc == -EKEYREJECTED
					 ? "is no signature of that file by a key that may sign it"
					 : NULL)
		      : 0;
}

static int add_signatures(struct tuf_staged *staged, const char *folder)
{
	const struct dirent *entry;
	DIR *all = opendir(folder);
	int rc = all ? 0 : complain(folder, "", -errno, NULL);

	while (rc == 0 && (entry = readdir(all)))
		if (is_signature_of(entry->d_name, staged->name))
			rc = add_signature(staged, folder, entry->d_name);
	if (all)
		closedir(all);
	return rc;
}

int tuf_staged_read(struct tuf_staged *out, const struct tuf_folder *folder,
		    const char *staged_folder, enum tuf_type type, uint32_t version)
{
	struct buffer file;
	char path[PATH_MAX];
	int rc = -ENAMETOOLONG;

	begin(out, folder, type, version);
	buffer_init(&file, TUF_FOLDER_FILE_BYTES_MAX);
	if (snprintf(path, sizeof(path), "%s/%s", staged_folder, out->name) < (int)sizeof(path))
		rc = buffer_read_file(&file, path);
	if (rc < 0 && rc != -ENOENT)
		complain(staged_folder, out->name, rc, NULL);
	if (rc == 0)
		rc = take_file(out, staged_folder, &file);
	if (rc == 0)
		rc = add_signatures(out, staged_folder);
	if (rc == 0)
		rc = tuf_staged_write(out);
	buffer_finish(&file);
	if (rc < 0)
		out->name[0] = '\0';
	return rc;
}

/* Takes ROLE out of VERSION.ROLE.json. Returns false if it is another name. */
static bool role_in_name(const char *name, const char **role, int *bytes)
{
	const size_t size = strlen(name), digits = strspn(name, "0123456789");

	*role = name + digits + 1;
	*bytes = (int)(size - digits - 1 - strlen(".json"));
	return digits > 0 && name[digits] == '.' && *bytes > 0 &&
	       strcmp(name + size - strlen(".json"), ".json") == 0 &&
	       strncmp(*role, "snapshot.json", strlen("snapshot.json")) != 0;
}

int tuf_staged_role(char *out, size_t out_bytes, const char *staged_folder)
{
	const struct dirent *entry;
	DIR *all = opendir(staged_folder);
	int bytes, rc = all ? 0 : complain(staged_folder, "", -errno, NULL);
	const char *role;

	out[0] = '\0';
	while (rc == 0 && (entry = readdir(all))) {
		if (!role_in_name(entry->d_name, &role, &bytes))
			continue;
		if (out[0] && (strncmp(out, role, (size_t)bytes) != 0 || out[bytes]))
			rc = complain(staged_folder, entry->d_name, -EINVAL,
				      "what two roles signed lies in one folder; use one for each");
		else if (snprintf(out, out_bytes, "%.*s", bytes, role) >= (int)out_bytes)
			rc = complain(staged_folder, entry->d_name, -ENAMETOOLONG, NULL);
	}
	if (all)
		closedir(all);
	if (strcmp(out, tuf_type_names[TUF_TARGETS]) == 0)
		out[0] = '\0';
	return rc;
}
