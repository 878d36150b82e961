/* Range images as scans of a content folder become one surface, which stands for them. */
#include "pipeline/content/scans.h"

#include <errno.h>
#include <sys/stat.h>

#include "tests/check.h"
#include "tests/pipeline/import/scan_text.h"
#include "tests/pipeline/octree/bumpy_ball.h"

enum { VIEWS = 14, GRID = 40 };

static char folder[256], ini_path[300];

/* The files that were written to the disk itself, in order. */
enum { SYNCS_MAX = 64 };
static ino_t synced[SYNCS_MAX];
static int sync_count;

int __real_fsync(int fd);
int __wrap_fsync(int fd);

int __wrap_fsync(int fd)
{
	struct stat status;

	if (sync_count < SYNCS_MAX && fstat(fd, &status) == 0)
		synced[sync_count++] = status.st_ino;
	return __real_fsync(fd);
}

/* SYNCS_MAX: it was not. */
static int when_synced(ino_t number)
{
	for (int i = 0; i < sync_count; i++)
		if (synced[i] == number)
			return i;
	return SYNCS_MAX;
}

static void write_ini(const char *more)
{
	char text[500];

	snprintf(text, sizeof(text), "[model]\nscans = tower.ply site.aln\n%s", more);
	scan_write_beside(ini_path, "temple.ini", text, strlen(text));
}

