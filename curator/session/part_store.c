/* Reads and changes parts.json and the lists of faces as documents. */
#include "curator/session/part_store.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/json_tree.h"
#include "curator/store/parts_file.h"

enum { FACES_BYTES_MAX = DOCUMENT_BYTES_MAX };

static int fail(struct diagnostics *diagnostics, int rc, const char *file)
{
	return diagnostics_add(diagnostics, rc, file, 0, "%s", strerror(-rc));
}

/* Returns the file of a part's list of faces, borrowed. NULL: its region is another kind. */
static const char *faces_file(const cJSON *part)
{
	const cJSON *region = cJSON_GetObjectItemCaseSensitive(part, "region"),
		    *kind = cJSON_GetObjectItemCaseSensitive(region, "kind"),
		    *file = cJSON_GetObjectItemCaseSensitive(region, "file");

	return cJSON_IsString(kind) && strcmp(kind->valuestring, "faces") == 0 &&
			       cJSON_IsString(file)
		       ? file->valuestring
		       : NULL;
}

/* The list of faces that a part is saved to. */
static void name_faces(const char *id, char name[DOCUMENT_NAME_BYTES])
{
	snprintf(name, DOCUMENT_NAME_BYTES, "regions/%s.faces", id);
}

/* A list of faces means others than those of the mesh that is marked on. */
static int refuse_other_scans(const struct site *site, struct diagnostics *diagnostics)
{
	if (!site_has_other_scans(site))
		return 0;
	return diagnostics_add(
		diagnostics, -EINVAL, NULL, 0,
		"the scans have been replaced since this program was started, so what is marked here "
		"would be other faces: whoever administers gopura-curator must start it again");
}

/* ---- the list */

static const char *title_of(const struct site *site, const cJSON *part)
{
	const cJSON *titles = cJSON_GetObjectItemCaseSensitive(part, "title");

	for (uint32_t n = 0; n < site->content.language_count; n++) {
		const cJSON *title =
			cJSON_GetObjectItemCaseSensitive(titles, site->content.languages[n]);

		if (cJSON_IsString(title))
			return title->valuestring;
	}
	return "";
}

static void add_row(const struct site *site, cJSON *rows, const cJSON *part)
{
	const cJSON *id = cJSON_GetObjectItemCaseSensitive(part, "id"),
		    *titles = cJSON_GetObjectItemCaseSensitive(part, "title");
	cJSON *row = cJSON_IsString(id) ? cJSON_CreateObject() : NULL;

	if (!row)
		return;
	cJSON_AddStringToObject(row, "id", id->valuestring);
	cJSON_AddStringToObject(row, "title", title_of(site, part));
	if (cJSON_IsObject(titles))
		json_add(row, "titles", cJSON_Duplicate(titles, true));
	else
		cJSON_AddObjectToObject(row, "titles");
	cJSON_AddBoolToObject(row, "faces", faces_file(part) != NULL);
	json_append(rows, row);
}

int part_store_list(struct site *site, struct buffer *out, struct diagnostics *diagnostics)
{
	cJSON *rows = cJSON_CreateArray();
	struct parts_file parts;
	const cJSON *part;
	char *text = NULL;
	int rc = parts_file_read(&parts, site->documents, diagnostics);

	if (rc == 0) {
		cJSON_ArrayForEach(part, parts_file_list(&parts)) add_row(site, rows, part);
		text = json_line(rows);
		rc = text ? 0 : fail(diagnostics, -ENOMEM, PARTS_FILE);
	}
	if (rc == 0)
		buffer_put_text(out, text);
	cJSON_free(text);
	cJSON_Delete(rows);
	parts_file_finish(&parts);
	return rc;
}

/* ---- saving */

/* Returns the scan on which the whole region lies, or -EINVAL. */
static int scan_of(const struct site *site, const struct region_set *set,
		   struct diagnostics *diagnostics)
{
	const struct mesh *mesh = site->mesh;
	uint32_t triangle = 0;
	int found = -1;

