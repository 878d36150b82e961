/* A mesh as a cache file (DIR/.work/mesh). Arrays are stored as in memory, so in this machine's
 * byte order; such a file is never published. Large arrays of a mesh that is loaded are the file
 * itself, mapped: loading takes no memory. It ends with a hash of everything before, which all
 * cores compute.
 *
 *   8 bytes   "gopmesh" and the version, 4
 *   u32       0x01020304, shows the byte order
 *   16 bytes  key: what the mesh was made from
 *   u32 x 5   vertices, triangles, textures, flags (1 colours, 2 uvs, 4 materials, 8 faces), scans
 *   u32 x 2   triangles and faces of each scan
 *   u32 x 2   width and height of each texture
 *   arrays    positions, colours, uvs, triangles, materials, faces, pixels of each texture,
 *             each filled up with zeros to 8 bytes
 *   16 bytes  BLAKE2b of the BLAKE2b (16 bytes each) of each MiB of everything before */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_FILE_H
#define GOPURA_PIPELINE_IMPORT_MESH_FILE_H

#include "format/hash.h"
#include "pipeline/import/mesh.h"

/* Writes the file atomically: a temporary file beside path, then a rename. Returns 0 or a negative
 * errno. */
must_check int mesh_file_save(const struct mesh *mesh, struct hash key, const char *path);

/* The same, and large arrays of the mesh become the file, mapped, as after loading: that halves the
 * memory and the space on the disk. On failure the mesh is only to be finished. */
must_check int mesh_file_move(struct mesh *mesh, struct hash key, const char *path);

/* *out is owned by the caller; it is zeroed on failure. -ENOENT: there is no file. -ESTALE: it has
 * another key. -EBADMSG: it is damaged. In these cases make the mesh again and save it. */
must_check int mesh_file_load(struct mesh *out, struct hash key, const char *path);

/* Writes a mesh to an open descriptor, from its current offset. The descriptor stays open. Negative
 * errno. */
must_check int mesh_file_write(int fd, const struct mesh *mesh, struct hash key);
/* Reads a mesh from an open descriptor, from its current offset. It stays open. Its arrays are
 * copies that may be changed. Results as mesh_file_load, without -ENOENT. -ENOSPC: the disk is
 * full. */
must_check int mesh_file_read(struct mesh *out, struct hash key, int fd);

#endif
