/* Takes a POSIX record lock on DIR/.work/lock. */
#include "pipeline/content/work_lock.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "base/log.h"

int work_lock(int *fd, const struct content *content)
{
	struct flock lock = { .l_type = F_WRLCK, .l_whence = SEEK_SET };
	char path[CONTENT_PATH_BYTES];
	int rc = content_work_path(content, "lock", path);

	*fd = -1;
	if (rc < 0)
		return rc;
	*fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0644);
	if (*fd < 0) {
		rc = -errno;
		log_error("pipeline", "%s: %s", path, strerror(-rc));
		return rc;
	}
	if (fcntl(*fd, F_SETLK, &lock) == 0)
		return 0;
	rc = errno == EACCES || errno == EAGAIN ? -EBUSY : -errno;
	if (rc == -EBUSY && fcntl(*fd, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK)
		log_error("pipeline", "%s: process %d works on this content folder; wait for it",
			  content->folder, (int)lock.l_pid);
	close(*fd);
	*fd = -1;
	return rc;
}
