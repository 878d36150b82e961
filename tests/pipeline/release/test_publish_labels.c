/* Labels of a whole release: told from the surface of the scan, they say the same of every
 * hierarchy that is made of it, and change no geometry. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/label.h"
#include "geometry/region.h"
#include "pipeline/content/part_faces.h"
#include "pipeline/hierarchy/master.h"
#include "pipeline/release/nearest.h"
#include "pipeline/release/publish_hierarchy.h"
#include "pipeline/release/publish_info.h"
#include "pipeline/release/publish_labels.h"
#include "tests/check.h"
#include "tests/pipeline/shapes.h"

enum { STEPS = 40 };

static char folder[64];
static struct content content;
static struct scans *scans;
static const struct mesh *scan; /* as imported */

static void write_text(const char *name, const char *text)
{
	char path[200];

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	CHECK(bytes_write_file((struct bytes){ (const uint8_t *)text, strlen(text) }, path) == 0);
}

static void write_scan(void)
{
	struct mesh mesh = shape_temple(STEPS);
	char path[200];
	FILE *file;

	snprintf(path, sizeof(path), "%s/scan.ply", folder);
	file = fopen(path, "w");
	CHECK(file != NULL);
	fprintf(file,
		"ply\nformat ascii 1.0\nelement vertex %u\nproperty float x\nproperty float y\n"
		"property float z\nelement face %u\nproperty list uchar int vertex_indices\n"
		"end_header\n",
		mesh.vertex_count, mesh.triangle_count);
	for (uint32_t v = 0; v < mesh.vertex_count; v++)
		fprintf(file, "%.6f %.6f %.6f\n", (double)mesh.positions[v][0],
			(double)mesh.positions[v][1], (double)mesh.positions[v][2]);
	for (uint32_t t = 0; t < mesh.triangle_count; t++)
		fprintf(file, "3 %u %u %u\n", mesh.triangles[t][0], mesh.triangles[t][1],
			mesh.triangles[t][2]);
	CHECK(fclose(file) == 0);
	mesh_finish(&mesh);
}

/* The faces of the scan whose middle is below that. */
static void write_faces(float most_z)
{
	struct mesh mesh = shape_temple(STEPS);
	char path[200];
	FILE *file;

	snprintf(path, sizeof(path), "%s/regions/foot.faces", folder);
	file = fopen(path, "w");
	CHECK(file != NULL);
	for (uint32_t t = 0; t < mesh.triangle_count; t++)
		if (mesh.positions[mesh.triangles[t][0]][2] +
			    mesh.positions[mesh.triangles[t][1]][2] +
			    mesh.positions[mesh.triangles[t][2]][2] <
		    3 * most_z)
			fprintf(file, "%u\n", t);
	CHECK(fclose(file) == 0);
	mesh_finish(&mesh);
}

static const struct region sphere = { .kind = REGION_SPHERE,
				      .centre_m = { 1, 0, 0 },
				      .radius_m = 0.6f };

/* A ball at a side, the foot as faces, a point. */
static void write_parts(float radius_m)
{
	char text[800];

	snprintf(text, sizeof(text),
		 "{\"parts\":["
		 "{\"id\":\"side\",\"region\":{\"kind\":\"sphere\",\"centre\":[1,0,0],"
		 "\"radius\":%g},\"page\":false,\"title\":{\"en\":\"Side\"}},"
		 "{\"id\":\"foot\",\"region\":{\"kind\":\"faces\",\"file\":\"regions/foot.faces\"},"
		 "\"page\":false,\"title\":{\"en\":\"Foot\"}},"
		 "{\"id\":\"spot\",\"anchor\":[0,0,2.5],\"page\":false,"
		 "\"title\":{\"en\":\"Spot\"}}]}",
		 (double)radius_m);
	write_text("parts.json", text);
}

static int set_up(void **state)
{
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	char regions[80];

	(void)state;
	snprintf(folder, sizeof(folder), "/tmp/gopura-labels-XXXXXX");
	CHECK(mkdtemp(folder) != NULL);
	snprintf(regions, sizeof(regions), "%s/regions", folder);
	CHECK(mkdir(regions, 0755) == 0);
	write_text("temple.ini", "[model]\nscans = scan.ply\ncolours = #808080\n");
	write_scan();
	write_faces(-0.8f);
	write_parts(0.6f);
	CHECK(content_read(&content, folder, &diagnostics) == 0);
	CHECK(scans_create(&scans, &content) == 0);
	CHECK(scans_get_mesh(scans, &scan, &diagnostics) == 0);
	return 0;
}

