/* A content folder of a tiny temple, in which everything can be built. */
#ifndef GOPURA_TESTS_PIPELINE_TEMPLE_FOLDER_H
#define GOPURA_TESTS_PIPELINE_TEMPLE_FOLDER_H

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/content/content.h"
#include "tests/check.h"
#include "tests/pipeline/shapes.h"

#define TEMPLE_INI "[model]\nscans = temple.ply\n[grid]\npoints = 4\nface_px = 256\n"

static struct {
	char top[64], folder[80], keys[80]; /* a temporary folder; its content; its keys */
} temple;

static void temple_put_scan(void)
{
	struct mesh mesh = shape_temple(40);
	char path[128];
	FILE *file;

	snprintf(path, sizeof(path), "%s/temple.ply", temple.folder);
	file = fopen(path, "w");
	CHECK(file != NULL);
	fprintf(file,
		"ply\nformat binary_little_endian 1.0\nelement vertex %u\nproperty float x\n"
		"property float y\nproperty float z\nelement face %u\n"
		"property list uchar uint vertex_indices\nend_header\n",
		mesh.vertex_count, mesh.triangle_count);
	fwrite(mesh.positions, sizeof(mesh.positions[0]), mesh.vertex_count, file);
	for (uint32_t i = 0; i < mesh.triangle_count; i++) {
		fputc(3, file);
		fwrite(mesh.triangles[i], sizeof(mesh.triangles[0]), 1, file);
	}
	fclose(file);
	mesh_finish(&mesh);
}

static void temple_put(const char *name, const char *text)
{
	char path[128];
	FILE *file;

	snprintf(path, sizeof(path), "%s/%s", temple.folder, name);
	file = fopen(path, "w");
	CHECK(file != NULL);
	fputs(text, file);
	fclose(file);
}

static int temple_make(void **state)
{
	(void)state;
	snprintf(temple.top, sizeof(temple.top), "/tmp/gopura-temple-XXXXXX");
	if (!mkdtemp(temple.top))
		return -1;
	snprintf(temple.folder, sizeof(temple.folder), "%s/content", temple.top);
	snprintf(temple.keys, sizeof(temple.keys), "%s/keys", temple.top);
	mkdir(temple.folder, 0777);
	temple_put_scan();
	temple_put("temple.ini", TEMPLE_INI);
	return 0;
}

static int temple_remove(void **state)
{
	char command[128];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf %s", temple.top);
	return system(command);
}

static void temple_read(struct content *content)
{
	struct diagnostics diagnostics = { 0 };

	CHECK(content_read(content, temple.folder, &diagnostics) == 0);
}

#endif
