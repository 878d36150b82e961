/* Decodes a recording in a sandboxed child, whose verdict is all that comes back. */
#include "curator/pages/sound_check.h"

#include <errno.h>

#include "base/proc_number.h"
#include "base/shared_memory.h"
#include "pipeline/content/spoken_sound.h"
#include "pipeline/import/sandbox.h"

enum { TIMEOUT_S = 30, MEMORY_MB = 256 };

struct job {
	struct bytes file; /* the child has a copy of the parent's memory */
};

static int work(void *shared, struct diagnostics *diagnostics)
{
	const struct job *job = shared;
	uint32_t duration_ms;

	(void)diagnostics;
	return spoken_sound_measure(job->file, false, &duration_ms);
}

int sound_check(struct bytes file, struct diagnostics *diagnostics)
{
	struct sandbox_options options = { .timeout_s = TIMEOUT_S };
	struct job *job = shared_memory_create(sizeof(*job));
	struct diagnostics told = { 0 };
	unsigned long long own_kb = 0;
	int rc = -ENOMEM;

	if (job) {
		/* The child begins with all that this process has mapped. */
		if (!proc_number("/proc/self/status", "VmSize: %llu kB", &own_kb))
			own_kb = 0;
		options.memory_bytes = ((uint64_t)own_kb << 10) + ((uint64_t)MEMORY_MB << 20);
		job->file = file;
		rc = sandbox_run(work, job, &options, "recording", &told);
		shared_memory_destroy(job, sizeof(*job));
	}
	diagnostics_finish(&told);
	if (rc == -EFBIG)
		diagnostics_add(diagnostics, rc, NULL, 0,
				"the recording is longer than ten minutes: divide the text");
	else if (rc < 0)
		diagnostics_add(diagnostics, rc, NULL, 0,
				"this is not a complete Ogg Opus file with one or two channels: "
				"encode it with 'opusenc --bitrate 24'");
	return rc;
}
