/* Writes a model as GLB, the binary form of glTF 2.0, with nothing that a reader must know beyond
 * its core, and of that nothing that readers get wrong (assimp reads texture coordinates of 16 bits
 * as if they were floats): floats but for colours and indices, JPEG pictures. */
#ifndef GOPURA_PIPELINE_TEXMESH_GLB_H
#define GOPURA_PIPELINE_TEXMESH_GLB_H

#include "base/bytes.h"
#include "pipeline/texmesh/reduced_mesh.h"

struct glb_material {
	struct bytes jpeg; /* empty: one colour; borrowed */
	uint8_t rgb[3];    /* that colour, sRGB */
};

struct glb_options {
	const struct glb_material *materials; /* mesh->material_count of them, borrowed */
	/* Whether a viewer lights it: with normals, as rough stone. Otherwise the colours are shown
	 * as they are, where the viewer knows KHR_materials_unlit. */
	bool lit;
};

/* Returns the bytes of the geometry, without the description (about a kilobyte) and pictures. */
uint64_t glb_mesh_bytes(const struct reduced_mesh *mesh, bool lit);
/* Appends the file; y is up, as glTF demands. -ENOMEM, -EFBIG beyond the buffer's ceiling or 4 GB.
 */
must_check int glb_write(struct buffer *out, const struct reduced_mesh *mesh,
			 const struct glb_options *options);

#endif
