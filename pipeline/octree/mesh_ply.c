/* Writes binary PLY files. */
#include "pipeline/octree/mesh_ply.h"

#include "base/chunk_file.h"
#include "base/spill.h"

static void put_vertices(struct chunk_file *file, const struct mesh *mesh)
{
	for (uint32_t i = 0; i < mesh->vertex_count && chunk_file_pass(file); i++) {
		for (int k = 0; k < 3; k++)
			buffer_put_f32(&file->chunk, mesh->positions[i][k]);
		if (mesh->colours)
			buffer_put(&file->chunk, mesh->colours[i], 3);
		spill_pass(i);
	}
}

static void put_triangles(struct chunk_file *file, const struct mesh *mesh)
{
	for (uint32_t i = 0; i < mesh->triangle_count && chunk_file_pass(file); i++) {
		buffer_put_u8(&file->chunk, 3);
		for (int k = 0; k < 3; k++)
			buffer_put_u32(&file->chunk, mesh->triangles[i][k]);
		spill_pass(i);
	}
}

int mesh_ply_write(const struct mesh *mesh, const char *path)
{
	struct chunk_file file;

	chunk_file_begin(&file, path);
	buffer_print(&file.chunk,
		     "ply\nformat binary_little_endian 1.0\nelement vertex %u\n"
		     "property float x\nproperty float y\nproperty float z\n%s"
		     "element face %u\nproperty list uchar uint vertex_indices\nend_header\n",
		     mesh->vertex_count,
		     mesh->colours ? "property uchar red\nproperty uchar green\n"
				     "property uchar blue\n"
				   : "",
		     mesh->triangle_count);
	put_vertices(&file, mesh);
	put_triangles(&file, mesh);
	return chunk_file_end(&file);
}
