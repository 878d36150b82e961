/* Decodes pictures of a content folder, and keeps them. */
#include "curator/pages/preview_pictures.h"

#include <stdio.h>
#include <string.h>

#include "format/page.h"

void preview_pictures_init(struct preview_pictures *pictures, const struct content *content)
{
	pictures->content = content;
	pictures->count = 0;
}

void preview_pictures_finish(struct preview_pictures *pictures)
{
	for (uint32_t n = 0; n < pictures->count; n++)
		picture_finish(&pictures->pictures[n]);
	pictures->count = 0;
}

static bool load(const struct content *content, const char *name, struct picture *out)
{
	char path[CONTENT_PATH_BYTES];
	struct buffer file;
	int rc = content_file_path(content, name, path);

	buffer_init(&file, OBJECT_BYTES_MAX);
	if (rc == 0)
		rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = picture_decode_for_page(out, buffer_bytes(&file));
	buffer_finish(&file);
	return rc == 0;
}

bool preview_pictures_get(void *data, const char *name, struct found_picture *out)
{
	struct preview_pictures *pictures = data;
	uint32_t n = 0;

	while (n < pictures->count && strcmp(pictures->names[n], name) != 0)
		n++;
	if (n == pictures->count) {
		if (n == PREVIEW_PICTURES_MAX || strlen(name) >= sizeof(pictures->names[0]) ||
		    !load(pictures->content, name, &pictures->pictures[n]))
			return false;
		snprintf(pictures->names[n], sizeof(pictures->names[n]), "%s", name);
		pictures->count++;
	}
	*out = (struct found_picture){ &pictures->pictures[n], pictures->pictures[n].width,
				       pictures->pictures[n].height };
	return true;
}
