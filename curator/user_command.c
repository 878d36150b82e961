/* Each subcommand reads the accounts, changes them and writes them, under a lock. */
#include "curator/user_command.h"

#include <errno.h>
#include <getopt.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include "curator/accounts/accounts.h"

static const char help[] =
	"gopura-curator user: who may use gopura-curator (docs/curator.md)\n"
	"\n"
	"usage: gopura-curator user add DIR NAME [--role ROLE] [--no-password]\n"
	"       gopura-curator user password DIR NAME\n"
	"       gopura-curator user role DIR NAME --role ROLE\n"
	"       gopura-curator user remove DIR NAME\n"
	"       gopura-curator user list DIR\n"
	"\n"
	"  --role ROLE      reader (looks), editor (saves; the default) or publisher (publishes)\n"
	"  --no-password    for a museum's own sign-on (gopura-curator DIR --sign-on HEADER)\n"
	"\n"
	"The password is asked for on the terminal, or read as a line from standard input. Accounts are\n"
	"kept in DIR/.curator/accounts.json. A program that runs takes changes up at once.\n"
	"\n"
	"Examples:\n"
	"  gopura-curator user add temple ana --role publisher\n"
	"  gopura-curator user remove temple ana\n";

struct settings {
	const char *folder, *name; /* borrowed from argv; name NULL: none was given */
	enum role role;            /* ROLE_NONE: none was given */
	bool has_no_password;
};

static int complain(int rc, const char *sentence)
{
	fprintf(stderr, "gopura-curator user: %s\n", sentence);
	return rc;
}

/* ---- the password */

/* Reads a line without its end. The terminal shows nothing of it, and is as before afterwards. */
static int read_line(char *out, size_t out_bytes, const char *prompt)
{
	struct termios before, silent;
	const bool is_terminal = tcgetattr(STDIN_FILENO, &before) == 0;
	bool good;

	if (is_terminal) {
		silent = before;
		silent.c_lflag &= ~(tcflag_t)ECHO;
		tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent);
		fputs(prompt, stderr);
	}
	good = fgets(out, (int)out_bytes, stdin) != NULL;
	if (is_terminal) {
		tcsetattr(STDIN_FILENO, TCSAFLUSH, &before);
		fputs("\n", stderr);
	}
	if (!good)
		return complain(-EINVAL, "no password was given");
	out[strcspn(out, "\r\n")] = '\0';
	return 0;
}

static int set_password(struct account *account)
{
	char once[PASSWORD_MAX_BYTES + 3], again[PASSWORD_MAX_BYTES + 3];
	int rc = read_line(once, sizeof(once), "Password: ");

	if (rc == 0 && isatty(STDIN_FILENO)) {
		rc = read_line(again, sizeof(again), "The same again: ");
		if (rc == 0 && strcmp(once, again) != 0)
			rc = complain(-EINVAL, "the two are not the same");
		sodium_memzero(again, sizeof(again));
	}
	if (rc == 0) {
		rc = account_set_password(account, once);
		if (rc == -EINVAL)
			complain(rc, "a password has 10 to 256 bytes");
		else if (rc < 0)
			complain(rc, strerror(-rc));
	}
	sodium_memzero(once, sizeof(once));
	return rc;
}

/* ---- subcommands: each changes the accounts */

static int add(struct accounts *accounts, const struct settings *settings)
{
	const enum role role = settings->role ? settings->role : ROLE_EDITOR;
	int rc = accounts_add(accounts, settings->name, role);

	if (rc == -EEXIST)
		return complain(rc, "there is an account of this name: see 'user password' and "
				    "'user role'");
	if (rc == -EINVAL)
		return complain(rc, "a name is 1 to 64 characters of A-Z a-z 0-9 . _ @ + -, and "
				    "begins with a letter or digit");
	if (rc < 0)
		return complain(rc, strerror(-rc));
	return settings->has_no_password ? 0 : set_password(&accounts->list[accounts->count - 1]);
}

/* NULL, and a complaint, if there is no such account. */
static struct account *find(struct accounts *accounts, const struct settings *settings)
{
	struct account *account = accounts_find(accounts, settings->name);

