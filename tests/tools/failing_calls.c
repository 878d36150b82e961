/* Makes the n-th call of a kind fail: preloaded (LD_PRELOAD), it counts the calls that the
 * program's own code makes, not those of its libraries, in each process for itself.
 *
 *   FAIL_KIND   memory: malloc, calloc, realloc, strdup give NULL
 *               io: open, read, write, fsync, rename, mmap and others fail with FAIL_ERRNO
 *               short: read and write of more than a byte do half of it
 *   FAIL_AT     which one, from 1; 0 or absent: none
 *   FAIL_ERRNO  a number; EIO if absent
 *   FAIL_COUNT  a file to which a process adds a line when it ends: how many calls it made */
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(&(name)))dlsym(RTLD_NEXT, #name))
#define CALLER     __builtin_return_address(0)

enum kind { NOTHING, MEMORY, IO, SHORT };

/* glibc's own, which need no dlsym: that allocates. */
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);

static enum kind kind;
static unsigned long fail_at, calls;
static int fail_errno = EIO;
static const char *text_begin, *text_end; /* the program's code */

static int find_text(struct dl_phdr_info *info, size_t size, void *data)
{
	(void)size;
	(void)data;
	for (int i = 0; i < info->dlpi_phnum; i++) {
		const ElfW(Phdr) *part = &info->dlpi_phdr[i];

		if (part->p_type != PT_LOAD || !(part->p_flags & PF_X))
			continue;
		text_begin = (const char *)(info->dlpi_addr + part->p_vaddr);
		text_end = text_begin + part->p_memsz;
	}
	return 1; /* the first is the program itself */
}

__attribute__((constructor)) static void begin(void)
{
	const char *what = getenv("FAIL_KIND"), *at = getenv("FAIL_AT"),
		   *code = getenv("FAIL_ERRNO");

	dl_iterate_phdr(find_text, NULL);
	fail_at = at ? strtoul(at, NULL, 10) : 0;
	fail_errno = code ? (int)strtol(code, NULL, 10) : EIO;
	if (what)
		kind = !strcmp(what, "memory")  ? MEMORY
		       : !strcmp(what, "io")    ? IO
		       : !strcmp(what, "short") ? SHORT
						: NOTHING;
}

__attribute__((destructor)) static void end(void)
{
	const char *path = getenv("FAIL_COUNT");
	char line[32];
	int fd = path ? REAL(open)(path, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0644) : -1;

	kind = NOTHING;
	if (fd < 0)
		return;
	if (REAL(write)(fd, line, (size_t)snprintf(line, sizeof(line), "%lu\n", calls)) < 0)
		abort();
	close(fd);
}

/* Counts a call of the program; returns whether it is the one to fail. */
static bool fails(enum kind of, const void *caller)
{
	const char *from = caller;

	if (kind != of || from < text_begin || from >= text_end)
		return false;
	return __atomic_add_fetch(&calls, 1, __ATOMIC_RELAXED) == fail_at;
}

/* ---- memory */

void *malloc(size_t size)
{
	if (!fails(MEMORY, CALLER))
		return __libc_malloc(size);
	errno = ENOMEM;
	return NULL;
}

void *calloc(size_t count, size_t size)
{
	if (!fails(MEMORY, CALLER))
		return __libc_calloc(count, size);
	errno = ENOMEM;
	return NULL;
}

void *realloc(void *old, size_t size)
{
	if (!fails(MEMORY, CALLER))
		return __libc_realloc(old, size);
	errno = ENOMEM;
	return NULL;
}

char *strdup(const char *text)
{
	const size_t size = strlen(text) + 1;
	char *copy;

	if (fails(MEMORY, CALLER)) {
		errno = ENOMEM;
		return NULL;
	}
	copy = __libc_malloc(size);
	return copy ? memcpy(copy, text, size) : NULL;
}

/* ---- files and sockets */

#define FAIL_IO(result)                                                                            \
	do {                                                                                       \
		if (fails(IO, CALLER)) {                                                           \
			errno = fail_errno;                                                        \
			return result;                                                             \
		}                                                                                  \
	} while (0)

static mode_t mode_of(int flags, va_list list)
{
	return flags & (O_CREAT | O_TMPFILE) ? (mode_t)va_arg(list, int) : 0;
}

int open(const char *path, int flags, ...)
{
	va_list list;
	mode_t mode;

	va_start(list, flags);
	mode = mode_of(flags, list);
	va_end(list);
	FAIL_IO(-1);
	return REAL(open)(path, flags, mode);
}

int openat(int folder, const char *path, int flags, ...)
{
	va_list list;
	mode_t mode;

	va_start(list, flags);
	mode = mode_of(flags, list);
	va_end(list);
	FAIL_IO(-1);
	return REAL(openat)(folder, path, flags, mode);
}

static size_t part_of(size_t size, const void *caller)
{
	return size > 1 && fails(SHORT, caller) ? size / 2 : size;
}

ssize_t read(int fd, void *out, size_t size)
{
	FAIL_IO(-1);
	return REAL(read)(fd, out, part_of(size, CALLER));
}

ssize_t pread(int fd, void *out, size_t size, off_t at)
{
	FAIL_IO(-1);
	return REAL(pread)(fd, out, part_of(size, CALLER), at);
}

ssize_t write(int fd, const void *data, size_t size)
{
	FAIL_IO(-1);
	return REAL(write)(fd, data, part_of(size, CALLER));
}

ssize_t pwrite(int fd, const void *data, size_t size, off_t at)
{
	FAIL_IO(-1);
	return REAL(pwrite)(fd, data, part_of(size, CALLER), at);
}

int fsync(int fd)
{
	FAIL_IO(-1);
	return REAL(fsync)(fd);
}

int fdatasync(int fd)
{
	FAIL_IO(-1);
	return REAL(fdatasync)(fd);
}

int ftruncate(int fd, off_t size)
{
	FAIL_IO(-1);
	return REAL(ftruncate)(fd, size);
}

int rename(const char *from, const char *to)
{
	FAIL_IO(-1);
	return REAL(rename)(from, to);
}

int mkdir(const char *path, mode_t mode)
{
	FAIL_IO(-1);
	return REAL(mkdir)(path, mode);
}

int fstat(int fd, struct stat *out)
{
	FAIL_IO(-1);
	return REAL(fstat)(fd, out);
}

DIR *opendir(const char *path)
{
	FAIL_IO(NULL);
	return REAL(opendir)(path);
}

FILE *fopen(const char *path, const char *mode)
{
	FAIL_IO(NULL);
	return REAL(fopen)(path, mode);
}

size_t fwrite(const void *data, size_t size, size_t count, FILE *file)
{
	FAIL_IO(0);
	return REAL(fwrite)(data, size, count, file);
}

int fflush(FILE *file)
{
	FAIL_IO(EOF);
	return REAL(fflush)(file);
}

void *mmap(void *at, size_t size, int protection, int flags, int fd, off_t offset)
{
	FAIL_IO(MAP_FAILED);
	return REAL(mmap)(at, size, protection, flags, fd, offset);
}

int socket(int family, int type, int protocol)
{
	FAIL_IO(-1);
	return REAL(socket)(family, type, protocol);
}

int pipe2(int ends[2], int flags)
{
	FAIL_IO(-1);
	return REAL(pipe2)(ends, flags);
}