	for (uint32_t scan = 0; scan < mesh->scan_count; scan++) {
		const uint32_t end = triangle + mesh->scans[scan].triangle_count;
		bool any = false;

		for (; triangle < end && !any; triangle++)
			any = region_set_has(set, triangle);
		triangle = end;
		if (any && found >= 0)
			return diagnostics_add(diagnostics, -EINVAL, NULL, 0,
					       "the region lies on several scans: save a part for "
					       "each");
		if (any)
			found = (int)scan;
	}
	if (found < 0)
		return diagnostics_add(diagnostics, -EINVAL, NULL, 0,
				       "nothing is marked: mark the part first");
	return found;
}

static void print_faces(struct buffer *out, const struct face_list *faces)
{
	for (uint32_t n = 0; n < faces->count; n++)
		if (faces->ranges[n].first == faces->ranges[n].last)
			buffer_print(out, "%" PRIu32 "\n", faces->ranges[n].first);
		else
			buffer_print(out, "%" PRIu32 "-%" PRIu32 "\n", faces->ranges[n].first,
				     faces->ranges[n].last);
}

/* Appends the text of a list of faces. */
static int write_faces(const struct site *site, const struct region_set *set, uint32_t scan,
		       struct buffer *out, struct diagnostics *diagnostics)
{
	struct face_list faces;
	int rc = region_set_faces(&faces, set, site->mesh, scan);

	print_faces(out, &faces);
	if (rc == 0)
		rc = out->error;
	if (rc < 0)
		fail(diagnostics, rc, NULL);
	else if (faces.count == 0)
		rc = diagnostics_add(diagnostics, -EINVAL, site->content.scans[scan], 0,
				     "its faces have no numbers: only regions of a PLY file can be "
				     "saved");
	face_list_finish(&faces);
	return rc;
}

/* A file that no part names is not written over either. */
static bool is_taken(const struct site *site, const struct parts_file *parts, const char *id)
{
	char name[DOCUMENT_NAME_BYTES], path[CONTENT_PATH_BYTES];

	name_faces(id, name);
	return parts_file_find(parts, id) ||
	       (content_file_path(&site->content, name, path) == 0 && access(path, F_OK) == 0);
}

/* Gets an id that is free: the wanted one, or the first with a number behind it. */
static void find_id(const struct site *site, const struct parts_file *parts, const char *wanted,
		    char id[REQUEST_ID_BYTES])
{
	char number[12];

	snprintf(id, REQUEST_ID_BYTES, "%s", wanted);
	for (unsigned n = 2; is_taken(site, parts, id); n++) {
		const int digits = snprintf(number, sizeof(number), "-%u", n);

		snprintf(id, REQUEST_ID_BYTES, "%.*s%s", REQUEST_ID_BYTES - 1 - digits, wanted,
			 number);
	}
}

/* Returns a new part at the end, which has a card alone, or NULL. */
static cJSON *add_part(const struct parts_file *parts, const char *id)
{
	cJSON *part = cJSON_CreateObject();

	if (!cJSON_AddStringToObject(part, "id", id) || !cJSON_AddFalseToObject(part, "page")) {
		cJSON_Delete(part);
		return NULL;
	}
	return json_append(parts_file_list(parts), part) ? part : NULL;
}

/* Finds the part that is saved, or makes it; *open becomes what is there of it. */
static int get_part(const struct site *site, const struct parts_file *parts,
		    const struct part_to_save *save, struct open_part *open, cJSON **out,
		    struct diagnostics *diagnostics)
{
	if (save->is_new && !*save->title)
		return diagnostics_add(diagnostics, -EINVAL, NULL, 0,
				       "a new part needs a title: write it beside Save");
	if (save->is_new) {
		*open = (struct open_part){ 0 };
		find_id(site, parts, save->id, open->id);
		*out = add_part(parts, open->id);
		return *out ? 0 : fail(diagnostics, -ENOMEM, PARTS_FILE);
	}
	if (strcmp(open->id, save->id) != 0)
		return diagnostics_add(diagnostics, -EINVAL, NULL, 0,
				       "what is marked is not of the part \"%s\": open it first",
				       save->id);
	*out = parts_file_find(parts, save->id);
	return *out ? 0
		    : diagnostics_add(diagnostics, -ENOENT, NULL, 0,
				      "somebody has removed this part: save yours as a new part, "
				      "or leave it");
}

