/* Runs assimp inside the sandbox. It reads through our own file functions, which ask the parent
 * process for every file (pipeline/import/sandbox.h). */
#include "pipeline/import/import_scene.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/transient.h"
#include "pipeline/import/import_files.h"
#include "pipeline/import/sandbox.h"

struct file {
	struct aiFile functions; /* must be first: assimp passes its address back */
	struct files *files;
	int fd;
	uint64_t at, size;
};

struct files {
	struct aiFileIO functions; /* must be first, as above */
	const char *seen_path;
	size_t folder_bytes; /* length of the folder in seen_path, with the slash */
	int failed;          /* why a file that is there could not be read; 0: all could */
	int refused;         /* why the first refused file was refused; 0: none was */
	char refused_name[256];
	char missing[PATH_MAX]; /* path of the last file that was not found */
	char missing_name[256]; /* the first one, as the scan names it */
};

/* ---- one file */

static size_t file_read(struct aiFile *handle, char *to, size_t size, size_t count)
{
	struct file *file = (struct file *)handle;
	uint64_t left = file->at < file->size ? file->size - file->at : 0;
	uint64_t items = size ? left / size : 0;
	size_t wanted, done = 0;

	wanted = (items < count ? (size_t)items : count) * size;
	while (done < wanted) {
		ssize_t got = pread(file->fd, to + done, wanted - done, (off_t)(file->at + done));

		if (got < 0 && errno == EINTR)
			continue;
		if (got < 0)
			file->files->failed = -errno;
		if (got <= 0)
			break;
		done += (size_t)got;
	}
	file->at += done;
	return size ? done / size : 0;
}

static size_t file_write(struct aiFile *handle, const char *from, size_t size, size_t count)
{
	(void)handle;
	(void)from;
	(void)size;
	(void)count;
	return 0;
}

static size_t file_tell(struct aiFile *handle)
{
	return (size_t)((struct file *)handle)->at;
}

static size_t file_size(struct aiFile *handle)
{
	return (size_t)((struct file *)handle)->size;
}

/* offset has an unsigned type, but negative values are passed in it. */
static enum aiReturn file_seek(struct aiFile *handle, size_t offset, enum aiOrigin origin)
{
	struct file *file = (struct file *)handle;
	uint64_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? file->at : file->size;
	uint64_t at = from + offset;

	if (at > file->size)
		return aiReturn_FAILURE;
	file->at = at;
	return aiReturn_SUCCESS;
}

static void file_flush(struct aiFile *handle)
{
	(void)handle;
}

/* ---- opening */

static void with_slashes(char out[PATH_MAX], const char *folder, size_t folder_bytes,
			 const char *name)
{
	snprintf(out, PATH_MAX, "%.*s%s", (int)folder_bytes, folder, name);
	for (char *c = out; *c; c++)
		if (*c == '\\')
			*c = '/';
}

/* If assimp cannot open a file, it tries other names: with and without the scan's folder, with
 * other slashes, and with parts of the path. Those attempts are not names in the scan, so they are
 * not reported. */
static bool is_another_try(const struct files *files, const char *asked, const char *name)
{
	char clean[PATH_MAX];

	with_slashes(clean, "", 0, asked);
	if (strstr(files->missing, clean))
		return true;
	with_slashes(clean, "", 0, name);
	return strstr(files->missing, clean);
}

static void note_failure(struct files *files, const char *asked, const char *name, int rc)
{
	const bool is_new = !is_another_try(files, asked, name);

	if (is_transient(rc))
		files->failed = rc;
	if (rc == -ENOENT && is_new && !files->missing_name[0])
		snprintf(files->missing_name, sizeof(files->missing_name), "%s", name);
	if (rc == -ENOENT)
		with_slashes(files->missing, files->seen_path, files->folder_bytes, name);
	if (files->refused || !is_new)
		return;
	if (rc == -EXDEV || rc == -ELOOP || rc == -EINVAL || rc == -EKEYREJECTED) {
		files->refused = rc;
		snprintf(files->refused_name, sizeof(files->refused_name), "%s", name);
	}
}

