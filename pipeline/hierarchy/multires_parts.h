/* What the sources of the hierarchy build share. Private to multires*.c. */
#ifndef GOPURA_PIPELINE_HIERARCHY_MULTIRES_PARTS_H
#define GOPURA_PIPELINE_HIERARCHY_MULTIRES_PARTS_H

#include <stdbool.h>

#include "pipeline/hierarchy/multires.h"

#define NO_GROUP UINT32_MAX

struct sphere {
	double centre[3], radius; /* in metres */
};

/* A patch of the current level. Vertices are given by their index in the scan. */
struct live_patch {
	uint32_t (*triangles)[3]; /* owned */
	uint32_t triangle_count;
	uint32_t finer; /* number of the group that replaces it, in order of making; or NO_GROUP */
	double error_m, loss_m4; /* of that group; 0 if there is none */
	struct sphere finer_sphere;
	float centre[3]; /* lattice steps; approximate position */
};

struct live_patches {
	struct live_patch *items; /* owned */
	uint32_t count, room;
};

/* Free the triangles. */
void live_patch_finish(struct live_patch *patch);
void live_patches_finish(struct live_patches *patches);
must_check int
live_patches_add(struct live_patches *patches,
		 struct live_patch patch); /* patch is taken, also on failure; -ENOMEM */

/* One group in progress: its patches become an object, then coarser patches. */
struct group_job {
	struct live_patch *patches; /* borrowed array; group_job_run frees their triangles */
	uint32_t patch_count;
	uint32_t low, high; /* a vertex belongs to the group alone if low <= its users <= high */
	uint32_t number;    /* in order of making */
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
	uint32_t *lows, *highs; /* for each vertex: its smallest and largest user */
	uint32_t patch_triangles;
	uint32_t **local_of; /* one map per worker; all NO_GROUP between jobs */
};

/* Runs a job on a worker thread; jobs touch disjoint unlocked vertices. Returns -ENOMEM or the
 * errors of encoding and partition. */
must_check int group_job_run(const struct job_site *site, struct group_job *job, uint32_t worker);
/* Frees the results. */
void group_job_finish(struct group_job *job);

/* Writes the object and the hierarchy rows of a group's patches. Returns -ENOMEM or encoder
 * errors. */
must_check int group_job_write(const struct job_site *site, struct group_job *job,
			       uint32_t *local_of);

#endif
