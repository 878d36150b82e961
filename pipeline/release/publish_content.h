/* A release out of a content folder whose hierarchy and samples are made. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_CONTENT_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_CONTENT_H

#include <limits.h>
#include <stdio.h>

#include "pipeline/content/content.h"
#include "pipeline/release/publish.h"

struct publish_content_options {
	const struct content *content;
	const char *out;        /* the release folder; NULL: "release" beside the content folder */
	const char *keys;       /* the keys' folder; NULL: as pipeline/keys/keys_place.h says */
	const char *comment;    /* NULL: none */
	int64_t release_life_s; /* 0: RELEASE_LIFE_DAYS */
};

struct publish_content_report {
	struct publish_report publish;
	char release[PATH_MAX];
	uint64_t release_bytes; /* of the objects of the current release */
	uint32_t release_packs;
	uint64_t published_triangles; /* by publish_content */
};

/* Errors are logged. -ENOENT: hierarchy or samples are not made yet. */
must_check int publish_content(struct publish_content_report *report,
			       const struct publish_content_options *options);

/* Whether parts, pages and pictures can be published; every fault is logged. */
must_check int publish_content_check(const struct content *content);

/* The root of an earlier release again: see publish_again. */
must_check int publish_content_again(struct publish_content_report *report,
				     const struct publish_content_options *options,
				     uint64_t sequence);

/* What is published, and nothing written. -ENOENT as below. */
must_check int publish_content_current(struct publish_content_report *report,
				       const struct publish_content_options *options);
/* Nothing but a new timestamp. -ENOENT: nothing is published there, or its packs are not all there
 * any more. */
must_check int publish_content_renew(struct publish_content_report *report,
				     const struct publish_content_options *options);

/* For people: one line for what is current, one for what was written. */
void publish_content_print(FILE *to, const struct publish_content_report *report);

#endif
