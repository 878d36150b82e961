/* Decodes the pictures of a scan into textures. Unusable pictures are replaced by a plain colour
 * with a warning. */
#include "pipeline/import/import_texture.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/transient.h"
#include "format/picture.h"
#include "pipeline/import/import_files.h"

enum { PICTURE_FILE_MAX = 1 << 29 };

static const char too_much[] = "makes the scan's pictures too large in total";

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
	diagnostics_add(&report->warning, 0, scan_path, 0,
			"its picture '%.200s' %s; a plain colour stands for it", name, why);
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
				"is damaged, or not a readable JPEG or PNG file", plain, report);
	if (rc == 0)
		rc = from_picture(out, &picture);
	picture_finish(&picture);
	if (rc == 0)
		report->textures++;
	return rc;
}

static int read_picture(struct buffer *file, int fd)
{
	uint8_t chunk[65536];
	ssize_t got;

	while ((got = read(fd, chunk, sizeof(chunk))) != 0) {
		if (got < 0 && errno == EINTR)
			continue;
		if (got < 0)
			return -errno;
		buffer_put(file, chunk, (size_t)got);
		if (file->error)
			return file->error;
	}
	return 0;
}

/* Counts the decoded picture against the limit. A scan may name a picture many times, and a file of
 * a few bytes may decode to a very large picture. */
static int charge(struct mesh_texture *out, struct import_files *files, const char *name,
		  const uint8_t plain[3], struct import_report *report)
{
	const uint64_t bytes = (uint64_t)out->width * out->height * 3;

	if (files->in_sandbox)
		return 0;
	if (bytes <= files->picture_bytes_left) {
		files->picture_bytes_left -= bytes;
		return 0;
	}
	files->picture_bytes_left = 0; /* no further picture is decoded */
	report->textures--;
	free(out->rgb);
	return tolerate(out, files->scan_path, name, too_much, plain, report);
}

int import_texture(struct mesh_texture *out, struct import_files *files, const char *name,
		   const uint8_t plain[3], struct import_report *report)
{
	const uint32_t textures = report->textures;
	struct buffer file;
	int fd, rc;

	if (!files->in_sandbox && files->picture_bytes_left == 0)
		return tolerate(out, files->scan_path, name, too_much, plain, report);
	fd = import_files_open(files, name);
	rc = fd < 0 ? fd : 0;
	buffer_init(&file, PICTURE_FILE_MAX);
	if (fd >= 0) {
		if (!files->in_sandbox)
			files->picture_bytes_left += files->picture_bytes_per_byte *
						     import_files_count(&files->counted, fd);
		rc = read_picture(&file, fd);
		close(fd);
	}
	if (is_transient(rc))
		import_files_note(&files->failure, rc, name);
	else if (rc < 0)
		rc = tolerate(out, files->scan_path, name, import_files_why(rc), plain, report);
	else
		rc = import_texture_bytes(out, files->scan_path, name, buffer_bytes(&file), plain,
					  report);
	if (rc == 0 && report->textures > textures)
		rc = charge(out, files, name, plain, report);
	buffer_finish(&file);
	return rc;
}
