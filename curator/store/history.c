/* Calls libgit2 on a bare repository. */
#include "curator/store/history.h"

#include <errno.h>
#include <git2.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/compiler.h"
#include "base/log.h"

#define MAIN   "refs/heads/main"
#define STAGED "refs/gopura/staged"

struct history {
	git_repository *repository;
};

static int from_git(int code, const char *doing)
{
	const git_error *error = git_error_last();

	if (code >= 0)
		return 0;
	if (code == GIT_ENOTFOUND)
		return -ENOENT;
	log_error("curator", "history: %s: %s", doing, error ? error->message : "failed");
	if (error && error->klass == GIT_ERROR_NOMEMORY)
		return -ENOMEM;
	/* Of what the system said, libgit2 keeps the words alone. */
	if (error && error->klass == GIT_ERROR_OS)
		return strstr(error->message, strerror(ENOSPC)) ||
				       strstr(error->message, strerror(EDQUOT))
			       ? -ENOSPC
			       : -EIO;
	return -EBADMSG;
}

static bool parse_id(git_oid *out, const char *id)
{
	return strlen(id) == GIT_OID_HEXSZ && strspn(id, "0123456789abcdef") == GIT_OID_HEXSZ &&
	       git_oid_fromstr(out, id) == 0;
}

static void print_id(char out[HISTORY_ID_BYTES], const git_oid *id)
{
	git_oid_tostr(out, HISTORY_ID_BYTES, id);
}

/* ---- opening */

/* Git's settings of the user and the machine mean nothing here, and what was written stays. */
static void set_up_library(void)
{
	static const int levels[] = { GIT_CONFIG_LEVEL_PROGRAMDATA, GIT_CONFIG_LEVEL_SYSTEM,
				      GIT_CONFIG_LEVEL_XDG, GIT_CONFIG_LEVEL_GLOBAL };

	git_libgit2_init();
	for (size_t n = 0; n < ARRAY_COUNT(levels); n++)
		git_libgit2_opts(GIT_OPT_SET_SEARCH_PATH, levels[n], "");
	git_libgit2_opts(GIT_OPT_ENABLE_FSYNC_GITDIR, 1);
	git_libgit2_opts(GIT_OPT_SET_OWNER_VALIDATION, 0); /* the operator names the folder */
}

/* *out is NULL with -ENOENT if there is no version yet. */
static int find_commit(git_commit **out, const struct history *history, const char *reference)
{
	git_oid id;
	int rc;

	*out = NULL;
	rc = from_git(git_reference_name_to_id(&id, history->repository, reference), reference);
	if (rc == 0)
		rc = from_git(git_commit_lookup(out, history->repository, &id), reference);
	return rc == -ENOENT && *out == NULL && git_error_last() &&
			       git_error_last()->klass == GIT_ERROR_ODB
		       ? -EBADMSG
		       : rc;
}

/* *out is owned by the caller (git_index_free). */
static int read_files(git_index **out, const git_commit *commit)
{
	git_tree *tree = NULL;
	int rc = from_git(git_index_new(out), "index");

	if (rc == 0 && commit)
		rc = from_git(git_commit_tree(&tree, commit), "tree");
	if (rc == 0 && tree)
		rc = from_git(git_index_read_tree(*out, tree), "tree");
	git_tree_free(tree);
	return rc == -ENOENT ? -EBADMSG : rc;
}

/* Whether everything that the newest version names is there. */
static int check(const struct history *history)
{
	git_commit *commit;
	git_index *files = NULL;
	git_odb *objects = NULL;
	int rc = find_commit(&commit, history, MAIN);

	if (rc == -ENOENT)
		return 0;
	if (rc == 0)
		rc = read_files(&files, commit);
	if (rc == 0)
		rc = from_git(git_repository_odb(&objects, history->repository), "objects");
	for (size_t n = 0; rc == 0 && n < git_index_entrycount(files); n++) {
		git_object_t type;
		size_t size;

		rc = from_git(git_odb_read_header(&size, &type, objects,
						  &git_index_get_byindex(files, n)->id),
			      "object");
		if (rc == -ENOENT)
			rc = -EBADMSG;
	}
	git_odb_free(objects);
	git_index_free(files);
	git_commit_free(commit);
	return rc;
}