static int tear_down(void **state)
{
	char command[200];

	(void)state;
	scans_destroy(scans);
	content_release(&content);
	snprintf(command, sizeof(command), "rm -rf '%s'", folder);
	return system(command);
}

/* ---- a release without samples */

struct made {
	struct object_store *objects;
	struct root_page root;
	struct page_child children[ROOT_CHILDREN_MAX];
	int labels;    /* what publish_labels said */
	bool imported; /* labels, or the place of a list of faces, needed the scan */
};

/* Empties .work/mesh: whoever needs the mesh now has to import it again, and saves it. */
static void empty_mesh(void)
{
	char path[CONTENT_PATH_BYTES];

	CHECK(content_work_path(&content, "mesh", path) == 0 && truncate(path, 0) == 0);
}

static bool is_mesh_back(void)
{
	char path[CONTENT_PATH_BYTES];
	struct stat status;

	CHECK(content_work_path(&content, "mesh", path) == 0 && stat(path, &status) == 0);
	return status.st_size > 0;
}

static struct made make(uint32_t patch_triangles)
{
	const struct master_options options = {
		.multires = { .patch_triangles = patch_triangles, .top_triangles = 300, .jobs = 2 }
	};
	const struct hash stamp = { { 1 } };
	const struct info_built *info;
	struct sources *sources;
	char place[CONTENT_PATH_BYTES];
	struct master_report report;
	struct master *master;
	struct made made = { 0 };

	CHECK(content_work_path(&content, "master", place) == 0);
	CHECK(master_build(place, scan, stamp, &options, &report) == 0);
	CHECK(master_open(&master, place, &stamp) == 0);
	made.root.lattice = master->lattice;
	CHECK(object_store_create(&made.objects) == 0);
	CHECK(publish_hierarchy(made.objects, master, 0.6, &made.children[ROOT_CHILD_HIERARCHY],
				&(struct published_patches){ 0 }) == 0);
	master_destroy(master);
	empty_mesh();
	CHECK(sources_create(&sources, &content) == 0);
	CHECK(sources_info(sources, &info) == 0);
	CHECK(publish_info(made.objects, info, folder, &made.children[ROOT_CHILD_INFO]) == 0);
	made.labels = publish_labels(made.objects, &made.root, sources, made.children,
				     &made.children[ROOT_CHILD_LABELS]);
	made.imported = is_mesh_back();
	sources_destroy(sources);
	return made;
}

static void made_finish(struct made *made)
{
	object_store_destroy(made->objects);
}

/* ---- its finest surface, and what it is labelled with */

struct surface {
	struct label_group *labels; /* of each group */
	uint32_t group_count, triangle_count, vertex_count;
	float (*positions)[3];
	uint32_t (*triangles)[3];
	uint32_t (*names)[3]; /* of each triangle: group, patch in it, triangle in that */
	struct nearest *nearest;
};

static struct page read_page(const struct made *made, struct hash hash, struct buffer *bytes)
{
	struct page page;

	buffer_init(bytes, PAGE_BYTES_MAX);
	CHECK(object_store_read(made->objects, hash, bytes) == 0);
	CHECK(page_decode(&page, buffer_bytes(bytes)) == 0);
	return page;
}

static void add_patch(struct surface *s, const struct lattice *lattice,
		      const struct patch_mesh *mesh, uint32_t group, uint32_t patch)
{
	uint32_t base = s->vertex_count;

	for (uint32_t v = 0; v < mesh->vertex_count; v++, s->vertex_count++)
		for (int i = 0; i < 3; i++)
			s->positions[s->vertex_count][i] =
				(float)(lattice->origin_m[i] +
					lattice->step_m * mesh->vertices[v].position[i]);
	for (uint32_t t = 0; t < mesh->triangle_count; t++, s->triangle_count++) {
		const uint32_t name[3] = { group, patch, t };

		memcpy(s->names[s->triangle_count], name, sizeof(name));
		for (uint32_t k = 0; k < 3; k++)
			s->triangles[s->triangle_count][k] = base + mesh->indices[3 * t + k];
	}
}