static const char tower[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
			    "property float y\nproperty float z\nelement face 1\n"
			    "property list uchar int vertex_indices\nend_header\n"
			    "9 0 0\n9 1 0\n9 0 1\n3 0 1 2\n";

/* A mesh far away, and 14 range images of a ball with the alignment that places them. */
static int make_folder(void **state)
{
	char path[320];
	FILE *aln;

	(void)state;
	scan_write(ini_path, "temple.ini", "", 0);
	snprintf(folder, sizeof(folder), "%.*s", (int)(strrchr(ini_path, '/') - ini_path),
		 ini_path);
	scan_write_beside(ini_path, "tower.ply", tower, strlen(tower));
	snprintf(path, sizeof(path), "%s/site.aln", folder);
	aln = fopen(path, "w");
	CHECK(aln != NULL);
	fprintf(aln, "%d\n", VIEWS);
	for (int v = 0; v < VIEWS; v++) {
		const struct transform place = ball_view(v);

		fprintf(aln, "view-%d.ply\n#\n", v);
		for (int i = 0; i < 3; i++)
			fprintf(aln, "%.17g %.17g %.17g %.17g\n", place.rows[i][0],
				place.rows[i][1], place.rows[i][2], place.rows[i][3]);
		fputs("0 0 0 1\n", aln);
		snprintf(path, sizeof(path), "%s/view-%d.ply", folder, v);
		ball_write(path, v, GRID, 0, v % 2 == 1);
	}
	fputs("0\n", aln);
	return fclose(aln);
}

static int remove_folder(void **state)
{
	(void)state;
	scan_remove(ini_path);
	return 0;
}

struct built {
	struct content content;
	struct diagnostics diagnostics;
	struct scans *scans;
	const struct mesh *mesh; /* NULL: refused, with rc */
	int rc;
};

static struct built *build(void)
{
	struct built *built = calloc(1, sizeof(*built));

	CHECK(built && content_read(&built->content, folder, &built->diagnostics) == 0);
	CHECK(scans_create(&built->scans, &built->content) == 0);
	built->rc = scans_get_mesh(built->scans, &built->mesh, &built->diagnostics);
	return built;
}

static void finish(struct built *built)
{
	scans_destroy(built->scans);
	content_release(&built->content);
	free(built);
}

/* The number of a file, which is another whenever it is made; 0: it is not there. */
static ino_t number_of(const char *name)
{
	struct stat status;
	char path[320];

	snprintf(path, sizeof(path), "%s/.work/%s", folder, name);
	return stat(path, &status) == 0 ? status.st_ino : 0;
}

static ino_t surface_number(void)
{
	return number_of("surface.ply");
}

/* In centimetres with y up, the ball's x, y and z are x, z and -y of the mesh. */
static void range_images_become_a_scan_in_metres_with_z_up(void **state)
{
	struct scans_surface surface;
	struct built *built;
	double worst = 0;
	(void)state;

	write_ini("unit = cm\nup = y\n[hierarchy]\ncell_mm = 0.5\n");
	built = build();
	if (built->rc < 0)
		fail_msg("%s", diagnostics_cause(&built->diagnostics, built->rc));
	scans_surface(built->scans, &surface);
	CHECK(surface.is_made && surface.scan_count == VIEWS && surface.point_count > 10000);
	CHECK(!surface.is_points[0] && surface.is_points[1]);
	CHECK(built->mesh->scan_count == 1 + VIEWS && built->mesh->scans[0].triangle_count == 1);
	CHECK(built->mesh->scans[1].triangle_count > 1000);
	CHECK(built->mesh->scans[1].face_count == built->mesh->scans[1].triangle_count);
	CHECK(built->mesh->scans[2].triangle_count == 0 && built->mesh->scans[2].face_count == 0);
	for (uint32_t i = 3; i < built->mesh->vertex_count; i++) {
		const float *at = built->mesh->positions[i];
		const double file[3] = { 100. * (double)at[0], 100. * (double)at[2],
					 -100. * (double)at[1] };
		const double colour = 127 + 200 * file[0];

		worst = fmax(worst, fabs(ball_outside(file)));
		CHECK(fabs(built->mesh->colours[i][2] - colour) < 12);
	}
	print_message("worst %.2f cubes\n", worst / 0.05);
	CHECK(worst < 0.01);
	finish(built);
}

static void it_is_made_again_only_if_its_own_inputs_change(void **state)
{
	struct built *built;
	ino_t first, second;
	(void)state;

	write_ini("[hierarchy]\ncell_mm = 60\n");
	finish(build());
	first = surface_number();
	CHECK(first != 0);
	/* another colour is another mesh of the same surface */
	write_ini("colours = #102030\n[hierarchy]\ncell_mm = 60\n");
	built = build();
	CHECK(built->rc == 0 && built->mesh->colours[5][0] == 0x10);
	CHECK(surface_number() == first);
	finish(built);
	write_ini("[hierarchy]\ncell_mm = 50\n");
	finish(build());
	second = surface_number();
	CHECK(second != first);
	/* a scan that is written again */
	scan_write_beside(ini_path, "view-3.ply", "ply\n", 4);
	built = build();
	CHECK(built->rc == -EBADMSG && surface_number() == second);
	CHECK(strstr(built->diagnostics.first.text, "view-3.ply"));
	finish(built);
}

/* If the power fails, a key must not be there without its surface, which the next build would take.
 */
static void it_is_on_the_disk_before_its_key(void **state)
{
	(void)state;

	write_ini("[hierarchy]\ncell_mm = 60\n");
	sync_count = 0;
	finish(build());
	CHECK(when_synced(number_of("surface.ply")) < when_synced(number_of("surface")));
	CHECK(when_synced(number_of("surface")) < SYNCS_MAX);
}

static void one_that_was_cut_off_is_made_again(void **state)
{
	struct built *built;
	char path[320];
	(void)state;

	write_ini("[hierarchy]\ncell_mm = 60\n");
	finish(build());
	snprintf(path, sizeof(path), "%s/.work/surface.ply", folder);
	CHECK(truncate(path, 5000) == 0);
	/* another colour makes the mesh anew, from the surface */
	write_ini("colours = #102030\n[hierarchy]\ncell_mm = 60\n");
	built = build();
	if (built->rc < 0)
		fail_msg("%s", diagnostics_cause(&built->diagnostics, built->rc));
	CHECK(built->mesh->scans[1].triangle_count > 1000);
	finish(built);
}

/* A ball and a triangle, which becomes a sheet; both keep the numbers of their faces. */
static void surface_octree_closes_all_scans(void **state)
{
	uint32_t open_triangles;
	struct hash open_key, key, other_key;
	struct built *built;
	(void)state;

	write_ini("[hierarchy]\ncell_mm = 60\n");
	built = build();
	CHECK(built->rc == 0 && scans_key(built->scans, &open_key, NULL) == 0);
	open_triangles = built->mesh->scans[1].triangle_count;
	finish(built);
	write_ini("[hierarchy]\nsurface = octree\ncell_mm = 60\n");
	built = build();
	if (built->rc < 0)
		fail_msg("%s", diagnostics_cause(&built->diagnostics, built->rc));
	CHECK(scans_key(built->scans, &key, NULL) == 0 && !hash_equal(key, open_key));
	CHECK(built->mesh->scan_count == 1 + VIEWS && built->mesh->scans[0].triangle_count > 100);
	CHECK(built->mesh->scans[0].triangle_count + built->mesh->scans[1].triangle_count ==
	      built->mesh->triangle_count);
	CHECK(built->mesh->scans[1].face_count == open_triangles);
	CHECK(built->mesh->triangle_count > 1000 && built->mesh->faces);
	/* two closed surfaces of genus 0 */
	CHECK(built->mesh->triangle_count == 2 * built->mesh->vertex_count - 8);
	for (uint32_t i = 0; i < built->mesh->vertex_count; i++) {
		const double at[3] = { (double)built->mesh->positions[i][0],
				       (double)built->mesh->positions[i][1],
				       (double)built->mesh->positions[i][2] };

		if (at[0] > 5)
			continue;
		CHECK(fabs(ball_outside(at)) < 0.03);
		CHECK(abs(built->mesh->colours[i][2] - (int)(127 + 200 * at[0])) < 14);
	}
	finish(built);
	write_ini("[hierarchy]\nsurface = octree\ncell_mm = 50\n");
	built = build();
	CHECK(built->rc == 0 && scans_key(built->scans, &other_key, NULL) == 0);
	CHECK(!hash_equal(key, other_key));
	finish(built);
	write_ini("[hierarchy]\nsurface = octree\ncell_mm = 0.01\n");
	built = build();
	CHECK(built->rc == -EINVAL && strstr(built->diagnostics.first.text, "correct the unit"));
	finish(built);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(range_images_become_a_scan_in_metres_with_z_up,
						make_folder, remove_folder),
		cmocka_unit_test_setup_teardown(it_is_made_again_only_if_its_own_inputs_change,
						make_folder, remove_folder),
		cmocka_unit_test_setup_teardown(it_is_on_the_disk_before_its_key, make_folder,
						remove_folder),
		cmocka_unit_test_setup_teardown(one_that_was_cut_off_is_made_again, make_folder,
						remove_folder),
		cmocka_unit_test_setup_teardown(surface_octree_closes_all_scans, make_folder,
						remove_folder),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
