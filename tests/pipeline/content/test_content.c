#include "pipeline/content/content.h"
#include "pipeline/content/scans.h"
#include "storage/info.h"

#include <errno.h>
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#include "storage/info_tools.h"
#include "tests/check.h"
#include "tests/pipeline/import/scan_text.h"

static const char triangle[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
			       "property float y\nproperty float z\nelement face 1\n"
			       "property list uchar int vertex_indices\nend_header\n"
			       "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

/* folder is filled with the name of a new content folder: temple.ini and one scan, tower.ply. */
static void make_folder(char folder[256], const char *ini)
{
	scan_write(folder, "temple.ini", ini, strlen(ini));
	scan_write_beside(folder, "tower.ply", triangle, strlen(triangle));
	*strrchr(folder, '/') = '\0';
}

static void remove_folder(const char *folder)
{
	char inside[300];

	snprintf(inside, sizeof(inside), "%s/temple.ini", folder);
	scan_remove(inside);
}

static void defaults_need_only_a_scan(void **state)
{
	char folder[256];
	struct content content;
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	(void)state;

	make_folder(folder, "[model]\nscans = tower.ply\n");
	CHECK(content_read(&content, folder, &diagnostics) == 0);
	CHECK(content.scan_count == 1 && strstr(content.scans[0], "/tower.ply"));
	CHECK(strcmp(content.name, strrchr(folder, '/') + 1) == 0);
	CHECK(content.grid_points == 8 && content.face_px == 512 && content.quality == 80);
	CHECK(content.effort == TILE_THOROUGH);
	CHECK(content.patch_triangles == 0 && content.block_triangles == 0 &&
	      content.publish_share == 0.10);
	CHECK(content.language_count == 1 && strcmp(content.languages[0], "en") == 0);
	CHECK(content.lit == CONTENT_LIT_AUTO && !content.has_start && !content.binary_tree);
	CHECK(content.tools == 0);
	CHECK(fabs(content.sun[0] * content.sun[0] + content.sun[1] * content.sun[1] +
		   content.sun[2] * content.sun[2] - 1) < 1e-3);
	content_release(&content);
	remove_folder(folder);
}

static void every_key_is_read(void **state)
{
	static const char ini[] =
		"# a comment\n[model]\nname = Banteay of the Test\nscans = tower.ply, tower.ply\n"
		"up = y\nunit = mm\nerror_mm = 2.5\ncolours = \"#102030\"\ncut = wood\nlit = no ; really\nsun = 0 3 4\n"
		"background = #ffffff\n[view]\nstart = eye 1 2 3 target -4 5e-1 6\n"
		"tools = section, measure light\n[grid]\n"
		"points = 32\nface_px = 1024\nquality = 90\neffort = quick\n[samples]\nquality = features\n[hierarchy]\nkind = tree\nsimplify = features\n"
		"patch_triangles = 1000\nblock_triangles = 2000\nlattice_mm = 0.5\n[release]\npublish_share = 0.5\nlanguages = en fr km pt-BR\n";
	char folder[256];
	struct content content;
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	(void)state;

	make_folder(folder, ini);
	CHECK(content_read(&content, folder, &diagnostics) == 0);
	CHECK(strcmp(content.name, "Banteay of the Test") == 0 && content.scan_count == 2);
	CHECK(content.import.up == IMPORT_Y_UP && content.import.metres_per_unit == 0.001);
	CHECK(content.substance == SUBSTANCE_NONE && content.cut == SUBSTANCE_WOOD);
	CHECK(content.colours == CONTENT_COLOURS_ONE && content.import.default_colour[2] == 0x30);
	CHECK(content.lit == CONTENT_LIT_NO && content.sun[1] == 0.6f && content.sun[2] == 0.8f);
	CHECK(content.background[0] == 255 && content.has_start);
	CHECK(content.tools == (INFO_TOOL_LIGHT | INFO_TOOL_SECTION | INFO_TOOL_MEASURE));
	CHECK(content.error_mm == 2.5);
	CHECK(content.start_eye_m[2] == 3 && content.start_target_m[1] == 0.5f);
	CHECK(content.grid_points == 32 && content.face_px == 1024 && content.quality == 90);
	CHECK(content.effort == TILE_QUICK);
	CHECK(content.quality_rule == CONTENT_QUALITY_FEATURES);
	CHECK(content.binary_tree && content.simplify_features);
	CHECK(content.patch_triangles == 1000);
	CHECK(content.block_triangles == 2000 && content.lattice_mm == 0.5);
	CHECK(content.publish_share == 0.5 && content.language_count == 4);
	CHECK(strcmp(content.languages[3], "pt-BR") == 0);
	content_release(&content);
	remove_folder(folder);
}

static void takes_a_substance_for_the_colours(void **state)
{
	struct content content;
	struct diagnostics diagnostics = { 0 };
	char folder[256];
	(void)state;

	make_folder(folder, "[model]\nscans = tower.ply\ncolours = laterite\n");
	CHECK(content_read(&content, folder, &diagnostics) == 0);
	CHECK(content.colours == CONTENT_COLOURS_PROCEDURAL &&
	      content.substance == SUBSTANCE_LATERITE);
	content_release(&content);
	remove_folder(folder);
}

/* The light in the pictures of a scan is no light of what has another colour. */
static void is_lit_unless_it_has_the_colours_of_pictures(void **state)
{
	static const struct {
		const char *lines;
		bool with_pictures, without;
	} cases[] = {
		{ "", false, true },
		{ "colours = scan\n", false, true },
		{ "colours = #c8b090\n", true, true },
		{ "colours = marble\n", true, true },
		{ "colours = #c8b090\nlit = no\n", false, false },
		{ "lit = yes\n", true, true },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct diagnostics diagnostics = { 0 };
		struct content content;
		char folder[256], ini[256];

		snprintf(ini, sizeof(ini), "[model]\nscans = tower.ply\n%s", cases[i].lines);
		make_folder(folder, ini);
		CHECK(content_read(&content, folder, &diagnostics) == 0);
		CHECK(content_is_lit(&content, true) == cases[i].with_pictures);
		CHECK(content_is_lit(&content, false) == cases[i].without);
		content_release(&content);
		remove_folder(folder);
	}
}

static void faults_name_file_line_and_cure(void **state)
{
	static const struct {
		const char *name, *ini, *says;
	} cases[] = {
		{ "no-scan", "[model]\nname = x\n", "scans = FILE" },
		{ "missing", "[model]\nscans = tower.ply gone.ply\n", "gone.ply: No such file" },
		{ "folder", "[model]\nscans = .work\n", "No such file" },
		{ "outside", "[model]\nscans = ../tower.ply\n", "line 2: scans" },
		{ "absolute", "[model]\nscans = /etc/passwd\n", "inside it" },
		{ "typo", "[model]\nscans = tower.ply\ncolors = scan\n",
		  "line 3: [model] has no 'colors'; did you mean 'colours'?" },
		{ "section", "[modle]\nscans = tower.ply\n",
		  "line 1: there is no section [modle]; did you mean [model]?" },
		{ "no-section", "scans = tower.ply\n", "line 1: scans belongs under [model]" },
		{ "twice", "[model]\nup = z\n\nup = y\n", "line 4: up is set in line 2 already" },
		{ "not-a-line", "[model]\nscans tower.ply\n",
		  "line 2: 'scans tower.ply' is neither" },
		{ "cut", "[model]\ncut = granite\n",
		  "line 2: cut must be marble, wood, sandstone, laterite or none" },
		{ "up", "[model]\nup = w\n",
		  "line 2: up must be z, y or x: the axis that points up in the scans, not 'w'" },
		{ "unit", "[model]\nunit = yard\n", "metres in one unit" },
		{ "unit-zero", "[model]\nunit = 0\n", "metres in one unit" },
		{ "sun", "[model]\nsun = 0 0 0\n", "three numbers" },
		{ "sun-nan", "[model]\nsun = nan 0 1\n", "three numbers" },
		{ "colour", "[model]\ncolours = #12345\n", "#rrggbb" },
		{ "lit", "[model]\nlit = perhaps\n", "yes or no" },
		{ "points", "[grid]\npoints = 33\n", "from 4 to 32" },
		{ "points-text", "[grid]\npoints = 8x\n", "from 4 to 32" },
		{ "effort", "[grid]\neffort = little\n", "thorough or quick" },
		{ "quality-rule", "[samples]\nquality = best\n", "gain, uniform or features" },
		{ "simplify", "[hierarchy]\nsimplify = edges\n", "quadric or features" },
		{ "face", "[grid]\nface_px = 500\n", "512" },
		{ "start", "[view]\nstart = 1 2 3 1 2 3\n", "two different places" },
		{ "start", "[view]\nstart = 1e39 2 3 1 2 3\n", "two different places" },
		{ "tools", "[view]\n\ntools = light, lens\n",
		  "line 3: tools must be light, section, measure and walk, or some of them, each once, not "
		  "'light, lens'" },
		{ "error", "[model]\nerror_mm = 0\n", "millimetres above 0" },
		{ "measure", "[model]\nscans = tower.ply\n[view]\ntools = measure\n",
		  "add 'error_mm = MILLIMETRES' to its [model] section" },
		{ "tools-twice", "[view]\ntools = light light\n", "each once" },
		{ "share", "[release]\npublish_share = 0\n", "above 0" },
		{ "languages", "[release]\nlanguages = en f\n", "language tags" },
		{ "alignment", "[model]\nscans = tower.ply gone.aln\n", "gone.aln: No such file" },
		{ "alignment-outside", "[model]\nscans = ../site.aln\n", "line 2: scans" },
	};
	char folder[256];
	struct content content;
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };

		make_folder(folder, cases[i].ini);
		if (content_read(&content, folder, &diagnostics) >= 0 ||
		    !strstr(diagnostics.first.text, cases[i].says))
			fail_msg("%s: '%s'", cases[i].name, diagnostics.first.text);
		diagnostics_finish(&diagnostics);
		remove_folder(folder);
	}
}

