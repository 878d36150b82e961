/* Parses a list of face numbers and ranges into sorted ranges, and finds the triangles that come
 * from these faces. */
#include "pipeline/import/face_list.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/bytes.h"

enum { FILE_BYTES_MAX = 256 << 20 };

/* The text being read, and the position in it. */
struct text {
	const char *at, *name;
	unsigned line;
	uint32_t face_count;
	struct diagnostics *diagnostics;
};

/* Skips white space and comments. Returns false at the end. */
static bool next_word(struct text *text)
{
	for (;; text->at++) {
		if (*text->at == '#')
			text->at += strcspn(text->at, "\n");
		if (*text->at == '\n')
			text->line++;
		if (!*text->at)
			return false;
		if (!isspace((unsigned char)*text->at))
			return true;
	}
}

/* Returns how many bytes of a word a message should show. */
static int shown(const char *word)
{
	const size_t size = strcspn(word, " \t\r\n#");

	return size < 20 ? (int)size : 20;
}

static int read_number(struct text *text, uint32_t *out)
{
	uint64_t value = 0;
	const char *from = text->at;

	for (; isdigit((unsigned char)*text->at); text->at++)
		value = value > UINT32_MAX ? value : 10 * value + (uint64_t)(*text->at - '0');
	if (text->at == from)
		return diagnostics_add(text->diagnostics, -EINVAL, text->name, text->line,
				       "'%.*s' is not a face: write numbers such as 17 and ranges "
				       "such as 20-31",
				       shown(from), from);
	if (value >= text->face_count)
		return diagnostics_add(text->diagnostics, -EINVAL, text->name, text->line,
				       "face %" PRIu64 " is not in the scan, which has %" PRIu32
				       " (the first is 0): is the list of another version of it?",
				       value, text->face_count);
	*out = (uint32_t)value;
	return 0;
}

static int read_range(struct text *text, struct face_range *out)
{
	int rc = read_number(text, &out->first);

	out->last = out->first;
	if (rc == 0 && *text->at == '-') {
		text->at++;
		rc = read_number(text, &out->last);
	}
	if (rc < 0)
		return rc;
	if (*text->at && *text->at != '#' && !isspace((unsigned char)*text->at))
		return diagnostics_add(text->diagnostics, -EINVAL, text->name, text->line,
				       "'%.*s' behind a number: put spaces between faces",
				       shown(text->at), text->at);
	if (out->last < out->first)
		return diagnostics_add(text->diagnostics, -EINVAL, text->name, text->line,
				       "%" PRIu32 "-%" PRIu32
				       " runs backwards: the lower number comes first",
				       out->first, out->last);
	return 0;
}

static int add(struct face_list *list, uint32_t *room, struct face_range range)
{
	int rc = ARRAY_RESERVE(list->ranges, *room, list->count + 1, UINT32_MAX);

	if (rc == 0)
		list->ranges[list->count++] = range;
	return rc;
}

static int by_first(const void *a, const void *b)
{
	const struct face_range *left = a, *right = b;

	return (left->first > right->first) - (left->first < right->first);
}

/* Sorts the ranges and merges those that overlap or touch, so that a face named twice counts
 * once. */
static void join(struct face_list *list)
{
	uint32_t kept = 0;

	qsort(list->ranges, list->count, sizeof(*list->ranges), by_first);
	for (uint32_t i = 1; i < list->count; i++) {
		struct face_range *last = &list->ranges[kept], *next = &list->ranges[i];

		if (next->first > last->last && next->first - last->last > 1)
			list->ranges[++kept] = *next;
		else if (next->last > last->last)
			last->last = next->last;
	}
	list->count = kept + 1;
}

static int read_all(struct face_list *list, struct text *text)
{
	uint32_t room = 0;
	int rc = 0;

	while (rc == 0 && next_word(text)) {
		struct face_range range;

		rc = read_range(text, &range);
		if (rc == 0)
			rc = add(list, &room, range);
	}
	if (rc == 0 && list->count == 0)
		rc = diagnostics_add(text->diagnostics, -EINVAL, text->name, 0, "names no face");
	if (rc == 0)
		join(list);
	return rc;
}

int face_list_read(struct face_list *out, const char *path, const char *name, uint32_t face_count,
		   struct diagnostics *diagnostics)
{
	struct text text = {
		.name = name, .line = 1, .face_count = face_count, .diagnostics = diagnostics
	};
	struct buffer file;
	int rc;

	*out = (struct face_list){ 0 };
	buffer_init(&file, FILE_BYTES_MAX);
	rc = buffer_read_file(&file, path);
	buffer_put_u8(&file, 0);
	if (rc == 0)
		rc = file.error;
	if (rc < 0) {
		diagnostics_add(diagnostics, rc, name, 0, "%s", strerror(-rc));
	} else {
		text.at = (const char *)file.data;
		rc = read_all(out, &text);
	}
	if (rc < 0)
		face_list_finish(out);
	buffer_finish(&file);
	return rc;
}

void face_list_finish(struct face_list *list)
{
	if (!list)
		return;
	free(list->ranges);
	*list = (struct face_list){ 0 };
}

static bool has(const struct face_list *list, uint32_t face)
{
	uint32_t low = 0, high = list->count;

	while (low < high) {
		uint32_t middle = (low + high) / 2;

		if (list->ranges[middle].last < face)
			low = middle + 1;
		else
			high = middle;
	}
	return low < list->count && list->ranges[low].first <= face;
}

int face_list_triangles(uint32_t **out, uint32_t *count, const struct face_list *list,
			const struct mesh *mesh, uint32_t scan)
{
	uint32_t first = 0, found = 0, *triangles;

	*out = NULL;
	*count = 0;
	for (uint32_t s = 0; s < scan; s++)
		first += mesh->scans[s].triangle_count;
	triangles = malloc(((size_t)mesh->scans[scan].triangle_count + 1) * sizeof(*triangles));
	if (!triangles)
		return -ENOMEM;
	for (uint32_t t = first; t < first + mesh->scans[scan].triangle_count; t++)
		if (mesh->faces && mesh->faces[t] != MESH_NO_FACE && has(list, mesh->faces[t]))
			triangles[found++] = t;
	*out = realloc(triangles, ((size_t)found + 1) * sizeof(*triangles));
	if (!*out)
		*out = triangles;
	*count = found;
	return 0;
}
