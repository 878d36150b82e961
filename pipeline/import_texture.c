#include "pipeline/import_parts.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "format/picture.h"

enum { PICTURE_FILE_MOST = 1 << 29 };

int import_texture_plain(struct mesh_texture *out, const uint8_t plain[3])
{
	out->rgb = malloc(3);
	if (!out->rgb)
		return -ENOMEM;
	memcpy(out->rgb, plain, 3);
	out->width = out->height = 1;
	return 0;
}

static int from_picture(struct mesh_texture *out, const struct picture *picture)
{
	size_t pixels = (size_t)picture->width * picture->height;

	out->rgb = malloc(pixels * 3);
	if (!out->rgb)
		return -ENOMEM;
	out->width = picture->width;
	out->height = picture->height;
	for (size_t i = 0; i < pixels; i++)
		memcpy(out->rgb + 3 * i, picture->rgba + 4 * i, 3);
	return 0;
}

static int tolerate(struct mesh_texture *out, const char *scan_path, const char *name,
		    const char *why, const uint8_t plain[3], struct import_report *report)
{
	fault_set(&report->warning, 0, "%s: its picture '%.200s' %s; a plain colour stands for it",
		  scan_path, name, why);
	return import_texture_plain(out, plain);
}

int import_texture_bytes(struct mesh_texture *out, const char *scan_path, const char *name,
			 struct bytes file, const uint8_t plain[3], struct import_report *report)
{
	struct picture picture;
	int rc = picture_decode(&picture, file);

	if (rc == -EFBIG)
		return tolerate(out, scan_path, name, "is over 16384 pixels a side", plain, report);
	if (rc == -EBADMSG)
		return tolerate(out, scan_path, name,
				"is damaged, or no JPEG or PNG that can be read", plain, report);
	if (rc == 0)
		rc = from_picture(out, &picture);
	picture_finish(&picture);
	if (rc == 0)
		report->textures++;
	return rc;
}

/* Relative, and never above the folder it starts in. */
static bool stays_below(const char *name)
{
	if (name[0] == '/' || strchr(name, ':'))
		return false;
	for (const char *c = name; *c;) {
		size_t length = strcspn(c, "/");

		if (length == 2 && c[0] == '.' && c[1] == '.')
			return false;
		c += length;
		c += *c == '/';
	}
	return true;
}

/* The scan's folder, then name. */
static int path_beside(char out[PATH_MAX], const char *scan_path, const char *name)
{
	const char *slash = strrchr(scan_path, '/');
	int folder = slash ? (int)(slash - scan_path) + 1 : 0;

	return snprintf(out, PATH_MAX, "%.*s%s", folder, scan_path, name) < PATH_MAX
		       ? 0
		       : -ENAMETOOLONG;
}

static int find_picture(struct buffer *file, const char *scan_path, const char *name)
{
	char clean[PATH_MAX], path[PATH_MAX];
	const char *last;
	int rc = -ENOENT;

	if (strlen(name) >= sizeof(clean) || name[0] == '\0')
		return -ENOENT;
	snprintf(clean, sizeof(clean), "%s", name);
	for (char *c = clean; *c; c++)
		if (*c == '\\')
			*c = '/';
	if (stays_below(clean) && path_beside(path, scan_path, clean) == 0)
		rc = buffer_read_file(file, path);
	last = strrchr(clean, '/');
	if (rc < 0 && rc != -ENOMEM && last && last[1] && strcmp(last, "/..") != 0 &&
	    path_beside(path, scan_path, last + 1) == 0)
		rc = buffer_read_file(file, path);
	return rc;
}

int import_texture(struct mesh_texture *out, const char *scan_path, const char *name,
		   const uint8_t plain[3], struct import_report *report)
{
	struct buffer file;
	int rc;

	buffer_init(&file, PICTURE_FILE_MOST);
	rc = find_picture(&file, scan_path, name);
	if (rc == -ENOENT)
		rc = tolerate(out, scan_path, name, "is not beside it", plain, report);
	else if (rc < 0 && rc != -ENOMEM)
		rc = tolerate(out, scan_path, name, strerror(-rc), plain, report);
	else if (rc == 0)
		rc = import_texture_bytes(out, scan_path, name, buffer_bytes(&file), plain, report);
	buffer_finish(&file);
	return rc;
}
