/* gopura-content publish: signs a release of what was built, repeats an earlier release, or renews
 * the timestamp. */
#include "pipeline/commands.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/build.h"
#include "pipeline/content/work_lock.h"
#include "pipeline/release/publish_content.h"

static const char help[] =
	"gopura-content publish: make a signed release from what is built, or undo a release\n"
	"\n"
	"usage: gopura-content publish DIR [OPTIONS]\n"
	"\n"
	"  --out RELEASE    the release folder (default: DIR/../release)\n"
	"  --comment TEXT   what is new in this release, for people; at most 255 bytes\n"
	"  --keys FOLDER    the signing keys (default: ~/.config/gopura/keys/NAME of DIR; see keys)\n"
	"  --expires DAYS   days after which terminals refuse to install this release (default: 1825)\n"
	"  --undo           publish the previous release again, under a new number\n"
	"  --sequence N     publish release N again, under a new number\n"
	"  --above N        give this release a number above N: after a backup of the release folder was brought\n"
	"                   back, terminals take only what is above all that they have seen\n"
	"  --renew          build nothing: sign the timestamp anew, which is valid for 30 days, and with less\n"
	"                   than two fifths of its days left the release too, under a new number\n"
	"  --trust-clock    sign even if this machine's clock seems wrong: earlier than the last timestamp, or\n"
	"                   more than 400 days later\n"
	"  --write-unsigned FOLDER\n"
	"                   do not publish: write the metadata into FOLDER, to be signed elsewhere\n"
	"  --add-signature FOLDER\n"
	"                   publish what --write-unsigned wrote, with the signatures that were put there\n"
	"\n"
	"Needs hierarchy and samples (`build` makes everything), and warns if the scans or temple.ini\n"
	"have changed since. Objects are written first and the signed files last, so terminals see\n"
	"either the whole old release or the whole new one. Nothing old is changed or removed.\n"
	"\n"
	"Examples:\n"
	"  gopura-content publish temple --comment 'new pages of the east gate'\n"
	"  gopura-content publish temple --undo\n";

enum { ABOVE_MOST = 1000000 }; /* earlier releases are looked for number by number */

struct settings {
	struct publish_content_options publish;
	uint64_t sequence;
	bool undo, renew;
	const char *staged_folder; /* NULL: nothing was signed elsewhere */
};

/* Nothing is made anew here, and what does not belong together looks wrong on the terminals. */
static void judge_age(struct scans *scans)
{
	if (!build_is_current(scans))
		fprintf(stderr,
			"gopura-content publish: warning: the scans or temple.ini have changed since "
			"hierarchy and samples were made: 'gopura-content build %s' makes them anew\n",
			scans_content(scans)->folder);
}

static int publish(struct publish_content_report *report, const struct settings *settings)
{
	if (settings->staged_folder)
		return publish_content_add_signatures(report, &settings->publish,
						      settings->staged_folder);
	if (settings->renew)
		return publish_content_renew(report, &settings->publish);
	if (settings->undo || settings->sequence)
		return publish_content_again(report, &settings->publish, settings->sequence);
	judge_age(sources_scans(settings->publish.sources));
	return publish_content(report, &settings->publish);
}

static int run(struct settings *settings, const char *folder)
{
	struct publish_content_report report;
	struct content content;
	struct sources *sources = NULL;
	int lock = -1;
	int rc = command_read_content(&content, folder);

	if (rc < 0)
		return EXIT_FAILURE;
	rc = work_lock(&lock, &content);
	if (rc == 0)
		rc = sources_create(&sources, &content);
	settings->publish.sources = sources;
	if (rc == 0)
		rc = publish(&report, settings);
	if (rc == 0)
		publish_content_print(stdout, &report);
	if (rc == 0 && settings->publish.unsigned_folder)
		printf("not published yet: sign each FILE.json in %s, or its FILE.json.bytes into "
		       "FILE.json.NAME.sig, and run publish with --add-signature %s\n",
		       settings->publish.unsigned_folder, settings->publish.unsigned_folder);
	if (rc < 0)
		fprintf(stderr, "gopura-content publish: nothing was published (%s)\n",
			strerror(-rc));
	if (lock >= 0)
		close(lock);
	sources_destroy(sources);
	content_release(&content);
	return rc < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

int command_publish(int argc, char **argv)
{
	static const struct option options[] = {
		{ "out", required_argument, NULL, 'o' },
		{ "comment", required_argument, NULL, 'c' },
		{ "keys", required_argument, NULL, 'K' },
		{ "expires", required_argument, NULL, 'e' },
		{ "undo", no_argument, NULL, 'u' },
		{ "sequence", required_argument, NULL, 's' },
		{ "above", required_argument, NULL, 'A' },
		{ "renew", no_argument, NULL, 'r' },
		{ "trust-clock", no_argument, NULL, 't' },
		{ "write-unsigned", required_argument, NULL, 'w' },
		{ "add-signature", required_argument, NULL, 'a' },
		{ "help", no_argument, NULL, 'h' },
		{ NULL, 0, NULL, 0 },
	};
	struct settings settings = { 0 };
	uint64_t days, above;
	int option;

	while ((option = getopt_long(argc, argv, "", options, NULL)) >= 0) {
		switch (option) {
		case 'o':
			settings.publish.out = optarg;
			break;
		case 'c':
			settings.publish.comment = optarg;
			break;
		case 'K':
			settings.publish.keys = optarg;
			break;
		case 'e':
			if (!command_number(optarg, 1, 36500, &days))
				return command_wrong(
					argv[0], "--expires must be 1 to 36500 days, not ", optarg);
			settings.publish.release_life_s = (int64_t)days * 86400;
			break;
		case 'u':
			settings.undo = true;
			break;
		case 's':
			if (!command_number(optarg, 1, UINT32_MAX, &settings.sequence))
				return command_wrong(argv[0],
						     "--sequence must be a release's number, not ",
						     optarg);
			break;
		case 'A':
			if (!command_number(optarg, 1, ABOVE_MOST, &above))
				return command_wrong(argv[0],
						     "--above must be a number up to 1000000, not ",
						     optarg);
			settings.publish.above = (uint32_t)above;
			break;
		case 'r':
			settings.renew = true;
			break;
		case 't':
			settings.publish.trust_clock = true;
			break;
		case 'w':
			settings.publish.unsigned_folder = optarg;
			break;
		case 'a':
			settings.staged_folder = optarg;
			break;
		case 'h':
			fputs(help, stdout);
			return 0;
		default:
			return 2;
		}
	}
	if (optind + 1 != argc)
		return command_wrong(argv[0], "name one content folder", "");
	if (settings.undo + settings.renew + (settings.sequence > 0) +
		    (settings.staged_folder != NULL) >
	    1)
		return command_wrong(
			argv[0], "give only one of --undo, --sequence, --renew and --add-signature",
			"");
	if (settings.publish.above > 0 && (settings.renew || settings.staged_folder))
		return command_wrong(argv[0],
				     "--above goes with neither --renew nor --add-signature", "");
	if (settings.staged_folder && settings.publish.unsigned_folder)
		return command_wrong(argv[0],
				     "give only one of --write-unsigned and --add-signature", "");
	return run(&settings, argv[optind]);
}
