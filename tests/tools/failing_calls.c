/* Makes the n-th call of a kind fail: preloaded (LD_PRELOAD), it counts the calls that the
 * program's own code makes, not those of its libraries, in each process for itself.
 *
 *   FAIL_KIND     memory: malloc, calloc, realloc, strdup, strndup give NULL
 *                 io: open, read, write, fsync, rename, mmap, connect, epoll_wait and others fail
 *                 with FAIL_ERRNO
 *                 database: the same calls as io where SQLite makes them for the program
 *                 codec: the same calls as memory where libraries that decode or compress make them
 *                 short: read and write of more than a byte do half of it
 *   FAIL_AT       which one, from 1; 0 or absent: none
 *   FAIL_ERRNO    a number; EIO if absent
 *   FAIL_COUNT    a file to which a process adds a line when it ends: how many calls it made
 *   FAIL_PROGRAM  only processes of this name are counted, and what they start is not
 *   FAIL_ONCE     a file that the failing call creates, with its name in it; while the file exists
 *                 no other call fails, so that a program that is started again works. A crash adds
 *                 a line that begins with "crashed"
 *   FAIL_LEFT     a file to which a process adds, when it ends, a line for each block of memory
 * that the program's code allocated and nobody freed, and for each open descriptor */
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <link.h>
#include <netdb.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/timerfd.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(&(name)))dlsym(RTLD_NEXT, #name))
#define CALLER     __builtin_return_address(0)

enum kind { NOTHING, MEMORY, IO, DATABASE, CODEC, SHORT };

/* glibc's own, which need no dlsym: that allocates. */
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void __libc_free(void *at);

static enum kind kind;
static unsigned long fail_at, calls;
static int fail_errno = EIO;
static struct text {
	const char *begin, *end;
	ptrdiff_t offset; /* of begin in the file */
} program, database;      /* the code of the program, and that of SQLite */
static const char *const codec_names[] = { "libjpeg",  "libpng", "libzstd.",
					   "libwebp.", "libz.",  "libopusfile" };
enum { CODECS = sizeof(codec_names) / sizeof(codec_names[0]) };
static struct text codecs[CODECS]; /* of each, where the program has it */
static const char *once_path, *left_path;
static bool was_open[256]; /* descriptors, when the process began */
static bool is_other;      /* not the process of FAIL_PROGRAM */

static bool is_in(const struct text *text, const char *at)
{
	return at >= text->begin && at < text->end;
}

static bool is_in_codec(const char *at)
{
	for (int i = 0; i < CODECS; i++)
		if (is_in(&codecs[i], at))
			return true;
	return false;
}

static struct text *text_of(const char *name)
{
	if (!program.begin)
		return &program; /* the first */
	if (strstr(name, "libsqlite3"))
		return &database;
	for (int i = 0; i < CODECS; i++)
		if (strstr(name, codec_names[i]))
			return &codecs[i];
	return NULL;
}

static int find_text(struct dl_phdr_info *info, size_t size, void *data)
{
	struct text *text = text_of(info->dlpi_name);

	(void)size;
	(void)data;
	for (int i = 0; text && i < info->dlpi_phnum; i++) {
		const ElfW(Phdr) *part = &info->dlpi_phdr[i];

		if (part->p_type != PT_LOAD || !(part->p_flags & PF_X))
			continue;
		text->begin = (const char *)(info->dlpi_addr + part->p_vaddr);
		text->end = text->begin + part->p_memsz;
		text->offset = (ptrdiff_t)part->p_vaddr;
	}
	return 0;
}

/* Adds a line to the file of FAIL_ONCE. */
static void note(int flags, const char *line)
{
	int fd = once_path ? REAL(open)(once_path, O_WRONLY | O_APPEND | O_CLOEXEC | flags, 0644)
			   : -1;

	if (fd < 0)
		return;
	if (REAL(write)(fd, line, strlen(line)) < 0)
		abort();
	close(fd);
}

static void on_crash(int signal)
{
	char line[48] = "crashed by signal 00\n";

	line[18] = (char)('0' + signal / 10);
	line[19] = (char)('0' + signal % 10);
	note(O_CREAT, line);
	raise(signal); /* with its default action, see SA_RESETHAND */
}

static void tell_crashes(void)
{
	const struct sigaction action = { .sa_handler = on_crash,
					  .sa_flags = SA_RESETHAND | SA_NODEFER };

	sigaction(SIGSEGV, &action, NULL);
	sigaction(SIGBUS, &action, NULL);
	sigaction(SIGABRT, &action, NULL);
	sigaction(SIGFPE, &action, NULL);
	sigaction(SIGILL, &action, NULL);
}

