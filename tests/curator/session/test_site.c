/* What a curator's pictures show, as a release would. */
#include "curator/session/site.h"

#include <sys/stat.h>

#include "format/picture.h"
#include "pipeline/build.h"
#include "tests/check.h"
#include "tests/pipeline/import/scan_text.h"

static char ini_path[256], folder[256];

static void put(const char *name, const char *text)
{
	scan_write_beside(ini_path, name, text, strlen(text));
}

/* A pyramid with a picture, of which a closed surface is made. */
static int make_folder(void **state)
{
	static const char ini[] = "[model]\nscans = scan.obj\n[hierarchy]\nsurface = octree\n"
				  "cell_mm = 60\n";
	const uint8_t rgba[4] = { 200, 100, 50, 255 };
	const struct picture picture = { 1, 1, (uint8_t *)rgba };
	struct buffer png;

	(void)state;
	scan_write(ini_path, "temple.ini", ini, strlen(ini));
	snprintf(folder, sizeof(folder), "%.*s", (int)(strrchr(ini_path, '/') - ini_path),
		 ini_path);
	put("scan.obj", "mtllib scan.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\nvt 0 0\n"
			"usemtl skin\nf 4/1 3/1 2/1 1/1\nf 1/1 2/1 5/1\nf 2/1 3/1 5/1\n"
			"f 3/1 4/1 5/1\nf 4/1 1/1 5/1\n");
	put("scan.mtl", "newmtl skin\nmap_Kd skin.png\n");
	put("parts.json", "{\"parts\": []}");
	buffer_init(&png, 1 << 16);
	CHECK(picture_encode_png(&png, &picture) == 0);
	scan_write_beside(ini_path, "skin.png", png.data, png.size);
	buffer_finish(&png);
	return 0;
}

static int remove_folder(void **state)
{
	(void)state;
	scan_remove(ini_path);
	return 0;
}

static void make_master(void)
{
	const struct build_master_options options = { .jobs = 1 };
	struct diagnostics diagnostics = { 0 };
	struct build_master_report report;
	struct master *master;
	struct content content;
	struct scans *scans;

	CHECK(content_read(&content, folder, &diagnostics) == 0);
	CHECK(scans_create(&scans, &content) == 0);
	if (build_master(&master, scans, &options, &report, &diagnostics) < 0)
		fail_msg("%s", diagnostics.first.text);
	master_destroy(master);
	scans_destroy(scans);
	content_release(&content);
}

/* The pictures hold their light, and so do the colours that the surface has of them. */
static void a_closed_surface_of_scans_with_pictures_is_not_lit_again(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct site site;

	(void)state;
	make_master();
	if (site_open(&site, folder, &diagnostics) < 0)
		fail_msg("%s", diagnostics.first.text);
	CHECK(site.mesh->texture_count == 0 && !site.lit);
	site_close(&site);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_closed_surface_of_scans_with_pictures_is_not_lit_again),
	};

	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
