/* One lock around accounts, sign-ins and attempts. */
#include "curator/accounts/gate.h"

#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/transient.h"
#include "curator/accounts/accounts.h"
#include "curator/accounts/attempts.h"

struct gate {
	char folder[PATH_MAX], file[PATH_MAX + 32];
	pthread_mutex_t lock;
	/* Under the lock. */
	struct accounts accounts;
	struct stat seen; /* the file when it was read */
	struct sign_ins sign_ins;
	struct attempts attempts;
};

/* Whoever knew a password that was changed is signed out. */
static void end_changed(struct gate *gate, const struct accounts *fresh)
{
	for (uint32_t n = 0; n < gate->accounts.count; n++) {
		const struct account *was = &gate->accounts.list[n],
				     *is = accounts_find(fresh, was->name);

		if (!is || strcmp(is->hash, was->hash) != 0)
			sign_ins_end_all(&gate->sign_ins, was->name);
	}
}

/* Reads the accounts again if the file has changed. A file that cannot be read leaves those that
 * were. */
static void refresh(struct gate *gate)
{
	struct diagnostics diagnostics = { 0 };
	struct accounts fresh;
	struct stat now;
	int rc;

	if (stat(gate->file, &now) < 0)
		now = (struct stat){ 0 };
	if (now.st_ino == gate->seen.st_ino && now.st_size == gate->seen.st_size &&
	    now.st_mtim.tv_sec == gate->seen.st_mtim.tv_sec &&
	    now.st_mtim.tv_nsec == gate->seen.st_mtim.tv_nsec)
		return;
	rc = accounts_read(&fresh, gate->folder, &diagnostics);
	if (!is_transient(rc)) /* otherwise it is read again at the next look */
		gate->seen = now;
	if (rc < 0) {
		log_error("curator", "%s", diagnostics_cause(&diagnostics, rc));
		return;
	}
	end_changed(gate, &fresh);
	accounts_finish(&gate->accounts);
	gate->accounts = fresh;
}

int gate_create(struct gate **out, const char *folder, struct diagnostics *diagnostics)
{
	struct gate *gate = calloc(1, sizeof(*gate));
	int rc;

	*out = NULL;
	if (!gate || sodium_init() < 0) {
		free(gate);
		return -ENOMEM;
	}
	pthread_mutex_init(&gate->lock, NULL);
	snprintf(gate->folder, sizeof(gate->folder), "%s", folder);
	snprintf(gate->file, sizeof(gate->file), "%s/.curator/accounts.json", folder);
	if (stat(gate->file, &gate->seen) < 0)
		gate->seen = (struct stat){ 0 };
	rc = accounts_read(&gate->accounts, folder, diagnostics);
	if (rc == 0 && gate->accounts.count == 0)
		rc = diagnostics_add(diagnostics, -ENOENT, folder, 0,
				     "has no accounts yet: make one with 'gopura-curator user add "
				     "%s NAME --role publisher'",
				     folder);
	if (rc < 0) {
		gate_destroy(gate);
		return rc;
	}
	*out = gate;
	return 0;
}

void gate_destroy(struct gate *gate)
{
	if (!gate)
		return;
	accounts_finish(&gate->accounts);
	pthread_mutex_destroy(&gate->lock);
	sodium_memzero(&gate->sign_ins, sizeof(gate->sign_ins));
	free(gate);
}

/* Under the lock. */
static void begin(struct gate *gate, const struct account *account, char key[SIGN_IN_SECRET_BYTES],
		  struct gate_visitor *out)
{
	const struct sign_in *sign_in =
		sign_ins_begin(&gate->sign_ins, account->name, clock_now_ms(), key);

	out->caller.role = account->role;
	memcpy(out->caller.name, account->name, sizeof(out->caller.name));
	memcpy(out->token, sign_in->token, sizeof(out->token));
}

int gate_sign_in(struct gate *gate, const char *name, const char *password, const char *address,
		 char key[SIGN_IN_SECRET_BYTES], struct gate_visitor *out, int64_t *wait_ms)
{
	struct account copy, *account;
	bool exists, good;
	int rc = -EACCES;

	*out = (struct gate_visitor){ 0 };
	pthread_mutex_lock(&gate->lock);
	*wait_ms = attempts_begin(&gate->attempts, name, address, clock_now_ms());
	refresh(gate);
	account = accounts_find(&gate->accounts, name);
	exists = account != NULL;
	if (exists)
		copy = *account;
	pthread_mutex_unlock(&gate->lock);
	if (*wait_ms > 0)
		return -EAGAIN;
	good = account_verify(exists ? &copy : NULL, password); /* slow, so without the lock */
	if (exists)
		sodium_memzero(copy.hash, sizeof(copy.hash));
	if (!good)
		return -EACCES;
	pthread_mutex_lock(&gate->lock);
	attempts_succeed(&gate->attempts, name, address);
	account = accounts_find(&gate->accounts, name);
	if (account) {
		begin(gate, account, key, out);
		rc = 0;
	}
	pthread_mutex_unlock(&gate->lock);
	return rc;
}

int gate_admit(struct gate *gate, const char *name, char key[SIGN_IN_SECRET_BYTES],
	       struct gate_visitor *out)
{
	const struct account *account;
	int rc = -EACCES;

	*out = (struct gate_visitor){ 0 };
	pthread_mutex_lock(&gate->lock);
	refresh(gate);
	account = accounts_find(&gate->accounts, name);
	if (account) {
		begin(gate, account, key, out);
		rc = 0;
	}
	pthread_mutex_unlock(&gate->lock);
	return rc;
}

void gate_sign_out(struct gate *gate, const char *key)
{
	pthread_mutex_lock(&gate->lock);
	sign_ins_end(&gate->sign_ins, key);
	pthread_mutex_unlock(&gate->lock);
}

/* Under the lock. */
static int identify(struct gate *gate, const char *key, enum gate_use use, struct gate_visitor *out)
{
	const int64_t now_ms = clock_now_ms();
	const struct account *account;
	struct sign_in *sign_in;

	refresh(gate);
	sign_in = sign_ins_find(&gate->sign_ins, key, now_ms);
	account = sign_in ? accounts_find(&gate->accounts, sign_in->name) : NULL;
	if (!account)
		return 0;
	if (use == GATE_REQUEST && !sign_in_may_ask(sign_in, now_ms))
		return -EAGAIN;
	if (use != GATE_LOOK)
		sign_in->used_ms = now_ms;
	out->caller.role = account->role;
	memcpy(out->caller.name, account->name, sizeof(out->caller.name));
	memcpy(out->token, sign_in->token, sizeof(out->token));
	return 0;
}

int gate_identify(struct gate *gate, const char *key, enum gate_use use, struct gate_visitor *out)
{
	int rc;

	*out = (struct gate_visitor){ 0 };
	pthread_mutex_lock(&gate->lock);
	rc = identify(gate, key, use, out);
	pthread_mutex_unlock(&gate->lock);
	return rc;
}

enum role gate_role(struct gate *gate, const char *name)
{
	const struct account *account;
	enum role role;

	pthread_mutex_lock(&gate->lock);
	refresh(gate);
	account = accounts_find(&gate->accounts, name);
	role = account ? account->role : ROLE_NONE;
	pthread_mutex_unlock(&gate->lock);
	return role;
}
