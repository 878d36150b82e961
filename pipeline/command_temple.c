/* gopura-content temple: writes the demo temple as a PLY file of any size. */
#include "pipeline/commands.h"

#include "base/progress.h"
#include "pipeline/temple/temple.h"

#include <errno.h>
#include <getopt.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char help[] =
	"gopura-content temple: write the demo temple as a binary PLY file\n"
	"\n"
	"usage: gopura-content temple --triangles N [--seed S] [--regions DIR] --out FILE.ply\n"
	"\n"
	"The demo temple is a procedural Khmer temple.\n"
	"\n"
	"  --triangles N   10000 to 100000000; the result has this number within 2 %, most of it in\n"
	"                  reliefs and mouldings\n"
	"  --seed S        varies poses, displaced stones and ruined parts (default: 1)\n"
	"  --regions DIR   also list the faces of each carving that is one piece (lions, hoods of\n"
	"                  nagas, flights of stairs, lintels, pediments, colonnettes, antefixes,\n"
	"                  faces, lotus crowns), as DIR/lion-1.faces and so on, for the regions of\n"
	"                  parts\n"
	"  --out FILE      the file to write; removed if writing fails\n"
	"\n"
	"Examples:\n"
	"  gopura-content temple --triangles 1500000 --out scan.ply\n"
	"  gopura-content temple --triangles 100000000 --seed 7 --out large.ply\n";

/* Writes to a temporary file first, so that an incomplete temple is never mistaken for a complete
 * one. */
static int write_file(const char *path, struct temple_options *options)
{
	char part[4096];
	int rc = 0;

	if (snprintf(part, sizeof(part), "%s.part", path) >= (int)sizeof(part))
		return -ENAMETOOLONG;
	FILE *file = fopen(part, "wb");
	if (!file)
		return -errno;
	setvbuf(file, NULL, _IOFBF, 1 << 20);
	errno = 0;
	rc = temple_write(file, options);
	if (rc == -EIO && errno)
		rc = -errno;
	if (fclose(file) != 0 && rc == 0)
		rc = -errno;
	if (rc == 0 && rename(part, path) != 0)
		rc = -errno;
	if (rc < 0)
		unlink(part);
	return rc;
}

/* Writes FOLDER/lion-1.faces and so on. On failure path names what could not be written. */
static int write_regions(const char *folder, const struct temple_bodies *all, char path[4096])
{
	int rc = 0;

	if (snprintf(path, 4096, "%s", folder) >= 4096)
		return -ENAMETOOLONG;
	if (mkdir(folder, 0777) < 0 && errno != EEXIST)
		return -errno;
	for (uint32_t i = 0; rc == 0 && i < all->count; i++) {
		const struct temple_body *body = &all->bodies[i];
		if (snprintf(path, 4096, "%s/%s.faces", folder, body->id) >= 4096)
			return -ENAMETOOLONG;
		FILE *file = fopen(path, "w");
		if (!file)
			return -errno;
		fprintf(file, "# faces of the demo temple\n%u-%u\n", body->first_face,
			body->first_face + body->face_count - 1);
		rc = ferror(file) ? -EIO : 0;
		if (fclose(file) != 0 && rc == 0)
			rc = -errno;
	}
	return rc;
}

struct request {
	uint64_t triangles, seed;
	const char *path, *regions;
};

/* Returns 0 to go on, otherwise the exit status plus one. */
static int read_options(int argc, char **argv, struct request *request)
{
	static const struct option names[] = { { "triangles", required_argument, NULL, 't' },
					       { "seed", required_argument, NULL, 's' },
					       { "out", required_argument, NULL, 'o' },
					       { "regions", required_argument, NULL, 'r' },
					       { "help", no_argument, NULL, 'h' },
					       { NULL, 0, NULL, 0 } };
	bool good = true;
	int c;

	while ((c = getopt_long(argc, argv, "", names, NULL)) != -1) {
		if (c == 'h') {
			fputs(help, stdout);
			return 1;
		} else if (c == 't') {
			good = good &&
			       command_number(optarg, 0, TEMPLE_TRIANGLES_MAX, &request->triangles);
		} else if (c == 's') {
			good = good && command_number(optarg, 0, UINT32_MAX, &request->seed);
		} else if (c == 'o') {
			request->path = optarg;
		} else if (c == 'r') {
			request->regions = optarg;
		} else {
			return 3;
		}
	}
	if (good && optind == argc && request->path && request->triangles >= TEMPLE_TRIANGLES_MIN)
		return 0;
	fprintf(stderr,
		"gopura-content temple: give --triangles (%d to %d) and --out FILE; see "
		"--help\n",
		TEMPLE_TRIANGLES_MIN, TEMPLE_TRIANGLES_MAX);
	return 3;
}

int command_temple(int argc, char **argv)
{
	struct request request = { .seed = 1 };
	int stop = read_options(argc, argv, &request);

	if (stop)
		return stop - 1;
	struct progress *progress = progress_start("temple", "vertices and triangles", 0);
	struct temple_bodies bodies = { 0 };
	struct temple_options options = { .triangles = request.triangles,
					  .seed = (uint32_t)request.seed,
					  .progress = progress,
					  .bodies = request.regions ? &bodies : NULL };
	char region[4096];
	const char *path = request.path;
	int rc = write_file(request.path, &options);
	progress_end(progress);
	if (rc == 0 && request.regions) {
		path = region;
		rc = write_regions(request.regions, &bodies, region);
	}
	free(bodies.bodies);
	if (rc < 0) {
		fprintf(stderr, "gopura-content temple: %s: %s\n", path, strerror(-rc));
		return 1;
	}
	return 0;
}
