#include "curator/accounts/gate.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "base/clock.h"
#include "curator/accounts/accounts.h"
#include "tests/check.h"

static int64_t now_ms;

int64_t clock_now_ms(void)
{
	return now_ms;
}

static char folder[64];
static struct gate *gate;

/* password NULL: it stays as it is. */
static void write_account(const char *name, enum role role, const char *password)
{
	struct diagnostics diagnostics = { 0 };
	struct accounts accounts;

	CHECK(accounts_read(&accounts, folder, &diagnostics) == 0);
	if (!accounts_find(&accounts, name))
		CHECK(accounts_add(&accounts, name, role) == 0);
	accounts_find(&accounts, name)->role = role;
	if (password)
		CHECK(account_set_password(accounts_find(&accounts, name), password) == 0);
	CHECK(accounts_write(&accounts, folder, &diagnostics) == 0);
	accounts_finish(&accounts);
}

static int start(void **state)
{
	struct diagnostics diagnostics = { 0 };

	(void)state;
	now_ms = 1000;
	snprintf(folder, sizeof(folder), "/tmp/gopura-gate-XXXXXX");
	CHECK(mkdtemp(folder));
	write_account("ana", ROLE_EDITOR, NULL); /* a password takes long */
	CHECK(gate_create(&gate, folder, &diagnostics) == 0);
	return 0;
}

static int stop(void **state)
{
	char path[128];

	(void)state;
	gate_destroy(gate);
	snprintf(path, sizeof(path), "%s/.curator", folder);
	bytes_remove_folder(path);
	bytes_remove_folder(folder);
	return 0;
}

static int sign_in(const char *password, char key[SIGN_IN_SECRET_BYTES])
{
	struct gate_visitor visitor;
	int64_t wait_ms;
	int rc = gate_sign_in(gate, "ana", password, "192.0.2.1", key, &visitor, &wait_ms);

	CHECK((rc == 0) == (visitor.token[0] != '\0'));
	return rc;
}

static void admit(char key[SIGN_IN_SECRET_BYTES])
{
	struct gate_visitor visitor;

	CHECK(gate_admit(gate, "ana", key, &visitor) == 0);
}

static enum role role_of(const char *key)
{
	struct gate_visitor visitor;

	CHECK(gate_identify(gate, key, GATE_LOOK, &visitor) == 0);
	CHECK((visitor.caller.role == ROLE_NONE) == (visitor.caller.name[0] == '\0'));
	return visitor.caller.role;
}

static void a_key_is_its_accounts_until_it_signs_out(void **state)
{
	char key[SIGN_IN_SECRET_BYTES];

	(void)state;
	write_account("ana", ROLE_EDITOR, "password of ana");
	CHECK(sign_in("password of eve", key) == -EACCES);
	CHECK(sign_in("password of ana", key) == 0 && role_of(key) == ROLE_EDITOR);
	CHECK(role_of("") == ROLE_NONE && role_of("0") == ROLE_NONE);
	gate_sign_out(gate, key);
	CHECK(role_of(key) == ROLE_NONE);
}

static void a_changed_role_holds_at_once(void **state)
{
	char key[SIGN_IN_SECRET_BYTES];

	(void)state;
	admit(key);
	write_account("ana", ROLE_READER, NULL);
	CHECK(role_of(key) == ROLE_READER && gate_role(gate, "ana") == ROLE_READER);
	CHECK(gate_role(gate, "eve") == ROLE_NONE);
}

static void a_change_that_could_not_be_read_is_read_later(void **state)
{
	char key[SIGN_IN_SECRET_BYTES];
	struct rlimit before, none;

	(void)state;
	admit(key);
	write_account("ana", ROLE_READER, NULL);
	CHECK(getrlimit(RLIMIT_NOFILE, &before) == 0);
	none = (struct rlimit){ 0, before.rlim_max };
	CHECK(setrlimit(RLIMIT_NOFILE, &none) == 0);
	CHECK(role_of(key) == ROLE_EDITOR);
	CHECK(setrlimit(RLIMIT_NOFILE, &before) == 0);
	CHECK(role_of(key) == ROLE_READER);
}

static void a_changed_password_ends_what_the_old_one_began(void **state)
{
	char key[SIGN_IN_SECRET_BYTES];

	(void)state;
	admit(key);
	write_account("ana", ROLE_EDITOR, "another of ana");
	CHECK(role_of(key) == ROLE_NONE);
	CHECK(sign_in("another of ana", key) == 0 && role_of(key) == ROLE_EDITOR);
}

static void looking_keeps_nobody_signed_in_and_messages_do(void **state)
{
	struct gate_visitor visitor;
	char key[SIGN_IN_SECRET_BYTES];

	(void)state;
	admit(key);
	now_ms += SIGN_IN_IDLE_MS - 1;
	CHECK(gate_identify(gate, key, GATE_MESSAGE, &visitor) == 0 && visitor.token[0]);
	now_ms += SIGN_IN_IDLE_MS - 1;
	CHECK(role_of(key) == ROLE_EDITOR); /* a look */
	now_ms += 1;
	CHECK(role_of(key) == ROLE_NONE);
}

static void only_requests_are_counted(void **state)
{
	struct gate_visitor visitor;
	char key[SIGN_IN_SECRET_BYTES];

	(void)state;
	admit(key);
	for (int n = 0; n < 2 * SIGN_IN_REQUESTS_AT_ONCE; n++)
		CHECK(gate_identify(gate, key, GATE_MESSAGE, &visitor) == 0);
	for (int n = 0; n < SIGN_IN_REQUESTS_AT_ONCE; n++)
		CHECK(gate_identify(gate, key, GATE_REQUEST, &visitor) == 0);
	CHECK(gate_identify(gate, key, GATE_REQUEST, &visitor) == -EAGAIN);
}

static void a_sign_on_admits_accounts_alone(void **state)
{
	struct gate_visitor visitor;
	char key[SIGN_IN_SECRET_BYTES];

	(void)state;
	CHECK(gate_admit(gate, "eve", key, &visitor) == -EACCES && !visitor.token[0]);
	CHECK(gate_admit(gate, "ana", key, &visitor) == 0 && role_of(key) == ROLE_EDITOR);
}

static void without_an_account_it_says_how_to_make_one(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct gate *none;

	(void)state;
	CHECK(gate_create(&none, "/tmp/gopura-gate-none", &diagnostics) == -ENOENT && !none);
	CHECK(strstr(diagnostics.first.text, "gopura-curator user add /tmp/gopura-gate-none NAME"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_key_is_its_accounts_until_it_signs_out, start,
						stop),
		cmocka_unit_test_setup_teardown(a_changed_role_holds_at_once, start, stop),
		cmocka_unit_test_setup_teardown(a_change_that_could_not_be_read_is_read_later,
						start, stop),
		cmocka_unit_test_setup_teardown(a_changed_password_ends_what_the_old_one_began,
						start, stop),
		cmocka_unit_test_setup_teardown(looking_keeps_nobody_signed_in_and_messages_do,
						start, stop),
		cmocka_unit_test_setup_teardown(only_requests_are_counted, start, stop),
		cmocka_unit_test_setup_teardown(a_sign_on_admits_accounts_alone, start, stop),
		cmocka_unit_test(without_an_account_it_says_how_to_make_one),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
