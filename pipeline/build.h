/* From a content folder to a release: import, hierarchy, samples, publishing, each only where what
 * it is made from has changed, and each going on where an interrupted run stopped. */
#ifndef GOPURA_PIPELINE_BUILD_H
#define GOPURA_PIPELINE_BUILD_H

#include "pipeline/release/publish_content.h"

struct build_options {
	const char *out;     /* the release folder; NULL: "release" beside the content folder */
	const char *keys;    /* the keys' folder; NULL: as pipeline/keys/keys_place.h says */
	const char *comment; /* NULL: none */
	uint32_t jobs;       /* processes and threads; 0: one a core */
};

struct build_report {
	bool nothing_changed; /* since the last build: only the timestamp is new */
	bool hierarchy_made;  /* anew */
	int64_t hierarchy_ms, samples_ms, publish_ms, all_ms;
	uint64_t source_triangles;
	struct publish_content_report publish;
};

/* content: as read, with what the command line changed. Errors are logged. */
must_check int build_content(struct build_report *report, const struct content *content,
			     const struct build_options *options);

/* How a folder's master is to be made. */
struct master_options;
void build_master_options(struct master_options *out, const struct content *content, uint32_t jobs);

#endif
