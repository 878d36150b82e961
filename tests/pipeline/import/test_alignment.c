#include "pipeline/import/alignment.h"

#include <errno.h>
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/check.h"
#include "tests/pipeline/import/scan_text.h"

#define ROWS        "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
#define EIGHT(text) text text text text text text text text
#define LAYER(name, matrix)                                                                        \
	"<MLMesh visible=\"1\" label=\"x\" filename=\"" name "\"><MLMatrix44>" matrix              \
	"</MLMatrix44></MLMesh>\n"
#define PROJECT(layers)                                                                            \
	"<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n<MeshGroup>\n" layers                       \
	"</MeshGroup><RasterGroup/></MeshLabProject>\n"

/* Reads text as a file of that name, beside a.ply, "b c.ply" and in/d.ply. */
static int read_text(struct alignment *out, const char *name, const char *text, size_t size,
		     struct diagnostics *diagnostics)
{
	char path[256], folder[300];
	int rc;

	scan_write(path, name, text, size);
	scan_write_beside(path, "a.ply", "ply\n", 4);
	scan_write_beside(path, "b c.ply", "ply\n", 4);
	snprintf(folder, sizeof(folder), "%.*s/in", (int)(strrchr(path, '/') - path), path);
	CHECK(mkdir(folder, 0700) == 0);
	scan_write_beside(path, "in/d.ply", "ply\n", 4);
	snprintf(folder, sizeof(folder), "%.*s/loop", (int)(strrchr(path, '/') - path), path);
	CHECK(symlink("loop", folder) == 0); /* what it is cannot be seen */
	rc = alignment_read(out, path, diagnostics);
	if (rc < 0 && !strstr(diagnostics->first.text, path))
		fail_msg("%s is not named: '%s'", path, diagnostics->first.text);
	scan_remove(path);
	return rc;
}

static bool path_ends(const struct alignment_scan *scan, const char *end)
{
	const size_t length = strlen(scan->path), end_length = strlen(end);

	return scan->path[0] == '/' && length > end_length &&
	       strcmp(scan->path + length - end_length, end) == 0 && !strstr(scan->path, "//");
}

static void check_three(const struct alignment *alignment)
{
	const double from[3] = { 1, 2, 3 };
	double to[3];

	CHECK(alignment->count == 3 && path_ends(&alignment->scans[0], "/a.ply"));
	CHECK(path_ends(&alignment->scans[1], "/b c.ply"));
	CHECK(path_ends(&alignment->scans[2], "/in/d.ply"));
	transform_point(&alignment->scans[0].transform, from, to);
	CHECK(to[0] == 1 && to[1] == 2 && to[2] == 3);
	/* a quarter turn about z, and a shift that a float would not hold */
	transform_point(&alignment->scans[1].transform, from, to);
	CHECK(to[0] == 448210.125 - 2 && to[1] == 1484770.0625 + 1 && to[2] == 3 - 0.5);
	CHECK(!transform_mirrors(&alignment->scans[1].transform));
	CHECK(transform_mirrors(&alignment->scans[2].transform));
}

static void reads_an_alignment(void **state)
{
	static const char *const texts[] = {
		"3\na.ply\n#\n" ROWS "b c.ply\n#\n0 -1 0 448210.125\n1 0 0 1484770.0625\n"
		"0 0 1 -0.5\n0 0 0 1\nin/d.ply\n#\n-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n0\n",
		/* as Windows and people write it */
		"\xef\xbb\xbf  3 \r\n\r\n.\\a.ply\r\n#\r\n# a note\r\n1 0\t0 0 \r\n0 1 0 0\r\n"
		"0 0 1 0\r\n0 0 0 1\r\n ./b c.ply  \r\n#\r\n0 -1 0 4.48210125e5\r\n"
		"1 0 0 1484770.0625\r\n0 0 1 -.5\r\n0 0 0 1.0000001\r\n"
		"in\\d.ply\r\n-1 0 0 0\r\n0 1 0 0\r\n0 0 1 0\r\n0 0 0 1",
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(texts); i++) {
		struct diagnostics diagnostics = { 0 };
		struct alignment alignment;

		if (read_text(&alignment, "site.aln", texts[i], strlen(texts[i]), &diagnostics) < 0)
			fail_msg("%s", diagnostics.first.text);
		check_three(&alignment);
		alignment_finish(&alignment);
	}
}

