/* The steps of an exchange, in an order that a power cut may end anywhere. */
#include "pipeline/keys/keys_exchange.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "pipeline/keys/exchange_roots.h"
#include "pipeline/keys/keys_path_private.h"

enum { ROOT_BYTES_MAX = 64 << 10 /* what terminals take */ };

/* ---- the keys */

static int read_old(struct exchange *exchange)
{
	for (int key = 0; key < EXCHANGE_KEYS; key++) {
		int rc;

		if (key != EXCHANGE_ROOT && !(exchange->wanted & 1u << key))
			continue;
		rc = keys_read_key(&exchange->old[key], exchange->folder, exchange_key_names[key]);
		if (rc == 0)
			exchange->present |= 1u << key;
		else if (rc == -EBADMSG && key != EXCHANGE_ROOT)
			log_error("pipeline",
				  "%s/%s.key: if it is to go anyhow, remove it and run this again",
				  exchange->folder, exchange_key_names[key]);
		if (rc < 0 && rc != -ENOENT)
			return rc;
	}
	return 0;
}

/* Reads the keys of an exchange that was interrupted, or makes others in memory. */
static int get_next(struct exchange *exchange, bool goes_on)
{
	char folder[PATH_MAX];
	int rc = keys_join(folder, exchange->folder, "exchange");

	for (int key = 0; key < EXCHANGE_KEYS && rc == 0; key++) {
		if (!(exchange->wanted & 1u << key))
			continue;
		if (goes_on)
			rc = keys_read_key(&exchange->next[key], folder, exchange_key_names[key]);
		else
			crypto_sign_keypair(exchange->next[key].public_key,
					    exchange->next[key].secret);
	}
	return rc;
}

/* Puts the new keys into FOLDER/exchange, all or none of them. */
static int stage(const struct exchange *exchange)
{
	char part[PATH_MAX], whole[PATH_MAX], path[2 * PATH_MAX];
	int rc = keys_join(part, exchange->folder, "exchange.part");

	if (rc == 0)
		rc = keys_join(whole, exchange->folder, "exchange");
	if (rc < 0)
		return rc;
	bytes_remove_folder(part); /* of an earlier exchange */
	if (mkdir(part, 0700) < 0)
		return keys_complain(exchange->folder, "exchange.part", -errno, NULL);
	for (int key = 0; key < EXCHANGE_KEYS && rc == 0; key++) {
		snprintf(path, sizeof(path), "%s/%s.key", part, exchange_key_names[key]);
		if (exchange->wanted & 1u << key)
			rc = keys_write_key(path, exchange_key_names[key], &exchange->next[key]);
	}
	if (rc == 0)
		rc = keys_sync_folder(part);
	if (rc == 0 && rename(part, whole) < 0)
		rc = keys_complain(exchange->folder, "exchange", -errno, NULL);
	return rc < 0 ? rc : keys_sync_folder(exchange->folder);
}

static int take_next(const struct exchange *exchange, enum exchange_key key, unsigned *kept)
{
	const struct signing_key *old = &exchange->old[key], *next = &exchange->next[key];
	const char *name = exchange_key_names[key];
	char path[PATH_MAX], aside[PATH_MAX + 8];
	const bool is_present = exchange->present & 1u << key;
	int rc = snprintf(path, sizeof(path), "%s/%s.key", exchange->folder, name) < PATH_MAX
			 ? 0
			 : keys_complain(exchange->folder, name, -ENAMETOOLONG, NULL);

	if (rc < 0)
		return rc;
	snprintf(aside, sizeof(aside), "%s.old", path);
	if (is_present && memcmp(old->public_key, next->public_key, KEY_BYTES) == 0) {
		*kept |= access(aside, F_OK) == 0 ? 1u << key : 0;
		return 0; /* before it was interrupted */
	}
	if (is_present) {
		rc = keys_write_key(aside, name, old);
		*kept |= 1u << key;
	}
	return rc < 0 ? rc : keys_write_key(path, name, next);
}

