/* Which documents a content folder has, and whether a file is still the one that was seen before.
 */
#ifndef GOPURA_CURATOR_STORE_FOLDER_FILES_H
#define GOPURA_CURATOR_STORE_FOLDER_FILES_H

#include "curator/store/documents.h"

/* What changes when a file is written or replaced. Zeroed: of no file. */
struct file_mark {
	uint64_t inode, size_bytes;
	int64_t changed_ns;
};

struct folder_file {
	char name[DOCUMENT_NAME_BYTES];
	char id[HISTORY_ID_BYTES]; /* of its bytes; "": not known */
	struct file_mark mark;
};

/* Zeroed: none. */
struct folder_files {
	struct folder_file *list; /* owned; by name */
	uint32_t count, room;
};

void folder_files_finish(struct folder_files *files); /* NULL and zeroed are fine */

/* Lists the regular files of a folder that are documents, without ids. -ENOMEM, or an error of
 * reading a folder; a folder that is missing has none. *out is for folder_files_finish. */
must_check int folder_files_scan(struct folder_files *out, const char *folder);
/* Returns a file, borrowed until the list changes, or NULL. */
struct folder_file *folder_files_find(const struct folder_files *files, const char *name);
/* Adds a file, or replaces the one of that name. -ENOMEM. */
must_check int folder_files_set(struct folder_files *files, const struct folder_file *file);
void folder_files_remove(struct folder_files *files, const char *name);
/* Returns whether the mark is that of a regular file which is there. */
bool file_mark_read(struct file_mark *out, const char *path);
bool file_mark_equals(const struct file_mark *a, const struct file_mark *b);

#endif
