/* Shared by the sources of the import. Private to pipeline/import/import*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_PARTS_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_PARTS_H

#include "base/bytes.h"
#include "pipeline/import/import.h"

/* Reads a PLY. Like every reader, it gives the mesh in the file's unit and axes, with valid
 * indices, not repaired. It applies the transform, because places may have more digits in the file
 * than in a mesh. Errors as import_scan. */
must_check int import_ply(struct mesh *out, const char *path, const struct import_options *options,
			  struct import_report *report, struct diagnostics *diagnostics);
/* Reads only the header of a PLY, and refuses one that has no surface. Errors as import_scan. */
must_check int import_ply_check(const char *path, struct diagnostics *diagnostics);
/* Returns how much memory decoding may use. Unless the options set it, it grows with the file,
 * because a small file should not need much. */
static inline uint64_t import_memory_bytes(const struct import_options *options,
					   uint64_t file_bytes)
{
	return options->memory_bytes ? options->memory_bytes : (1ull << 30) + 64 * file_bytes;
}

/* ---- files that a scan names */

/* Opens a file that a scan names. The name is looked up as given, if that stays below the scan's
 * folder, and else by its last component in the folder itself (exporters like to write
 * C:\Users\...). Only regular files; no link is followed, no hidden file or folder used, no signing
 * key opened. Returns a descriptor owned by the caller, or: -ENOENT: not found; -EXDEV: outside the
 * folder; -ELOOP: a link; -EINVAL: not a regular file; -EKEYREJECTED: a signing key; other negative
 * errno. */
must_check int import_files_open_at(int folder_fd, const char *name);
/* Opens the folder of a scan for import_files_open_at. Returns a descriptor owned by the caller, or
 * a negative errno. */
must_check int import_files_open_folder(const char *scan_path);

struct import_files {
	const char *scan_path; /* borrowed; for messages */
	int folder_fd;         /* borrowed; not used in the sandbox */
	/* the parent opens files, and the sandbox limits the memory for pictures */
	bool in_sandbox;
	uint64_t picture_bytes_left; /* outside the sandbox: for all decoded pictures together */
};

/* Opens a file that the scan names, directly or through the sandbox's parent. Results as
 * import_files_open_at. */
must_check int import_files_open(const struct import_files *files, const char *name);
/* Returns the error as a phrase about the file, such as "is not beside it". Borrowed. */
const char *import_files_why(int rc);

/* ---- assimp's reader */

struct import_foreign_format {
	const char *extension; /* the extension by which assimp recognises it, such as ".obj" */
	bool is_linear;        /* colours are linear light, not sRGB */
	bool has_materials;    /* false: ignore the grey material that assimp adds */
};

/* Reads a scan with assimp in a sandbox, with the same result as import_ply but for the transform,
 * which is not applied. Also -ETIMEDOUT,
 * -ENOMEM, -EBADMSG as sandbox_run. */
must_check int import_foreign(struct mesh *out, const char *path,
			      struct import_foreign_format format,
			      const struct import_options *options, struct import_report *report,
			      struct diagnostics *diagnostics);

struct aiScene;
/* Runs assimp in the sandbox. The parent opens all files: seen_path stands for the scan, other
 * names are as the scan gives them. The scene is borrowed until the process ends. NULL: diagnostics
 * says why. warning names a file that the scan names and that is missing. */
const struct aiScene *import_scene(const char *seen_path, const char *format_name,
				   struct diagnostics *warning, struct diagnostics *diagnostics);

/* ---- pictures */

/* Decodes a picture that the scan names. A missing, outside or damaged picture is tolerated: a
 * warning, and one pixel of the plain colour. *out is owned by the caller. -ENOMEM. */
must_check int import_texture(struct mesh_texture *out, struct import_files *files,
			      const char *name, const uint8_t plain[3],
			      struct import_report *report);
/* The same for a picture embedded in the scan. */
must_check int import_texture_bytes(struct mesh_texture *out, const char *scan_path,
				    const char *name, struct bytes file, const uint8_t plain[3],
				    struct import_report *report);
/* Makes a texture of one pixel of the plain colour; owned by the caller. -ENOMEM. */
must_check int import_texture_plain(struct mesh_texture *out, const uint8_t plain[3]);

#endif
