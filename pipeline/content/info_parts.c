/* Reads parts.json into parts. */
#include "pipeline/content/info_parts.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/content/info_credits.h"

static const char parts_file[] = "parts.json";

/* ---- fields of a part ---- */

/* Shared by the functions that read one part. */
struct part_reader {
	struct draft *draft;
	struct draft_part *part;
	const cJSON *json;
};

#define report_part(reader, ...)                                                                   \
	diagnostics_add((reader)->draft->diagnostics, -EINVAL, parts_file, (reader)->part->line,   \
			__VA_ARGS__)

static const char *part_name(const struct part_reader *r)
{
	return r->part->id ? r->part->id : "?";
}

static bool is_length(const cJSON *item)
{
	return cJSON_IsNumber(item) && fabs(item->valuedouble) <= DRAFT_FAR_M;
}

static bool read_numbers(const cJSON *array, float *out, int count)
{
	if (!cJSON_IsArray(array) || cJSON_GetArraySize(array) != count)
		return false;
	for (int i = 0; i < count; i++) {
		const cJSON *item = cJSON_GetArrayItem(array, i);

		if (!is_length(item))
			return false;
		out[i] = (float)item->valuedouble;
	}
	return true;
}

static bool read_number(const cJSON *object, const char *key, float *out)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);

	if (!is_length(item))
		return false;
	*out = (float)item->valuedouble;
	return true;
}

static bool read_vector(const struct part_reader *r, const cJSON *object, const char *key,
			float out[3])
{
	if (read_numbers(cJSON_GetObjectItemCaseSensitive(object, key), out, 3))
		return true;
	report_part(r, "part \"%s\": \"%s\" must be three numbers, metres, up to %g: [x, y, z]",
		    part_name(r), key, DRAFT_FAR_M);
	return false;
}

static void read_sphere(struct part_reader *r, const cJSON *json)
{
	struct region *region = &r->part->region;

	region->kind = REGION_SPHERE;
	read_vector(r, json, "centre", region->centre_m);
	if (!read_number(json, "radius", &region->radius_m) || region->radius_m <= 0)
		report_part(r,
			    "part \"%s\": \"radius\" must be a positive number of metres, up to %g",
			    part_name(r), DRAFT_FAR_M);
}

static void read_box(struct part_reader *r, const cJSON *json)
{
	struct region *region = &r->part->region;

	region->kind = REGION_BOX;
	read_vector(r, json, "centre", region->centre_m);
	if (read_vector(r, json, "half", region->half_m) &&
	    !(region->half_m[0] > 0 && region->half_m[1] > 0 && region->half_m[2] > 0))
		report_part(r, "part \"%s\": \"half\" must be positive: half the box's sides",
			    part_name(r));
	if (cJSON_HasObjectItem(json, "turn") && !read_number(json, "turn", &region->turn_deg))
		report_part(r, "part \"%s\": \"turn\" must be a number of degrees", part_name(r));
}

/* Returns twice the area; positive if counter-clockwise. */
static double area_twice(const struct region *region)
{
	double sum = 0;

	for (uint32_t i = 0; i < region->corner_count; i++) {
		const float *a = region->corners_m[i];
		const float *b = region->corners_m[(i + 1) % region->corner_count];

		sum += (double)a[0] * b[1] - (double)b[0] * a[1];
	}
	return sum;
}

static void make_counter_clockwise(struct region *region)
{
	if (area_twice(region) >= 0)
		return;
	for (uint32_t i = 0, j = region->corner_count - 1; i < j; i++, j--) {
		float swap[2];

		memcpy(swap, region->corners_m[i], sizeof(swap));
		memcpy(region->corners_m[i], region->corners_m[j], sizeof(swap));
		memcpy(region->corners_m[j], swap, sizeof(swap));
	}
}

static bool read_corners(struct part_reader *r, const cJSON *corners)
{
	struct region *region = &r->part->region;
	int count = cJSON_IsArray(corners) ? cJSON_GetArraySize(corners) : 0;

	if (count < 3 || count > REGION_CORNERS_MAX) {
		report_part(r, "part \"%s\": a prism needs 3 to %d \"corners\", it has %d",
			    part_name(r), REGION_CORNERS_MAX, count);
		return false;
	}
	for (int i = 0; i < count; i++) {
		if (!read_numbers(cJSON_GetArrayItem(corners, i), region->corners_m[i], 2)) {
			report_part(r,
				    "part \"%s\": corner %d must be two numbers up to %g: [x, y]",
				    part_name(r), i + 1, DRAFT_FAR_M);
			return false;
		}
		region->centre_m[0] += region->corners_m[i][0] / (float)count;
		region->centre_m[1] += region->corners_m[i][1] / (float)count;
	}
	region->corner_count = (uint32_t)count;
	return true;
}