__attribute__((constructor)) static void begin(void)
{
	const char *what = getenv("FAIL_KIND"), *at = getenv("FAIL_AT"),
		   *code = getenv("FAIL_ERRNO"), *only = getenv("FAIL_PROGRAM");

	dl_iterate_phdr(find_text, NULL);
	if (only && strcmp(only, program_invocation_short_name) != 0) {
		is_other = true;
		return;
	}
	once_path = getenv("FAIL_ONCE");
	left_path = getenv("FAIL_LEFT");
	for (int fd = 0; fd < 256; fd++)
		was_open[fd] = REAL(fcntl)(fd, F_GETFD) >= 0;
	if (once_path)
		tell_crashes();
	fail_at = at ? strtoul(at, NULL, 10) : 0;
	fail_errno = code ? (int)strtol(code, NULL, 10) : EIO;
	if (what)
		kind = !strcmp(what, "memory")     ? MEMORY
		       : !strcmp(what, "io")       ? IO
		       : !strcmp(what, "database") ? DATABASE
		       : !strcmp(what, "codec")    ? CODEC
		       : !strcmp(what, "short")    ? SHORT
						   : NOTHING;
}

__attribute__((destructor)) static void end(void)
{
	const char *path = is_other ? NULL : getenv("FAIL_COUNT");
	char line[32];
	int fd = path ? REAL(open)(path, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0644) : -1;

	kind = NOTHING;
	if (fd < 0)
		return;
	if (REAL(write)(fd, line, (size_t)snprintf(line, sizeof(line), "%lu\n", calls)) < 0)
		abort();
	close(fd);
}

/* Creates the file of FAIL_ONCE with what fails and the places in the program that led to it.
 * Returns false if it exists. */
static bool is_first(const char *name)
{
	char line[256];
	void *frames[16];
	size_t size;
	int count;

	if (!once_path)
		return true;
	if (REAL(access)(once_path, F_OK) == 0)
		return false;
	count = backtrace(frames, 16);
	size = (size_t)snprintf(line, sizeof(line), "%s at", name);
	for (int i = 0; i < count && size < sizeof(line) - 24; i++) {
		const char *from = frames[i];

		if (is_in(&program, from))
			size += (size_t)snprintf(line + size, sizeof(line) - size, " %#tx",
						 from - program.begin + program.offset);
	}
	snprintf(line + size, sizeof(line) - size, "\n");
	note(O_CREAT, line);
	return true;
}

/* Counts a call of the program; returns whether it is the one to fail. */
static bool fails(enum kind of, const void *caller, const char *name)
{
	const char *from = caller;

	if (kind == DATABASE ? of != IO || !is_in(&database, from)
	    : kind == CODEC  ? of != MEMORY || !is_in_codec(from)
			     : of != kind || !is_in(&program, from))
		return false;
	return __atomic_add_fetch(&calls, 1, __ATOMIC_RELAXED) == fail_at && is_first(name);
}

/* ---- blocks that the program has not freed */

enum { BLOCKS_MAX = 1 << 20, CHAINS = 1 << 16 };

static struct block {
	void *at;
	const char *from;
	struct block *next;
} blocks[BLOCKS_MAX], *chains[CHAINS], *unused;
static size_t blocks_used;
static pthread_mutex_t blocks_lock = PTHREAD_MUTEX_INITIALIZER;

static struct block **chain_of(const void *at)
{
	return &chains[((uintptr_t)at >> 4) * 2654435761u % CHAINS];
}

/* Returns at. What other code than the program's allocates is not kept. */
static void *keep_block(void *at, const char *from)
{
	struct block *block;

	if (!left_path || !at || !is_in(&program, from))
		return at;
	pthread_mutex_lock(&blocks_lock);
	block = unused ? unused : blocks_used < BLOCKS_MAX ? &blocks[blocks_used++] : NULL;
	if (block) {
		struct block **chain = chain_of(at);

		unused = block == unused ? block->next : unused;
		*block = (struct block){ at, from, *chain };
		*chain = block;
	}
	pthread_mutex_unlock(&blocks_lock);
	return at;
}

/* Returns where the block was allocated, NULL if not in the program. */
static const char *drop_block(const void *at)
{
	const char *from = NULL;

	if (!left_path || !at)
		return NULL;
	pthread_mutex_lock(&blocks_lock);
	for (struct block **link = chain_of(at); *link; link = &(*link)->next) {
		struct block *block = *link;

		if (block->at != at)
			continue;
		from = block->from;
		*link = block->next;
		block->next = unused;
		unused = block;
		break;
	}
	pthread_mutex_unlock(&blocks_lock);
	return from;
}

/* Those of the first 256 that were not open when the process began. */
static void tell_descriptors(int out)
{
	for (int fd = 0; fd < 256; fd++) {
		char link[32], path[256];
		ssize_t size;

		snprintf(link, sizeof(link), "/proc/self/fd/%d", fd);
		size = fd == out || was_open[fd] ? -1 : REAL(readlink)(link, path, sizeof(path));
		if (size > 0)
			dprintf(out, "descriptor %d of %.*s\n", fd, (int)size, path);
	}
}

