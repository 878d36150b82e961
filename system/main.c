/* gopura-setup: parses the command line, then applies gopura.conf to the system, checks it, prints
 * its checksum, or enlarges the data partition. */
#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/safe_open.h"
#include "base/transient.h"
#include "board/profile.h"
#include "system/grow.h"
#include "system/setup.h"

static const char help[] =
	"gopura-setup: applies a terminal's gopura.conf to the system (docs/terminal.md)\n"
	"\n"
	"usage: gopura-setup --conf FILE... --out DIR [--boards DIR]\n"
	"       gopura-setup --check FILE [--boards DIR]\n"
	"       gopura-setup --checksum FILE\n"
	"       gopura-setup --grow DISK --partition NAME\n"
	"       gopura-setup --grow-files DEVICE --mounted DIR\n"
	"\n"
	"  --conf FILE      gopura.conf; if given several times, the first file that exists is read;\n"
	"                   if none exists, the network is configured by DHCP. Exit status 3 if all was\n"
	"                   written, but without what could not be read, if that may pass\n"
	"  --out DIR        write the configuration of network, Wi-Fi, fetcher, health page, host\n"
	"                   name and time zone, and the list of faults, to this folder\n"
	"  --boards DIR     board profiles that gopura.conf may name\n"
	"                   (default: /usr/share/gopura/board)\n"
	"  --check FILE     print the faults of the file; exit status 1 if there are any\n"
	"  --checksum FILE  print a checksum of the file and the files that it names; exit status 1\n"
	"                   if it cannot be read, 2 if that may pass\n"
	"  --grow DISK      enlarge the last partition of the disk, NAME, to the end of the disk\n"
	"  --grow-files DEVICE\n"
	"                   enlarge the ext4 file system on the device, mounted at DIR, to its end\n"
	"  --help, --version\n"
	"\n"
	"Examples:\n"
	"  gopura-setup --check gopura.conf\n"
	"  gopura-setup --conf /efi/gopura.conf --conf /media/usb/gopura.conf --out /run/gopura\n";

enum {
	CONFS_MAX = 4,
	STATUS_AGAIN = 3, /* exit status: applied without what could not be read now */
};

struct command {
	const char *confs[CONFS_MAX];
	unsigned count;
	const char *out, *check, *sum, *boards;
	const char *grow, *partition, *grow_files, *mounted;
	bool boards_asked;
};

enum {
	OPTION_CONF = 256,
	OPTION_OUT,
	OPTION_BOARDS,
	OPTION_CHECK,
	OPTION_CHECKSUM,
	OPTION_SUM,
	OPTION_GROW,
	OPTION_PARTITION,
	OPTION_GROW_FILES,
	OPTION_MOUNTED,
	OPTION_VERSION,
	OPTION_HELP,
};

static const struct option long_options[] = {
	{ "conf", required_argument, NULL, OPTION_CONF },
	{ "out", required_argument, NULL, OPTION_OUT },
	{ "boards", required_argument, NULL, OPTION_BOARDS },
	{ "check", required_argument, NULL, OPTION_CHECK },
	{ "checksum", required_argument, NULL, OPTION_CHECKSUM },
	{ "sum", required_argument, NULL, OPTION_SUM }, /* its name before */
	{ "grow", required_argument, NULL, OPTION_GROW },
	{ "partition", required_argument, NULL, OPTION_PARTITION },
	{ "grow-files", required_argument, NULL, OPTION_GROW_FILES },
	{ "mounted", required_argument, NULL, OPTION_MOUNTED },
	{ "version", no_argument, NULL, OPTION_VERSION },
	{ "help", no_argument, NULL, OPTION_HELP },
	{ 0 },
};

static void usage(const char *wrong)
{
	fprintf(stderr, "gopura-setup: %s; see gopura-setup --help\n", wrong);
	exit(2);
}

static void refuse_argument(const char *argument)
{
	fprintf(stderr, "gopura-setup: '%s' is not an option; see gopura-setup --help\n", argument);
	exit(2);
}

/* Refuses file names that other programs could misread, because the names are passed on to them. */
static void check_name(const char *name)
{
	for (const char *c = name; *c; c++)
		if ((unsigned char)*c < 0x20 || *c == 0x7f || *c == '"' || *c == '\\')
			usage("a file name contains quotes, backslashes or control characters; "
			      "rename the file or folder");
}

static void take_option(struct command *command, int option)
{
	if (option == OPTION_CONF || option == OPTION_OUT || option == OPTION_BOARDS)
		check_name(optarg);
	switch (option) {
	case OPTION_CONF:
		if (command->count == CONFS_MAX)
			usage("--conf is given more than 4 times");
		command->confs[command->count++] = optarg;
		break;
	case OPTION_OUT:
		command->out = optarg;
		break;
	case OPTION_BOARDS:
		command->boards = optarg;
		command->boards_asked = true;
		break;
	case OPTION_CHECK:
		command->check = optarg;
		break;
	case OPTION_CHECKSUM:
		command->sum = optarg;
		break;
	case OPTION_SUM:
		usage("--sum is called --checksum now");
		break;
	case OPTION_GROW:
		command->grow = optarg;
		break;
	case OPTION_PARTITION:
		command->partition = optarg;
		break;
	case OPTION_GROW_FILES:
		command->grow_files = optarg;
		break;
	case OPTION_MOUNTED:
		command->mounted = optarg;
		break;
	case OPTION_VERSION:
		puts("gopura-setup " GOPURA_VERSION);
		exit(0);
	case OPTION_HELP:
		fputs(help, stdout);
		exit(0);
	default: /* getopt has printed the error */
		usage("an option is wrong");
	}
}

