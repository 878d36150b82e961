/* A scan in OBJ, STL, OFF or glTF, and a reader of it that was taken over: assimp itself is behind
 * a sandbox (pipeline/import/sandbox.h), whose child may crash on any file. What the parent
 * believes of such a child is ours. Here the sandbox is this file: the first byte says whether the
 * child gives back a result, the rest is what it writes into the memory that it shares with its
 * parent, and after a "gopmesh", the mesh it claims to have read (with its hash made right). The
 * files themselves are left to tests/pipeline/import/test_import.c. */
#include <errno.h>
#include <math.h>
#include <sys/mman.h>

#include "base/shared_memory.h"
#include "pipeline/import/import.h"
#include "pipeline/import/import_report.h"
#include "pipeline/import/sandbox.h"
#include "tests/fuzz/scratch.h"

int sandbox_open(const char *name);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { SHARED_BYTES_MAX = 1 << 20 };

static struct bytes story; /* of the child */
static size_t shared_bytes;
static int result_fd = -1;

/* The file for the result is found by its name: how it gets to the child is import's affair. */
int memfd_create(const char *name, unsigned flags)
{
	const char *path = scratch_path("result");
	int fd = open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);

	(void)name, (void)flags;
	result_fd = fd;
	return fd;
}

void *shared_memory_create(size_t size)
{
	if (size > SHARED_BYTES_MAX)
		abort();
	shared_bytes = size;
	return calloc(1, size);
}

void shared_memory_destroy(void *shared, size_t size)
{
	if (shared && size != shared_bytes)
		abort();
	free(shared);
}

int sandbox_open(const char *name)
{
	(void)name;
	return -EACCES;
}

uint64_t sandbox_memory_bytes(uint64_t more_bytes)
{
	return more_bytes;
}

static void give_mesh(const uint8_t *mesh, size_t size)
{
	uint8_t *sealed = scratch_sealed(mesh, size, true);

	if (sealed && write(result_fd, sealed, size) != (ssize_t)size)
		abort();
	free(sealed);
}

int sandbox_run(sandbox_work work, void *shared, const struct sandbox_options *options,
		const char *name, struct diagnostics *diagnostics)
{
	const uint8_t *mesh = story.size ? memmem(story.data, story.size, "gopmesh", 7) : NULL;
	const size_t told = mesh ? (size_t)(mesh - story.data) : story.size;
	const size_t from = 1, bytes = told > from ? told - from : 0;

	(void)work, (void)options;
	if (mesh)
		give_mesh(mesh, story.size - told);
	/* Over all of it, again and again: where what lies is import's affair. */
	for (size_t i = 0; bytes > 0 && i < shared_bytes; i++)
		((uint8_t *)shared)[i] = story.data[from + i % bytes];
	return story.size && story.data[0] == 'x'
		       ? diagnostics_add(diagnostics, -EBADMSG, name, 0, "its reader crashed on it")
		       : 0;
}

static void check(const struct mesh *mesh)
{
	if (mesh->triangle_count == 0 || !mesh->colours)
		abort();
	for (uint32_t i = 0; i < mesh->triangle_count; i++)
		for (int k = 0; k < 3; k++)
			if (mesh->triangles[i][k] >= mesh->vertex_count)
				abort();
	for (uint32_t i = 0; i < mesh->vertex_count; i++)
		for (int k = 0; k < 3; k++)
			if (!isfinite(mesh->positions[i][k]))
				abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const struct import_options options = { .metres_per_unit = 1 };
	struct diagnostics diagnostics = { 0 };
	struct import_report report;
	struct mesh mesh;
	char path[128];
	FILE *nowhere;

	if (!scratch[0]) {
		scratch_begin();
		scratch_write("scan.obj", (const uint8_t *)"# nobody reads it\n", 18);
	}
	story = (struct bytes){ data, size };
	snprintf(path, sizeof(path), "%s", scratch_path("scan.obj"));
	if (import_scan(&mesh, path, &options, &report, &diagnostics) < 0) {
		if (strncmp(diagnostics.first.text, path, strlen(path)) != 0)
			abort();
		return 0;
	}
	check(&mesh);
	nowhere = fopen("/dev/null", "w");
	if (!nowhere)
		abort();
	import_report_print(nowhere, path, &report);
	fclose(nowhere);
	mesh_finish(&mesh);
	return 0;
}