__attribute__((destructor)) static void tell_left(void)
{
	int out = left_path ? REAL(open)(left_path, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0644)
			    : -1;

	kind = NOTHING;
	if (out < 0)
		return;
	pthread_mutex_lock(&blocks_lock);
	for (size_t i = 0; i < CHAINS; i++)
		for (const struct block *block = chains[i]; block; block = block->next) {
			char line[48]; /* dprintf frees, which would wait for the lock */

			snprintf(line, sizeof(line), "block from %#tx\n",
				 block->from - program.begin + program.offset);
			if (REAL(write)(out, line, strlen(line)) < 0)
				abort();
		}
	pthread_mutex_unlock(&blocks_lock);
	tell_descriptors(out);
	close(out);
}

/* ---- memory */

void *malloc(size_t size)
{
	if (!fails(MEMORY, CALLER, __func__))
		return keep_block(__libc_malloc(size), CALLER);
	errno = ENOMEM;
	return NULL;
}

void *calloc(size_t count, size_t size)
{
	if (!fails(MEMORY, CALLER, __func__))
		return keep_block(__libc_calloc(count, size), CALLER);
	errno = ENOMEM;
	return NULL;
}

void *realloc(void *old, size_t size)
{
	const char *from;
	void *at;

	if (fails(MEMORY, CALLER, __func__)) {
		errno = ENOMEM;
		return NULL;
	}
	from = drop_block(old);
	at = __libc_realloc(old, size);
	if (!at && size > 0)
		keep_block(old, from);
	return keep_block(at, from ? from : CALLER);
}

void free(void *at)
{
	drop_block(at);
	__libc_free(at);
}

char *strdup(const char *text)
{
	const size_t size = strlen(text) + 1;
	char *copy;

	if (fails(MEMORY, CALLER, __func__)) {
		errno = ENOMEM;
		return NULL;
	}
	copy = keep_block(__libc_malloc(size), CALLER);
	return copy ? memcpy(copy, text, size) : NULL;
}

char *strndup(const char *text, size_t most)
{
	const size_t size = strnlen(text, most);
	char *copy;

	if (fails(MEMORY, CALLER, __func__)) {
		errno = ENOMEM;
		return NULL;
	}
	copy = keep_block(__libc_malloc(size + 1), CALLER);
	if (!copy)
		return NULL;
	copy[size] = '\0';
	return memcpy(copy, text, size);
}

/* ---- files and sockets */