static void tells_all_faults_at_once(void **state)
{
	char folder[256];
	struct content content;
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	(void)state;

	make_folder(folder, "[model]\nscans = gone.ply\nup = w\n[grid]\npoints = 40\n");
	CHECK(content_read(&content, folder, &diagnostics) == -EINVAL);
	CHECK(diagnostics.count == 2 && diagnostics.first.line == 3 &&
	      diagnostics_get(&diagnostics, 1)->line == 5);
	diagnostics_finish(&diagnostics);
	remove_folder(folder);
	make_folder(folder, "[model]\nscans = gone.ply tower.ply lost.ply\n");
	CHECK(content_read(&content, folder, &diagnostics) == -ENOENT && diagnostics.count == 2);
	CHECK(strstr(diagnostics.first.text, "gone.ply") &&
	      strstr(diagnostics_get(&diagnostics, 1)->text, "lost.ply"));
	diagnostics_finish(&diagnostics);
	remove_folder(folder);
}

static void says_what_is_no_content_folder(void **state)
{
	struct content content;
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	(void)state;

	CHECK(content_read(&content, "/nowhere/at/all", &diagnostics) == -ENOENT &&
	      diagnostics.count == 1);
	diagnostics_finish(&diagnostics);
	CHECK(content_read(&content, "", &diagnostics) == -EINVAL && diagnostics.count == 1);
	diagnostics_finish(&diagnostics);
}

