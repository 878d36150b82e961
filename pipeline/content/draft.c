/* Shared helpers of the readers of a content folder: searching, freeing, and checking pictures. */
#include "pipeline/content/draft.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/array.h"
#include "base/safe_open.h"
#include "format/page.h"
#include "format/picture.h"

static void part_finish(struct draft_part *part)
{
	free(part->id);
	free(part->faces_file);
	free(part->faces_scan);
	free(part->thumbnail);
	for (uint32_t i = 0; i < part->document_count; i++)
		free(part->documents[i]);
	for (uint32_t i = 0; i < part->credit_count; i++)
		free(part->credits[i].value);
	for (size_t i = 0; i < INFO_LANGUAGES_MAX; i++) {
		free(part->titles[i]);
		free(part->captions[i]);
		free(part->readings[i]);
		free(part->pages[i].html);
		buffer_finish(&part->pages[i].article);
		free(part->pages[i].pictures);
		cues_finish(&part->pages[i].spoken.cues);
	}
}

static void tour_finish(struct draft_tour *tour)
{
	free(tour->id);
	for (size_t i = 0; i < INFO_LANGUAGES_MAX; i++) {
		free(tour->titles[i]);
		free(tour->captions[i]);
		for (uint32_t s = 0; s < tour->stop_count; s++)
			free(tour->stops[s].captions[i]);
	}
	free(tour->stops);
}

void draft_finish(struct draft *draft)
{
	for (uint32_t i = 0; i < draft->tour_count; i++)
		tour_finish(&draft->tours[i]);
	free(draft->tours);
	for (uint32_t i = 0; i < draft->part_count; i++)
		part_finish(&draft->parts[i]);
	for (uint32_t i = 0; i < draft->picture_count; i++)
		free(draft->pictures[i].name);
	free(draft->parts);
	free(draft->pictures);
	*draft = (struct draft){ .options = draft->options, .diagnostics = draft->diagnostics };
}

static int parse_json(struct draft *draft, const char *file, const char *key, struct json_text *out,
		      struct buffer *text, const cJSON **array)
{
	const cJSON *found;
	int rc = json_text_parse(out, text, file, draft->diagnostics);

	if (rc < 0)
		return rc == -EBADMSG ? 0 : rc;
	found = cJSON_GetObjectItemCaseSensitive(out->root, key);
	if (cJSON_IsArray(found))
		*array = found;
	else
		diagnostics_add(draft->diagnostics, -EINVAL, file, 1,
				"must be {\"%s\": [...]} at the top level", key);
	return 0;
}

int draft_read_text(const struct draft *draft, const char *name, struct buffer *out)
{
	const struct info_build_options *options = draft->options;
	char path[PATH_MAX];

	for (uint32_t n = 0; n < options->instead_count; n++) {
		const struct info_text_instead *instead = &options->instead[n];

		if (strcmp(instead->name, name) != 0)
			continue;
		if (!instead->text.data)
			return -ENOENT;
		buffer_put(out, instead->text.data, instead->text.size);
		return out->error;
	}
	if (!draft_path(draft, path, sizeof(path), name))
		return -ENAMETOOLONG;
	return buffer_read_file(out, path);
}

int draft_read_json(struct draft *draft, const char *file, const char *key, struct json_text *out,
		    const cJSON **array)
{
	struct buffer text;
	int rc;

	*out = (struct json_text){ 0 };
	*array = NULL;
	buffer_init(&text, INFO_PARTS_FILE_BYTES_MAX);
	rc = draft_read_text(draft, file, &text);
	if (rc == -ENAMETOOLONG)
		return rc;
	if (rc == 0) {
		rc = parse_json(draft, file, key, out, &text, array);
	} else if (rc == -ENOENT) {
		rc = 0; /* there may be no parts or tours yet */
	} else if (rc != -ENOMEM) {
		diagnostics_add(draft->diagnostics, -EINVAL, file, 0, "cannot be read: %s",
				strerror(-rc));
		rc = 0;
	}
	buffer_finish(&text);
	return rc;
}

int draft_find_part(const struct draft *draft, const char *id)
{
	for (uint32_t i = 0; i < draft->part_count; i++)
		if (strcmp(draft->parts[i].id, id) == 0)
			return (int)i;
	return -1;
}

int draft_find_tour(const struct draft *draft, const char *id)
{
	for (uint32_t i = 0; i < draft->tour_count; i++)
		if (strcmp(draft->tours[i].id, id) == 0)
			return (int)i;
	return -1;
}

bool draft_has_faces(const struct draft *draft)
{
	for (uint32_t i = 0; i < draft->part_count; i++)
		if (draft->parts[i].faces_file)
			return true;
	return false;
}

bool draft_path(const struct draft *draft, char *path, size_t path_bytes, const char *name)
{
	int n = snprintf(path, path_bytes, "%s/%s", draft->options->folder, name);

	return n > 0 && (size_t)n < path_bytes;
}