static void parse(struct command *command, int argc, char **argv)
{
	int option;

	while ((option = getopt_long(argc, argv, "", long_options, NULL)) != -1)
		take_option(command, option);
	if (optind < argc)
		refuse_argument(argv[optind]);
	if (command->grow || command->partition || command->grow_files || command->mounted) {
		if (!command->grow != !command->partition)
			usage("--grow and --partition need each other");
		if (!command->grow_files != !command->mounted)
			usage("--grow-files and --mounted need each other");
		if ((command->grow && command->grow_files) || command->check || command->sum ||
		    command->count > 0 || command->out)
			usage("--grow and --grow-files cannot be combined with other commands");
		return;
	}
	if (command->check || command->sum) {
		if ((command->check && command->sum) || command->count > 0 || command->out)
			usage("--check and --checksum cannot be combined with other commands");
		return;
	}
	if (command->count == 0)
		usage("--conf is missing");
	if (!command->out)
		usage("--out is missing");
}

/* Checks one file. On a desk computer the board profiles are not installed, so they are only
 * checked if --boards is given. */
static int check(const struct command *command)
{
	static struct terminal terminal;
	static struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	char before[PATH_MAX + 2];
	bool bad;

	if (terminal_read(&terminal, command->check, command->boards_asked ? command->boards : NULL,
			  &diagnostics) < 0) {
		fprintf(stderr, "gopura-setup: %s: there is no such file\n", command->check);
		return 1;
	}
	snprintf(before, sizeof(before), "%s: ", command->check);
	diagnostics_print(&diagnostics, stdout, before);
	if (diagnostics.count == 0)
		printf("%s: no faults\n", command->check);
	bad = diagnostics.count > 0;
	diagnostics_finish(&diagnostics);
	return bad;
}

static int print_sum(const char *path)
{
	char sum[TERMINAL_SUM_BYTES];
	const int rc = terminal_sum(path, sum);

	if (rc < 0)
		fprintf(stderr, "gopura-setup: %s: %s\n", path, open_problem(rc));
	else
		puts(sum);
	return rc == 0 ? 0 : is_transient(rc) ? 2 : 1;
}

/* Sets what the profile of the terminal's board says of the cache; 0 if there is none. Returns the
 * result of reading it. */
static int read_cache_mib(uint32_t *out, const struct terminal *terminal, const char *boards)
{
	struct profile profile;
	char path[PATH_MAX];
	int rc;

	*out = 0;
	if (!terminal->board[0])
		return 0;
	snprintf(path, sizeof(path), "%s/%s.ini", boards, terminal->board);
	rc = profile_read(&profile, path);
	if (rc == 0)
		*out = profile.cache_mib;
	return rc;
}

/* Returns whether a file could not be read now, but perhaps at the next try. */
static bool may_pass(const struct diagnostics *diagnostics)
{
	for (unsigned i = 0; i < diagnostics->count; i++)
		if (is_transient(diagnostics_get(diagnostics, i)->error))
			return true;
	return false;
}

static int apply(const struct command *command)
{
	static struct terminal terminal;
	static struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	struct setup setup = { .terminal = &terminal,
			       .diagnostics = &diagnostics,
			       .out = command->out };
	bool again;
	int rc;

	for (unsigned i = 0; i < command->count && !setup.conf_path; i++)
		if (terminal_read(&terminal, command->confs[i], command->boards, &diagnostics) == 0)
			setup.conf_path = command->confs[i];
	if (setup.conf_path)
		log_info("setup", "%s: %u faults", setup.conf_path,
			 diagnostics_total(&diagnostics));
	else
		diagnostics_add(&diagnostics, -EINVAL, NULL, 0,
				"%s does not exist: create it (docs/terminal.md); until then the "
				"network is configured by DHCP",
				command->confs[0]);
	for (unsigned i = 0; i < diagnostics.count; i++)
		log_warn("setup", "%s", diagnostics_get(&diagnostics, i)->text);
	again = may_pass(&diagnostics);
	if (setup.conf_path)
		again |= is_transient(read_cache_mib(&setup.cache_mib, &terminal, command->boards));
	rc = setup_write(&setup);
	diagnostics_finish(&diagnostics);
	if (rc == -EAGAIN || (rc == 0 && again))
		return STATUS_AGAIN;
	return rc < 0;
}

int main(int argc, char **argv)
{
	struct command command = { .boards = "/usr/share/gopura/board" };

	parse(&command, argc, argv);
	if (command.grow)
		return grow_partition(command.grow, command.partition) < 0;
	if (command.grow_files)
		return grow_files(command.grow_files, command.mounted) < 0;
	if (command.sum)
		return print_sum(command.sum);
	return command.check ? check(&command) : apply(&command);
}
