#include "pipeline/import/ply.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static uint64_t vertex_count;

static int see_vertex(void *data, uint32_t index, const struct ply_vertex *vertex)
{
	if (index >= vertex_count)
		abort();
	*(uint64_t *)data += vertex->colour[0];
	return 0;
}

/* The reader's promise: corners are in range. */
static int see_triangle(void *data, uint64_t index, const struct ply_triangle *triangle)
{
	(void)index;
	for (int k = 0; k < 3; k++)
		if (triangle->corner[k] >= vertex_count)
			abort();
	*(uint64_t *)data += triangle->corner[0];
	return 0;
}

static int see_cell(void *data, uint64_t index, int64_t vertex)
{
	if (vertex < -1 || vertex >= (int64_t)vertex_count)
		abort();
	*(uint64_t *)data += index;
	return 0;
}

/* Errors name the file; success leaves no fault behind. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	uint64_t sum = 0;
	const struct ply_visitor visitor = {
		.data = &sum, .vertex = see_vertex, .triangle = see_triangle, .cell = see_cell
	};
	struct diagnostics diagnostics = { 0 };
	int fd = memfd_create("ply", MFD_CLOEXEC);
	struct ply *ply;
	int rc;

	if (fd < 0 || write(fd, data, size) != (ssize_t)size || lseek(fd, 0, SEEK_SET) != 0)
		abort();
	rc = ply_open_fd(&ply, fd, "fuzz.ply", &diagnostics);
	if (rc == 0) {
		vertex_count = ply_summary(ply)->vertex_count;
		rc = ply_read(ply, &visitor, &diagnostics);
		ply_close(ply);
	}
	if ((rc < 0) != (strncmp(diagnostics.first.text, "fuzz.ply", 8) == 0))
		abort();
	return 0;
}
