/* Simulates a failing machine: preloaded (LD_PRELOAD), it removes what SICK names:
 *
 *   units  the GPU has four texture units
 *   room   every disk has one megabyte left
 *   sync   fsync fails, as on a disk that is failing
 */
#include <dlfcn.h>
#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <GLES2/gl2.h>

#define REAL(name) ((__typeof__(&(name)))dlsym(RTLD_NEXT, #name))

static bool lacks(const char *what)
{
	const char *sick = getenv("SICK");

	return sick && strcmp(sick, what) == 0;
}

GL_APICALL void GL_APIENTRY glGetIntegerv(GLenum name, GLint *out)
{
	REAL(glGetIntegerv)(name, out);
	if (lacks("units") && name == GL_MAX_TEXTURE_IMAGE_UNITS)
		*out = 4;
}

int statvfs(const char *path, struct statvfs *out)
{
	const int rc = REAL(statvfs)(path, out);

	if (rc == 0 && lacks("room"))
		out->f_bavail = (1 << 20) / out->f_frsize;
	return rc;
}

int fsync(int fd)
{
	if (lacks("sync")) {
		errno = EIO;
		return -1;
	}
	return REAL(fsync)(fd);
}