static int make(struct history *history, const char *path, struct diagnostics *diagnostics)
{
	git_repository_init_options options = { .version = GIT_REPOSITORY_INIT_OPTIONS_VERSION };
	int rc;

	options.flags = GIT_REPOSITORY_INIT_BARE | GIT_REPOSITORY_INIT_MKDIR;
	options.initial_head = "main";
	rc = from_git(git_repository_init_ext(&history->repository, path, &options), path);
	if (rc < 0)
		diagnostics_add(diagnostics, rc, path, 0, "the history cannot be made: %s",
				strerror(-rc));
	return rc;
}

static int put_aside(const char *path, struct diagnostics *diagnostics)
{
	char aside[BYTES_PATH_MAX + 32];

	snprintf(aside, sizeof(aside), "%s.broken-%lld", path, (long long)time(NULL));
	if (rename(path, aside) < 0)
		return diagnostics_add(diagnostics, -errno, path, 0,
				       "is damaged, and cannot be renamed: %s", strerror(errno));
	log_warn("curator", "%s is damaged: it is now %s, and a new history begins", path, aside);
	return 0;
}

/* Removes what a program that was killed in the middle of a change has left: libgit2 refuses to
 * write while there is such a file. */
static void drop_locks(const char *path)
{
	static const char *const names[] = { MAIN, STAGED, "HEAD", "config" };
	char lock[PATH_MAX];

	for (size_t i = 0; i < ARRAY_COUNT(names); i++)
		if (snprintf(lock, sizeof(lock), "%s/%s.lock", path, names[i]) < PATH_MAX &&
		    unlink(lock) == 0)
			log_info("curator", "%s of a program that was killed is removed", lock);
}

int history_open(struct history **out, const char *path, struct diagnostics *diagnostics)
{
	struct history *history = calloc(1, sizeof(*history));
	int rc;

	*out = NULL;
	if (!history)
		return -ENOMEM;
	set_up_library();
	if (access(path, F_OK) < 0) {
		rc = make(history, path, diagnostics);
	} else if (access(path, R_OK | W_OK | X_OK) < 0) {
		/* libgit2 would find nothing there, as in one that is damaged. */
		rc = diagnostics_add(diagnostics, -errno, path, 0,
				     "%s: give the history to the user who runs this program",
				     strerror(errno));
	} else {
		drop_locks(path);
		rc = from_git(git_repository_open_bare(&history->repository, path), path);
		if (rc == 0)
			rc = check(history);
		if (rc == -EIO) {
			diagnostics_add(diagnostics, rc, path, 0,
					"the history cannot be read: %s; look at the disk, or move "
					"the history away to begin a new one",
					strerror(-rc));
		} else if (rc < 0 && rc != -ENOMEM) {
			git_repository_free(history->repository);
			history->repository = NULL;
			rc = put_aside(path, diagnostics);
			if (rc == 0)
				rc = make(history, path, diagnostics);
		}
	}
	if (rc < 0)
		history_close(history);
	else
		*out = history;
	return rc;
}

void history_close(struct history *history)
{
	if (!history)
		return;
	git_repository_free(history->repository);
	free(history);
	git_libgit2_shutdown();
}

/* ---- bytes */

int history_id(struct bytes bytes, char id[HISTORY_ID_BYTES])
{
	git_oid found;
	int rc = from_git(git_odb_hash(&found, bytes.data, bytes.size, GIT_OBJECT_BLOB), "hash");

	if (rc == 0)
		print_id(id, &found);
	return rc;
}

int history_put(struct history *history, struct bytes bytes, char id[HISTORY_ID_BYTES])
{
	git_oid made;
	int rc = from_git(
		git_blob_create_from_buffer(&made, history->repository, bytes.data, bytes.size),
		"a text cannot be kept");

	if (rc == 0)
		print_id(id, &made);
	return rc;
}

int history_get(struct history *history, const char *id, struct buffer *out)
{
	git_blob *blob = NULL;
	git_oid wanted;
	int rc;

	if (!parse_id(&wanted, id))
		return -EINVAL;
	rc = from_git(git_blob_lookup(&blob, history->repository, &wanted), "a text");
	if (rc == 0) {
		buffer_put(out, git_blob_rawcontent(blob), (size_t)git_blob_rawsize(blob));
		rc = out->error;
	}
	git_blob_free(blob);
	return rc;
}

