/* Rotates a picture clockwise by quarter turns, as a rotated panel does.
 *
 *   turn_picture QUARTERS IN.png OUT.png */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/picture.h"

/* A quarter clockwise: what was the left edge is the top. *out is owned by the caller. */
static int quarter(struct picture *out, const struct picture *in)
{
	*out = (struct picture){ .width = in->height, .height = in->width };
	out->rgba = malloc((size_t)in->width * in->height * 4);
	if (!out->rgba)
		return -1;
	for (uint32_t y = 0; y < out->height; y++)
		for (uint32_t x = 0; x < out->width; x++)
			memcpy(out->rgba + 4 * ((size_t)y * out->width + x),
			       in->rgba + 4 * ((size_t)(in->height - 1 - x) * in->width + y), 4);
	return 0;
}

static int turn(struct picture *picture, int quarters)
{
	for (int i = 0; i < quarters; i++) {
		struct picture turned;

		if (quarter(&turned, picture) < 0)
			return -1;
		picture_finish(picture);
		*picture = turned;
	}
	return 0;
}

int main(int argc, char **argv)
{
	const int quarters = argc == 4 ? argv[1][0] - '0' : -1;
	struct picture picture = { 0 };
	struct buffer in, out;
	int rc;

	if (quarters < 0 || quarters > 3) {
		fputs("usage: turn_picture QUARTERS IN.png OUT.png\n", stderr);
		return 2;
	}
	buffer_init(&in, 256 << 20);
	buffer_init(&out, 256 << 20);
	rc = buffer_read_file(&in, argv[2]);
	if (rc == 0)
		rc = picture_decode(&picture, buffer_bytes(&in));
	if (rc == 0)
		rc = turn(&picture, quarters);
	if (rc == 0)
		rc = picture_encode_png(&out, &picture);
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&out), argv[3]);
	if (rc < 0)
		fprintf(stderr, "turn_picture: %s: it failed\n", argv[2]);
	picture_finish(&picture);
	buffer_finish(&in);
	buffer_finish(&out);
	return rc == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
