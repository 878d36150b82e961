/* One at a time on a content folder: DIR/.work/lock, held as long as the process lives (POSIX
 * record lock, so that neither a crash nor children that outlive us keep it). */
#ifndef GOPURA_PIPELINE_CONTENT_WORK_LOCK_H
#define GOPURA_PIPELINE_CONTENT_WORK_LOCK_H

#include "pipeline/content/content.h"

/* *fd is owned by the caller: closing it lets go. -EBUSY: another process works there (logged, with
 * its id). Two locks of one process do not keep each other out. */
must_check int work_lock(int *fd, const struct content *content);

#endif