static void read_group(struct surface *s, const struct made *made,
		       const struct hierarchy *hierarchy, struct hash hash, uint32_t group)
{
	struct patch_mesh meshes[GROUP_PATCHES_MAX];
	struct buffer object;
	uint32_t count;

	buffer_init(&object, OBJECT_BYTES_MAX);
	CHECK(object_store_read(made->objects, hash, &object) == 0);
	CHECK(patch_group_decode(meshes, &count, buffer_bytes(&object)) == 0);
	for (uint32_t p = 0; p < count; p++) {
		uint32_t at = hierarchy->groups[group].first_patch + p;

		if (hierarchy->patches[at].finer == HIERARCHY_NONE)
			add_patch(s, &made->root.lattice, &meshes[p], group, p);
		patch_mesh_finish(&meshes[p]);
	}
	buffer_finish(&object);
}

static void read_labels(struct surface *s, const struct made *made)
{
	struct buffer bytes, object;
	struct page page = read_page(made, made->children[ROOT_CHILD_LABELS].hash, &bytes);
	uint32_t *child_of_group;

	CHECK(page.kind == PAGE_LABELS);
	CHECK(label_page_decode(&child_of_group, s->group_count, page.child_count, page.payload) ==
	      0);
	s->labels = calloc(s->group_count, sizeof(*s->labels));
	for (uint32_t g = 0; g < s->group_count; g++) {
		if (child_of_group[g] == LABEL_NONE)
			continue;
		buffer_init(&object, OBJECT_BYTES_MAX);
		CHECK(object_store_read(made->objects, page.children[child_of_group[g]].hash,
					&object) == 0);
		CHECK(label_group_decode(&s->labels[g], buffer_bytes(&object)) == 0);
		buffer_finish(&object);
	}
	free(child_of_group);
	page_finish(&page);
	buffer_finish(&bytes);
}

static void surface_init(struct surface *s, const struct made *made)
{
	struct buffer bytes;
	struct page page = read_page(made, made->children[ROOT_CHILD_HIERARCHY].hash, &bytes);
	struct hierarchy hierarchy;
	size_t vertices = 0, triangles = 0;

	*s = (struct surface){ 0 };
	CHECK(hierarchy_decode(&hierarchy, page.payload) == 0);
	s->group_count = hierarchy.group_count;
	for (uint32_t p = 0; p < hierarchy.patch_count; p++) {
		vertices += hierarchy.patches[p].vertex_count;
		triangles += hierarchy.patches[p].triangle_count;
	}
	s->positions = calloc(vertices, sizeof(*s->positions));
	s->triangles = calloc(triangles, sizeof(*s->triangles));
	s->names = calloc(triangles, sizeof(*s->names));
	for (uint32_t g = 0; g < hierarchy.group_count; g++)
		read_group(s, made, &hierarchy, page.children[g].hash, g);
	CHECK(nearest_create(&s->nearest, s->positions, s->triangles, s->triangle_count) == 0);
	read_labels(s, made);
	hierarchy_finish(&hierarchy);
	page_finish(&page);
	buffer_finish(&bytes);
}

static void surface_finish(struct surface *s)
{
	for (uint32_t g = 0; g < s->group_count; g++)
		label_group_finish(&s->labels[g]);
	nearest_destroy(s->nearest);
	free(s->labels);
	free(s->positions);
	free(s->triangles);
	free(s->names);
}

/* Shares of the second and third corner at a place of a triangle. */
static void shares_at(const struct surface *s, const struct nearest_place *place, float out[2])
{
	const uint32_t *t = s->triangles[place->triangle];
	const float *a = s->positions[t[0]], *b = s->positions[t[1]], *c = s->positions[t[2]];
	double ab[3], ac[3], ap[3], bb = 0, cc = 0, bc = 0, pb = 0, pc = 0, all;

	for (int i = 0; i < 3; i++) {
		ab[i] = (double)b[i] - (double)a[i];
		ac[i] = (double)c[i] - (double)a[i];
		ap[i] = (double)place->at_m[i] - (double)a[i];
		bb += ab[i] * ab[i];
		cc += ac[i] * ac[i];
		bc += ab[i] * ac[i];
		pb += ap[i] * ab[i];
		pc += ap[i] * ac[i];
	}
	all = bb * cc - bc * bc;
	out[0] = (float)((cc * pb - bc * pc) / all);
	out[1] = (float)((bb * pc - bc * pb) / all);
}

