/* Builds a release from a content folder: a surface of scans that are none, import and hierarchy,
 * samples, publishing. Each stage runs only if its inputs have changed, and continues where an
 * interrupted run stopped. */
#ifndef GOPURA_PIPELINE_BUILD_H
#define GOPURA_PIPELINE_BUILD_H

#include "pipeline/hierarchy/master.h"
#include "pipeline/release/publish_content.h"
#include "pipeline/report/report.h"
#include "pipeline/samples/sampler.h"

struct build_options {
	const char *out;     /* release folder; NULL: "release" beside the content folder */
	const char *keys;    /* folder of the keys; NULL: chosen by pipeline/keys/keys_place.h */
	const char *comment; /* NULL: none */
	uint32_t jobs;       /* processes and threads; 0: one per core */
};

/* BUILD_SURFACE has no name unless range images or clouds are among the scans, or temple.ini asks
 * for an octree. */
enum build_stage { BUILD_SURFACE, BUILD_HIERARCHY, BUILD_SAMPLES, BUILD_PUBLISHING, BUILD_STAGES };

struct build_report {
	bool nothing_changed; /* since the last build; only signatures are new */
	struct report_stage stages[BUILD_STAGES];
	int64_t all_ms;
	char page[CONTENT_PATH_BYTES]; /* the report for people; "" if it was not written */
	uint64_t source_triangles;
	struct publish_content_report publish;
};

/* content: as read, with changes from the command line. *report is filled in. Negative errno;
 * errors are logged, and -EINVAL means that the content has faults. */
must_check int build_content(struct build_report *report, const struct content *content,
			     const struct build_options *options);

/* ---- single stages */

struct build_master_options {
	uint32_t jobs;      /* threads; 0: one per core */
	struct shard shard; /* of several machines that do this at once */
	bool force;         /* make it again even if nothing changed */
};

struct build_master_report {
	bool made;                   /* it was made, not opened */
	struct master_report master; /* if it was made */
};

/* Opens this content's master, and makes it if it is missing or its sources have changed. *out is
 * owned by the caller; NULL on failure. *report is filled in. Negative errno, with a diagnostic. */
must_check int build_master(struct master **out, struct scans *scans,
			    const struct build_master_options *options,
			    struct build_master_report *report, struct diagnostics *diagnostics);
/* Opens this content's master if it is there and of these scans; otherwise *out is NULL. */
void build_known_master(struct master **out, struct scans *scans);
/* Returns whether hierarchy and samples are there and of these scans and settings. The hierarchy
 * may be of either kind, because a build can be told another than temple.ini has. Reads no scan. */
bool build_is_current(struct scans *scans);
/* Renders the samples that are missing, with the master where the scans have no pictures; it is
 * that of build_master. options->master is not used. Negative errno, with a diagnostic. */
must_check int build_samples(struct scans *scans, const struct master *master,
			     const struct sampler_options *options,
			     struct diagnostics *diagnostics);

#endif
