/* Keeps the files of a content folder and their history equal. A change is staged in the history,
 * its files are written, and it is accepted; what a killed program left staged is finished when the
 * folder is opened. */
#include "curator/store/documents.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/array.h"
#include "base/log.h"
#include "curator/store/documents_private.h"

static void path_of(const struct documents *documents, const char *name, char path[PATH_BYTES])
{
	snprintf(path, PATH_BYTES, "%s/%s", documents->folder, name);
}

int documents_report(struct diagnostics *diagnostics, int rc, const char *name)
{
	return rc < 0 ? diagnostics_add(diagnostics, rc, name, 0, "%s",
					rc == -EBADMSG ? "its history is damaged" : strerror(-rc))
		      : 0;
}

void documents_lock(struct documents *documents)
{
	pthread_mutex_lock(&documents->mutex);
}

void documents_unlock(struct documents *documents)
{
	pthread_mutex_unlock(&documents->mutex);
}

/* ---- files */

static int read_file(const struct documents *documents, const char *name, struct buffer *out)
{
	char path[PATH_BYTES];

	path_of(documents, name, path);
	return buffer_read_file(out, path);
}

/* Makes the folder that a document is in. */
static int make_room(const struct documents *documents, const char *name)
{
	const char *slash = strchr(name, '/');
	char path[PATH_BYTES];

	if (!slash)
		return 0;
	snprintf(path, sizeof(path), "%s/%.*s", documents->folder, (int)(slash - name), name);
	if (mkdir(path, 0755) == 0)
		return bytes_sync_folder_of(path);
	return errno == EEXIST ? 0 : -errno;
}

/* id "": the file is removed. */
static int write_file(struct documents *documents, const char *name, const char *id)
{
	char path[PATH_BYTES];
	struct buffer text;
	int rc;

	path_of(documents, name, path);
	if (!id[0]) {
		if (unlink(path) < 0 && errno != ENOENT)
			return -errno;
		return bytes_sync_folder_of(path);
	}
	buffer_init(&text, DOCUMENT_BYTES_MAX);
	rc = history_get(documents->history, id, &text);
	if (rc == 0)
		rc = make_room(documents, name);
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&text), path);
	buffer_finish(&text);
	return rc;
}

/* The list of files as they are after a change. */
static int note(struct documents *documents, const char *name, const char *id)
{
	struct folder_file file = { 0 };
	char path[PATH_BYTES];

	if (!id[0]) {
		folder_files_remove(&documents->files, name);
		return 0;
	}
	path_of(documents, name, path);
	snprintf(file.name, sizeof(file.name), "%s", name);
	snprintf(file.id, sizeof(file.id), "%s", id);
	file_mark_read(&file.mark, path); /* if it fails, the next look reads the file again */
	return folder_files_set(&documents->files, &file);
}

/* ---- what others changed */

struct changes {
	struct history_file *list; /* owned */
	uint32_t count, room;
};

static int add_change(struct changes *changes, const char *name, const char *id)
{
	int rc = ARRAY_RESERVE(changes->list, changes->room, changes->count + 1, UINT32_MAX);

	if (rc < 0)
		return rc;
	changes->list[changes->count].name = name;
	snprintf(changes->list[changes->count++].id, HISTORY_ID_BYTES, "%s", id);
	return 0;
}

/* Finds the id of a file that may have changed, and keeps its bytes if it has. */
static int look_at(struct documents *documents, struct folder_file *file, struct changes *changes)
{
	const struct folder_file *known = folder_files_find(&documents->files, file->name);
	struct buffer text;
	int rc;

	if (known && file_mark_equals(&known->mark, &file->mark)) {
		memcpy(file->id, known->id, sizeof(file->id));
		return 0;
	}
	buffer_init(&text, DOCUMENT_BYTES_MAX);
	rc = read_file(documents, file->name, &text);
	if (rc == 0)
		rc = history_id(buffer_bytes(&text), file->id);
	if (rc == 0 && (!known || strcmp(known->id, file->id) != 0)) {
		rc = history_put(documents->history, buffer_bytes(&text), file->id);
		if (rc == 0)
			rc = add_change(changes, file->name, file->id);
	}
	buffer_finish(&text);
	return rc;
}

/* Compares the folder, as found, with the newest version. */
static int find_changes(struct documents *documents, struct folder_files *found,
			struct changes *changes, const char **name)
{
	int rc = 0;

	for (uint32_t n = 0; rc == 0 && n < found->count; n++) {
		*name = found->list[n].name;
		rc = look_at(documents, &found->list[n], changes);
	}
	for (uint32_t n = 0; rc == 0 && n < documents->files.count; n++)
		if (!folder_files_find(found, documents->files.list[n].name))
			rc = add_change(changes, documents->files.list[n].name, "");
	return rc;
}