#define FAIL_IO(result)                                                                            \
	do {                                                                                       \
		if (fails(IO, CALLER, __func__)) {                                                 \
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

int open64(const char *path, int flags, ...)
{
	va_list list;
	mode_t mode;

	va_start(list, flags);
	mode = mode_of(flags, list);
	va_end(list);
	FAIL_IO(-1);
	return REAL(open64)(path, flags, mode);
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
	return size > 1 && fails(SHORT, caller, "a short one") ? size / 2 : size;
}

int fcntl(int fd, int command, ...)
{
	va_list list;
	void *argument;

	va_start(list, command);
	argument = va_arg(list, void *);
	va_end(list);
	FAIL_IO(-1);
	return REAL(fcntl)(fd, command, argument);
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

ssize_t send(int fd, const void *data, size_t size, int flags)
{
	FAIL_IO(-1);
	return REAL(send)(fd, data, part_of(size, CALLER), flags);
}

ssize_t recv(int fd, void *out, size_t size, int flags)
{
	FAIL_IO(-1);
	return REAL(recv)(fd, out, part_of(size, CALLER), flags);
}

/* A call that gives `failed` when it fails, and otherwise what the library gives. */
#define CALL(result, failed, name, parameters, arguments)                                          \
	result name parameters                                                                     \
	{                                                                                          \
		FAIL_IO(failed);                                                                   \
		return REAL(name) arguments;                                                       \
	}

CALL(int, -1, fsync, (int fd), (fd))
CALL(int, -1, fdatasync, (int fd), (fd))
CALL(int, -1, ftruncate, (int fd, off_t size), (fd, size))
CALL(int, -1, rename, (const char *from, const char *to), (from, to))
CALL(int, -1, unlink, (const char *path), (path))
CALL(int, -1, mkdir, (const char *path, mode_t mode), (path, mode))
CALL(int, -1, access, (const char *path, int mode), (path, mode))
CALL(int, -1, stat, (const char *path, struct stat *out), (path, out))
CALL(int, -1, lstat, (const char *path, struct stat *out), (path, out))
CALL(int, -1, fstat, (int fd, struct stat *out), (fd, out))
CALL(int, -1, statvfs, (const char *path, struct statvfs *out), (path, out))
CALL(int, -1, chmod, (const char *path, mode_t mode), (path, mode))
CALL(int, -1, fchmod, (int fd, mode_t mode), (fd, mode))
CALL(ssize_t, -1, readlink, (const char *path, char *out, size_t size), (path, out, size))
CALL(int, -1, mkostemp, (char *path, int flags), (path, flags))
/* as SQLite calls them */
CALL(ssize_t, -1, pread64, (int fd, void *out, size_t size, off64_t at), (fd, out, size, at))
CALL(ssize_t, -1, pwrite64, (int fd, const void *data, size_t size, off64_t at),
     (fd, data, size, at))
CALL(int, -1, ftruncate64, (int fd, off64_t size), (fd, size))
CALL(int, -1, stat64, (const char *path, struct stat64 *out), (path, out))
CALL(int, -1, lstat64, (const char *path, struct stat64 *out), (path, out))
CALL(int, -1, fstat64, (int fd, struct stat64 *out), (fd, out))
CALL(void *, MAP_FAILED, mmap64,
     (void *at, size_t size, int protection, int flags, int fd, off64_t offset),
     (at, size, protection, flags, fd, offset))
CALL(DIR *, NULL, opendir, (const char *path), (path))
CALL(FILE *, NULL, fopen, (const char *path, const char *mode), (path, mode))
CALL(size_t, 0, fwrite, (const void *data, size_t size, size_t count, FILE *file),
     (data, size, count, file))
CALL(int, EOF, fflush, (FILE * file), (file))
CALL(void *, MAP_FAILED, mmap,
     (void *at, size_t size, int protection, int flags, int fd, off_t offset),
     (at, size, protection, flags, fd, offset))
CALL(int, -1, memfd_create, (const char *name, unsigned flags), (name, flags))
CALL(int, -1, socket, (int family, int type, int protocol), (family, type, protocol))
CALL(int, -1, socketpair, (int family, int type, int protocol, int pair[2]),
     (family, type, protocol, pair))
CALL(int, -1, bind, (int fd, const struct sockaddr *address, socklen_t size), (fd, address, size))
CALL(int, -1, connect, (int fd, const struct sockaddr *address, socklen_t size),
     (fd, address, size))
CALL(int, -1, listen, (int fd, int count), (fd, count))
CALL(int, -1, accept4, (int fd, struct sockaddr *address, socklen_t *size, int flags),
     (fd, address, size, flags))
CALL(int, -1, setsockopt, (int fd, int level, int name, const void *value, socklen_t size),
     (fd, level, name, value, size))
CALL(int, EAI_SYSTEM, getaddrinfo,
     (const char *host, const char *port, const struct addrinfo *wish, struct addrinfo **out),
     (host, port, wish, out))
CALL(ssize_t, -1, sendmsg, (int fd, const struct msghdr *message, int flags), (fd, message, flags))
CALL(ssize_t, -1, recvmsg, (int fd, struct msghdr *message, int flags), (fd, message, flags))
CALL(int, -1, poll, (struct pollfd * fds, nfds_t count, int timeout_ms), (fds, count, timeout_ms))
CALL(int, -1, epoll_create1, (int flags), (flags))
CALL(int, -1, epoll_ctl, (int epoll_fd, int how, int fd, struct epoll_event *event),
     (epoll_fd, how, fd, event))
CALL(int, -1, epoll_wait, (int fd, struct epoll_event *events, int count, int timeout_ms),
     (fd, events, count, timeout_ms))
CALL(int, -1, eventfd, (unsigned value, int flags), (value, flags))
CALL(int, -1, signalfd, (int fd, const sigset_t *signals, int flags), (fd, signals, flags))
CALL(int, -1, timerfd_create, (int clock, int flags), (clock, flags))
CALL(int, -1, inotify_init1, (int flags), (flags))
CALL(int, -1, inotify_add_watch, (int fd, const char *path, uint32_t events), (fd, path, events))
CALL(int, -1, pidfd_open, (pid_t pid, unsigned flags), (pid, flags))
CALL(pid_t, -1, fork, (void), ())
CALL(pid_t, -1, waitpid, (pid_t pid, int *status, int options), (pid, status, options))
CALL(int, -1, pipe2, (int ends[2], int flags), (ends, flags))
CALL(int, fail_errno, posix_spawn,
     (pid_t * pid, const char *path, const posix_spawn_file_actions_t *actions,
      const posix_spawnattr_t *attributes, char *const *arguments, char *const *environment),
     (pid, path, actions, attributes, arguments, environment))
CALL(int, fail_errno, pthread_create,
     (pthread_t * thread, const pthread_attr_t *attributes, void *(*run)(void *), void *data),
     (thread, attributes, run, data))
