/* The files of a scene: that which is read, and those that Inline and EXTERNPROTO name. */
#include "pipeline/scene/vrml_files.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/scene/vrml_text.h"

/* Adds a file; its text is still empty. NULL: no memory, or too many. */
struct vrml_source *vrml_add_source(struct vrml_parser *parser, const char *path)
{
	struct vrml_source *source;

	if (parser->source_count == VRML_FILES_MAX)
		return NULL;
	source = arena_alloc(&parser->scene->arena, sizeof(*source));
	if (!source)
		return NULL;
	source->path = arena_text(&parser->scene->arena, path, strlen(path));
	buffer_init(&source->text, VRML_TEXT_BYTES_MAX + 1);
	if (!source->path)
		return NULL;
	parser->sources[parser->source_count++] = source;
	return source;
}

int vrml_source_text(struct vrml_parser *parser, struct vrml_source *source, struct bytes file)
{
	int rc = vrml_text(&source->text, file);

	if (rc == 0)
		return 0;
	return diagnostics_add(parser->diagnostics, rc, source->path, 0,
			       rc == -EFBIG ? "too large; split it into several files"
			       : rc == -EBADMSG
				       ? "not a text, or a damaged gzip file; copy it again from "
					 "the source"
				       : "too large for this machine's memory");
}

/* Opens one address of a file: what stands before #. */
static int open_url(struct vrml_parser *parser, const char *url, char name[256])
{
	size_t length = strcspn(url, "#");

	if (length == 0 || length > 255 || !parser->options || !parser->options->open_file)
		return -ENOENT;
	memcpy(name, url, length);
	name[length] = '\0';
	return parser->options->open_file(parser->options->data, name);
}

static struct vrml_source *find_source(const struct vrml_parser *parser, const char *name)
{
	for (uint32_t i = 1; i < parser->source_count; i++)
		if (strcmp(parser->sources[i]->path, name) == 0)
			return parser->sources[i];
	return NULL;
}

static int load_fd(struct vrml_parser *parser, struct vrml_source **out, int fd, const char *name,
		   unsigned line)
{
	struct buffer file;
	int rc;

	*out = vrml_add_source(parser, name);
	if (!*out) {
		close(fd);
		return VRML_FAIL(parser, -EFBIG, line, "the scene names over %d files; join some",
				 VRML_FILES_MAX);
	}
	buffer_init(&file, VRML_TEXT_BYTES_MAX);
	rc = buffer_read_fd(&file, fd);
	if (rc < 0)
		rc = VRML_FAIL(parser, rc, line, "%s: %s", name, strerror(-rc));
	else
		rc = vrml_source_text(parser, *out, buffer_bytes(&file));
	buffer_finish(&file);
	return rc;
}

int vrml_open_source(struct vrml_parser *parser, struct vrml_source **out,
		     const struct vrml_value *urls, unsigned line)
{
	char name[256] = "";
	int fd = -ENOENT;

	for (uint32_t i = 0; i < urls->count && fd < 0; i++)
		fd = open_url(parser, urls->strings[i], name);
	if (fd < 0)
		return VRML_FAIL(parser, fd, line,
				 "it names %.100s, which is not beside it; copy it there",
				 urls->count > 0 ? urls->strings[0] : "no file");
	*out = find_source(parser, name);
	if (!*out)
		return load_fd(parser, out, fd, name, line);
	close(fd);
	if ((*out)->is_open)
		return VRML_FAIL(parser, -EBADMSG, line, "%s contains itself; remove this", name);
	return 0;
}
