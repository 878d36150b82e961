#include "curator/accounts/accounts.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/check.h"

static struct bytes bytes_of(const char *text)
{
	return (struct bytes){ (const uint8_t *)text, strlen(text) };
}

static void make_folder(char folder[64])
{
	snprintf(folder, 64, "/tmp/gopura-accounts-XXXXXX");
	CHECK(mkdtemp(folder));
}

static void remove_folder(const char *folder)
{
	char path[128];

	snprintf(path, sizeof(path), "%s/.curator", folder);
	bytes_remove_folder(path);
	bytes_remove_folder(folder);
}

static void what_is_written_is_read_again(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct accounts written = { 0 }, read;
	char folder[64], path[128];
	struct stat stat_of;

	(void)state;
	make_folder(folder);
	CHECK(accounts_add(&written, "ana", ROLE_PUBLISHER) == 0);
	CHECK(accounts_add(&written, "rolf@museum.example", ROLE_READER) == 0);
	CHECK(account_set_password(accounts_find(&written, "ana"), "ten and more") == 0);
	CHECK(accounts_write(&written, folder, &diagnostics) == 0);
	CHECK(accounts_read(&read, folder, &diagnostics) == 0 && read.count == 2);
	CHECK(accounts_find(&read, "ana")->role == ROLE_PUBLISHER);
	CHECK(account_verify(accounts_find(&read, "ana"), "ten and more"));
	CHECK(!read.list[1].hash[0] && read.list[1].role == ROLE_READER);
	snprintf(path, sizeof(path), "%s/.curator/accounts.json", folder);
	CHECK(stat(path, &stat_of) == 0 && (stat_of.st_mode & 07777) == 0600);
	CHECK(chmod(path, 0640) == 0);
	accounts_finish(&read);
	CHECK(accounts_read(&read, folder, &diagnostics) == -EPERM && read.count == 0);
	CHECK(strstr(diagnostics.first.text, "chmod 600"));
	accounts_finish(&written);
	remove_folder(folder);
}

static void a_folder_without_the_file_has_no_accounts(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct accounts accounts;
	char folder[64];

	(void)state;
	make_folder(folder);
	CHECK(accounts_read(&accounts, folder, &diagnostics) == 0 && accounts.count == 0);
	remove_folder(folder);
}

static void a_link_in_place_of_the_file_is_refused(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct accounts accounts = { 0 };
	char folder[64], path[128];

	(void)state;
	make_folder(folder);
	CHECK(accounts_write(&accounts, folder, &diagnostics) == 0);
	snprintf(path, sizeof(path), "%s/.curator/accounts.json", folder);
	CHECK(unlink(path) == 0 && symlink("/etc/passwd", path) == 0);
	CHECK(accounts_read(&accounts, folder, &diagnostics) < 0);
	remove_folder(folder);
}

static void refuses_a_file_that_is_not_its_own(void **state)
{
	static const char *const bad[] = {
		"",
		"[]",
		"{}",
		"{\"accounts\": {}}",
		"{\"accounts\": [1]}",
		"{\"accounts\": [{\"name\": \"ana\"}]}",
		"{\"accounts\": [{\"name\": \"ana\", \"role\": \"king\"}]}",
		"{\"accounts\": [{\"name\": \"a b\", \"role\": \"editor\"}]}",
		"{\"accounts\": [{\"role\": \"editor\"}]}",
		"{\"accounts\": [{\"name\": \"a\", \"role\": \"editor\"}, "
		"{\"name\": \"a\", \"role\": \"reader\"}]}",
		"{\"accounts\": [{\"name\": \"a\", \"role\": \"editor\", \"password\": \"\\\\\"}]}",
		"{\"accounts\": [{\"name\": \"a\", \"role\": \"editor\", \"password\": \"\\\"\"}]}",
	};

	(void)state;
	for (unsigned n = 0; n < ARRAY_COUNT(bad); n++) {
		struct diagnostics diagnostics = { 0 };
		struct accounts accounts;

		CHECK(accounts_parse(&accounts, bytes_of(bad[n]), &diagnostics) == -EBADMSG);
		CHECK(accounts.count == 0 && !accounts.list && diagnostics.count == 1);
	}
}

static void a_name_is_short_and_plain(void **state)
{
	static const char *const bad[] = { "",    " ",   "-a",  ".a",       "@",
					   "a b", "a\n", "a\"", "\xc3\xa9", "a/b" };
	char longest[ACCOUNT_NAME_BYTES + 1];

	(void)state;
	for (unsigned n = 0; n < ARRAY_COUNT(bad); n++)
		CHECK(!account_name_is_valid(bad[n]));
	CHECK(account_name_is_valid("ana") && account_name_is_valid("A.b-c+d@museum.example"));
	memset(longest, 'a', sizeof(longest));
	longest[ACCOUNT_NAME_BYTES] = '\0';
	CHECK(!account_name_is_valid(longest));
	longest[ACCOUNT_NAME_BYTES - 1] = '\0';
	CHECK(account_name_is_valid(longest));
}

static void only_the_right_password_of_an_account_is_right(void **state)
{
	struct accounts accounts = { 0 };
	struct account *account;
	char longest[PASSWORD_MAX_BYTES + 2];

	(void)state;
	CHECK(accounts_add(&accounts, "ana", ROLE_EDITOR) == 0);
	account = accounts_find(&accounts, "ana");
	CHECK(!account_verify(account, "")); /* it has none yet */
	CHECK(account_set_password(account, "too short") == -EINVAL);
	memset(longest, 'x', sizeof(longest));
	longest[PASSWORD_MAX_BYTES + 1] = '\0';
	CHECK(account_set_password(account, longest) == -EINVAL && !account->hash[0]);
	CHECK(account_set_password(account, "a good password") == 0);
	CHECK(account_verify(account, "a good password"));
	CHECK(!account_verify(account, "a good passworD") && !account_verify(account, ""));
	CHECK(!account_verify(NULL, "a good password"));
	accounts_finish(&accounts);
}

static void an_account_is_removed_and_the_others_stay(void **state)
{
	static const char *const names[] = { "a", "b", "c" };
	struct accounts accounts = { 0 };

	(void)state;
	for (unsigned n = 0; n < 3; n++)
		CHECK(accounts_add(&accounts, names[n], ROLE_READER) == 0);
	CHECK(accounts_add(&accounts, "b", ROLE_READER) == -EEXIST);
	CHECK(accounts_remove(&accounts, "b") == 0 && accounts_remove(&accounts, "b") == -ENOENT);
	CHECK(accounts.count == 2 && accounts_find(&accounts, "a") &&
	      accounts_find(&accounts, "c"));
	accounts_finish(&accounts);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_written_is_read_again),
		cmocka_unit_test(a_folder_without_the_file_has_no_accounts),
		cmocka_unit_test(a_link_in_place_of_the_file_is_refused),
		cmocka_unit_test(refuses_a_file_that_is_not_its_own),
		cmocka_unit_test(a_name_is_short_and_plain),
		cmocka_unit_test(only_the_right_password_of_an_account_is_right),
		cmocka_unit_test(an_account_is_removed_and_the_others_stay),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