	if (!account)
		complain(0, "there is no account of this name: see 'user list'");
	return account;
}

static int change_password(struct accounts *accounts, const struct settings *settings)
{
	struct account *account = find(accounts, settings);

	return account ? set_password(account) : -ENOENT;
}

static int change_role(struct accounts *accounts, const struct settings *settings)
{
	struct account *account = find(accounts, settings);

	if (!account)
		return -ENOENT;
	if (!settings->role)
		return complain(-EINVAL, "name the role: --role reader, editor or publisher");
	account->role = settings->role;
	return 0;
}

static int remove_account(struct accounts *accounts, const struct settings *settings)
{
	return find(accounts, settings) ? accounts_remove(accounts, settings->name) : -ENOENT;
}

static int change(const struct settings *settings,
		  int (*how)(struct accounts *accounts, const struct settings *settings))
{
	struct diagnostics diagnostics = { 0 };
	struct accounts accounts = { 0 };
	int rc = 0, lock = accounts_lock(settings->folder, &diagnostics);

	if (lock >= 0)
		rc = accounts_read(&accounts, settings->folder, &diagnostics);
	if (lock < 0 || rc < 0) {
		complain(rc, diagnostics_cause(&diagnostics, lock < 0 ? lock : rc));
		rc = rc < 0 ? rc : lock;
	}
	if (rc == 0)
		rc = how(&accounts, settings);
	if (rc == 0) {
		rc = accounts_write(&accounts, settings->folder, &diagnostics);
		if (rc < 0)
			complain(rc, diagnostics_cause(&diagnostics, rc));
	}
	accounts_finish(&accounts);
	if (lock >= 0)
		close(lock);
	return rc == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

static int list(const struct settings *settings)
{
	struct diagnostics diagnostics = { 0 };
	struct accounts accounts;
	int rc = accounts_read(&accounts, settings->folder, &diagnostics);

	if (rc < 0) {
		complain(rc, diagnostics_cause(&diagnostics, rc));
		return EXIT_FAILURE;
	}
	for (uint32_t n = 0; n < accounts.count; n++)
		printf("%-10s %s%s\n", role_name(accounts.list[n].role), accounts.list[n].name,
		       accounts.list[n].hash[0] ? "" : " (no password: signs on elsewhere)");
	accounts_finish(&accounts);
	return EXIT_SUCCESS;
}

/* ---- the command line */

static int wrong(const char *sentence)
{
	complain(0, sentence);
	fputs("see gopura-curator user --help\n", stderr);
	return 2;
}

static int run(const char *verb, const struct settings *settings)
{
	static const struct {
		const char *verb;
		int (*how)(struct accounts *accounts, const struct settings *settings);
	} verbs[] = {
		{ "add", add },
		{ "password", change_password },
		{ "role", change_role },
		{ "remove", remove_account },
	};

	if (strcmp(verb, "list") == 0)
		return settings->name ? wrong("list takes a folder alone") : list(settings);
	for (unsigned n = 0; n < ARRAY_COUNT(verbs); n++)
		if (strcmp(verb, verbs[n].verb) == 0)
			return settings->name ? change(settings, verbs[n].how)
					      : wrong("name the account");
	return wrong("a subcommand is add, password, role, remove or list");
}

int user_command(int argc, char **argv)
{
	static const struct option options[] = {
		{ "role", required_argument, NULL, 'r' },
		{ "no-password", no_argument, NULL, 'n' },
		{ "help", no_argument, NULL, 'h' },
		{ 0 },
	};
	struct settings settings = { 0 };
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) != -1)
		switch (option) {
		case 'r':
			if (role_parse(&settings.role, optarg) < 0)
				return wrong("--role is reader, editor or publisher");
			break;
		case 'n':
			settings.has_no_password = true;
			break;
		case 'h':
			fputs(help, stdout);
			return 0;
		default:
			return 2;
		}
	if (argc - optind < 2 || argc - optind > 3)
		return wrong("name a subcommand, a content folder and an account");
	settings.folder = argv[optind + 1];
	settings.name = argv[optind + 2];
	return run(argv[optind], &settings);
}