static void reads_a_project(void **state)
{
	static const char text[] = PROJECT(
		"<MLMesh filename=\"a.ply\" visible=\"0\"/><!-- where it was scanned -->"
		"<MLMesh idInFile=\"-1\" filename=\"b c.ply\"><RenderingOption/><MLMatrix44>\n"
		"0 -1 0 448210.125 \n1 0 0 1484770.0625 \n0 0 1 -0.5 \n0 0 0 1 \n</MLMatrix44>"
		"</MLMesh>" LAYER("in/d.ply", "-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"));
	struct diagnostics diagnostics = { 0 };
	struct alignment alignment;
	(void)state;

	if (read_text(&alignment, "Site.MLP", text, strlen(text), &diagnostics) < 0)
		fail_msg("%s", diagnostics.first.text);
	check_three(&alignment);
	CHECK(alignment.scans[0].line == 4);
	alignment_finish(&alignment);
}

/* The quaternion is that of the inverse rotation, as in Stanford's files. */
static void reads_a_registration(void **state)
{
	static const char text[] =
		"camera 0 -0.1 -0.7 0 1 0 0\nmesh gone_cyl 0 0 0 0 0 0 1\n"
		"bmesh a.ply 0 0 0 0 0 0 1\r\n"
		"bmesh in/d.ply 5 0.25 -1 0 0 -0.70710678118654752 0.70710678118654752\n";
	const double from[3] = { 1, 2, 3 };
	struct diagnostics diagnostics = { 0 };
	struct alignment alignment;
	double to[3];
	(void)state;

	if (read_text(&alignment, "site.conf", text, strlen(text), &diagnostics) < 0)
		fail_msg("%s", diagnostics.first.text);
	CHECK(alignment.count == 2 && path_ends(&alignment.scans[1], "/in/d.ply"));
	CHECK(alignment.left_out.count == 1 &&
	      strstr(alignment.left_out.first.text, "site.conf:2: gone_cyl is not there"));
	transform_point(&alignment.scans[1].transform, from, to);
	CHECK(fabs(to[0] - 3) < 1e-12 && fabs(to[1] - 1.25) < 1e-12 && fabs(to[2] - 2) < 1e-12);
	alignment_finish(&alignment);
}