int documents_take_in(struct documents *documents, struct diagnostics *diagnostics)
{
	struct folder_files found;
	struct changes changes = { 0 };
	const char *name = documents->folder;
	int rc = folder_files_scan(&found, documents->folder);

	if (rc == 0)
		rc = find_changes(documents, &found, &changes, &name);
	if (rc == 0 && changes.count > 0) {
		rc = history_stage(documents->history, changes.list, changes.count,
				   DOCUMENTS_OUTSIDE, "changed outside gopura-curator");
		if (rc == 0)
			rc = history_accept(documents->history);
		if (rc == 0)
			log_info("curator", "%u documents have been changed by other programs",
				 changes.count);
	}
	documents_report(diagnostics, rc, name);
	free(changes.list);
	if (rc == 0) {
		folder_files_finish(&documents->files);
		documents->files = found;
	} else {
		folder_files_finish(&found);
	}
	return rc;
}

/* ---- opening */

/* Only one process may stage and accept. A crash frees the lock. */
static int lock_folder(struct documents *documents, struct diagnostics *diagnostics)
{
	struct flock lock = { .l_type = F_WRLCK, .l_whence = SEEK_SET };
	char path[PATH_BYTES];

	path_of(documents, ".curator", path);
	if (mkdir(path, 0700) < 0 && errno != EEXIST)
		return diagnostics_add(diagnostics, -errno, path, 0, "cannot be made: %s",
				       strerror(errno));
	path_of(documents, ".curator/documents.lock", path);
	documents->lock_fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
	if (documents->lock_fd < 0)
		return diagnostics_add(diagnostics, -errno, path, 0, "cannot be opened: %s",
				       strerror(errno));
	if (fcntl(documents->lock_fd, F_SETLK, &lock) == 0)
		return 0;
	return diagnostics_add(diagnostics, -EBUSY, documents->folder, 0,
			       "another gopura-curator has this folder: use that one, or end it");
}

static int know(void *user, const struct history_file *file)
{
	struct documents *documents = user;
	struct folder_file known = { 0 };

	snprintf(known.name, sizeof(known.name), "%s", file->name);
	memcpy(known.id, file->id, sizeof(known.id));
	return folder_files_set(&documents->files, &known);
}

/* Writes a file of a change that was left half made, unless somebody has changed it since: that is
 * then a later version. */
static int finish_file(void *user, const struct history_file *file, const char *before)
{
	struct documents *documents = user;
	char now[HISTORY_ID_BYTES] = "";
	struct buffer text;
	int rc;

	buffer_init(&text, DOCUMENT_BYTES_MAX);
	rc = read_file(documents, file->name, &text);
	if (rc == 0)
		rc = history_id(buffer_bytes(&text), now);
	else if (rc == -ENOENT)
		rc = 0;
	buffer_finish(&text);
	if (rc < 0 || strcmp(now, before) != 0)
		return rc;
	return write_file(documents, file->name, file->id);
}

static int finish_staged(struct documents *documents, struct diagnostics *diagnostics)
{
	int rc;

	if (!history_has_staged(documents->history))
		return 0;
	rc = history_each_staged(documents->history, finish_file, documents);
	if (rc == 0)
		rc = history_accept(documents->history);
	else if (rc == -EBADMSG)
		rc = history_give_up(documents->history); /* it was not written whole */
	return documents_report(diagnostics, rc, documents->folder);
}

static int open_history(struct documents *documents, struct diagnostics *diagnostics)
{
	char path[PATH_BYTES];
	int rc;

	path_of(documents, ".curator/history.git", path);
	rc = history_open(&documents->history, path, diagnostics);
	if (rc == 0)
		rc = finish_staged(documents, diagnostics);
	if (rc == 0)
		rc = documents_report(diagnostics,
				      history_each(documents->history, know, documents), path);
	return rc < 0 ? rc : documents_take_in(documents, diagnostics);
}

int documents_open(struct documents **out, const char *folder, struct diagnostics *diagnostics)
{
	struct documents *documents = calloc(1, sizeof(*documents));
	pthread_mutexattr_t attributes;
	int rc;

	*out = NULL;
	if (!documents)
		return -ENOMEM;
	documents->lock_fd = -1;
	pthread_mutexattr_init(&attributes);
	pthread_mutexattr_settype(&attributes, PTHREAD_MUTEX_RECURSIVE);
	pthread_mutex_init(&documents->mutex, &attributes);
	pthread_mutexattr_destroy(&attributes);
	snprintf(documents->folder, sizeof(documents->folder), "%s", folder);
	rc = lock_folder(documents, diagnostics);
	if (rc == 0)
		rc = open_history(documents, diagnostics);
	if (rc < 0)
		documents_close(documents);
	else
		*out = documents;
	return rc;
}

void documents_close(struct documents *documents)
{
	if (!documents)
		return;
	history_close(documents->history);
	folder_files_finish(&documents->files);
	if (documents->lock_fd >= 0)
		close(documents->lock_fd);
	pthread_mutex_destroy(&documents->mutex);
	free(documents);
}

/* ---- reading */

