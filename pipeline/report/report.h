/* The report of a build: DIR/.work/report.html, one file for people that needs no other, with what
 * the stages found and left. It lies beside what a build keeps and is no part of the release.
 * docs/report.md shows it. */
#ifndef GOPURA_PIPELINE_REPORT_REPORT_H
#define GOPURA_PIPELINE_REPORT_REPORT_H

#include "pipeline/release/publish_content.h"

/* What a stage of this build took. */
struct report_stage {
	const char *name;      /* constant */
	bool was_there;        /* its result was there already */
	int64_t ms;            /* by the clock */
	int64_t processor_us;  /* of all processes */
	uint64_t memory_bytes; /* most of one process; 0: unknown */
};

struct report_options {
	struct sources *sources;                      /* borrowed, as the next two */
	const struct publish_content_report *publish; /* of the release that was just made */
	const struct report_stage *stages;
	uint32_t stage_count;
};

/* Writes the report from what lies in .work; path gets its name. Pictures are left out if they
 * cannot be drawn (logged). Negative errno; errors are logged. */
must_check int report_write(const struct report_options *options, char path[CONTENT_PATH_BYTES]);

#endif
