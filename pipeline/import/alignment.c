/* Parses MeshLab's alignments and projects and Stanford's registrations, takes the models of
 * manifests, and checks names, matrices and files. */
#include "pipeline/import/alignment.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <libxml/parser.h>
#include <libxml/tree.h>

#include "base/array.h"
#include "base/bytes.h"
#include "base/json_text.h"
#include "base/uri.h"
#include "pipeline/import/alignment_conf.h"
#include "pipeline/import/import_files.h"
#include "pipeline/import/manifest.h"

enum { FILE_BYTES_MAX = 16 << 20, SHOWN_BYTES = 60 };

/* One reading of a file. */
struct reading {
	const char *path;
	struct alignment *alignment;
	struct diagnostics *diagnostics;
	unsigned line; /* of an alignment, from 1 */
	char *at;      /* the next line of an alignment */
};

bool alignment_is_named(const char *name)
{
	return import_has_extension(name, ".aln") || import_has_extension(name, ".mlp") ||
	       import_has_extension(name, ".conf") || import_has_extension(name, ".json");
}

void alignment_finish(struct alignment *alignment)
{
	if (!alignment)
		return;
	for (uint32_t i = 0; i < alignment->count; i++)
		free(alignment->scans[i].path);
	free(alignment->scans);
	diagnostics_finish(&alignment->left_out);
	*alignment = (struct alignment){ 0 };
}

/* ---- one scan */

/* Returns whether a name stays below the folder: neither absolute nor with "..". */
static bool stays_below(const char *name)
{
	if (name[0] == '/' || strchr(name, ':'))
		return false;
	for (const char *c = name; *c; c += *c == '/') {
		const size_t length = strcspn(c, "/");

		if (length == 2 && c[0] == '.' && c[1] == '.')
			return false;
		c += length;
	}
	return true;
}

/* Checks the name of a scan and joins it with the folder of the file. *out is owned by the caller.
 */
static int join_path(const struct reading *reading, unsigned line, const char *name, char **out)
{
	const char *slash = strrchr(reading->path, '/');
	const int folder_length = slash ? (int)(slash - reading->path) + 1 : 0;
	char path[PATH_MAX], *c;

	if (!name[0])
		return diagnostics_add(reading->diagnostics, -EBADMSG, reading->path, line,
				       "a scan without a file name; save it again from MeshLab");
	while (name[0] == '.' && (name[1] == '/' || name[1] == '\\'))
		name += 2;
	if (snprintf(path, sizeof(path), "%.*s%s", folder_length, reading->path, name) >=
	    (int)sizeof(path))
		return diagnostics_add(reading->diagnostics, -ENAMETOOLONG, reading->path, line,
				       "the name of a scan is too long; shorten it");
	for (c = path + folder_length; *c; c++)
		if (*c == '\\')
			*c = '/';
	if (!stays_below(path + folder_length))
		return diagnostics_add(reading->diagnostics, -EXDEV, reading->path, line,
				       "scan %.*s lies outside the folder of this file; copy it "
				       "there and write its name only",
				       SHOWN_BYTES, name);
	if (alignment_is_named(path))
		return diagnostics_add(reading->diagnostics, -EINVAL, reading->path, line,
				       "%.*s is no scan; name its scans here", SHOWN_BYTES, name);
	*out = strdup(path);
	return *out ? 0 : -ENOMEM;
}

static int add_scan(struct reading *reading, unsigned line, const char *name,
		    const double matrix[16])
{
	struct alignment *alignment = reading->alignment;
	struct alignment_scan scan = { .line = line };
	const char *why = transform_set(&scan.transform, matrix);
	int rc;

	if (why)
		return diagnostics_add(reading->diagnostics, -EBADMSG, reading->path, line,
				       "the matrix of scan %.*s %s; align the scans and save again",
				       SHOWN_BYTES, name, why);
	rc = ARRAY_RESERVE(alignment->scans, alignment->room, alignment->count + 1,
			   ALIGNMENT_SCANS_MAX);
	if (rc == -EFBIG)
		return diagnostics_add(reading->diagnostics, rc, reading->path, line,
				       "over %d scans; join some of them into one file",
				       ALIGNMENT_SCANS_MAX);
	if (rc == 0)
		rc = join_path(reading, line, name, &scan.path);
	if (rc == 0)
		alignment->scans[alignment->count++] = scan;
	return rc;
}