int documents_read(struct documents *documents, const char *name, struct buffer *text,
		   char tag[DOCUMENT_TAG_BYTES], struct diagnostics *diagnostics)
{
	int rc;

	tag[0] = '\0';
	if (!document_name_is_valid(name))
		return diagnostics_add(diagnostics, -EINVAL, NULL, 0, "no document has that name");
	documents_lock(documents);
	rc = read_file(documents, name, text);
	documents_unlock(documents);
	if (rc == 0)
		rc = history_id(buffer_bytes(text), tag);
	return rc == -ENOENT ? rc : documents_report(diagnostics, rc, name);
}

int documents_each(struct documents *documents,
		   int (*call)(void *user, const char *name, const char *tag), void *user,
		   struct diagnostics *diagnostics)
{
	int rc;

	documents_lock(documents);
	rc = documents_take_in(documents, diagnostics);
	for (uint32_t n = 0; rc == 0 && n < documents->files.count; n++)
		rc = call(user, documents->files.list[n].name, documents->files.list[n].id);
	documents_unlock(documents);
	return rc;
}

/* ---- saving */

/* Judges a change by what is there now, and keeps its text. */
static int admit(struct documents *documents, struct document_change *change,
		 struct diagnostics *diagnostics)
{
	const struct folder_file *now;

	if (!document_name_is_valid(change->name))
		return diagnostics_add(diagnostics, -EINVAL, NULL, 0, "no document has that name");
	if (!change->removes && change->text.size > DOCUMENT_BYTES_MAX)
		return documents_report(diagnostics, -EFBIG, change->name);
	now = folder_files_find(&documents->files, change->name);
	if (change->base && strcmp(change->base, now ? now->id : "") != 0) {
		snprintf(change->tag, sizeof(change->tag), "%s", now ? now->id : "");
		return diagnostics_add(diagnostics, -ESTALE, change->name, 0,
				       "has been changed by somebody else meanwhile");
	}
	change->tag[0] = '\0';
	return change->removes ? 0
			       : documents_report(
					 diagnostics,
					 history_put(documents->history, change->text, change->tag),
					 change->name);
}

/* Puts back what the first changes wrote. If that fails too, the change stays staged, and is
 * finished when the folder is opened. */
static void take_back(struct documents *documents, const struct document_change *changes,
		      uint32_t count)
{
	int rc = 0;

	for (uint32_t n = 0; rc == 0 && n < count; n++) {
		const struct folder_file *old =
			folder_files_find(&documents->files, changes[n].name);

		rc = write_file(documents, changes[n].name, old ? old->id : "");
	}
	if (rc == 0)
		rc = history_give_up(documents->history);
	if (rc < 0)
		log_error("curator", "a change that failed cannot be taken back: %s",
			  strerror(-rc));
}

static int write_all(struct documents *documents, const struct document_change *changes,
		     uint32_t count, struct diagnostics *diagnostics)
{
	uint32_t done = 0;
	int rc = 0;

	for (; rc == 0 && done < count; done++)
		rc = write_file(documents, changes[done].name, changes[done].tag);
	if (rc < 0) {
		take_back(documents, changes, done);
		return documents_report(diagnostics, rc, changes[done - 1].name);
	}
	rc = history_accept(documents->history);
	for (uint32_t n = 0; rc == 0 && n < count; n++)
		rc = note(documents, changes[n].name, changes[n].tag);
	return documents_report(diagnostics, rc, changes[0].name);
}

/* Leaves out what changes nothing. */
static uint32_t list_changes(const struct documents *documents,
			     const struct document_change *changes, uint32_t count,
			     struct history_file *out)
{
	uint32_t kept = 0;

	for (uint32_t n = 0; n < count; n++) {
		const struct folder_file *now =
			folder_files_find(&documents->files, changes[n].name);

		if (strcmp(now ? now->id : "", changes[n].tag) == 0)
			continue;
		out[kept].name = changes[n].name;
		memcpy(out[kept++].id, changes[n].tag, HISTORY_ID_BYTES);
	}
	return kept;
}

static int save(struct documents *documents, struct document_change *changes, uint32_t count,
		const char *author, const char *what, struct diagnostics *diagnostics)
{
	struct history_file files[DOCUMENTS_CHANGES_MAX];
	uint32_t file_count;
	int rc = documents_take_in(documents, diagnostics);

	for (uint32_t n = 0; rc == 0 && n < count; n++)
		rc = admit(documents, &changes[n], diagnostics);
	if (rc < 0)
		return rc;
	file_count = list_changes(documents, changes, count, files);
	if (file_count == 0)
		return 0;
	rc = documents_report(diagnostics,
			      history_stage(documents->history, files, file_count,
					    *author ? author : "curator", what),
			      changes[0].name);
	return rc < 0 ? rc : write_all(documents, changes, count, diagnostics);
}

int documents_save(struct documents *documents, struct document_change *changes, uint32_t count,
		   const char *author, const char *what, struct diagnostics *diagnostics)
{
	int rc;

	if (count == 0 || count > DOCUMENTS_CHANGES_MAX)
		return -EINVAL;
	documents_lock(documents);
	rc = save(documents, changes, count, author, what, diagnostics);
	documents_unlock(documents);
	return rc;
}
