/* Predicts what a build of a content folder will cost, before anything of it is spent: from the
 * headers and sizes of the scans' files, temple.ini, what lies in .work already, and a short trial
 * of this machine. docs/estimate.md says how, and how far it is from what builds took. */
#ifndef GOPURA_PIPELINE_ESTIMATE_H
#define GOPURA_PIPELINE_ESTIMATE_H

#include <stdio.h>

#include "pipeline/build.h"

enum estimate_stage_name {
	ESTIMATE_SURFACE, /* only if work.surface_points is not 0 */
	ESTIMATE_IMPORT,
	ESTIMATE_HIERARCHY,
	ESTIMATE_SAMPLES,
	ESTIMATE_PUBLISHING,
	ESTIMATE_STAGES
};

struct estimate_stage {
	bool is_done;          /* by an earlier build; it costs nothing */
	double processor_s;    /* seconds of one processor, of this machine without other work */
	double time_s;         /* with all processors that are used, without other work */
	uint64_t memory_bytes; /* resident at one time, of all its processes */
	uint64_t disk_bytes;   /* of what it leaves in .work or in the release */
};

/* What is to be done. */
struct estimate_work {
	uint64_t triangle_count, vertex_count;
	uint64_t surface_points; /* of scans that become a surface first; 0: there is none */
	uint64_t closed_from; /* triangles of the scans of which a closed surface is made; 0: none
				 is */
	bool is_counted; /* the files say how many triangles they have, or they were imported */
	bool is_text, is_foreign, has_pictures;
	uint32_t point_count, points_done;
	uint64_t face_count, tile_count;
	double seconds_a_point; /* of the points that are done; 0: unknown */
	uint64_t published_triangles;
};

struct estimate {
	struct estimate_work work;
	struct estimate_stage stages[ESTIMATE_STAGES];
	double time_s;
	uint64_t memory_bytes;       /* of the stage that needs most */
	uint64_t disk_peak_bytes;    /* of .work and the release together, with what is there */
	uint64_t work_bytes;         /* of .work after the build */
	uint64_t release_bytes;      /* of the release's objects */
	uint64_t budget_bytes;       /* as in content; 0: none */
	uint64_t least_bytes;        /* with a budget: of the smallest release */
	uint64_t disk_present_bytes; /* of the stages that are done */
	uint64_t disk_free_bytes;    /* of the file system with .work; UINT64_MAX: unknown */
	uint64_t memory_free_bytes;  /* of the machine; 0: unknown */
	uint32_t processors, jobs;
	double load; /* processes that want a processor, over the last minute */
};

/* Checks the content as build_content does before its long work, and fills in *out. Nothing is
 * imported and nothing written but a folder for the trial, which is removed. Takes seconds.
 * Negative errno; errors are logged, and -EINVAL means that the content has faults. */
must_check int estimate_build(struct estimate *out, const struct content *content,
			      const struct build_options *options);

/* Prints the estimate for people: a table and what it means. */
void estimate_print(FILE *to, const struct estimate *estimate);

#endif