/* Reads up to `wanted` numbers apart by white space. Returns how many were read; *end is what
 * follows them: "" if that was all. */
static int read_numbers(const char *text, double *out, int wanted, const char **end)
{
	int count = 0;

	for (; count < wanted; count++) {
		char *after;

		out[count] = strtod(text, &after);
		if (after == text || (*after && !strchr(" \t\r\n", *after)))
			break;
		text = after;
	}
	*end = text + strspn(text, " \t\r\n");
	return count;
}

/* ---- alignments: a count; for each scan its name, a line with # and four rows; then 0 */

/* Returns where the text begins, past the mark that Windows puts before UTF-8. */
static char *past_mark(char *text)
{
	return strncmp(text, "\xef\xbb\xbf", 3) == 0 ? text + 3 : text;
}

/* Returns the next line that is not empty, without white space around it; NULL at the end. */
static char *next_line(struct reading *reading)
{
	while (*reading->at) {
		char *line = reading->at + strspn(reading->at, " \t\r");
		char *end = reading->at + strcspn(reading->at, "\n");

		reading->at = *end ? end + 1 : end;
		reading->line++;
		while (end > line && strchr(" \t\r", end[-1]))
			end--;
		if (end > line) {
			*end = '\0';
			return line;
		}
	}
	return NULL;
}

/* The same, past lines with # */
static char *next_content(struct reading *reading)
{
	char *line;

	do
		line = next_line(reading);
	while (line && line[0] == '#');
	return line;
}

static int ends_early(const struct reading *reading, unsigned long wanted)
{
	return diagnostics_add(reading->diagnostics, -EBADMSG, reading->path, reading->line,
			       "the file ends after %u of the %lu scans that its first line says; "
			       "correct the count, or save it again from MeshLab",
			       reading->alignment->count, wanted);
}

static int read_aln_scan(struct reading *reading, unsigned long wanted)
{
	char *name = next_line(reading), *row;
	const unsigned line = reading->line;
	double matrix[16];
	const char *end;

	if (!name || strcmp(name, "0") == 0)
		return ends_early(reading, wanted);
	for (int r = 0; r < 4; r++) {
		row = next_content(reading);
		if (!row)
			return ends_early(reading, wanted);
		if (read_numbers(row, matrix + 4 * r, 4, &end) != 4 || *end)
			return diagnostics_add(reading->diagnostics, -EBADMSG, reading->path,
					       reading->line,
					       "row %d of the matrix of scan %.*s must be four "
					       "numbers, not '%.*s'",
					       r + 1, SHOWN_BYTES, name, SHOWN_BYTES, row);
	}
	return add_scan(reading, line, name, matrix);
}

static int read_aln(struct reading *reading, char *text)
{
	const char *line;
	char *end = NULL;
	unsigned long count;
	int rc = 0;

	reading->at = past_mark(text);
	line = next_content(reading);
	count = line ? strtoul(line, &end, 10) : 0;
	if (!line || !isdigit((unsigned char)line[0]) || *end || count == 0)
		return diagnostics_add(reading->diagnostics, -EBADMSG, reading->path, reading->line,
				       "must begin with the number of its scans, not '%.*s'",
				       SHOWN_BYTES, line ? line : "");
	while (rc == 0 && reading->alignment->count < count)
		rc = read_aln_scan(reading, count);
	if (rc < 0)
		return rc;
	line = next_content(reading);
	if (line && strcmp(line, "0") != 0)
		return diagnostics_add(reading->diagnostics, -EBADMSG, reading->path, reading->line,
				       "'%.*s' follows the %lu scans that its first line says; "
				       "correct the count",
				       SHOWN_BYTES, line, count);
	return 0;
}

/* ---- registrations: a line for each scan */

/* Of a line with "mesh", for Stanford's own tools, the scan may be missing. Returns 1 if it is
 * there, 0 if not, or a negative errno with a diagnostic: no scan may be called so. */
static int is_there(const struct reading *reading, const char *name)
{
	struct stat status;
	char *path = NULL;
	int rc = join_path(reading, reading->line, name, &path);

	if (rc == 0)
		rc = stat(path, &status) == 0 ? 1 : -errno;
	if (rc == -ENOENT || rc == -ENOTDIR)
		rc = 0;
	else if (rc < 0 && path)
		diagnostics_add(reading->diagnostics, rc, reading->path, reading->line,
				"scan %s: %s; correct that, or remove the line", path,
				strerror(-rc));
	free(path);
	return rc;
}