int history_each(struct history *history, int (*call)(void *user, const struct history_file *file),
		 void *user)
{
	git_commit *commit;
	git_index *files = NULL;
	int rc = find_commit(&commit, history, MAIN);

	if (rc == -ENOENT)
		return 0;
	if (rc == 0)
		rc = read_files(&files, commit);
	for (size_t n = 0; rc == 0 && n < git_index_entrycount(files); n++) {
		const git_index_entry *entry = git_index_get_byindex(files, n);
		struct history_file file = { .name = entry->path };

		print_id(file.id, &entry->id);
		rc = call(user, &file);
	}
	git_index_free(files);
	git_commit_free(commit);
	return rc;
}

/* ---- changes */

static int change_files(git_index *index, const struct history_file *files, uint32_t count)
{
	int rc = 0;

	for (uint32_t n = 0; rc == 0 && n < count; n++) {
		git_index_entry entry = { .mode = GIT_FILEMODE_BLOB, .path = files[n].name };

		if (!files[n].id[0])
			rc = from_git(git_index_remove(index, files[n].name, 0), files[n].name);
		else if (!parse_id(&entry.id, files[n].id))
			rc = -EINVAL;
		else
			rc = from_git(git_index_add(index, &entry), files[n].name);
	}
	return rc;
}

static int write_commit(git_oid *out, struct history *history, git_index *index, git_commit *parent,
			const char *author, const char *what)
{
	const git_commit *parents[] = { parent };
	char line[HISTORY_WHAT_BYTES];
	git_signature *signature = NULL;
	git_tree *tree = NULL;
	git_oid tree_id;
	int rc;

	snprintf(line, sizeof(line), "%.*s", (int)strcspn(what, "\n"), what);
	rc = from_git(git_index_write_tree_to(&tree_id, index, history->repository), "tree");
	if (rc == 0)
		rc = from_git(git_tree_lookup(&tree, history->repository, &tree_id), "tree");
	if (rc == 0)
		rc = from_git(git_signature_now(&signature, author, "gopura-curator"), "author");
	if (rc == 0)
		rc = from_git(git_commit_create(out, history->repository, NULL, signature,
						signature, NULL, line, tree, parent ? 1 : 0,
						parents),
			      "a version cannot be kept");
	git_signature_free(signature);
	git_tree_free(tree);
	return rc;
}

static int point(struct history *history, const char *reference, const git_oid *id)
{
	git_reference *made = NULL;
	int rc = from_git(git_reference_create(&made, history->repository, reference, id, 1, NULL),
			  reference);

	git_reference_free(made);
	return rc;
}

int history_stage(struct history *history, const struct history_file *files, uint32_t count,
		  const char *author, const char *what)
{
	git_commit *parent;
	git_index *index = NULL;
	git_oid id;
	int rc = find_commit(&parent, history, MAIN);

	if (rc == 0 || rc == -ENOENT)
		rc = read_files(&index, parent);
	if (rc == 0)
		rc = change_files(index, files, count);
	if (rc == 0)
		rc = write_commit(&id, history, index, parent, author, what);
	if (rc == 0)
		rc = point(history, STAGED, &id);
	git_index_free(index);
	git_commit_free(parent);
	return rc;
}

bool history_has_staged(const struct history *history)
{
	git_oid id;

	return git_reference_name_to_id(&id, history->repository, STAGED) == 0;
}

/* Files of one version that the other has not, or has with other bytes. Those of `next` get next's
 * id, those of `last` alone get "". */
static int each_changed(const git_index *last, const git_index *next,
			int (*call)(void *user, const struct history_file *file,
				    const char *before),
			void *user)
{
	int rc = 0;

	for (size_t n = 0; rc == 0 && n < git_index_entrycount(next); n++) {
		const git_index_entry *now = git_index_get_byindex((git_index *)next, n),
				      *then = git_index_get_bypath((git_index *)last, now->path, 0);
		struct history_file file = { .name = now->path };
		char before[HISTORY_ID_BYTES] = "";

		print_id(file.id, &now->id);
		if (then)
			print_id(before, &then->id);
		if (strcmp(file.id, before) != 0)
			rc = call(user, &file, before);
	}
	for (size_t n = 0; rc == 0 && n < git_index_entrycount(last); n++) {
		const git_index_entry *then = git_index_get_byindex((git_index *)last, n);
		const struct history_file file = { .name = then->path };
		char before[HISTORY_ID_BYTES];

		print_id(before, &then->id);
		if (!git_index_get_bypath((git_index *)next, then->path, 0))
			rc = call(user, &file, before);
	}
	return rc;
}

