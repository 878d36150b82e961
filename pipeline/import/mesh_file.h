/* A mesh as a cache file (DIR/.work/mesh): arrays as they lie in memory, so of this machine's byte
 * order and never published; a BLAKE2b of everything at the end.
 *
 *   8 bytes   "gopmesh" and the version, 2
 *   u32       0x01020304, tells the byte order
 *   16 bytes  key: what the mesh was made from
 *   u32 x 5   vertices, triangles, textures, flags (1 colours, 2 uvs, 4 materials, 8 faces), scans
 *   u32 x 2   triangles and faces of each scan
 *   u32 x 2   width and height of each texture
 *   arrays    positions, colours, uvs, triangles, materials, faces, pixels of each texture
 *   16 bytes  BLAKE2b of all before
 */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_FILE_H
#define GOPURA_PIPELINE_IMPORT_MESH_FILE_H

#include "format/hash.h"
#include "pipeline/import/mesh.h"

/* Atomically: a temporary file beside path, then a rename. Negative errno. */
must_check int mesh_file_save(const struct mesh *mesh, struct hash key, const char *path);

/* *out is owned by the caller; zeroed on failure. -ENOENT: there is none; -ESTALE: of another key;
 * -EBADMSG: damaged. In each of these cases: make it anew and save it. */
must_check int mesh_file_load(struct mesh *out, struct hash key, const char *path);

/* The same on an open descriptor, from its present offset; it stays open. */
must_check int mesh_file_write(int fd, const struct mesh *mesh, struct hash key);
must_check int mesh_file_read(struct mesh *out, struct hash key, int fd);

#endif
