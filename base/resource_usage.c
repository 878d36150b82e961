/* Asks the kernel for processor time and resident memory. */
#include "base/resource_usage.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/proc_number.h"

static int64_t processor_us(const struct rusage *usage)
{
	return ((int64_t)usage->ru_utime.tv_sec + usage->ru_stime.tv_sec) * 1000000 +
	       usage->ru_utime.tv_usec + usage->ru_stime.tv_usec;
}

/* The kernel's high-water mark, which resource_usage_reset_own resets; 0 if it does not tell. */
static uint64_t resident_peak_bytes(void)
{
	unsigned long long kib;

	return proc_number("/proc/self/status", "VmHWM: %llu", &kib) ? kib * 1024 : 0;
}

void resource_usage_now(struct resource_usage *out)
{
	struct rusage own = { 0 }, children = { 0 };

	getrusage(RUSAGE_SELF, &own);
	getrusage(RUSAGE_CHILDREN, &children);
	out->processor_us = processor_us(&own) + processor_us(&children);
	out->own_bytes = resident_peak_bytes();
	if (out->own_bytes == 0)
		out->own_bytes = (uint64_t)own.ru_maxrss * 1024;
	out->child_bytes = (uint64_t)children.ru_maxrss * 1024;
}

void resource_usage_reset_own(void)
{
	int fd = open("/proc/self/clear_refs", O_WRONLY | O_CLOEXEC);

	if (fd < 0)
		return;
	if (write(fd, "5", 1) != 1) {
		/* the mark then counts from the process's beginning */
	}
	close(fd);
}
