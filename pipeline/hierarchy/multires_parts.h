/* Private to multires*.c. */
#ifndef GOPURA_PIPELINE_HIERARCHY_MULTIRES_PARTS_H
#define GOPURA_PIPELINE_HIERARCHY_MULTIRES_PARTS_H

#include <stdbool.h>

#include "pipeline/hierarchy/multires.h"

#define NO_GROUP UINT32_MAX

struct sphere {
	double centre[3], radius; /* metres */
};

/* A patch of the level at work: vertices by their index in the scan. */
struct live_patch {
	uint32_t (*triangles)[3]; /* owned */
	uint32_t triangle_count;
	uint32_t finer;          /* the group that replaces it, by order of making; or NO_GROUP */
	double error_m, loss_m4; /* of that group; 0: none */
	struct sphere finer_sphere;
	float centre[3]; /* lattice steps; where it is, roughly */
};

struct live_patches {
	struct live_patch *items; /* owned */
	uint32_t count, room;
};

void live_patch_finish(struct live_patch *patch);
void live_patches_finish(struct live_patches *patches);
must_check int live_patches_add(struct live_patches *patches, struct live_patch patch); /* taken */

/* One group at work: its patches become an object, then coarser patches. */
struct group_job {
	struct live_patch *patches; /* borrowed; emptied once they are an object */
	uint32_t patch_count;
	uint32_t low, high;        /* a vertex is the group's own if low <= its users <= high */
	uint32_t number;           /* by order of making */
	uint32_t target_triangles; /* 0: it is the top, nothing coarser is made */
	bool is_whole;             /* the level is this one group */
	/* What comes of it, owned: */
	struct buffer object;
	struct hierarchy_group group;
	float loss_m4;                /* as multires_sink has it */
	struct hierarchy_patch *made; /* patch_count; finer is by order of making */
	struct live_patches coarser;
	uint64_t vertex_count;
};

/* What all jobs of a level share. */
struct job_site {
	struct lattice_mesh *mesh;
	uint32_t *lows, *highs; /* of each vertex: the least and greatest user */
	uint32_t patch_triangles;
	uint32_t **local_of; /* a map a worker, all NO_GROUP between jobs */
};

must_check int group_job_run(const struct job_site *site, struct group_job *job, uint32_t worker);
void group_job_finish(struct group_job *job);

/* Writes object and records of a group's patches. */
must_check int group_job_write(const struct job_site *site, struct group_job *job,
			       uint32_t *local_of);

#endif