static void read_prism(struct part_reader *r, const cJSON *json)
{
	struct region *region = &r->part->region;

	region->kind = REGION_PRISM;
	if (!read_number(json, "floor", &region->floor_m) ||
	    !read_number(json, "roof", &region->roof_m) || region->roof_m <= region->floor_m)
		report_part(
			r,
			"part \"%s\": \"floor\" and \"roof\" must be heights up to %g, roof above",
			part_name(r), DRAFT_FAR_M);
	region->centre_m[2] = (region->floor_m + region->roof_m) / 2;
	if (!read_corners(r, cJSON_GetObjectItemCaseSensitive(json, "corners")))
		return;
	make_counter_clockwise(region);
	if (area_twice(region) == 0)
		report_part(r, "part \"%s\": the corners enclose no area", part_name(r));
}

/* Keeps the list's names, and lets judge_faces check it. */
static int read_faces(struct part_reader *r, const cJSON *json)
{
	const struct info_build_options *options = r->draft->options;
	const char *file = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "file"));
	const char *scan = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "scan"));
	struct info_faces faces = { .part = part_name(r), .file = file, .scan = scan };
	struct diagnostics diagnostics = { 0 };
	int rc;

	if (!file) {
		report_part(r,
			    "part \"%s\": a region of faces needs a \"file\" that lists them, such "
			    "as \"regions/lintel.faces\"",
			    part_name(r));
		return 0;
	}
	r->part->faces_file = strdup(file);
	r->part->faces_scan = scan ? strdup(scan) : NULL;
	if (!r->part->faces_file || (scan && !r->part->faces_scan))
		return -ENOMEM;
	rc = options->judge_faces ? options->judge_faces(options->faces_data, &faces, &diagnostics)
				  : 0;
	if (rc == -EINVAL)
		report_part(r, "part \"%s\": %s", part_name(r),
			    diagnostics_cause(&diagnostics, rc));
	return rc == -EINVAL ? 0 : rc;
}

static int read_region(struct part_reader *r)
{
	const cJSON *json = cJSON_GetObjectItemCaseSensitive(r->json, "region");
	const cJSON *anchor = cJSON_GetObjectItemCaseSensitive(r->json, "anchor");
	const char *kind = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "kind"));
	bool has_faces = kind && strcmp(kind, "faces") == 0;
	int rc = 0;

	if (has_faces)
		rc = read_faces(r, json);
	else if (!json && anchor)
		r->part->region.kind = REGION_POINT;
	else if (kind && strcmp(kind, "sphere") == 0)
		read_sphere(r, json);
	else if (kind && strcmp(kind, "box") == 0)
		read_box(r, json);
	else if (kind && strcmp(kind, "prism") == 0)
		read_prism(r, json);
	else if (kind && strcmp(kind, "point") == 0)
		read_vector(r, json, "centre", r->part->region.centre_m);
	else
		report_part(r,
			    "part \"%s\": region kind \"%.40s\" is none of point, sphere, box, "
			    "prism, faces",
			    part_name(r), kind ? kind : "");
	memcpy(r->part->anchor_m, r->part->region.centre_m, sizeof(r->part->anchor_m));
	r->part->has_anchor = anchor != NULL;
	if (anchor)
		read_vector(r, r->json, "anchor", r->part->anchor_m);
	if (!json)
		memcpy(r->part->region.centre_m, r->part->anchor_m, sizeof(r->part->anchor_m));
	return rc;
}

static void warn_of_no_text(const struct part_reader *r, const char *key, const char *language)
{
	diagnostics_add(r->draft->diagnostics, 0, parts_file, r->part->line,
			"part \"%s\": its %s is left out, because it is no text by language: write "
			"\"%s\": {\"%s\": \"...\"}",
			part_name(r), key, key, language);
}

/* A card is one paragraph: further ones would be drawn below its edge. NULL: no memory. */
static char *copy_paragraph(const char *text)
{
	char *copy = strdup(text);

	for (char *at = copy; at && *at; at++)
		if (*at == '\n' || *at == '\r')
			*at = ' ';
	return copy;
}

/* Reads {"en": "...", "fr": "..."} into texts indexed by the release's languages. */
static int read_texts(struct part_reader *r, const char *key, char *texts[], bool needed)
{
	const struct info_build_options *options = r->draft->options;
	const cJSON *object = cJSON_GetObjectItemCaseSensitive(r->json, key);

	if (object && !cJSON_IsObject(object))
		warn_of_no_text(r, key, options->languages[0]);
	for (uint32_t i = 0; i < options->language_count; i++) {
		const char *language = options->languages[i];
		const cJSON *value = cJSON_GetObjectItemCaseSensitive(object, language);
		const char *text = cJSON_GetStringValue(value);

		if (value && !text)
			warn_of_no_text(r, key, language);
		if (text && strspn(text, " \t\r\n") == strlen(text))
			text = NULL;
		if (text && !(texts[i] = copy_paragraph(text)))
			return -ENOMEM;
		if (!text && needed)
			diagnostics_add(r->draft->diagnostics, i == 0 ? -EINVAL : 0, parts_file,
					r->part->line,
					"part \"%s\" has no %s in \"%s\"%s: add \"%s\": {\"%s\": "
					"\"...\"}",
					part_name(r), key, language,
					i == 0 ? ", the first language" : "", key, language);
	}
	return 0;
}