/* Accepts only files directly in pictures/: no parent folder, no sub-folder, no hidden file. */
static bool is_picture_name(const char *name)
{
	static const char folder[] = "pictures/";
	const char *rest = name + sizeof(folder) - 1;

	if (strncmp(name, folder, sizeof(folder) - 1) != 0)
		return false;
	return *rest && *rest != '.' && strlen(rest) <= 200 && !strpbrk(rest, "/\\\"<>?#%");
}

static void skim_picture(struct draft *draft, struct draft_picture *picture, const char *file,
			 unsigned line)
{
	uint8_t start[4] = { 0 };
	char path[PATH_MAX];
	int fd = draft_path(draft, path, sizeof(path), picture->name) ? open_regular(path)
								      : -ENAMETOOLONG;

	picture->damaged = true; /* until its start was seen */
	if (fd < 0) {
		diagnostics_add(draft->diagnostics, -EINVAL, file, line,
				"picture \"%s\" is not there: add the file, or correct the name",
				picture->name);
	} else if (bytes_read_at(fd, start, sizeof(start), 0) < 0 ||
		   (memcmp(start, "\x89PNG", 4) != 0 && memcmp(start, "\xff\xd8\xff", 3) != 0)) {
		diagnostics_add(draft->diagnostics, -EINVAL, picture->name, 0,
				"is not a complete JPEG or PNG picture: save it again as one");
	} else {
		picture->damaged = false;
		picture->media_type = start[0] == 0x89 ? "image/png" : "image/jpeg";
		picture->width_px = picture->height_px = 1;
	}
	if (fd >= 0)
		close(fd);
}

static void measure_picture(struct draft *draft, struct draft_picture *picture, const char *file,
			    unsigned line)
{
	struct picture decoded = { 0 };
	struct buffer bytes;
	char path[PATH_MAX];
	int rc = -ENAMETOOLONG;

	if (draft->options->skims_pictures) {
		skim_picture(draft, picture, file, line);
		return;
	}
	picture->damaged = true; /* until it was decoded */
	buffer_init(&bytes, OBJECT_BYTES_MAX);
	if (draft_path(draft, path, sizeof(path), picture->name))
		rc = buffer_read_file(&bytes, path);
	if (rc == -ENOENT) {
		diagnostics_add(draft->diagnostics, -EINVAL, file, line,
				"picture \"%s\" is not there: add the file, or correct the name",
				picture->name);
	} else if (rc == -EFBIG) {
		diagnostics_add(draft->diagnostics, -EINVAL, picture->name, 0,
				"picture is larger than %u MB: save it smaller",
				OBJECT_BYTES_MAX >> 20);
	} else if (rc < 0) {
		diagnostics_add(draft->diagnostics, -EINVAL, picture->name, 0, "cannot be read: %s",
				strerror(-rc));
	} else if ((rc = picture_decode_for_page(&decoded, buffer_bytes(&bytes))) == -EFBIG) {
		diagnostics_add(draft->diagnostics, -EINVAL, picture->name, 0,
				"picture is larger than %d pixels a side, which terminals do not "
				"show: save it smaller",
				PICTURE_PAGE_SIDE_MOST_PX);
	} else if (rc < 0) {
		diagnostics_add(draft->diagnostics, -EINVAL, picture->name, 0,
				"is not a complete JPEG or PNG picture: save it again as one");
	} else {
		picture->damaged = false;
		picture->media_type = bytes.data[0] == 0x89 ? "image/png" : "image/jpeg";
		picture->hash = hash_of(buffer_bytes(&bytes));
		picture->size = (uint32_t)bytes.size;
		picture->width_px = decoded.width;
		picture->height_px = decoded.height;
	}
	picture_finish(&decoded);
	buffer_finish(&bytes);
}

int draft_add_picture(struct draft *draft, const char *name, const char *file, unsigned line)
{
	struct draft_picture *picture;

	for (uint32_t i = 0; i < draft->picture_count; i++)
		if (strcmp(draft->pictures[i].name, name) == 0)
			return draft->pictures[i].damaged ? -1 : (int)i;
	if (!is_picture_name(name)) {
		diagnostics_add(draft->diagnostics, -EINVAL, file, line,
				"picture \"%.80s\": write it as \"pictures/NAME\", a file of the "
				"content folder; nothing is loaded from elsewhere",
				name);
		return -1;
	}
	if (ARRAY_RESERVE(draft->pictures, draft->picture_room, draft->picture_count + 1,
			  INT32_MAX) < 0)
		return -ENOMEM;
	picture = &draft->pictures[draft->picture_count];
	*picture = (struct draft_picture){ .name = strdup(name) };
	if (!picture->name)
		return -ENOMEM;
	draft->picture_count++;
	measure_picture(draft, picture, file, line);
	return picture->damaged ? -1 : (int)draft->picture_count - 1;
}