/* Returns the name as the scan gives it. assimp puts the scan's folder in front of such names. */
static const char *as_named_in_the_scan(const struct files *files, const char *name)
{
	bool is_scan = strcmp(name, files->seen_path) == 0;
	bool has_folder = strncmp(name, files->seen_path, files->folder_bytes) == 0;

	return has_folder && !is_scan ? name + files->folder_bytes : name;
}

static struct aiFile *files_open(struct aiFileIO *handle, const char *asked, const char *mode)
{
	struct files *files = (struct files *)handle;
	const char *name = as_named_in_the_scan(files, asked);
	struct file *file;
	off_t size;
	int fd;

	if (mode[0] != 'r' || strchr(mode, '+'))
		return NULL;
	fd = sandbox_open(name);
	if (fd < 0) {
		note_failure(files, asked, name, fd);
		return NULL;
	}
	size = lseek(fd, 0, SEEK_END);
	file = calloc(1, sizeof(*file));
	if (!file || size < 0) {
		files->failed = size < 0 ? -errno : -ENOMEM;
		free(file);
		close(fd);
		return NULL;
	}
	*file = (struct file){ .functions = { .ReadProc = file_read,
					      .WriteProc = file_write,
					      .TellProc = file_tell,
					      .FileSizeProc = file_size,
					      .SeekProc = file_seek,
					      .FlushProc = file_flush },
			       .files = files,
			       .fd = fd,
			       .size = (uint64_t)size };
	return &file->functions;
}

static void files_close(struct aiFileIO *handle, struct aiFile *file)
{
	(void)handle;
	if (!file)
		return;
	close(((struct file *)file)->fd);
	free(file);
}

/* assimp's own words are for programmers. */
static const char *plain_error(const char *said)
{
	if (said[0] == '\0' || strstr(said, "No suitable reader"))
		return "it is damaged, or its name tells another format";
	if (strstr(said, "bad_alloc"))
		return "it promises more than it holds, or is too large for this machine's memory";
	return said;
}

const struct aiScene *import_scene(const char *seen_path, const char *format_name,
				   struct diagnostics *warning, struct diagnostics *diagnostics)
{
	const char *slash = strrchr(seen_path, '/');
	struct files files = { .functions = { .OpenProc = files_open, .CloseProc = files_close },
			       .seen_path = seen_path,
			       .folder_bytes = slash ? (size_t)(slash - seen_path) + 1 : 0 };
	const struct aiScene *scene =
		aiImportFileEx(seen_path, aiProcess_Triangulate, &files.functions);

	if (files.refused) {
		diagnostics_add(
			diagnostics, -EPERM, seen_path, 0, "it names '%.200s', which %s; %s",
			files.refused_name, import_files_why(files.refused),
			files.refused == -EKEYREJECTED ? "no scan needs one: do not trust its maker"
						       : "copy that file beside the scan");
		return NULL;
	}
	if (files.failed) {
		diagnostics_add(diagnostics, files.failed, seen_path, 0,
				"it, or a file that it names, cannot be read: %s; try again",
				strerror(-files.failed));
		return NULL;
	}
	if (!scene && strstr(aiGetErrorString(), "referenced file") && files.missing_name[0]) {
		diagnostics_add(diagnostics, -ENOENT, seen_path, 0,
				"it names '%.200s', which is not beside it; copy that file beside "
				"the scan",
				files.missing_name);
		return NULL;
	}
	if (!scene || !scene->mRootNode) {
		const char *error = plain_error(aiGetErrorString());
		const size_t length = strlen(error);

		diagnostics_add(diagnostics, -EBADMSG, seen_path, 0,
				"its %s reader says: %.*s; export it again", format_name,
				(int)(error[length - 1] == '.' ? length - 1 : length), error);
		return NULL;
	}
	if (files.missing_name[0])
		diagnostics_add(warning, 0, seen_path, 0,
				"it names '%.200s', which is not beside it: its colours are left "
				"out; copy that file beside the scan",
				files.missing_name);
	return scene;
}