static void a_line_that_is_too_long_is_a_fault(void **state)
{
	char ini[1100], folder[256];
	struct content content;
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	(void)state;

	snprintf(ini, sizeof(ini), "[model]\nscans = tower.ply\nname = %01000d\n", 7);
	make_folder(folder, ini);
	CHECK(content_read(&content, folder, &diagnostics) == -EINVAL);
	CHECK(strstr(diagnostics.first.text, "line 3: the line is longer than"));
	diagnostics_finish(&diagnostics);
	remove_folder(folder);
}

static void names_stay_inside_the_folder(void **state)
{
	static const char *const bad[] = { "",  "/",   "/a",   "..", "../a", "a/..", "a/../b",
					   ".", "./a", "a//b", "a/", "a\\b", "a\nb" };
	static const char *const good[] = { "a",   "a b.ply", "a/b",         "..a",
					    "a..", ".work",   "\xe1\x9e\x80" };
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(bad); i++)
		if (content_name_is_safe(bad[i]))
			fail_msg("taken for safe: '%s'", bad[i]);
	for (size_t i = 0; i < ARRAY_COUNT(good); i++)
		if (!content_name_is_safe(good[i]))
			fail_msg("taken for unsafe: '%s'", good[i]);
}

static const char site_aln[] = "2\ntower.ply\n#\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
			       "tower.ply\n#\n1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n0\n";

