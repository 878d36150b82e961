/* Writes overlapping range images of a carved wall, as a scanner that looks along -z would see it:
 * range_wall FOLDER IMAGES SIDE. Each has SIDE x SIDE points 1 mm apart and is a binary PLY. They
 * lie in rows, each a fifth over its neighbours. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static float height_m(double x, double y)
{
	return (float)(0.03 * sin(9 * x) * cos(7 * y) + 0.004 * sin(80 * x) * sin(90 * y));
}

static int write_image(const char *folder, int number, int across, int side)
{
	const double step = 0.001, left = 0.8 * side * step * (number % across);
	const double bottom = 0.8 * side * step * (number / across);
	char path[4096];
	FILE *file;

	snprintf(path, sizeof(path), "%s/wall-%03d.ply", folder, number);
	file = fopen(path, "wb");
	if (!file)
		return -1;
	fprintf(file,
		"ply\nformat binary_little_endian 1.0\nobj_info num_cols %d\nobj_info num_rows %d\n"
		"element vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
		"end_header\n",
		side, side, side * side);
	for (int row = 0; row < side; row++)
		for (int column = 0; column < side; column++) {
			const double x = left + column * step, y = bottom + row * step;
			const float place[3] = { (float)x, (float)y, height_m(x, y) };

			fwrite(place, sizeof(place), 1, file);
		}
	return fclose(file);
}

int main(int argc, char **argv)
{
	const int images = argc == 4 ? (int)strtol(argv[2], NULL, 10) : 0;
	const int side = argc == 4 ? (int)strtol(argv[3], NULL, 10) : 0;
	const int across = (int)ceil(sqrt(images));

	if (images <= 0 || side <= 1) {
		fprintf(stderr, "usage: range_wall FOLDER IMAGES SIDE\n");
		return 2;
	}
	for (int i = 0; i < images; i++)
		if (write_image(argv[1], i, across, side) != 0) {
			perror(argv[1]);
			return 1;
		}
	return 0;
}