static bool set_region(const struct site *site, cJSON *part, uint32_t scan, const char *file)
{
	const struct content *content = &site->content;
	cJSON *region = cJSON_CreateObject();
	bool good = cJSON_AddStringToObject(region, "kind", "faces") &&
		    cJSON_AddStringToObject(region, "file", file);

	if (good && content->scan_count > 1)
		good = cJSON_AddStringToObject(region, "scan",
					       content->scans[scan] + strlen(content->folder) + 1);
	if (!good) {
		cJSON_Delete(region);
		return false;
	}
	return json_set(part, "region", region);
}

static int set_title(const struct site *site, cJSON *part, const struct part_to_save *save,
		     struct diagnostics *diagnostics)
{
	const char *language = *save->language ? save->language : site->content.languages[0];
	cJSON *titles = cJSON_GetObjectItemCaseSensitive(part, "title");
	const cJSON *now = cJSON_GetObjectItemCaseSensitive(titles, language);
	const char *text = cJSON_IsString(now) ? now->valuestring : "";

	if (!*save->title || strcmp(text, save->title) == 0)
		return 0;
	if (!save->replaces && strcmp(text, save->from) != 0)
		return diagnostics_add(diagnostics, -ESTALE, NULL, 0,
				       "somebody has changed the title meanwhile, to \"%s\"", text);
	if (!cJSON_IsObject(titles)) {
		titles = cJSON_CreateObject();
		if (!json_set(part, "title", titles))
			return fail(diagnostics, -ENOMEM, PARTS_FILE);
	}
	return json_set(titles, language, cJSON_CreateString(save->title))
		       ? 0
		       : fail(diagnostics, -ENOMEM, PARTS_FILE);
}

/* Saves both documents; open->tag is that of the list which was there, and becomes the new one. */
static int save_documents(struct site *site, const struct parts_file *parts, struct bytes faces,
			  const struct part_to_save *save, struct open_part *open,
			  struct diagnostics *diagnostics)
{
	char name[DOCUMENT_NAME_BYTES], what[HISTORY_WHAT_BYTES];
	struct document_change changes[2] = {
		{ .name = name, .text = faces, .base = save->replaces ? NULL : open->tag },
		{ .name = PARTS_FILE },
	};
	struct diagnostics found = { 0 };
	struct buffer text;
	int rc;

	buffer_init(&text, PARTS_FILE_BYTES_MAX);
	name_faces(open->id, name);
	snprintf(what, sizeof(what), "region of %s", open->id);
	rc = json_print(parts->root, &text);
	changes[1].text = buffer_bytes(&text);
	if (rc < 0)
		fail(&found, rc, PARTS_FILE);
	else
		rc = documents_save(site->documents, changes, 2, save->author, what, &found);
	buffer_finish(&text);
	if (rc == -ESTALE)
		diagnostics_add(
			diagnostics, rc, NULL, 0,
			"somebody has marked this part anew meanwhile: replace it (it stays in the history), or save yours as a new part");
	else if (rc < 0)
		diagnostics_add(diagnostics, rc, NULL, 0, "%s", diagnostics_cause(&found, rc));
	else
		snprintf(open->tag, sizeof(open->tag), "%s", changes[0].tag);
	return rc;
}

/* parts is changed. */
static int save_part(struct site *site, const struct parts_file *parts,
		     const struct region_set *set, const struct part_to_save *save,
		     struct open_part *open, struct diagnostics *diagnostics)
{
	char name[DOCUMENT_NAME_BYTES];
	struct buffer faces;
	cJSON *part;
	int scan, rc = refuse_other_scans(site, diagnostics);

	if (rc < 0)
		return rc;
	scan = scan_of(site, set, diagnostics);
	if (scan < 0)
		return scan;
	rc = get_part(site, parts, save, open, &part, diagnostics);
	if (rc < 0)
		return rc;
	name_faces(open->id, name);
	if (!set_region(site, part, (uint32_t)scan, name))
		return fail(diagnostics, -ENOMEM, PARTS_FILE);
	rc = set_title(site, part, save, diagnostics);
	buffer_init(&faces, FACES_BYTES_MAX);
	if (rc == 0)
		rc = write_faces(site, set, (uint32_t)scan, &faces, diagnostics);
	if (rc == 0)
		rc = save_documents(site, parts, buffer_bytes(&faces), save, open, diagnostics);
	buffer_finish(&faces);
	return rc;
}

