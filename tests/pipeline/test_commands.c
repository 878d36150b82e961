/* What the commands of gopura-content refuse before they work. */
#include "pipeline/commands.h"

#include <getopt.h>
#include <string.h>

#include "base/bytes.h"
#include "tests/check.h"
#include "tests/pipeline/import/scan_text.h"

static const char box[] = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
			  "property float y\nproperty float z\nelement face 4\n"
			  "property list uchar int vertex_indices\nend_header\n"
			  "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
			  "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
static const char plan[] = "{\"steps\": [{\"lattice\": [1, 1, 1], \"moves\": "
			   "[{\"points\": [\"all\", \"all\", \"all\"], \"by\": [1, 0, 0]}]}]}";

static int run(int (*command)(int, char **), char **argv)
{
	int argc = 0;

	while (argv[argc])
		argc++;
	optind = 0; /* begin anew */
	return command(argc, argv);
}

static bool is_whole(const char *path, const char *text)
{
	struct buffer file;
	bool same;

	buffer_init(&file, 1 << 20);
	same = buffer_read_file(&file, path) == 0 && file.size == strlen(text) &&
	       memcmp(file.data, text, file.size) == 0;
	buffer_finish(&file);
	return same;
}

/* The original of a scan is what a museum cannot make again. */
static void a_scan_is_never_written_over(void **state)
{
	char scan[256], with[300], other[300], none[300];
	(void)state;

	scan_write(scan, "box.ply", box, strlen(box));
	snprintf(other, sizeof(other), "%s.out.ply", scan);
	snprintf(none, sizeof(none), "%s.folder/out.ply", scan);
	snprintf(with, sizeof(with), "%.*swith.json", (int)(strrchr(scan, '/') - scan) + 1, scan);
	scan_write_beside(scan, "with.json", plan, strlen(plan));

	CHECK(run(command_reconstruct, (char *[]){ "reconstruct", "--depth", "3", "--closed",
						   "--out", scan, scan, NULL }) == EXIT_FAILURE);
	CHECK(is_whole(scan, box));
	CHECK(run(command_deform, (char *[]){ "deform", "--with", with, "--out", scan, scan,
					      NULL }) == EXIT_FAILURE);
	CHECK(is_whole(scan, box));
	CHECK(run(command_deform, (char *[]){ "deform", "--with", with, "--out", with, scan,
					      NULL }) != EXIT_SUCCESS);
	CHECK(is_whole(with, plan));
	CHECK(run(command_reconstruct, (char *[]){ "reconstruct", "--depth", "3", "--closed",
						   "--out", none, scan, NULL }) == EXIT_FAILURE);

	CHECK(run(command_reconstruct, (char *[]){ "reconstruct", "--depth", "3", "--closed",
						   "--out", other, scan, NULL }) == EXIT_SUCCESS);
	CHECK(run(command_deform, (char *[]){ "deform", "--with", with, "--out", other, scan,
					      NULL }) == EXIT_SUCCESS);
	scan_remove(scan);
}

/* A PLY called upright.OBJ or upright.stl is read by no other program. */
static void what_deform_writes_is_as_its_name_says(void **state)
{
	static const char *const names[] = { "bent.OBJ", "bent.stl", "bent" };
	char scan[256], with[300], out[300];
	(void)state;

	scan_write(scan, "box.ply", box, strlen(box));
	snprintf(with, sizeof(with), "%.*swith.json", (int)(strrchr(scan, '/') - scan) + 1, scan);
	scan_write_beside(scan, "with.json", plan, strlen(plan));
	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		snprintf(out, sizeof(out), "%.*s%s", (int)(strrchr(scan, '/') - scan) + 1, scan,
			 names[i]);
		CHECK(run(command_deform,
			  (char *[]){ "deform", "--with", with, "--out", out, scan, NULL }) == 2);
		CHECK(access(out, F_OK) < 0);
	}
	scan_remove(scan);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_scan_is_never_written_over),
		cmocka_unit_test(what_deform_writes_is_as_its_name_says),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