/* Puts the new keys into their places, and ends the exchange. */
static int take_all(const struct exchange *exchange, unsigned *kept)
{
	char part[PATH_MAX], whole[PATH_MAX];
	int rc = keys_join(part, exchange->folder, "exchange.part");

	if (rc == 0)
		rc = keys_join(whole, exchange->folder, "exchange");
	for (int key = 0; key < EXCHANGE_KEYS && rc == 0; key++)
		if (exchange->wanted & 1u << key)
			rc = take_next(exchange, key, kept);
	if (rc == 0)
		rc = keys_sync_folder(exchange->folder);
	if (rc < 0)
		return rc;
	bytes_remove_folder(part);
	if (rename(whole, part) < 0)
		return keys_complain(exchange->folder, "exchange", -errno, NULL);
	bytes_remove_folder(part);
	return keys_sync_folder(exchange->folder);
}

/* ---- */

static int write_root(const struct exchange *exchange, const char *form, struct exchange_root *root)
{
	char name[64], path[PATH_MAX];
	int rc;

	if (root->file.size == 0)
		return 0;
	snprintf(name, sizeof(name),
		 form[0] == 't' ? "tuf/%" PRIu32 ".root.json" : "root/%" PRIu32 ".json",
		 ++root->version);
	rc = keys_join(path, exchange->folder, name);
	if (rc == 0 && (rc = bytes_write_file(buffer_bytes(&root->file), path)) < 0)
		keys_complain(exchange->folder, name, rc, NULL);
	return rc;
}

/* Nothing is written before it is clear that all can be made. */
static int make_roots(struct exchange_root *earlier, struct exchange_root *tuf,
		      const struct exchange *exchange)
{
	int rc = exchange_earlier_root(earlier, exchange);

	if (rc == 0)
		rc = exchange_tuf_root(tuf, exchange);
	if (rc == 0 && earlier->version == 0 && tuf->version == 0)
		rc = keys_complain(exchange->folder, "root/1.json", -ENOENT,
				   "not here, nor tuf/1.root.json: there are no keys to exchange; "
				   "`gopura-content keys` makes the first ones");
	if (rc == 0 && tuf->version == 0 && exchange->wanted & 1u << EXCHANGE_SNAPSHOT)
		rc = keys_complain(exchange->folder, "tuf/1.root.json", -ENOENT,
				   "not here: releases in the earlier form have no snapshot.key");
	return rc;
}

static int run(struct keys_exchanged *out, struct exchange *exchange)
{
	struct exchange_root earlier, tuf;
	int rc = read_old(exchange);

	buffer_init(&earlier.file, METADATA_FILE_BYTES_MAX);
	buffer_init(&tuf.file, ROOT_BYTES_MAX);
	if (rc == 0)
		rc = get_next(exchange, out->went_on);
	if (rc == 0)
		rc = make_roots(&earlier, &tuf, exchange);
	if (rc == 0 && !out->went_on)
		rc = stage(exchange);
	if (rc == 0)
		rc = write_root(exchange, "root", &earlier);
	if (rc == 0)
		rc = write_root(exchange, "tuf", &tuf);
	if (rc == 0)
		rc = take_all(exchange, &out->kept);
	if (rc == 0)
		rc = keys_has(exchange->folder, "snapshot.key");
	if (rc >= 0) {
		out->root = earlier.version;
		out->tuf_root = tuf.version;
		out->is_shared = rc > 0;
		rc = 0;
	}
	buffer_finish(&earlier.file);
	buffer_finish(&tuf.file);
	return rc;
}

static int lock(const char *folder)
{
	int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);

	if (fd < 0)
		return keys_complain(folder, "", -errno, NULL);
	if (flock(fd, LOCK_EX) < 0)
		log_debug("pipeline", "%s: cannot be locked: %s", folder, strerror(errno));
	return fd;
}

int keys_exchange(struct keys_exchanged *out, const char *folder, unsigned keys)
{
	struct exchange exchange = { .folder = folder,
				     .wanted = keys,
				     .expires_s = clock_wall_s() + KEYS_ROOT_LIFE_S };
	unsigned going_on;
	int fd, rc = sodium_init() < 0 ? -EIO : 0;

	*out = (struct keys_exchanged){ .expires_s = exchange.expires_s };
	if (rc < 0)
		return rc;
	fd = lock(folder);
	if (fd < 0)
		return fd;
	going_on = exchange_going_on(folder);
	out->went_on = going_on != 0;
	if (going_on && going_on != keys)
		rc = exchange_check(folder);
	if (rc == 0)
		rc = run(out, &exchange);
	close(fd);
	sodium_memzero(&exchange, sizeof(exchange));
	return rc;
}
