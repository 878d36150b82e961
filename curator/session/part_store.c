/* Reads and writes parts.json with cJSON, which keeps what it does not know. */
#include "curator/session/part_store.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { PARTS_BYTES_MAX = 64 << 20, FACES_BYTES_MAX = 256 << 20 };

static int fail(struct diagnostics *diagnostics, int rc, const char *file)
{
	return diagnostics_add(diagnostics, rc, file, 0, "%s", strerror(-rc));
}

/* *out is owned by the caller (cJSON_Delete); an empty object if there is no file. */
static int read_parts(const struct site *site, cJSON **out, struct diagnostics *diagnostics)
{
	char path[CONTENT_PATH_BYTES];
	struct buffer text;
	int rc = content_file_path(&site->content, "parts.json", path);

	*out = NULL;
	buffer_init(&text, PARTS_BYTES_MAX);
	if (rc == 0)
		rc = buffer_read_file(&text, path);
	if (rc == 0)
		*out = cJSON_ParseWithLength((const char *)text.data, text.size);
	else if (rc == -ENOENT)
		*out = cJSON_CreateObject();
	else
		fail(diagnostics, rc, "parts.json");
	buffer_finish(&text);
	if ((rc == 0 || rc == -ENOENT) && !cJSON_IsObject(*out))
		rc = diagnostics_add(diagnostics, -EINVAL, "parts.json", 0,
				     "is not valid: 'gopura-content build' names the line");
	if (rc == 0 || rc == -ENOENT)
		return 0;
	cJSON_Delete(*out);
	*out = NULL;
	return rc;
}

static cJSON *find_part(const cJSON *root, const char *id)
{
	cJSON *part;

	cJSON_ArrayForEach(part, cJSON_GetObjectItemCaseSensitive(root, "parts"))
	{
		const cJSON *its = cJSON_GetObjectItemCaseSensitive(part, "id");

		if (cJSON_IsString(its) && strcmp(its->valuestring, id) == 0)
			return part;
	}
	return NULL;
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
	const cJSON *id = cJSON_GetObjectItemCaseSensitive(part, "id");
	cJSON *row = cJSON_IsString(id) ? cJSON_CreateObject() : NULL;

	if (!row)
		return;
	cJSON_AddStringToObject(row, "id", id->valuestring);
	cJSON_AddStringToObject(row, "title", title_of(site, part));
	cJSON_AddBoolToObject(row, "faces", faces_file(part) != NULL);
	cJSON_AddItemToArray(rows, row);
}

int part_store_list(struct site *site, struct buffer *out, struct diagnostics *diagnostics)
{
	cJSON *root, *rows = cJSON_CreateArray();
	const cJSON *part;
	char *text = NULL;
	int rc;

	pthread_mutex_lock(&site->saving);
	rc = read_parts(site, &root, diagnostics);
	pthread_mutex_unlock(&site->saving);
	if (rc == 0) {
		cJSON_ArrayForEach(part, cJSON_GetObjectItemCaseSensitive(root, "parts"))
			add_row(site, rows, part);
		text = cJSON_PrintUnformatted(rows);
		rc = text ? 0 : fail(diagnostics, -ENOMEM, "parts.json");
	}
	if (rc == 0)
		buffer_put_text(out, text);
	cJSON_free(text);
	cJSON_Delete(rows);
	cJSON_Delete(root);
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

static int write_faces(const struct site *site, const struct region_set *set, uint32_t scan,
		       const char *name, struct diagnostics *diagnostics)
{
	char path[CONTENT_PATH_BYTES];
	struct face_list faces;
	struct buffer text;
	int rc = region_set_faces(&faces, set, site->mesh, scan);

	buffer_init(&text, FACES_BYTES_MAX);
	print_faces(&text, &faces);
	if (rc == 0)
		rc = text.error;
	if (rc == 0)
		rc = content_file_path(&site->content, "regions", path);
	if (rc == 0 && mkdir(path, 0777) < 0 && errno != EEXIST)
		rc = -errno;
	if (rc == 0)
		rc = content_file_path(&site->content, name, path);
	if (rc < 0)
		fail(diagnostics, rc, name);
	else if (faces.count == 0)
		rc = diagnostics_add(diagnostics, -EINVAL, site->content.scans[scan], 0,
				     "its faces have no numbers: only regions of a PLY file can be "
				     "saved");
	else if ((rc = bytes_write_file(buffer_bytes(&text), path)) < 0)
		fail(diagnostics, rc, name);
	buffer_finish(&text);
	face_list_finish(&faces);
	return rc;
}

/* cJSON's own replace functions add nothing that is missing. */
static bool set_item(cJSON *object, const char *key, cJSON *item)
{
	if (!item)
		return false;
	if (cJSON_GetObjectItemCaseSensitive(object, key))
		return cJSON_ReplaceItemInObjectCaseSensitive(object, key, item);
	return cJSON_AddItemToObject(object, key, item);
}

/* Returns the part, which is new, and has a card alone, if there is none of that id. NULL: no
 * memory is left. */
static cJSON *get_part(cJSON *root, const char *id)
{
	cJSON *part = find_part(root, id), *parts;

	if (part)
		return part;
	parts = cJSON_GetObjectItemCaseSensitive(root, "parts");
	if (!parts)
		parts = cJSON_AddArrayToObject(root, "parts");
	part = cJSON_CreateObject();
	if (!cJSON_AddStringToObject(part, "id", id) || !cJSON_AddFalseToObject(part, "page") ||
	    !cJSON_AddItemToArray(parts, part)) {
		cJSON_Delete(part);
		return NULL;
	}
	return part;
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
	return set_item(part, "region", region);
}

static bool set_title(cJSON *part, const char *language, const char *title)
{
	cJSON *titles = cJSON_GetObjectItemCaseSensitive(part, "title");

	if (!cJSON_IsObject(titles)) {
		titles = cJSON_CreateObject();
		if (!set_item(part, "title", titles))
			return false;
	}
	return set_item(titles, language, cJSON_CreateString(title));
}

static int write_parts(const struct site *site, const cJSON *root, struct diagnostics *diagnostics)
{
	char path[CONTENT_PATH_BYTES], *text = cJSON_Print(root);
	struct buffer file;
	int rc = content_file_path(&site->content, "parts.json", path);

	buffer_init(&file, PARTS_BYTES_MAX);
	if (text) {
		buffer_put_text(&file, text);
		buffer_put_u8(&file, '\n');
	}
	if (rc == 0)
		rc = text ? file.error : -ENOMEM;
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&file), path);
	if (rc < 0)
		fail(diagnostics, rc, "parts.json");
	buffer_finish(&file);
	cJSON_free(text);
	return rc;
}