int history_each_staged(struct history *history,
			int (*call)(void *user, const struct history_file *file,
				    const char *before),
			void *user)
{
	git_commit *last = NULL, *next = NULL;
	git_index *before = NULL, *after = NULL;
	int rc = find_commit(&next, history, STAGED);

	if (rc == 0)
		rc = find_commit(&last, history, MAIN);
	if (rc == -ENOENT && next)
		rc = 0; /* it is the first */
	if (rc == 0)
		rc = read_files(&before, last);
	if (rc == 0)
		rc = read_files(&after, next);
	if (rc == 0)
		rc = each_changed(before, after, call, user);
	git_index_free(after);
	git_index_free(before);
	git_commit_free(next);
	git_commit_free(last);
	return rc;
}

int history_give_up(struct history *history)
{
	return from_git(git_reference_remove(history->repository, STAGED), "staged");
}

int history_accept(struct history *history)
{
	git_oid id;
	int rc = from_git(git_reference_name_to_id(&id, history->repository, STAGED), "staged");

	if (rc == 0)
		rc = point(history, MAIN, &id);
	return rc < 0 ? rc : history_give_up(history);
}

/* ---- versions */

/* "" if the file is not in it. */
static int file_in(const git_commit *commit, const char *name, char id[HISTORY_ID_BYTES])
{
	git_tree_entry *entry = NULL;
	git_tree *tree = NULL;
	int rc;

	id[0] = '\0';
	if (!commit)
		return 0;
	rc = from_git(git_commit_tree(&tree, commit), "tree");
	if (rc == 0) {
		rc = from_git(git_tree_entry_bypath(&entry, tree, name), name);
		if (rc == 0)
			print_id(id, git_tree_entry_id(entry));
		else if (rc == -ENOENT)
			rc = 0;
	}
	git_tree_entry_free(entry);
	git_tree_free(tree);
	return rc;
}

static void describe(struct history_version *out, const git_commit *commit, const char *text_id)
{
	const git_signature *author = git_commit_author(commit);
	const char *what = git_commit_message(commit);

	*out = (struct history_version){ .time_s = author->when.time };
	print_id(out->id, git_commit_id(commit));
	snprintf(out->text_id, sizeof(out->text_id), "%s", text_id);
	snprintf(out->author, sizeof(out->author), "%s", author->name);
	snprintf(out->what, sizeof(out->what), "%.*s", (int)strcspn(what, "\n"), what);
}

/* *commit is replaced by its parent; NULL: it was the first. */
static int step_back(git_commit **commit)
{
	git_commit *parent = NULL;
	int rc = 0;

	if (git_commit_parentcount(*commit) > 0)
		rc = from_git(git_commit_parent(&parent, *commit, 0), "an older version");
	git_commit_free(*commit);
	*commit = parent;
	return rc == -ENOENT ? -EBADMSG : rc;
}

int history_list(struct history *history, const char *name, struct history_version *out,
		 uint32_t max, uint32_t *count)
{
	char id[HISTORY_ID_BYTES], older[HISTORY_ID_BYTES];
	struct history_version version;
	git_commit *commit;
	int rc = find_commit(&commit, history, MAIN);

	*count = 0;
	if (rc == 0)
		rc = file_in(commit, name, id);
	while (rc == 0 && commit && *count < max) {
		describe(&version, commit, id);
		rc = step_back(&commit);
		if (rc == 0)
			rc = file_in(commit, name, older);
		if (rc == 0 && strcmp(id, older) != 0)
			out[(*count)++] = version;
		memcpy(id, older, sizeof(id));
	}
	git_commit_free(commit);
	return rc == -ENOENT ? 0 : rc;
}

int history_find(struct history *history, const char *version, const char *name,
		 char id[HISTORY_ID_BYTES])
{
	git_commit *commit = NULL;
	git_oid wanted;
	int rc;

	if (!parse_id(&wanted, version))
		return -EINVAL;
	rc = from_git(git_commit_lookup(&commit, history->repository, &wanted), "a version");
	if (rc == 0)
		rc = file_in(commit, name, id);
	git_commit_free(commit);
	return rc == 0 && !id[0] ? -ENOENT : rc;
}
