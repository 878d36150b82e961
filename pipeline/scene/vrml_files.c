/* The files of a scene: that which is read, and those that Inline, EXTERNPROTO and textures name.
 */
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

/* Removes the last component of a path, and returns the size of what is left; "": 0. */
static size_t parent_of(const char *path, size_t size)
{
	while (size > 0 && path[size - 1] != '/')
		size--;
	return size > 0 ? size - 1 : 0;
}

/* Appends a component to a path. Returns false if it leads out of the scan's folder, or is too
 * long. */
static bool append_component(char name[VRML_NAME_BYTES], size_t *size, const char *part,
			     size_t length)
{
	if (length == 0 || (length == 1 && part[0] == '.'))
		return true;
	if (length == 2 && part[0] == '.' && part[1] == '.') {
		if (*size == 0)
			return false;
		*size = parent_of(name, *size);
		return true;
	}
	if (*size + 1 + length >= VRML_NAME_BYTES)
		return false;
	if (*size > 0)
		name[(*size)++] = '/';
	memcpy(name + *size, part, length);
	*size += length;
	return true;
}

/* Makes the file's name in the scan's folder of an address in a file `by`, which may lie deeper.
 * Returns false if it cannot be in that folder. */
static bool place_url(const char *by, const char *url, size_t length, char name[VRML_NAME_BYTES])
{
	size_t size = parent_of(by, strlen(by));

	if (url[0] == '/' || memmem(url, length, "://", 3))
		return false;
	memcpy(name, by, size);
	for (const char *at = url; at < url + length;) {
		const size_t rest = (size_t)(url + length - at), part = strcspn(at, "/");

		if (!append_component(name, &size, at, part < rest ? part : rest))
			return false;
		at += part < rest ? part + 1 : rest;
	}
	name[size] = '\0';
	return size > 0;
}

/* As vrml_open, of the first bytes of an address. by: the file that has it, as it was opened; "":
 * the scene's own, whose path is not one in its folder. */
static int open_url(const char *by, const char *url, size_t length,
		    const struct vrml_options *options, char name[VRML_NAME_BYTES])
{
	int fd = -ENOENT;

	name[0] = '\0';
	if (length == 0 || length >= VRML_NAME_BYTES || !options || !options->open_file)
		return -ENOENT;
	if (place_url(by, url, length, name))
		fd = options->open_file(options->data, name);
	if (fd < 0) {
		memcpy(name, url, length);
		name[length] = '\0';
		fd = options->open_file(options->data, name);
	}
	return fd;
}

int vrml_open(const struct vrml *scene, const struct vrml_node *node, const char *url,
	      const struct vrml_options *options, char name[VRML_NAME_BYTES])
{
	const size_t length = strlen(url);

	name[0] = '\0';
	if (length >= VRML_NAME_BYTES && options && options->open_file)
		return options->open_file(options->data, url);
	return open_url(node->file == scene->path ? "" : node->file, url, length, options, name);
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
	const struct vrml_source *by = parser->scope->source;
	char name[VRML_NAME_BYTES] = "";
	int fd = -ENOENT;

	for (uint32_t i = 0; i < urls->count && fd < 0; i++)
		fd = open_url(by == parser->sources[0] ? "" : by->path, urls->strings[i],
			      strcspn(urls->strings[i], "#"), parser->options, name);
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
