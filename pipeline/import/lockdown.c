/* Builds an empty Landlock ruleset, and a seccomp filter with a short list of allowed system
 * calls. */
#include "pipeline/import/lockdown.h"

#include <errno.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Landlock and seccomp require this: no program that is started can gain more rights than this
 * process has. */
static int give_up_privileges(void)
{
	return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) < 0 ? -EOPNOTSUPP : 0;
}

/* ---- Landlock */

/* Returns the file access rights that this version of Landlock knows; it refuses unknown ones. */
static uint64_t rights_of_version(int version)
{
	/* Version 1: execute, write, read, list, remove and create every kind of file. */
	uint64_t rights = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1) - 1;

	if (version >= 2)
		rights |= 1ull << 13; /* link or rename into another folder */
	if (version >= 3)
		rights |= 1ull << 14; /* truncate */
	if (version >= 5)
		rights |= 1ull << 15; /* ioctl on a device */
	return rights;
}

int lockdown_files(void)
{
	struct landlock_ruleset_attr rules = { 0 };
	long version =
		syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
	int rc = version < 1 ? -EOPNOTSUPP : give_up_privileges();
	int fd;

	if (rc < 0)
		return rc;
	/* No rule allows anything, so every right named here is denied. */
	rules.handled_access_fs = rights_of_version((int)version);
	fd = (int)syscall(SYS_landlock_create_ruleset, &rules, sizeof(rules), 0);
	if (fd < 0)
		return -errno;
	if (syscall(SYS_landlock_restrict_self, fd, 0) < 0)
		rc = -errno;
	close(fd);
	return rc;
}

/* ---- seccomp */

#if defined(__x86_64__)
#define OUR_ARCHITECTURE AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define OUR_ARCHITECTURE AUDIT_ARCH_AARCH64
#endif

#ifdef OUR_ARCHITECTURE

enum { X32_CALLS = 0x40000000, STEPS_MAX = 256 };

/* The calls that a parser and the sanitizers need. None takes a file name; recvmsg receives files
 * that the parent opened (pipeline/import/sandbox.h). */
static const uint32_t allowed_calls[] = {
	SYS_read,          SYS_readv,        SYS_pread64,         SYS_write,        SYS_writev,
	SYS_pwrite64,      SYS_lseek,        SYS_close,           SYS_recvmsg,      SYS_brk,
	SYS_munmap,        SYS_mremap,       SYS_madvise,         SYS_futex,        SYS_sched_yield,
	SYS_clock_gettime, SYS_gettimeofday, SYS_clock_nanosleep, SYS_getpid,       SYS_gettid,
	SYS_getrandom,     SYS_rt_sigaction, SYS_rt_sigprocmask,  SYS_rt_sigreturn, SYS_sigaltstack,
	SYS_exit,          SYS_exit_group,
};

struct program {
	struct sock_filter code[STEPS_MAX];
	unsigned short count;
};

static void put(struct program *program, struct sock_filter step)
{
	if (program->count < STEPS_MAX)
		program->code[program->count++] = step;
}

static void load(struct program *program, size_t offset)
{
	put(program, (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, (uint32_t)offset));
}

static void answer(struct program *program, uint32_t verdict)
{
	put(program, (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, verdict));
}

/* Offset of the low half of an argument. The arguments checked here use only that half. */
static size_t argument_at(int index)
{
	const size_t low = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? 4 : 0;

	return offsetof(struct seccomp_data, args) + (size_t)index * 8 + low;
}

/* Allows mapping memory, but not executable memory. */
static void allow_unless_executable(struct program *program, uint32_t call)
{
	put(program, (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 4));
	load(program, argument_at(2));
	put(program, (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, PROT_EXEC, 0, 1));
	answer(program, SECCOMP_RET_ERRNO | EPERM);
	answer(program, SECCOMP_RET_ALLOW);
}

/* Allows signals to the own process only: abort() and the sanitizers need that. */
static void allow_signals_to_itself(struct program *program)
{
	put(program, (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_tgkill, 0, 4));
	load(program, argument_at(0));
	put(program,
	    (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)getpid(), 0, 1));
	answer(program, SECCOMP_RET_ALLOW);
	answer(program, SECCOMP_RET_ERRNO | EPERM);
}

static void write_program(struct program *program)
{
	load(program, offsetof(struct seccomp_data, arch));
	put(program,
	    (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, OUR_ARCHITECTURE, 1, 0));
	answer(program, SECCOMP_RET_KILL_PROCESS);
	load(program, offsetof(struct seccomp_data, nr));
	/* On x86 the same calls exist under other numbers (x32). */
	put(program, (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, X32_CALLS, 0, 1));
	answer(program, SECCOMP_RET_KILL_PROCESS);
	for (size_t i = 0; i < ARRAY_COUNT(allowed_calls); i++) {
		put(program, (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K,
							  allowed_calls[i], 0, 1));
		answer(program, SECCOMP_RET_ALLOW);
	}
	allow_unless_executable(program, SYS_mmap);
	allow_unless_executable(program, SYS_mprotect);
	allow_signals_to_itself(program);
	answer(program, SECCOMP_RET_ERRNO | EPERM);
}

int lockdown_calls(void)
{
	struct program program = { .count = 0 };
	struct sock_fprog filter = { .filter = program.code };
	int rc = give_up_privileges();

	if (rc < 0)
		return rc;
	write_program(&program);
	filter.len = program.count;
	if (syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &filter) < 0)
		return errno == ENOSYS || errno == EINVAL ? -EOPNOTSUPP : -errno;
	return 0;
}

#else

int lockdown_calls(void)
{
	return -EOPNOTSUPP;
}

#endif