bool draft_is_id(const char *id)
{
	size_t size = strlen(id);

	return size > 0 && size <= INFO_ID_BYTES_MAX &&
	       strspn(id, "abcdefghijklmnopqrstuvwxyz0123456789-_") == size;
}

static int read_id(struct part_reader *r)
{
	const char *id = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(r->json, "id"));

	if (!id || !draft_is_id(id))
		report_part(r,
			    "part id \"%.70s\": use 1 to %d of a-z, 0-9, - and _ (it names the "
			    "page's file)",
			    id ? id : "", INFO_ID_BYTES_MAX);
	else if (draft_find_part(r->draft, id) >= 0)
		report_part(r, "part \"%s\" is defined twice: rename or remove one", id);
	r->part->id = strdup(id ? id : "");
	return r->part->id ? 0 : -ENOMEM;
}

static int read_thumbnail(struct part_reader *r)
{
	const char *name =
		cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(r->json, "thumbnail"));

	r->part->thumbnail_picture = -1;
	if (!name)
		return 0;
	r->part->thumbnail = strdup(name);
	if (!r->part->thumbnail)
		return -ENOMEM;
	r->part->thumbnail_picture = draft_add_picture(r->draft, name, parts_file, r->part->line);
	return r->part->thumbnail_picture == -ENOMEM ? -ENOMEM : 0;
}

/* The documents that follow the part's own page, by name. */
static int read_documents(struct part_reader *r)
{
	const cJSON *list = cJSON_GetObjectItemCaseSensitive(r->json, "documents"), *item;
	struct draft_part *part = r->part;

	if (list && (!cJSON_IsArray(list) || cJSON_GetArraySize(list) > DRAFT_DOCUMENTS_MAX))
		report_part(r, "part \"%s\": \"documents\" must be a list of at most %d names",
			    part_name(r), DRAFT_DOCUMENTS_MAX);
	cJSON_ArrayForEach(item, list)
	{
		const char *name = cJSON_GetStringValue(item);
		bool is_new = name && strcmp(name, part->id) != 0;

		for (uint32_t n = 0; is_new && n < part->document_count; n++)
			is_new = strcmp(part->documents[n], name) != 0;
		if (part->document_count == DRAFT_DOCUMENTS_MAX)
			break;
		if (!is_new || !draft_is_id(name)) {
			report_part(r,
				    "part \"%s\": \"documents\" has \"%.70s\": name other pages, "
				    "each once, with a-z, 0-9, - and _",
				    part_name(r), name ? name : "?");
			continue;
		}
		part->documents[part->document_count] = strdup(name);
		if (!part->documents[part->document_count])
			return -ENOMEM;
		part->document_count++;
	}
	return 0;
}

static int read_part(struct draft *draft, const cJSON *json, unsigned line, const cJSON *credits)
{
	struct draft_part *part = &draft->parts[draft->part_count];
	struct part_reader reader = { .draft = draft, .part = part, .json = json };
	int rc;

	part->line = line;
	rc = read_id(&reader);
	if (rc < 0)
		return rc;
	draft->part_count++; /* from here on draft_finish frees it */
	part->expects_page = !cJSON_IsFalse(cJSON_GetObjectItemCaseSensitive(json, "page"));
	rc = read_documents(&reader);
	part->without_page = !part->expects_page && part->document_count == 0;
	if (rc == 0)
		rc = read_region(&reader);
	if (rc == 0)
		rc = read_texts(&reader, "title", part->titles, true);
	if (rc == 0)
		rc = read_texts(&reader, "caption", part->captions, false);
	if (rc == 0)
		rc = read_texts(&reader, "reading", part->readings, false);
	if (rc == 0)
		rc = draft_read_credits(draft, part,
					cJSON_GetObjectItemCaseSensitive(json, "credits"), credits);
	if (rc == 0)
		rc = read_thumbnail(&reader);
	return rc;
}

static int read_array(struct draft *draft, const struct json_text *json, const cJSON *array)
{
	const cJSON *credits = cJSON_GetObjectItemCaseSensitive(json->root, "credits");
	int count = cJSON_GetArraySize(array);
	const cJSON *item;
	int rc = 0, i = 0;

	if (count > INFO_PARTS_MAX) {
		diagnostics_add(draft->diagnostics, -EINVAL, parts_file, 0,
				"%d parts: at most %d are possible", count, INFO_PARTS_MAX);
		return 0;
	}
	draft->parts = calloc((size_t)count + 1, sizeof(*draft->parts));
	if (!draft->parts)
		return -ENOMEM;
	cJSON_ArrayForEach(item, array)
	{
		i++;
		if (rc < 0)
			break;
		if (cJSON_IsObject(item))
			rc = read_part(draft, item, json_text_line(json, item), credits);
		else
			diagnostics_add(
				draft->diagnostics, -EINVAL, parts_file, 0,
				"entry %d of \"parts\" is not an object: write {\"id\": ...}", i);
	}
	return rc;
}

int draft_read_parts(struct draft *draft)
{
	struct json_text json;
	const cJSON *array;
	int rc = draft_read_json(draft, parts_file, "parts", &json, &array);

	if (rc == 0 && array)
		rc = read_array(draft, &json, array);
	json_text_finish(&json);
	return rc;
}