/* The part at a place of the surface ("" for none), which lies off_m from the point. */
static const char *part_at(const struct surface *s, const float point_m[3], float *off_m)
{
	struct nearest_place place;
	const uint32_t *name;
	float shares[2];
	int part = -1;

	CHECK(nearest_find(s->nearest, point_m, NULL, INFINITY, &place));
	*off_m = place.distance_m;
	name = s->names[place.triangle];
	shares_at(s, &place, shares);
	if (s->labels[name[0]].part_count > 0)
		part = label_part_at(&s->labels[name[0]], name[1], name[2], shares[0], shares[1]);
	return part < 0 ? "" : s->labels[name[0]].parts[part].id;
}

/* ---- claims */

static void middle_of(uint32_t triangle, float out[3])
{
	const uint32_t *t = scan->triangles[triangle];

	for (int i = 0; i < 3; i++)
		out[i] = (scan->positions[t[0]][i] + scan->positions[t[1]][i] +
			  scan->positions[t[2]][i]) /
			 3;
}

/* What the regions themselves say, but within a cell of an outline, where it is not told. */
static const char *truth_at(const float at[3], float slack_m)
{
	float away = region_distance(&sphere, at);

	if (fabsf(away) < slack_m || fabsf(at[2] + 0.8f) < slack_m)
		return NULL;
	return away < 0 ? "side" : at[2] < -0.8f ? "foot" : "";
}

static void labels_survive_another_hierarchy(void **state)
{
	static const uint32_t sizes[] = { 60, 130, 500 };
	const float cell_m = (float)M_PI / STEPS; /* the scan's own squares, at the equator */
	uint32_t seen[3] = { 0 };

	(void)state;
	for (int i = 0; i < 3; i++) {
		struct made made = make(sizes[i]);
		struct surface surface;

		CHECK(made.labels == 1);
		surface_init(&surface, &made);
		for (uint32_t t = 0; t < scan->triangle_count; t++) {
			const char *truth, *says;
			float at[3], off_m;

			middle_of(t, at);
			says = part_at(&surface, at, &off_m);
			truth = truth_at(at, cell_m + off_m);
			if (truth && strcmp(truth, says) != 0)
				fail_msg("patches of %u: at %g %g %g \"%s\" and not \"%s\"",
					 sizes[i], (double)at[0], (double)at[1], (double)at[2],
					 says, truth);
			seen[0] += truth && strcmp(truth, "side") == 0;
			seen[1] += truth && strcmp(truth, "foot") == 0;
			seen[2] += truth && !truth[0];
		}
		surface_finish(&surface);
		made_finish(&made);
	}
	CHECK(seen[0] > 300 && seen[1] > 300 && seen[2] > 3000);
}

static void another_region_changes_no_geometry(void **state)
{
	struct made before = make(130), after;

	(void)state;
	write_parts(0.4f);
	after = make(130);
	CHECK(hash_equal(before.children[ROOT_CHILD_HIERARCHY].hash,
			 after.children[ROOT_CHILD_HIERARCHY].hash));
	CHECK(!hash_equal(before.children[ROOT_CHILD_LABELS].hash,
			  after.children[ROOT_CHILD_LABELS].hash));
	made_finish(&before);
	made_finish(&after);
}

static void the_same_parts_give_the_same_bytes(void **state)
{
	struct made before = make(130), after;
	char path[CONTENT_PATH_BYTES];

	(void)state;
	CHECK(content_work_path(&content, "labels", path) == 0 && unlink(path) == 0);
	after = make(130);
	CHECK(hash_equal(before.children[ROOT_CHILD_LABELS].hash,
			 after.children[ROOT_CHILD_LABELS].hash));
	made_finish(&before);
	made_finish(&after);
}

static void only_what_changes_is_labelled_again(void **state)
{
	struct made before, after, damaged;
	char path[CONTENT_PATH_BYTES];
	FILE *file;

	(void)state;
	write_text(
		"parts.json",
		"{\"parts\":[{\"id\":\"ball\",\"region\":{\"kind\":\"sphere\",\"centre\":[1,0,0],"
		"\"radius\":0.6},\"page\":false,\"title\":{\"en\":\"Ball\"}}]}");
	before = make(130);
	CHECK(before.imported);
	after = make(130);
	CHECK(!after.imported);
	CHECK(hash_equal(before.children[ROOT_CHILD_LABELS].hash,
			 after.children[ROOT_CHILD_LABELS].hash));
	CHECK(content_work_path(&content, "labels", path) == 0);
	file = fopen(path, "r+");
	CHECK(file && fseek(file, -3, SEEK_END) == 0 && fputc('!', file) == '!' &&
	      fclose(file) == 0);
	damaged = make(130);
	CHECK(damaged.imported);
	CHECK(hash_equal(before.children[ROOT_CHILD_LABELS].hash,
			 damaged.children[ROOT_CHILD_LABELS].hash));
	made_finish(&before);
	made_finish(&after);
	made_finish(&damaged);
	after = make(60);
	CHECK(after.imported);
	made_finish(&after);
}

