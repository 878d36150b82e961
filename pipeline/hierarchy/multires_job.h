/* Makes one group of the hierarchy and the coarser patches above it. Private to multires*.c. */
#ifndef GOPURA_PIPELINE_HIERARCHY_MULTIRES_JOB_H
#define GOPURA_PIPELINE_HIERARCHY_MULTIRES_JOB_H

#include "pipeline/hierarchy/multires.h"

/* One group in progress: its patches become an object, then coarser patches. */
struct group_job {
	struct live_patch *patches; /* borrowed array; group_job_run frees their triangles */
	uint32_t patch_count;
	uint32_t low, high; /* a vertex belongs to the group alone if low <= its users <= high */
	uint32_t number;    /* in order of making, from first_number of the node */
	uint32_t target_triangles; /* 0: the top group, nothing coarser is made */
	bool is_whole; /* no error limit: the only group of its level, or the binary tree */
	/* Results, owned by the job: */
	struct buffer object;
	struct hierarchy_group group;
	float loss_m4;                /* as in multires_sink */
	struct hierarchy_patch *made; /* patch_count rows; finer is in order of making */
	struct live_patches coarser;
	uint64_t vertex_count;
};

/* Data that all jobs of a level share. */
struct job_site {
	struct lattice_mesh *mesh;
	const uint8_t *pinned;  /* for each vertex; NULL: none is */
	uint32_t *lows, *highs; /* for each vertex: its smallest and largest user */
	enum multires_simplifier simplifier;
	uint32_t patch_triangles;
	uint32_t **local_of; /* one map per worker; all NO_GROUP between jobs */
};

/* Runs a job on a worker thread; jobs touch disjoint unlocked vertices. Returns -ENOMEM or the
 * errors of encoding and partition. */
must_check int group_job_run(const struct job_site *site, struct group_job *job, uint32_t worker);
/* Frees the results. */
void group_job_finish(struct group_job *job);

#endif
