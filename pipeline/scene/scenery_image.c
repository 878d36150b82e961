/* Decodes pictures of scenes; what cannot be read is a warning, and the surface stays plain. */
#include "pipeline/scene/scenery_image.h"

#include <errno.h>
#include <string.h>

#include "base/transient.h"

static int leave_out(struct diagnostics *warnings, const char *file, unsigned line,
		     const char *name, const char *why)
{
	diagnostics_add(warnings, 0, file, line, "the picture %.200s is left out: %s", name, why);
	return 0;
}

int scenery_image_decode(struct picture *out, struct bytes bytes, const char *name,
			 const char *file, unsigned line, struct diagnostics *warnings)
{
	int rc = picture_decode_for_page(out, bytes);

	if (rc == 0)
		return 1;
	if (rc == -ENOMEM)
		return rc;
	return leave_out(warnings, file, line, name,
			 rc == -EFBIG ? "it is over 4096 pixels wide or high; make it smaller"
				      : "it is neither JPEG nor PNG, or damaged; save it anew");
}

int scenery_image_read(struct picture *out, int fd, const char *name, const char *file,
		       unsigned line, struct diagnostics *warnings)
{
	struct buffer bytes;
	int rc = fd;

	*out = (struct picture){ 0 };
	if (fd < 0)
		return leave_out(warnings, file, line, name,
				 fd == -ENOENT ? "it is not there; put it beside the file"
					       : strerror(-fd));
	buffer_init(&bytes, SCENERY_IMAGE_BYTES_MAX);
	rc = buffer_read_fd(&bytes, fd);
	if (rc == 0)
		rc = scenery_image_decode(out, buffer_bytes(&bytes), name, file, line, warnings);
	else if (rc != -ENOMEM && is_transient(rc))
		diagnostics_add(warnings, rc, file, line,
				"the picture %.200s cannot be read: %s; try again", name,
				strerror(-rc));
	else if (rc != -ENOMEM)
		rc = leave_out(warnings, file, line, name,
			       rc == -EFBIG ? "it is over 64 MiB; make it smaller" : strerror(-rc));
	buffer_finish(&bytes);
	return rc;
}
