/* Makes a release from its parts: root page, packs, locator, signed files. */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_H

#include "format/root_page.h"
#include "pipeline/release/pack.h"
#include "pipeline/release/release_files.h"
#include "pipeline/release/tuf_folder.h"

enum {
	RELEASE_LIFE_DAYS = 5 * 365, /* a terminal may be without network for years */
	TIMESTAMP_LIFE_DAYS = 30,
};

struct publish_target {
	const char *release;               /* the release folder; created if needed */
	const char *keys_folder;           /* folder of `keys` */
	const struct publisher_keys *keys; /* not used if tuf_alone */
	bool tuf_alone;         /* in the form of The Update Framework alone (docs/tuf.md) */
	const char *tuf_target; /* path among its targets; NULL or "": release.json */
	const char *tuf_role;   /* of its targets; NULL or "": the top */
	/* Where metadata of The Update Framework goes that is signed elsewhere; NULL: it is
	 * published. With tuf_alone. */
	const char *unsigned_folder;
	bool trust_clock; /* sign even if published_check_clock would refuse */
	/* The next release gets a number above it, and is made even if nothing changed: terminals
	 * may know higher ones than a folder that was restored from a backup. 0: there is none. */
	uint32_t above;
	const char *comment;    /* NULL: none. A changed comment alone also makes a new release. */
	int64_t release_life_s; /* 0: RELEASE_LIFE_DAYS */
	int64_t timestamp_life_s; /* 0: TIMESTAMP_LIFE_DAYS */
	uint32_t pack_bytes;      /* 0: PACK_BYTES; for tests */
};

struct publish_report {
	struct release release; /* the release that is current now */
	bool changed;           /* a new release was made */
	struct pack_result packs;
};

/* Publishes a release. children: the pages of hierarchy, samples, information and, if there are
 * any, labels, and what root->has_solid and root->has_stream announce; objects holds them and
 * everything below them. If nothing changed and there is no new comment, what runs out is renewed:
 * publish_renew. Errors are logged. */
must_check int publish_parts(struct publish_report *report, const struct publish_target *target,
			     struct object_store *objects, const struct root_page *root,
			     const struct page_child *children, uint32_t child_count);

/* Publishes the root of an earlier release again, with a higher sequence. sequence 0: the last
 * release with another root than the current one (undo). Returns -ENOENT if there is none
 * (logged). */
must_check int publish_again(struct publish_report *report, const struct publish_target *target,
			     uint64_t sequence);

/* Signs anew what runs out: the timestamp; and with less than two fifths of its life left, which is
 * release_life_s, the release itself, under the next sequence. Only release and changed of *report
 * are set. Returns -ENOENT if nothing was published yet; -ECANCELED, as the two above: the clock
 * seems to be wrong (published_check_clock). */
must_check int publish_renew(struct publish_report *report, const struct publish_target *target);

/* Creates the folder "a/b/c" and all folders above it. Errors are logged. */
must_check int publish_make_folder(const char *path);

#endif
