/* What the sources of import share. Private to pipeline/import/import*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_PARTS_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_PARTS_H

#include "base/bytes.h"
#include "pipeline/import/import.h"

/* Readers give the mesh in the file's unit and axes, indices in range, not repaired. */
must_check int import_ply(struct mesh *out, const char *path, const struct import_options *options,
			  struct import_report *report, struct fault *fault);
/* The most memory that decoding may take. Unless the options say so, it grows with the file: a
 * small file is no scan that needs much. */
static inline uint64_t import_memory_bytes(const struct import_options *options,
					   uint64_t file_bytes)
{
	return options->memory_bytes ? options->memory_bytes : (1ull << 30) + 64 * file_bytes;
}

/* ---- files that a scan names */

/* Looked for as named where that stays below the scan's folder, else by the last component in the
 * folder itself (exporters like to write C:\Users\...). Regular files only; no link is followed, no
 * hidden file or folder taken, no signing key given out. A descriptor, or: -ENOENT; -EXDEV: it lies
 * elsewhere; -ELOOP: a link; -EINVAL: no regular file; -EKEYREJECTED: a signing key; other negative
 * errno. */
must_check int import_files_open_at(int folder_fd, const char *name);
/* The folder of a scan, for import_files_open_at. Owned by the caller. Negative errno. */
must_check int import_files_open_folder(const char *scan_path);

struct import_files {
	const char *scan_path;       /* borrowed; for messages */
	int folder_fd;               /* borrowed; not used in the sandbox */
	bool in_sandbox;             /* whose parent opens, and whose limits hold for pictures */
	uint64_t picture_bytes_left; /* outside of it: for all decoded pictures together */
};

must_check int import_files_open(const struct import_files *files, const char *name);
/* The error as what is to be said about the file: "is not beside it". Borrowed. */
const char *import_files_why(int rc);

/* ---- assimp's reader */

struct import_foreign_format {
	const char *extension; /* by which assimp is to know it: ".obj" */
	bool is_linear;        /* its colours are linear light, not sRGB */
	bool has_materials;    /* assimp makes up a grey one for the others */
};

must_check int import_foreign(struct mesh *out, const char *path,
			      struct import_foreign_format format,
			      const struct import_options *options, struct import_report *report,
			      struct fault *fault);

/* In the sandbox: the scene that assimp reads. Its parent opens all files: seen_path is the scan,
 * other names are as the scan has them. Borrowed until the process ends. NULL: fault says why. */
struct aiScene;
const struct aiScene *import_scene(const char *seen_path, const char *format_name,
				   struct fault *fault);

/* ---- pictures */

/* The picture that a scan names. One that is missing, elsewhere or damaged is tolerated: a warning,
 * and one pixel of the plain colour. -ENOMEM. */
must_check int import_texture(struct mesh_texture *out, struct import_files *files,
			      const char *name, const uint8_t plain[3],
			      struct import_report *report);
/* The same for a picture that lies in the scan itself. */
must_check int import_texture_bytes(struct mesh_texture *out, const char *scan_path,
				    const char *name, struct bytes file, const uint8_t plain[3],
				    struct import_report *report);
must_check int import_texture_plain(struct mesh_texture *out, const uint8_t plain[3]);

#endif