/* Adds the scan of a line. */
static int add_conf_scan(struct reading *reading, const struct alignment_conf_line *parsed)
{
	const int found = parsed->is_optional ? is_there(reading, parsed->name) : 1;

	if (found == 0)
		return diagnostics_add(&reading->alignment->left_out, 0, reading->path,
				       reading->line, "%.*s is not there and is left out",
				       SHOWN_BYTES, parsed->name);
	return found < 0 ? found : add_scan(reading, reading->line, parsed->name, parsed->matrix);
}

static int read_conf(struct reading *reading, char *text)
{
	struct alignment_conf_line parsed;
	const char *line;
	int rc = 0;

	reading->at = past_mark(text);
	while (rc == 0 && (line = next_line(reading))) {
		rc = alignment_conf_parse(&parsed, line);
		if (rc < 0)
			return diagnostics_add(reading->diagnostics, rc, reading->path,
					       reading->line,
					       "expected: bmesh NAME, three numbers that move it "
					       "and a quaternion x y z w, not '%.*s'",
					       SHOWN_BYTES, line);
		rc = rc > 0 ? add_conf_scan(reading, &parsed) : 0;
	}
	if (rc == 0 && reading->alignment->count == 0)
		rc = diagnostics_add(reading->diagnostics, -EBADMSG, reading->path, 0,
				     "it places no scan (no line begins with bmesh)");
	return rc;
}

/* ---- projects: MeshLabProject, MeshGroup, and an MLMesh with an MLMatrix44 for each scan */

static bool is_element(const xmlNode *node, const char *name)
{
	return node->type == XML_ELEMENT_NODE && strcmp((const char *)node->name, name) == 0;
}

static unsigned line_of(const xmlNode *node)
{
	const long line = xmlGetLineNo(node);

	return line > 0 ? (unsigned)line : 0;
}

/* A layer without a matrix lies where it was scanned. */
static int read_matrix(const struct reading *reading, const xmlNode *layer, const char *name,
		       double matrix[16])
{
	const xmlNode *node = layer->children;
	const char *end;
	char *text;
	int count, rc = 0;

	for (int i = 0; i < 16; i++)
		matrix[i] = i % 5 == 0;
	while (node && !is_element(node, "MLMatrix44"))
		node = node->next;
	if (!node)
		return 0;
	text = (char *)xmlNodeGetContent(node);
	if (!text)
		return -ENOMEM;
	count = read_numbers(text, matrix, 16, &end);
	if (count != 16 || *end)
		rc = diagnostics_add(
			reading->diagnostics, -EBADMSG, reading->path, line_of(node),
			"the matrix of scan %.*s must be 16 numbers, but after %d there is '%.20s'; "
			"save the project again as .mlp",
			SHOWN_BYTES, name, count, end);
	xmlFree(text);
	return rc;
}

/* Some formats hold several layers in one file, which is imported whole, once. */
static bool is_later_layer(const xmlNode *layer)
{
	char *text = (char *)xmlGetProp((xmlNode *)layer, BAD_CAST "idInFile");
	const bool is_later = text && strtol(text, NULL, 10) > 0;

	xmlFree(text);
	return is_later;
}

static int read_layer(struct reading *reading, const xmlNode *layer)
{
	char *name = (char *)xmlGetProp((xmlNode *)layer, BAD_CAST "filename");
	double matrix[16];
	int rc;

	if (!name)
		return diagnostics_add(reading->diagnostics, -EBADMSG, reading->path,
				       line_of(layer),
				       "a layer (MLMesh) without a filename; save it as a file in "
				       "MeshLab, then the project again");
	if (is_later_layer(layer))
		rc = diagnostics_add(
			reading->diagnostics, -EINVAL, reading->path, line_of(layer),
			"%.*s holds several layers; save each as a file of its own in MeshLab, "
			"then the project again",
			SHOWN_BYTES, name);
	else
		rc = read_matrix(reading, layer, name, matrix);
	if (rc == 0)
		rc = add_scan(reading, line_of(layer), name, matrix);
	xmlFree(name);
	return rc;
}