static void an_alignment_stands_for_its_scans(void **state)
{
	char folder[256], path[512];
	struct content content;
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	(void)state;

	make_folder(folder, "[model]\nscans = tower.ply in/site.aln tower.ply\n");
	snprintf(path, sizeof(path), "%s/in", folder);
	CHECK(mkdir(path, 0700) == 0);
	snprintf(path, sizeof(path), "%s/temple.ini", folder);
	scan_write_beside(path, "in/site.aln", site_aln, strlen(site_aln));
	CHECK(content_read(&content, folder, &diagnostics) == -ENOENT && diagnostics.count == 2);
	CHECK(strstr(diagnostics.first.text, "in/site.aln:2: scan "));
	CHECK(strstr(diagnostics_get(&diagnostics, 1)->text, "in/site.aln:8: scan "));
	diagnostics_finish(&diagnostics);

	scan_write_beside(path, "in/tower.ply", triangle, strlen(triangle));
	CHECK(content_read(&content, folder, &diagnostics) == 0 && content.scan_count == 4);
	CHECK(!content.transforms[0] && !content.transforms[3]);
	CHECK(strcmp(content.scans[1] + strlen(folder), "/in/tower.ply") == 0);
	CHECK(content.transforms[1]->rows[0][3] == 0 && content.transforms[2]->rows[0][3] == 5);
	content_release(&content);
	remove_folder(folder);
}

static void alignments_do_not_name_more_scans_than_fit(void **state)
{
	char folder[256], path[512], ini[1000];
	size_t length = (size_t)snprintf(ini, sizeof(ini), "[model]\nscans =");
	struct content content;
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	(void)state;

	/* 129 alignments of two scans each */
	for (int i = 0; i < 129; i++)
		length += (size_t)snprintf(ini + length, sizeof(ini) - length, " s.aln");
	CHECK(length < sizeof(ini) - 1);
	make_folder(folder, ini);
	snprintf(path, sizeof(path), "%s/temple.ini", folder);
	scan_write_beside(path, "s.aln", site_aln, strlen(site_aln));
	CHECK(content_read(&content, folder, &diagnostics) == -EFBIG);
	CHECK(strstr(diagnostics.first.text, "over 256 scans"));
	diagnostics_finish(&diagnostics);
	remove_folder(folder);
}

/* Four scans, the last two of which no reader would take: both are told, and nothing is imported.
 */
