/* A release out of its parts: root page, packs, locator, signed files. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_H

#include "format/root_page.h"
#include "pipeline/release/pack.h"
#include "pipeline/release/release_files.h"

enum {
	RELEASE_LIFE_DAYS = 5 * 365, /* a terminal may be without network for years */
	TIMESTAMP_LIFE_DAYS = 30,
};

struct publish_target {
	const char *release;     /* the release folder; made if it is not there */
	const char *keys_folder; /* of `keys` */
	const struct publisher_keys *keys;
	const char *comment;      /* NULL: none. A new one alone makes a new release too. */
	int64_t release_life_s;   /* 0: RELEASE_LIFE_DAYS */
	int64_t timestamp_life_s; /* 0: TIMESTAMP_LIFE_DAYS */
	uint32_t pack_bytes;      /* 0: PACK_BYTES; for tests */
};

struct publish_report {
	struct release release; /* that is current now */
	bool changed;           /* it has a new sequence */
	struct pack_result packs;
};

/* children: hierarchy, samples, information and, where there is one, labels page, in objects with
 * all that is below them.
 * Nothing new and no comment: only the timestamp is renewed. Errors are logged. */
must_check int publish_parts(struct publish_report *report, const struct publish_target *target,
			     struct object_store *objects, const struct root_page *root,
			     const struct page_child *children, uint32_t child_count);

/* The root of an earlier release again, under a higher sequence. sequence 0: the last one that had
 * another root than the current (undo). -ENOENT: there is none (logged). */
must_check int publish_again(struct publish_report *report, const struct publish_target *target,
			     uint64_t sequence);

/* A new timestamp for what is current. */
must_check int publish_renew(const struct publish_target *target);

/* "a/b/c" with all folders above it. */
must_check int publish_make_folder(const char *path);

#endif