static int read_project(struct reading *reading, const xmlNode *root)
{
	int rc = 0;

	if (!root || !is_element(root, "MeshLabProject"))
		return diagnostics_add(reading->diagnostics, -EBADMSG, reading->path,
				       root ? line_of(root) : 0,
				       "is no MeshLab project: it does not begin with "
				       "<MeshLabProject>");
	for (const xmlNode *group = root->children; group; group = group->next)
		for (const xmlNode *layer = is_element(group, "MeshGroup") ? group->children : NULL;
		     layer && rc == 0; layer = layer->next)
			if (is_element(layer, "MLMesh"))
				rc = read_layer(reading, layer);
	if (rc == 0 && reading->alignment->count == 0)
		rc = diagnostics_add(reading->diagnostics, -EBADMSG, reading->path, 0,
				     "the project has no layer (MLMesh)");
	return rc;
}

static int broken_xml(const struct reading *reading, xmlParserCtxt *parser)
{
	const xmlError *error = xmlCtxtGetLastError(parser);
	const char *message = error && error->message ? error->message : "it is empty";

	return diagnostics_add(reading->diagnostics, -EBADMSG, reading->path,
			       error && error->line > 0 ? (unsigned)error->line : 0,
			       "is not whole as XML: %.*s; save the project again from MeshLab",
			       (int)strcspn(message, "\n"), message);
}

/* Files and addresses that the document names are not followed. Entities, which may stand for more
 * than fits in memory, are refused: MeshLab writes none. */
static int read_mlp(struct reading *reading, struct bytes file)
{
	const int options = XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING;
	xmlParserCtxt *parser = xmlNewParserCtxt();
	xmlDoc *document;
	int rc;

	if (!parser)
		return -ENOMEM;
	document = xmlCtxtReadMemory(parser, (const char *)file.data, (int)file.size, NULL, NULL,
				     options);
	if (!document)
		rc = broken_xml(reading, parser);
	else if (document->intSubset && document->intSubset->entities)
		rc = diagnostics_add(reading->diagnostics, -EBADMSG, reading->path, 0,
				     "declares entities (<!ENTITY ...>); save the project again "
				     "from MeshLab");
	else
		rc = read_project(reading, xmlDocGetRootElement(document));
	xmlFreeDoc(document);
	xmlFreeParserCtxt(parser);
	return rc;
}

/* ---- manifests */

/* Decodes the path of an address. Returns false if it is empty, or too long for a file's name. */
static bool decode_address(const char *address, char out[PATH_MAX])
{
	const size_t size = strcspn(address, "?#");
	char path[PATH_MAX];

	if (size == 0 || size >= sizeof(path))
		return false;
	memcpy(path, address, size);
	path[size] = '\0';
	return uri_decode(out, PATH_MAX, path);
}

static bool is_beside(const struct reading *reading, const char *name)
{
	const char *slash = strrchr(reading->path, '/');
	const int folder_length = slash ? (int)(slash - reading->path) + 1 : 0;
	char path[PATH_MAX];
	struct stat status;

	return name[0] && stays_below(name) && !strchr(name, '\\') &&
	       snprintf(path, sizeof(path), "%.*s%s", folder_length, reading->path, name) <
		       (int)sizeof(path) &&
	       stat(path, &status) == 0 && S_ISREG(status.st_mode);
}

/* Finds the model's file: the longest end of its address that exists beside the manifest. Addresses
 * are never fetched. */
static int add_model(struct reading *reading, const struct manifest_item *item)
{
	const char *address = manifest_id(item->resource);
	double matrix[16] = { [15] = 1 };
	char decoded[PATH_MAX];
	const char *name, *scheme;

	if (!address || !decode_address(address, decoded))
		return diagnostics_add(reading->diagnostics, -EBADMSG, reading->path, item->line,
				       "a model without an address: give it an \"id\" that ends "
				       "with its file's name");
	memcpy(matrix, item->place.rows, sizeof(item->place.rows));
	scheme = strstr(decoded, "://");
	name = scheme ? scheme + 3 + strcspn(scheme + 3, "/") : decoded;
	for (name += strspn(name, "/"); !is_beside(reading, name); name += strspn(name, "/")) {
		const char *slash = strchr(name, '/');

		if (!slash)
			return diagnostics_add(reading->diagnostics, -ENOENT, reading->path,
					       item->line,
					       "model %.300s is not beside the manifest; fetch it "
					       "and put it there as %.100s",
					       address, name);
		name = slash;
	}
	return add_scan(reading, item->line, name, matrix);
}