static void every_bad_scan_is_told_before_the_first_is_imported(void **state)
{
	static const char points[] = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
				     "property float y\nproperty float z\nend_header\n0 0 0\n";
	char folder[256], path[512];
	struct content content;
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	const struct mesh *mesh;
	struct scans *scans;
	(void)state;

	make_folder(folder, "[model]\nscans = tower.ply tower.ply points.ply notes.txt\n");
	snprintf(path, sizeof(path), "%s/temple.ini", folder);
	scan_write_beside(path, "points.ply", points, strlen(points));
	scan_write_beside(path, "notes.txt", "a note", 6);
	CHECK(content_read(&content, folder, &diagnostics) == 0);
	CHECK(scans_create(&scans, &content) == 0);
	CHECK(scans_get_mesh(scans, &mesh, &diagnostics) < 0 && diagnostics.count == 2);
	CHECK(strstr(diagnostics.first.text,
		     "/points.ply: its points have neither a range_grid nor normals"));
	CHECK(strstr(diagnostics_get(&diagnostics, 1)->text,
		     "/notes.txt: not a supported scan format"));
	diagnostics_finish(&diagnostics);
	scans_destroy(scans);
	content_release(&content);
	remove_folder(folder);
}

/* The number of the file .work/mesh, which is another whenever the mesh is saved; 0: none. */
static ino_t mesh_number(const char *folder)
{
	struct stat status;
	char path[512];

	snprintf(path, sizeof(path), "%s/.work/mesh", folder);
	return stat(path, &status) == 0 ? status.st_ino : 0;
}

static void import_of(const char *folder, bool *from_cache, uint32_t *triangles)
{
	const ino_t before = mesh_number(folder);
	struct content content;
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	const struct mesh *mesh;
	struct scans *scans;

	CHECK(content_read(&content, folder, &diagnostics) == 0);
	CHECK(scans_create(&scans, &content) == 0);
	if (scans_get_mesh(scans, &mesh, &diagnostics) < 0)
		fail_msg("%s", diagnostics.first.text);
	*from_cache = mesh_number(folder) == before;
	*triangles = mesh->triangle_count;
	CHECK(content_is_lit(&content, mesh->textures != NULL));
	scans_destroy(scans);
	content_release(&content);
}

static void the_shape_is_known_without_the_mesh(void **state)
{
	char folder[256], path[512];
	const struct scans_shape *shape;
	struct content content;
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	struct scans *scans;
	FILE *file;
	(void)state;

	make_folder(folder, "[model]\nscans = tower.ply tower.ply\nunit = cm\n");
	CHECK(content_read(&content, folder, &diagnostics) == 0);
	CHECK(scans_create(&scans, &content) == 0);
	CHECK(scans_known_shape(scans) == NULL && mesh_number(folder) == 0);
	CHECK(scans_get_shape(scans, &shape, &diagnostics) == 0);
	scans_destroy(scans);
	snprintf(path, sizeof(path), "%s/.work/mesh", folder);
	CHECK(unlink(path) == 0);

	CHECK(scans_create(&scans, &content) == 0);
	shape = scans_known_shape(scans);
	CHECK(shape != NULL && mesh_number(folder) == 0);
	CHECK(shape->high_m[0] == 0.01f && shape->high_m[2] == 0 && shape->low_m[1] == 0);
	CHECK(!shape->has_textures && shape->scan_count == 2 && shape->face_counts[1] == 1);
	scans_destroy(scans);

	/* a damaged one counts as none */
	snprintf(path, sizeof(path), "%s/.work/shape", folder);
	file = fopen(path, "r+b");
	CHECK(file && fseek(file, 30, SEEK_SET) == 0 && fputc(0x55, file) != EOF &&
	      fclose(file) == 0);
	CHECK(scans_create(&scans, &content) == 0);
	CHECK(scans_known_shape(scans) == NULL);
	CHECK(scans_get_shape(scans, &shape, &diagnostics) == 0 && shape->high_m[0] == 0.01f);
	scans_destroy(scans);
	content_release(&content);
	remove_folder(folder);
}

