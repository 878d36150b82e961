/* A mesh file of a content folder's .work, as it is and with the right hash at its end: what is
 * taken up is written and read again. */
#include <sys/mman.h>

#include "pipeline/import/mesh_file.h"
#include "tests/fuzz/scratch.h"

enum { KEY_AT = 12 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int file_of(const uint8_t *data, size_t size)
{
	int fd = memfd_create("mesh", MFD_CLOEXEC);

	if (fd < 0 || write(fd, data, size) != (ssize_t)size || lseek(fd, 0, SEEK_SET) != 0)
		abort();
	return fd;
}

static void read_it(const uint8_t *data, size_t size)
{
	struct hash key = { { 0 } };
	struct mesh mesh, again;
	int fd = file_of(data, size), copy;

	if (size >= KEY_AT + HASH_BYTES)
		memcpy(key.bytes, data + KEY_AT, HASH_BYTES);
	if (mesh_file_read(&mesh, key, fd) == 0) {
		copy = file_of(NULL, 0);
		if (mesh_file_write(copy, &mesh, key) < 0 || lseek(copy, 0, SEEK_SET) != 0 ||
		    mesh_file_read(&again, key, copy) < 0 ||
		    again.triangle_count != mesh.triangle_count)
			abort();
		mesh_finish(&again);
		close(copy);
	}
	mesh_finish(&mesh);
	close(fd);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	uint8_t *sealed = scratch_sealed(data, size, true);

	read_it(data, size);
	if (sealed)
		read_it(sealed, size);
	free(sealed);
	return 0;
}