/* A content folder has one first view; whether it is this one the author decides. */
static void leave_out_camera(struct reading *reading, const struct manifest *manifest,
			     const struct manifest_item *item)
{
	double eye[3], target[3];

	manifest_view(manifest, item, eye, target);
	manifest_z_up(eye, eye);
	manifest_z_up(target, target);
	diagnostics_add(&reading->alignment->left_out, 0, reading->path, item->line,
			"a camera is left out: as the first view write 'start = eye %g %g %g "
			"target %g %g %g' into [view] of temple.ini, if a unit is a metre",
			eye[0], eye[1], eye[2], target[0], target[1], target[2]);
}

static int read_models(struct reading *reading, struct manifest *manifest)
{
	int rc = 0;

	reading->alignment->y_is_up = true;
	reading->alignment->left_out = manifest->left_out;
	manifest->left_out = (struct diagnostics){ 0 };
	for (uint32_t i = 0; i < manifest->count && rc != -EFBIG && rc != -ENOMEM; i++) {
		const struct manifest_item *item = &manifest->items[i];
		int failed = 0;

		if (item->kind == MANIFEST_MODEL)
			failed = add_model(reading, item);
		else if (item->kind == MANIFEST_CAMERA)
			leave_out_camera(reading, manifest, item);
		rc = rc == 0 || failed == -ENOMEM || failed == -EFBIG ? failed : rc;
	}
	if (rc == 0 && reading->alignment->count == 0)
		rc = diagnostics_add(reading->diagnostics, -EBADMSG, reading->path, 1,
				     "its scenes have no model: paint one with an Annotation");
	return rc;
}

static int read_manifest(struct reading *reading, struct buffer *file)
{
	struct json_text json;
	struct manifest manifest = { 0 };
	int rc = json_text_parse(&json, file, reading->path, reading->diagnostics);

	if (rc == 0)
		rc = manifest_read(&manifest, &json, reading->path, reading->diagnostics);
	if (rc == 0)
		rc = read_models(reading, &manifest);
	manifest_finish(&manifest);
	json_text_finish(&json);
	return rc;
}

/* ---- the whole */

static int check_files(const struct reading *reading)
{
	int rc = 0;

	for (uint32_t i = 0; i < reading->alignment->count; i++) {
		const struct alignment_scan *scan = &reading->alignment->scans[i];
		struct stat status;
		int failed = stat(scan->path, &status) < 0 ? -errno : 0;

		if (failed == 0 && !S_ISREG(status.st_mode))
			failed = -EINVAL;
		if (failed < 0)
			rc = diagnostics_add(
				reading->diagnostics, failed, reading->path, scan->line,
				"scan %s: %s; put it there, or correct its name", scan->path,
				failed == -EINVAL ? "not a regular file" : strerror(-failed));
	}
	return rc;
}

int alignment_read(struct alignment *out, const char *path, struct diagnostics *diagnostics)
{
	struct reading reading = { .path = path, .alignment = out, .diagnostics = diagnostics };
	struct buffer file;
	int rc;

	*out = (struct alignment){ 0 };
	buffer_init(&file, FILE_BYTES_MAX);
	rc = buffer_read_file(&file, path);
	buffer_put_u8(&file, 0); /* ends the text of an alignment */
	if (rc == 0)
		rc = file.error;
	if (rc < 0)
		diagnostics_add(diagnostics, rc, path, 0, "%s",
				rc == -EFBIG ? "over 16 MiB; is it an alignment of scans?"
					     : strerror(-rc));
	else if (import_has_extension(path, ".json"))
		rc = read_manifest(&reading, &file);
	else if (import_has_extension(path, ".mlp"))
		rc = read_mlp(&reading, (struct bytes){ file.data, file.size - 1 });
	else if (import_has_extension(path, ".conf"))
		rc = read_conf(&reading, (char *)file.data);
	else
		rc = read_aln(&reading, (char *)file.data);
	if (rc == 0)
		rc = check_files(&reading);
	if (rc == -ENOMEM)
		diagnostics_add(diagnostics, rc, path, 0, "too large for this machine's memory");
	buffer_finish(&file);
	if (rc < 0)
		alignment_finish(out);
	return rc;
}