static void a_second_import_comes_from_the_cache_until_something_changes(void **state)
{
	char folder[256], path[512], other[sizeof(triangle) + 8];
	bool from_cache;
	uint32_t triangles;
	FILE *file;
	(void)state;

	make_folder(folder, "[model]\nscans = tower.ply tower.ply\n");
	import_of(folder, &from_cache, &triangles);
	CHECK(!from_cache && triangles == 2);
	import_of(folder, &from_cache, &triangles);
	CHECK(from_cache && triangles == 2);

	/* a damaged cache is made anew */
	snprintf(path, sizeof(path), "%s/.work/mesh", folder);
	file = fopen(path, "r+b");
	CHECK(file && fseek(file, 80, SEEK_SET) == 0 && fputc(0x55, file) != EOF &&
	      fclose(file) == 0);
	import_of(folder, &from_cache, &triangles);
	CHECK(!from_cache && triangles == 2);
	import_of(folder, &from_cache, &triangles);
	CHECK(from_cache);

	/* so is one of other options, and one of other scans */
	snprintf(path, sizeof(path), "%s/temple.ini", folder);
	scan_write_beside(path, "temple.ini", "[model]\nscans = tower.ply\n", 26);
	import_of(folder, &from_cache, &triangles);
	CHECK(!from_cache && triangles == 1);
	/* a file beside a scan that names none changes nothing, the scan itself does */
	scan_write_beside(path, "tower.mtl", "x", 1);
	import_of(folder, &from_cache, &triangles);
	CHECK(from_cache);
	snprintf(other, sizeof(other), "%s0 0 0\n", triangle);
	scan_write_beside(path, "tower.ply", other, strlen(other));
	import_of(folder, &from_cache, &triangles);
	CHECK(!from_cache && triangles == 1);
	remove_folder(folder);
}

static void another_place_of_a_scan_is_another_mesh(void **state)
{
	char folder[256], path[512], other[sizeof(site_aln)];
	bool from_cache;
	uint32_t triangles;
	(void)state;

	make_folder(folder, "[model]\nscans = site.aln\n");
	snprintf(path, sizeof(path), "%s/temple.ini", folder);
	scan_write_beside(path, "site.aln", site_aln, strlen(site_aln));
	import_of(folder, &from_cache, &triangles);
	CHECK(!from_cache && triangles == 2);
	import_of(folder, &from_cache, &triangles);
	CHECK(from_cache);

	memcpy(other, site_aln, sizeof(other));
	*strchr(other, '5') = '6';
	scan_write_beside(path, "site.aln", other, strlen(other));
	import_of(folder, &from_cache, &triangles);
	CHECK(!from_cache);
	/* Where no scan moves, none is imported again. */
	scan_write_beside(path, "copy.aln", other, strlen(other));
	scan_write_beside(path, "temple.ini", "[model]\nscans = copy.aln\n", 25);
	import_of(folder, &from_cache, &triangles);
	CHECK(from_cache);
	remove_folder(folder);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(defaults_need_only_a_scan),
		cmocka_unit_test(every_key_is_read),
		cmocka_unit_test(takes_a_substance_for_the_colours),
		cmocka_unit_test(is_lit_unless_it_has_the_colours_of_pictures),
		cmocka_unit_test(faults_name_file_line_and_cure),
		cmocka_unit_test(tells_all_faults_at_once),
		cmocka_unit_test(says_what_is_no_content_folder),
		cmocka_unit_test(a_line_that_is_too_long_is_a_fault),
		cmocka_unit_test(names_stay_inside_the_folder),
		cmocka_unit_test(an_alignment_stands_for_its_scans),
		cmocka_unit_test(alignments_do_not_name_more_scans_than_fit),
		cmocka_unit_test(every_bad_scan_is_told_before_the_first_is_imported),
		cmocka_unit_test(the_shape_is_known_without_the_mesh),
		cmocka_unit_test(a_second_import_comes_from_the_cache_until_something_changes),
		cmocka_unit_test(another_place_of_a_scan_is_another_mesh),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
