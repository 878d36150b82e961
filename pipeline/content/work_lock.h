/* Allows only one process at a time to work on a content folder. The lock is DIR/.work/lock, held
 * while the process lives. It is a POSIX record lock, so neither a crash nor a child that outlives
 * us keeps it. */
#ifndef GOPURA_PIPELINE_CONTENT_WORK_LOCK_H
#define GOPURA_PIPELINE_CONTENT_WORK_LOCK_H

#include "pipeline/content/content.h"

/* *fd is owned by the caller; closing it releases the lock. -EBUSY: another process works there
 * (logged, with its id). Two locks in the same process do not exclude each other. */
must_check int work_lock(int *fd, const struct content *content);

#endif
