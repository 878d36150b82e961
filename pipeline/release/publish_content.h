/* Publishes a content folder whose hierarchy and samples exist. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_CONTENT_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_CONTENT_H

#include <limits.h>
#include <stdio.h>

#include "pipeline/content/sources.h"
#include "pipeline/release/publish.h"
#include "pipeline/release/publish_budget.h"

struct publish_content_options {
	struct sources *sources; /* borrowed */
	const char *out;         /* the release folder; NULL: "release" beside the content folder */
	const char *keys;        /* the keys' folder; NULL: as pipeline/keys/keys_place.h says */
	const char *comment;     /* NULL: none */
	/* Where metadata goes that is signed elsewhere; NULL: it is published. */
	const char *unsigned_folder;
	int64_t release_life_s; /* 0: RELEASE_LIFE_DAYS */
	bool trust_clock;       /* as struct publish_target has it */
	uint32_t above;         /* likewise */
};

struct publish_content_report {
	struct publish_report publish;
	char release[PATH_MAX];
	uint64_t release_bytes; /* size of all objects of the current release */
	uint32_t release_packs;
	/* Set by publish_content: what the root page says. */
	uint64_t published_triangles;
	uint64_t patch_bytes; /* of the published groups */
	float start_eye_m[3], start_target_m[3];
	bool lit;
	struct publish_budget_report budget; /* all 0 if there was no budget */
};

/* Publishes the content folder. Makes signing keys if there are none. Returns -ENOENT if hierarchy
 * or samples do not exist yet. Errors are logged. */
must_check int publish_content(struct publish_content_report *report,
			       const struct publish_content_options *options);

/* Publishes the root of an earlier release again: see publish_again. */
must_check int publish_content_again(struct publish_content_report *report,
				     const struct publish_content_options *options,
				     uint64_t sequence);

/* Reports the current release; nothing is published. Returns the errors below, without a word. */
must_check int publish_content_current(struct publish_content_report *report,
				       const struct publish_content_options *options);
/* Signs anew what runs out: see publish_renew. Returns -ENOENT if nothing was published there, or
 * its locator is missing; -ENODATA: some of its packs are. */
must_check int publish_content_renew(struct publish_content_report *report,
				     const struct publish_content_options *options);

/* Publishes what was staged in a folder: see release_tuf_add_signatures. */
must_check int publish_content_add_signatures(struct publish_content_report *report,
					      const struct publish_content_options *options,
					      const char *staged_folder);

/* Prints for people: one line about the current release, one about what was written. */
void publish_content_print(FILE *to, const struct publish_content_report *report);

#endif