int part_store_save(struct site *site, const struct region_set *set,
		    const struct part_to_save *save, struct open_part *open,
		    struct diagnostics *diagnostics)
{
	struct open_part saved = *open;
	struct parts_file parts;
	int rc;

	documents_lock(site->documents);
	rc = parts_file_read(&parts, site->documents, diagnostics);
	if (rc == 0)
		rc = save_part(site, &parts, set, save, &saved, diagnostics);
	documents_unlock(site->documents);
	parts_file_finish(&parts);
	if (rc == 0)
		*open = saved;
	return rc;
}

/* ---- opening */

/* Returns the scan that a region names, or 0 if it names none; -EINVAL if there is no such scan. */
static int named_scan(const struct site *site, const cJSON *part, struct diagnostics *diagnostics)
{
	const struct content *content = &site->content;
	const cJSON *scan = cJSON_GetObjectItemCaseSensitive(
		cJSON_GetObjectItemCaseSensitive(part, "region"), "scan");

	if (!cJSON_IsString(scan))
		return 0;
	for (uint32_t n = 0; n < content->scan_count; n++)
		if (strcmp(content->scans[n] + strlen(content->folder) + 1, scan->valuestring) == 0)
			return (int)n;
	return diagnostics_add(diagnostics, -EINVAL, "parts.json", 0,
			       "the part's region names a scan that temple.ini does not");
}

/* Makes these triangles the region. */
static int put_region(struct region_set *set, const uint32_t *triangles, uint32_t count)
{
	region_set_begin(set);
	region_set_put_all(set, false);
	for (uint32_t n = 0; n < count; n++)
		region_set_put(set, triangles[n], true);
	return region_set_commit(set);
}

static int put_faces(const struct site *site, struct region_set *set, const char *file,
		     uint32_t scan, struct diagnostics *diagnostics)
{
	char path[CONTENT_PATH_BYTES];
	struct face_list faces = { 0 };
	uint32_t *triangles = NULL, count;
	int rc = content_file_path(&site->content, file, path);

	if (rc < 0)
		return fail(diagnostics, rc, "parts.json");
	rc = refuse_other_scans(site, diagnostics);
	if (rc == 0)
		rc = face_list_read(&faces, path, file, site->mesh->scans[scan].face_count,
				    diagnostics);
	if (rc == 0)
		rc = face_list_triangles(&triangles, &count, &faces, site->mesh, scan);
	if (rc == 0)
		rc = put_region(set, triangles, count);
	free(triangles);
	face_list_finish(&faces);
	return rc;
}

/* Notes which list of faces a save would replace. */
static int note_open(const struct site *site, const char *id, struct open_part *open,
		     struct diagnostics *diagnostics)
{
	char name[DOCUMENT_NAME_BYTES];
	struct buffer text;
	int rc;

	name_faces(id, name);
	snprintf(open->id, sizeof(open->id), "%s", id);
	buffer_init(&text, FACES_BYTES_MAX);
	rc = documents_read(site->documents, name, &text, open->tag, diagnostics);
	buffer_finish(&text);
	return rc == -ENOENT ? 0 : rc;
}

static int open_part(const struct site *site, const struct parts_file *parts,
		     struct region_set *set, const char *id, struct open_part *open,
		     struct diagnostics *diagnostics)
{
	const cJSON *part = parts_file_find(parts, id);
	const char *file = faces_file(part);
	int rc, scan;

	if (!part)
		return diagnostics_add(diagnostics, -ENOENT, NULL, 0,
				       "there is no part \"%s\": somebody may have removed it", id);
	rc = note_open(site, id, open, diagnostics);
	if (rc < 0)
		return rc;
	if (!file)
		return put_region(set, NULL, 0);
	scan = named_scan(site, part, diagnostics);
	return scan < 0 ? scan : put_faces(site, set, file, (uint32_t)scan, diagnostics);
}

int part_store_open(struct site *site, struct region_set *set, const char *id,
		    struct open_part *open, struct diagnostics *diagnostics)
{
	struct open_part found;
	struct parts_file parts;
	int rc;

	documents_lock(site->documents);
	rc = parts_file_read(&parts, site->documents, diagnostics);
	if (rc == 0)
		rc = open_part(site, &parts, set, id, &found, diagnostics);
	documents_unlock(site->documents);
	parts_file_finish(&parts);
	if (rc == 0)
		*open = found;
	return rc;
}