/* root is changed. */
static int save(const struct site *site, cJSON *root, const struct region_set *set, const char *id,
		const char *title, const char *language, struct diagnostics *diagnostics)
{
	const cJSON *parts = cJSON_GetObjectItemCaseSensitive(root, "parts");
	char name[CONTENT_PATH_BYTES];
	cJSON *part;
	int rc, scan = scan_of(site, set, diagnostics);

	if (scan < 0)
		return scan;
	if (parts && !cJSON_IsArray(parts))
		return diagnostics_add(diagnostics, -EINVAL, "parts.json", 0,
				       "\"parts\" is not a list");
	if (!find_part(root, id) && !*title)
		return diagnostics_add(diagnostics, -EINVAL, NULL, 0,
				       "a new part needs a title: write it beside Save");
	snprintf(name, sizeof(name), "regions/%s.faces", id);
	rc = write_faces(site, set, (uint32_t)scan, name, diagnostics);
	if (rc < 0)
		return rc;
	part = get_part(root, id);
	if (!part || !set_region(site, part, (uint32_t)scan, name) ||
	    (*title && !set_title(part, *language ? language : site->content.languages[0], title)))
		return fail(diagnostics, -ENOMEM, "parts.json");
	return write_parts(site, root, diagnostics);
}

int part_store_save(struct site *site, const struct region_set *set, const char *id,
		    const char *title, const char *language, struct diagnostics *diagnostics)
{
	cJSON *root;
	int rc;

	pthread_mutex_lock(&site->saving);
	rc = read_parts(site, &root, diagnostics);
	if (rc == 0)
		rc = save(site, root, set, id, title, language, diagnostics);
	pthread_mutex_unlock(&site->saving);
	cJSON_Delete(root);
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

static int put_faces(const struct site *site, struct region_set *set, const char *file,
		     uint32_t scan, struct diagnostics *diagnostics)
{
	char path[CONTENT_PATH_BYTES];
	struct face_list faces = { 0 };
	uint32_t *triangles = NULL, count;
	int rc = content_file_path(&site->content, file, path);

	if (rc < 0)
		return fail(diagnostics, rc, "parts.json");
	rc = face_list_read(&faces, path, file, site->mesh->scans[scan].face_count, diagnostics);
	if (rc == 0)
		rc = face_list_triangles(&triangles, &count, &faces, site->mesh, scan);
	if (rc == 0) {
		region_set_begin(set);
		region_set_put_all(set, false);
		for (uint32_t n = 0; n < count; n++)
			region_set_put(set, triangles[n], true);
		rc = region_set_commit(set);
	}
	free(triangles);
	face_list_finish(&faces);
	return rc;
}

static int open_part(const struct site *site, const cJSON *root, struct region_set *set,
		     const char *id, struct diagnostics *diagnostics)
{
	const cJSON *part = find_part(root, id);
	const char *file = faces_file(part);
	int scan;

	if (!part)
		return diagnostics_add(diagnostics, -ENOENT, "parts.json", 0, "has no part \"%s\"",
				       id);
	if (!file)
		return diagnostics_add(
			diagnostics, -EINVAL, "parts.json", 0,
			"the region of \"%s\" is a shape, not a list of faces: mark it "
			"anew",
			id);
	scan = named_scan(site, part, diagnostics);
	return scan < 0 ? scan : put_faces(site, set, file, (uint32_t)scan, diagnostics);
}

int part_store_open(struct site *site, struct region_set *set, const char *id,
		    struct diagnostics *diagnostics)
{
	cJSON *root;
	int rc;

	pthread_mutex_lock(&site->saving);
	rc = read_parts(site, &root, diagnostics);
	if (rc == 0)
		rc = open_part(site, root, set, id, diagnostics);
	pthread_mutex_unlock(&site->saving);
	cJSON_Delete(root);
	return rc;
}
