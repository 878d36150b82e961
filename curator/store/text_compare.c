/* Calls libgit2's merge and difference on texts in memory. */
#include "curator/store/text_compare.h"

#include <errno.h>
#include <git2.h>
#include <string.h>

#include "base/log.h"

static int from_git(int code, const char *doing)
{
	const git_error *error = git_error_last();

	if (code >= 0)
		return 0;
	log_error("curator", "%s: %s", doing, error ? error->message : "failed");
	return error && error->klass == GIT_ERROR_NOMEMORY ? -ENOMEM : -EIO;
}

static bool is_text(struct bytes bytes)
{
	return bytes.size == 0 || !memchr(bytes.data, 0, bytes.size);
}

static git_merge_file_input input_of(struct bytes bytes)
{
	git_merge_file_input input = { .version = GIT_MERGE_FILE_INPUT_VERSION };

	input.ptr = bytes.size ? (const char *)bytes.data : "";
	input.size = bytes.size;
	return input;
}

int text_merge(struct buffer *out, struct bytes base, struct bytes mine, struct bytes theirs,
	       bool *is_clean)
{
	const git_merge_file_input ancestor = input_of(base), ours = input_of(mine),
				   others = input_of(theirs);
	git_merge_file_options options = { .version = GIT_MERGE_FILE_OPTIONS_VERSION };
	git_merge_file_result result = { 0 };
	int rc;

	if (!is_text(base) || !is_text(mine) || !is_text(theirs))
		return -EINVAL;
	options.our_label = "mine";
	options.their_label = "theirs";
	git_libgit2_init();
	rc = from_git(git_merge_file(&result, &ancestor, &ours, &others, &options), "merge");
	if (rc == 0) {
		*is_clean = result.automergeable;
		buffer_put(out, result.ptr, result.len);
		rc = out->error;
	}
	git_merge_file_result_free(&result);
	git_libgit2_shutdown();
	return rc;
}

static int put_hunk(const git_diff_delta *delta, const git_diff_hunk *hunk, void *user)
{
	(void)delta;
	if (hunk->old_start > 1 || hunk->new_start > 1)
		buffer_put_text(user, "@\n");
	return 0;
}

static int put_line(const git_diff_delta *delta, const git_diff_hunk *hunk,
		    const git_diff_line *line, void *user)
{
	const char origin = line->origin;
	struct buffer *out = user;

	(void)delta;
	(void)hunk;
	if (origin != GIT_DIFF_LINE_CONTEXT && origin != GIT_DIFF_LINE_ADDITION &&
	    origin != GIT_DIFF_LINE_DELETION)
		return 0; /* a remark on the last line's end */
	buffer_put_u8(out, (uint8_t)origin);
	buffer_put(out, line->content, line->content_len);
	if (line->content_len == 0 || line->content[line->content_len - 1] != '\n')
		buffer_put_u8(out, '\n');
	return 0;
}

int text_difference(struct buffer *out, struct bytes old, struct bytes new)
{
	git_diff_options options = { .version = GIT_DIFF_OPTIONS_VERSION, .context_lines = 3 };
	int rc;

	if (!is_text(old) || !is_text(new))
		return -EINVAL;
	options.flags = GIT_DIFF_FORCE_TEXT;
	git_libgit2_init();
	rc = from_git(git_diff_buffers(old.size ? old.data : NULL, old.size, NULL,
				       new.size ? new.data : NULL, new.size, NULL, &options, NULL,
				       NULL, put_hunk, put_line, out),
		      "difference");
	git_libgit2_shutdown();
	return rc < 0 ? rc : out->error;
}