static void refuses_with_line_and_cure(void **state)
{
	static const struct {
		const char *name, *text, *says;
	} cases[] = {
		{ "number.conf", "bmesh a.ply 0 0 0 0 0 1\n", ":1: expected: bmesh NAME" },
		{ "turn.conf", "\nbmesh a.ply 0 0 0 0 0 0 0\n", ":2: expected: bmesh NAME" },
		{ "none.conf", "camera 0 0 0\n", "places no scan" },
		{ "outside.conf", "bmesh a.ply 0 0 0 0 0 0 1\nmesh ../b.ply 0 0 0 0 0 0 1\n",
		  ":2: scan ../b.ply lies outside" },
		{ "loop.conf", "bmesh a.ply 0 0 0 0 0 0 1\nmesh loop 0 0 0 0 0 0 1\n",
		  ":2: scan " },
		{ "mark.conf",
		  "\xef\xbb\xbf"
		  "bmesh a.ply 0 0 0 0 0 1\n",
		  ":1: expected: bmesh NAME" },
		{ "gone.conf", "bmesh gone.ply 0 0 0 0 0 0 1\n", ":1: scan " },
		{ "far.conf", "bmesh a.ply 1e300 0 0 0 0 0 1\n", "beyond 1e12" },
		{ "e.aln", "", "must begin with the number of its scans" },
		{ "n.aln", "a.ply\n#\n" ROWS "0\n",
		  ":1: must begin with the number of its scans, not 'a.ply'" },
		{ "zero.aln", "0\n", ":1: must begin with" },
		{ "minus.aln", "-1\n", ":1: must begin with" },
		{ "many.aln", "99999999999999999999999\na.ply\n#\n" ROWS, "ends after 1 of the" },
		{ "less.aln", "2\na.ply\n#\n" ROWS "0\n",
		  ":8: the file ends after 1 of the 2 scans that its first line says; correct" },
		{ "cut.aln", "1\na.ply\n#\n1 0 0 0\n", ":4: the file ends after 0 of the 1" },
		{ "more.aln", "1\na.ply\n#\n" ROWS "b c.ply\n#\n" ROWS "0\n",
		  ":8: 'b c.ply' follows the 1 scans that its first line says; correct" },
		{ "wide.aln", "1\na.ply\n#\n1 0 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n0\n",
		  ":4: row 1 of the matrix of scan a.ply must be four numbers, not '1 0 0 0 0'" },
		{ "flat.aln", "1\na.ply\n#\n1 0 0\n0 1 0\n0 0 1\n0\n", ":4: row 1" },
		{ "three.aln", "2\na.ply\n#\n1 0 0 0\n0 1 0 0\n0 0 1 0\nb c.ply\n#\n" ROWS "0\n",
		  ":7: row 4 of the matrix of scan a.ply must be four numbers, not 'b c.ply'" },
		{ "word.aln", "1\na.ply\n#\n1 0 0 0\n0 1,0 0 0\n0 0 1 0\n0 0 0 1\n0\n",
		  ":5: row 2" },
		{ "nan.aln", "1\na.ply\n#\n1 0 0 nan\n0 1 0 0\n0 0 1 0\n0 0 0 1\n0\n",
		  ":2: the matrix of scan a.ply holds a number that is not finite; align" },
		{ "far.aln", "1\na.ply\n#\n1 0 0 1e300\n0 1 0 0\n0 0 1 0\n0 0 0 1\n0\n",
		  "holds a number beyond 1e12" },
		{ "singular.aln", "1\na.ply\n#\n1 2 0 0\n2 4 0 0\n0 0 1 0\n0 0 0 1\n0\n",
		  ":2: the matrix of scan a.ply flattens the scan" },
		{ "nought.aln", "1\na.ply\n#\n0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 1\n0\n",
		  "flattens" },
		{ "transposed.aln", "1\na.ply\n#\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n0\n",
		  "does not end with the row 0 0 0 1 (is it transposed?)" },
		{ "up.aln", "1\n../a.ply\n#\n" ROWS "0\n",
		  ":2: scan ../a.ply lies outside the folder of this file; copy it there" },
		{ "round.aln", "1\nin/../../a.ply\n#\n" ROWS "0\n", "lies outside" },
		{ "root.aln", "1\n/etc/passwd\n#\n" ROWS "0\n", "lies outside" },
		{ "drive.aln", "1\nC:\\scans\\a.ply\n#\n" ROWS "0\n", "lies outside" },
		{ "gone.aln", "2\na.ply\n#\n" ROWS "e.ply\n#\n" ROWS "0\n",
		  "/e.ply: No such file or directory; put it there, or correct its name" },
		{ "folder.aln", "1\nin\n#\n" ROWS "0\n", "/in: not a regular file" },
		{ "self.aln", "1\nself.aln\n#\n" ROWS "0\n", ":2: self.aln is no scan" },
		{ "e.mlp", "", "is not whole as XML" },
		{ "cut.mlp", "<MeshLabProject>\n<MeshGroup>\n",
		  ":3: is not whole as XML: Premature end of data" },
		{ "crossed.mlp", "<MeshLabProject>\n<a></b>\n</MeshLabProject>\n",
		  ":2: is not whole as XML: Opening and ending tag mismatch" },
		{ "other.mlp", "<svg/>", ":1: is no MeshLab project" },
		{ "none.mlp", PROJECT(""), "has no layer" },
		{ "unsaved.mlp", PROJECT("<MLMesh label=\"Poisson\"/>"),
		  ":4: a layer (MLMesh) without a filename; save it" },
		{ "empty.mlp", PROJECT("<MLMesh filename=\"\"/>"), "without a file name" },
		{ "short.mlp", PROJECT(LAYER("a.ply", "1 0 0 0 0 1 0 0 0 0 1 0")),
		  ":4: the matrix of scan a.ply must be 16 numbers, but after 12 there is ''" },
		{ "base64.mlp", PROJECT(LAYER("a.ply", "AACAPwAAAAAAAAAA")),
		  "must be 16 numbers, but after 0 there is 'AACAPwAAAAAAAAAA'; save the "
		  "project again as .mlp" },
		{ "long.mlp", PROJECT(LAYER("a.ply", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0")),
		  "but after 16 there is '0'" },
		{ "inf.mlp", PROJECT(LAYER("a.ply", "inf 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1")),
		  "not finite" },
		{ "up.mlp", PROJECT(LAYER("../a.ply", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1")),
		  "lies outside" },
		{ "gone.mlp", PROJECT(LAYER("e.ply", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1")),
		  "/e.ply: No such file" },
		{ "layers.mlp", PROJECT("<MLMesh filename=\"a.ply\" idInFile=\"1\"/>"),
		  ":4: a.ply holds several layers" },
		{ "file.mlp",
		  "<!DOCTYPE MeshLabProject [<!ENTITY e SYSTEM \"file:///etc/hostname\">]>"
		  "<MeshLabProject><MeshGroup><MLMesh filename=\"a.ply\"><MLMatrix44>&e;"
		  "</MLMatrix44></MLMesh></MeshGroup></MeshLabProject>",
		  "declares entities" },
		{ "laughs.mlp",
		  "<!DOCTYPE p [<!ENTITY a \"1 1 1 1 1 1 1 1\"><!ENTITY b \"" EIGHT(
			  "&a;") "\">"
				 "<!ENTITY c \"" EIGHT("&b;") "\"><!ENTITY d \"" EIGHT(
					 "&c;") "\">"
						"<!ENTITY e \"" EIGHT("&d;") "\"><!ENTITY f \"" EIGHT(
							"&e;") "\">"
							       "<!ENTITY g \"" EIGHT("&f;") "\"><!ENTITY h \"" EIGHT(
								       "&g;") "\">]>\n"
									      "<MeshLabProject><MeshGroup><MLMesh filename=\"a.ply\"><MLMatrix44>&h;"
									      "</MLMatrix44></MLMesh></MeshGroup></MeshLabProject>",
		  "ntit" },
		{ "loud.mlp",
		  "<!DOCTYPE p [<!ENTITY a \"1 1 1 1 1 1 1 1\"><!ENTITY b \"" EIGHT(
			  "&a;") "\">"
				 "<!ENTITY c \"" EIGHT("&b;") "\"><!ENTITY d \"" EIGHT(
					 "&c;") "\">"
						"<!ENTITY e \"" EIGHT("&d;") "\"><!ENTITY f \"" EIGHT(
							"&e;") "\">"
							       "<!ENTITY g \"" EIGHT("&f;") "\"><!ENTITY h \"" EIGHT(
								       "&g;") "\">]>\n"
									      "<MeshLabProject><MeshGroup><MLMesh filename=\"&h;\"/></MeshGroup>"
									      "</MeshLabProject>",
		  "ntit" },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct diagnostics diagnostics = { 0 };
		struct alignment alignment;
		int rc = read_text(&alignment, cases[i].name, cases[i].text, strlen(cases[i].text),
				   &diagnostics);

		if (rc >= 0 || !strstr(diagnostics.first.text, cases[i].says))
			fail_msg("%s: '%s'", cases[i].name, diagnostics.first.text);
		CHECK(alignment.count == 0 && !alignment.scans);
	}
}

static void tells_every_scan_that_is_missing(void **state)
{
	static const char text[] = "3\nx.ply\n#\n" ROWS "a.ply\n#\n" ROWS "y.ply\n#\n" ROWS "0\n";
	struct diagnostics diagnostics = { .max = 8 };
	struct alignment alignment;
	(void)state;

	CHECK(read_text(&alignment, "site.aln", text, strlen(text), &diagnostics) == -ENOENT);
	CHECK(diagnostics.count == 2 && diagnostics.first.line == 2);
	CHECK(diagnostics_get(&diagnostics, 1)->line == 14);
	CHECK(strstr(diagnostics_get(&diagnostics, 1)->text, "y.ply"));
	diagnostics_finish(&diagnostics);
}

static void refuses_more_scans_than_a_mesh_takes(void **state)
{
	static const char scan[] = "a.ply\n#\n" ROWS;
	struct diagnostics diagnostics = { 0 };
	struct alignment alignment;
	char text[16 + (ALIGNMENT_SCANS_MAX + 1) * sizeof(scan)];
	size_t length = (size_t)snprintf(text, sizeof(text), "%d\n", ALIGNMENT_SCANS_MAX + 1);
	(void)state;

	for (int i = 0; i <= ALIGNMENT_SCANS_MAX; i++, length += sizeof(scan) - 1)
		memcpy(text + length, scan, sizeof(scan) - 1);
	CHECK(read_text(&alignment, "site.aln", text, length, &diagnostics) == -EFBIG);
	CHECK(strstr(diagnostics.first.text, "over 256 scans"));
	diagnostics = (struct diagnostics){ 0 };
	text[2] = '6';
	CHECK(read_text(&alignment, "site.aln", text, length - (sizeof(scan) - 1), &diagnostics) ==
	      0);
	CHECK(alignment.count == ALIGNMENT_SCANS_MAX);
	alignment_finish(&alignment);
}

/* Cut anywhere, a file is refused; of an alignment only the last 0 may be missing. */
static void refuses_every_truncation(void **state)
{
	static const char *const names[] = { "site.aln", "site.mlp" };
	static const char *const texts[] = {
		"2\na.ply\n#\n" ROWS "a.ply\n#\n" ROWS,
		PROJECT(LAYER("a.ply", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1")),
	};
	char path[256];
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		scan_write(path, names[i], "", 0);
		scan_write_beside(path, "a.ply", "ply\n", 4);
		for (size_t n = 0; n < strlen(texts[i]) - 1; n++) {
			struct diagnostics diagnostics = { 0 };
			struct alignment alignment;

			scan_write_beside(path, names[i], texts[i], n);
			if (alignment_read(&alignment, path, &diagnostics) >= 0)
				fail_msg("%s: %zu bytes are taken for the whole", names[i], n);
		}
		scan_remove(path);
	}
}

static void names_of_alignments(void **state)
{
	(void)state;
	CHECK(alignment_is_named("a.aln") && alignment_is_named("in/A.MLP"));
	CHECK(!alignment_is_named(".aln") && !alignment_is_named("a.mlx") &&
	      !alignment_is_named("a.aln.ply") && !alignment_is_named("aln"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(reads_an_alignment),
		cmocka_unit_test(reads_a_project),
		cmocka_unit_test(reads_a_registration),
		cmocka_unit_test(refuses_with_line_and_cure),
		cmocka_unit_test(tells_every_scan_that_is_missing),
		cmocka_unit_test(refuses_more_scans_than_a_mesh_takes),
		cmocka_unit_test(refuses_every_truncation),
		cmocka_unit_test(names_of_alignments),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