static void a_list_of_faces_needs_the_scan_only_when_it_is_new(void **state)
{
	struct made before = make(130), after;

	(void)state;
	CHECK(before.imported);
	after = make(130);
	CHECK(!after.imported);
	CHECK(hash_equal(before.children[ROOT_CHILD_INFO].hash,
			 after.children[ROOT_CHILD_INFO].hash));
	CHECK(hash_equal(before.children[ROOT_CHILD_LABELS].hash,
			 after.children[ROOT_CHILD_LABELS].hash));
	made_finish(&after);
	write_faces(-0.7f);
	after = make(130);
	CHECK(after.imported);
	CHECK(!hash_equal(before.children[ROOT_CHILD_INFO].hash,
			  after.children[ROOT_CHILD_INFO].hash));
	CHECK(!hash_equal(before.children[ROOT_CHILD_LABELS].hash,
			  after.children[ROOT_CHILD_LABELS].hash));
	made_finish(&before);
	made_finish(&after);
}

static void points_alone_need_no_labels(void **state)
{
	struct made made;

	(void)state;
	write_text("parts.json", "{\"parts\":[{\"id\":\"spot\",\"anchor\":[0,0,2.5],\"page\":false,"
				 "\"title\":{\"en\":\"Spot\"}}]}");
	made = make(130);
	CHECK(made.labels == 0);
	made_finish(&made);
}

static void faces_that_cannot_be_are_told_before_the_long_work(void **state)
{
	static const struct {
		const char *region, *says;
	} cases[] = {
		{ "{\"kind\":\"faces\"}", "needs a \"file\"" },
		{ "{\"kind\":\"faces\",\"file\":\"regions/none.faces\"}", "none.faces" },
		{ "{\"kind\":\"faces\",\"file\":\"foot.faces\"}", "lie in regions/" },
		{ "{\"kind\":\"faces\",\"file\":\"regions/../../foot.faces\"}",
		  "not a file within" },
		{ "{\"kind\":\"faces\",\"file\":\"regions/bad.faces\"}", "bad.faces:2" },
		{ "{\"kind\":\"faces\",\"file\":\"regions/foot.faces\",\"scan\":\"other.ply\"}",
		  "none of the scans" },
	};
	static const char *const languages[] = { "en" };

	(void)state;
	write_text("regions/bad.faces", "1\n99999999\n");
	empty_mesh();
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct diagnostics told = { 0 };
		struct part_faces_all faces;
		const struct info_build_options options = { .folder = folder,
							    .languages = languages,
							    .language_count = 1,
							    .diagnostics = &told,
							    .judge_faces = part_faces_judge,
							    .faces_data = &faces };
		struct draft *draft;
		char text[400];

		snprintf(text, sizeof(text),
			 "{\"parts\":[{\"id\":\"foot\",\"region\":%s,\"page\":false,"
			 "\"title\":{\"en\":\"Foot\"}}]}",
			 cases[i].region);
		write_text("parts.json", text);
		part_faces_init(&faces, scans);
		CHECK(info_read(&draft, &options) == -EINVAL);
		if (!strstr(told.first.text, cases[i].says))
			fail_msg("case %zu says: %s", i, told.first.text);
		part_faces_finish(&faces);
	}
	CHECK(!is_mesh_back());
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(labels_survive_another_hierarchy, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(another_region_changes_no_geometry, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(the_same_parts_give_the_same_bytes, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(only_what_changes_is_labelled_again, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_list_of_faces_needs_the_scan_only_when_it_is_new,
						set_up, tear_down),
		cmocka_unit_test_setup_teardown(points_alone_need_no_labels, set_up, tear_down),
		cmocka_unit_test_setup_teardown(faces_that_cannot_be_are_told_before_the_long_work,
						set_up, tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
