/* Writes the object and the hierarchy rows of a group. Private to multires*.c. */
#ifndef GOPURA_PIPELINE_HIERARCHY_MULTIRES_WRITE_H
#define GOPURA_PIPELINE_HIERARCHY_MULTIRES_WRITE_H

#include "pipeline/hierarchy/multires_job.h"

/* Writes the object and the hierarchy rows of a group's patches. Returns -ENOMEM or encoder
 * errors. */
must_check int group_job_write(const struct job_site *site, struct group_job *job,
			       uint32_t *local_of);

#endif
