/* Opens the files that a scan names, safely. Private to pipeline/import/import*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_FILES_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_FILES_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"
#include "base/diagnostics.h"

enum { IMPORT_FILES_COUNTED_MAX = 1024 };

/* Returns whether a name ends with the extension (".ply") after at least one other character, in
 * any case of letters. */
bool import_has_extension(const char *name, const char *extension);

/* Opens a file that a scan names. The name is looked up as given, if that stays below the scan's
 * folder, and else by its last component in the folder itself (exporters like to write
 * C:\Users\...); then likewise with %20 and the like decoded, because names in glTF are URIs. Where
 * a name is not there, the only one that differs in the case of letters is taken, as Windows does.
 * Only regular files; no link is followed, no hidden file or folder used, no signing key opened.
 * Returns a descriptor owned by the caller, or: -ENOENT: not found; -EXDEV: outside the folder;
 * -ELOOP: a link; -EINVAL: not a regular file; -EKEYREJECTED: a signing key; other negative errno.
 */
must_check int import_files_open_at(int folder_fd, const char *name);
/* Opens the folder of a scan for import_files_open_at. Returns a descriptor owned by the caller, or
 * a negative errno. */
must_check int import_files_open_folder(const char *scan_path);

/* The first file that a scan names and that could not be read for a reason that says nothing of the
 * scan (base/transient.h). Such a scan is refused: what is left out for a reason of its own is
 * warned of, but a release must not lose a picture because a disk was slow to answer. Zeroed: none.
 */
struct import_files_failure {
	int rc; /* 0: there is none */
	char name[128];
};

/* Notes rc if it is a transient failure and the first; other numbers and descriptors are not noted.
 */
void import_files_note(struct import_files_failure *failure, int rc, const char *name);
/* Returns rc if it is a failure; else what was noted, with an error; else rc. */
must_check int import_files_judge(const struct import_files_failure *failure, int rc,
				  const char *scan_path, struct diagnostics *diagnostics);

/* The files that a scan named and that were counted, each once however often it is named. */
struct import_files_counted {
	uint32_t count;
	struct {
		uint64_t device, number;
	} files[IMPORT_FILES_COUNTED_MAX];
};

/* Returns the size of an open file, or 0 if it was counted before or no more can be. */
uint64_t import_files_count(struct import_files_counted *counted, int fd);

struct import_files {
	const char *scan_path; /* borrowed; for messages */
	int folder_fd;         /* borrowed; not used in the sandbox */
	/* the parent opens files, and the sandbox limits the memory for pictures */
	bool in_sandbox;
	/* outside the sandbox: for all decoded pictures together; each that is opened adds
	 * picture_bytes_per_byte of its file */
	uint64_t picture_bytes_left, picture_bytes_per_byte;
	struct import_files_counted counted;
	struct import_files_failure failure; /* outside the sandbox */
};

/* Opens a file that the scan names, directly or through the sandbox's parent. Results as
 * import_files_open_at. */
must_check int import_files_open(struct import_files *files, const char *name);
/* Returns the error as a phrase about the file, such as "is not beside it". Borrowed. */
const char *import_files_why(int rc);

#endif
